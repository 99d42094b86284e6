//! Common complaints about navigation stacks as simulated runs: the scenes of
//! `docs/lab/complaints.md`.
//!
//! The bounds say what a user would still accept as solved. They are not today's measurements.

use keyway::files::{find_robot, find_stack};
use keyway::geometry::{Point, wrap_angle};
use keyway::local::Explanation;
use keyway::map::formats::read_map;
use keyway::navigate::{Misfit, RecoveryCounts};
use keyway::robot::Robot;
use keyway_sim::episode::{
    Cycle, CycleReport, Episode, EpisodeObserver, EpisodeOutcome, RobotReport, RunOptions,
    StepName, run_episode, watch_episode,
};
use keyway_sim::scene_files::read_scene;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/complaints")
}

fn episode(name: &str) -> Episode {
    let scene = read_scene(&folder().join(name).with_extension("toml")).unwrap();
    let map = scene.generated_map().map_or_else(
        || read_map(&folder().join(scene.map.as_ref().unwrap()), None).unwrap().into(),
        Result::unwrap,
    );
    let robot = find_robot(&scene.robot, &folder()).unwrap();
    let stack = find_stack(&scene.stack, &folder(), &robot).unwrap();
    scene.episode_with(map, &robot, &stack).unwrap()
}

/// A run that reaches its goal without contact.
fn reached(name: &str) -> (Episode, RobotReport) {
    let episode = episode(name);
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{name}: {:?}", report.reason);
    (episode, report)
}

/// Position and velocity of the robot at the end of a cycle.
#[derive(Clone, Copy, Debug)]
struct At {
    place: Point,
    yaw_rad: f64,
    v_mps: f64,
    omega_radps: f64,
}

fn drive(report: &RobotReport) -> Vec<At> {
    let rows = report.trajectory.as_ref().unwrap().iter();
    let at = |&[_, x, y, yaw_rad, v_mps, omega_radps]: &[f64; 6]| At {
        place: Point::new(x, y),
        yaw_rad,
        v_mps,
        omega_radps,
    };
    rows.map(at).collect()
}

fn end(report: &RobotReport) -> At {
    *drive(report).last().unwrap()
}

/// Number of changes of turning direction; turn rates below 0.05 rad/s count as none.
fn turning_back(drive: &[At]) -> usize {
    let turns = drive.iter().map(|at| at.omega_radps).filter(|omega| omega.abs() > 0.05);
    let turns: Vec<f64> = turns.collect();
    turns.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
}

fn near(drive: &[At], place: Point, within_m: f64) -> Vec<At> {
    drive.iter().copied().filter(|at| at.place.distance(place) < within_m).collect()
}

#[test]
fn shaking_near_the_goal_and_near_an_obstacle() {
    let (episode, report) = reached("shaking");
    let drive = drive(&report);
    let at_goal = near(&drive, episode.robots[0].goal.position, 1.0);
    let at_obstacle = near(&drive, episode.obstacles[0].centre, 1.2);
    assert!(at_goal.len() > 10 && at_obstacle.len() > 10);
    assert!(turning_back(&at_goal) <= 1, "{}", turning_back(&at_goal));
    assert!(turning_back(&at_obstacle) <= 2, "{}", turning_back(&at_obstacle));
    // In the last metre it does not stop and restart.
    let stops = at_goal.windows(2).filter(|pair| pair[0].v_mps > 0.0 && pair[1].v_mps == 0.0);
    assert_eq!(stops.count(), 1);
}

/// Observer that keeps the reports of all cycles.
#[derive(Default)]
struct Reasons(Vec<CycleReport>);

impl EpisodeObserver for Reasons {
    fn decided(&mut self, cycle: &Cycle<'_>) {
        self.0.push(CycleReport::of(cycle, &cycle.navigator.explain()));
    }
}

fn reasons(name: &str, time_limit_s: f64) -> Vec<CycleReport> {
    let mut episode = episode(name);
    episode.rules.time_limit_s = Some(time_limit_s);
    let mut reasons = Reasons::default();
    watch_episode(&episode, RunOptions::default(), std::slice::from_mut(&mut reasons)).unwrap();
    reasons.0
}

#[test]
fn no_valid_trajectory_says_which_rule_and_what_would_free_the_robot() {
    let cycles = reasons("boxed_in", 0.5);
    let first = &cycles[0];
    assert_eq!((first.step, first.driving), (StepName::Blocked, 0));
    assert!(first.candidates > 10);
    assert!(first.rejected.count("contact") > 0, "{:?}", first.rejected);
    let reason = first.reason.as_ref().unwrap();
    assert!(reason.contains("touch something"), "{reason}");
    // Each remedy was tried; the tests of the explanations apply them.
    assert!(first.remedies.iter().any(|remedy| remedy.frees), "{:?}", first.remedies);
    let ends = run_episode(&episode("boxed_in")).unwrap().first();
    assert_eq!(ends.outcome, EpisodeOutcome::Stuck);
    assert!(ends.run.unwrap().time_s < 30.0);
    let why = ends.reason.unwrap();
    assert!(why.contains("candidate velocities moves the robot ("), "{why}");
}

#[test]
fn a_narrow_door_is_passed_near_its_middle() {
    let (_, report) = reached("narrow_door");
    // It cannot turn on the spot in front of the door, and drives a curve.
    assert!(matches!(report.misfit, Some(Misfit::Turn { .. })), "{:?}", report.misfit);
    // The wall is from x = 2.9 to 3.1 m, the door from y = 2.3 to 2.8 m: 3.5 cm of clearance on
    // each side. The robot approaches at an angle and straightens, and is through in two cycles.
    let drive = drive(&report);
    let inside = || drive.iter().filter(|at| (2.9..3.1).contains(&at.place.x));
    assert!(inside().count() > 1);
    for at in inside() {
        assert!((at.place.y - 2.55).abs() < 0.02, "{at:?}");
        assert!(at.yaw_rad.abs() < 0.25, "{at:?}");
    }
    let run = report.run.unwrap();
    let margin_m = Robot::jackal().safety_margin_or_default_m();
    assert!(run.time_s < 10.0 && run.min_clearance_m.unwrap() > margin_m - 1e-4);
}

#[test]
fn the_blocked_path_does_not_pull_the_robot_back() {
    let (episode, report) = reached("blocked_path");
    let obstacle = episode.obstacles[0].centre;
    let drive = drive(&report);
    let nearest = (0..drive.len())
        .min_by(|&a, &b| {
            let away_m = |i: usize| drive[i].place.distance(obstacle);
            away_m(a).total_cmp(&away_m(b))
        })
        .unwrap();
    // Once past the obstacle, it never comes nearer again.
    let after = drive[nearest..].windows(2);
    let mut away_m = after.map(|pair| [0, 1].map(|i| pair[i].place.distance(obstacle)));
    assert!(away_m.all(|[before, then]| then > before - 0.01 || then > 2.0));
    let run = report.run.as_ref().unwrap();
    assert!(run.length_m < 1.05 * report.smoothed.as_ref().unwrap().length_m);
    assert_eq!(run.recoveries, RecoveryCounts::default());
}

#[test]
fn a_u_trap_is_left_by_its_open_side() {
    let (_, report) = reached("u_trap");
    let drive = drive(&report);
    let turned = drive.iter().position(|at| at.place.x < 0.3).unwrap();
    // The trap is not entered again.
    let is_inside =
        |at: &At| at.place.x > 0.5 && at.place.x < 2.0 && (0.6..2.0).contains(&at.place.y);
    assert!(drive[0].place.x > 1.0 && !drive[turned..].iter().any(is_inside));
    assert!(report.run.unwrap().time_s < 60.0);
}

#[test]
fn every_velocity_has_its_reasons() {
    let cycles = reasons("shaking", 4.0);
    let decided = cycles.iter().filter_map(|cycle| Some((cycle, cycle.chosen.as_ref()?)));
    let decided: Vec<_> = decided.collect();
    assert!(decided.len() > 30);
    for (cycle, chosen) in decided {
        let sum = chosen.shares.total();
        assert!((sum - chosen.score).abs() < 1e-9);
        assert_eq!(cycle.command, Some(chosen.velocity));
        let second = cycle.runner_up.as_ref().unwrap();
        assert!(second.score <= chosen.score && second.velocity != chosen.velocity);
        let refused: u32 = cycle.rejected.as_slice().iter().map(|one| one.count).sum();
        assert!(refused < cycle.candidates);
    }
}

/// A robot that drives towards a walker ahead of it is reported as driving.
#[test]
fn who_drives_up_to_a_walker_is_said_to_drive() {
    let cycles = reasons("pacing", 1.0);
    let near = cycles.iter().filter(|cycle| !cycle.movers.is_empty());
    assert!(near.count() > 10);
    for cycle in cycles {
        assert!(cycle.driving > 0 && cycle.remedies.is_empty(), "{cycle:?}");
        let refused: u32 = cycle.rejected.as_slice().iter().map(|one| one.count).sum();
        assert!(refused + cycle.driving <= cycle.candidates, "{cycle:?}");
    }
}

#[test]
fn people_who_walk_across_the_way_are_not_run_into() {
    let (_, report) = reached("crossing");
    let run = report.run.unwrap();
    assert!(run.min_mover_clearance_m.unwrap() > 0.05, "{:?}", run.min_mover_clearance_m);
    assert!(run.time_s < 60.0);
}

/// A walker moves to and fro in the gap ahead. A robot that only waits for it makes no progress.
#[test]
fn who_walks_to_and_fro_is_gone_around() {
    let (_, report) = reached("pacing");
    let run = report.run.unwrap();
    assert!(
        run.time_s < 9.0 && run.recoveries.go_around == 1,
        "{} s, {:?}",
        run.time_s,
        run.recoveries
    );
    let mut waits = episode("pacing");
    waits.robots[0].stack.controller.go_around = false;
    let outcome = run_episode(&waits).unwrap().first().outcome;
    assert_eq!(outcome, EpisodeOutcome::Stuck, "otherwise the scene shows nothing");
}

/// Observer that keeps the obstacles that are avoided by a detour in each cycle.
#[derive(Default)]
struct Walked(Vec<Vec<[f64; 3]>>);

impl EpisodeObserver for Walked {
    fn decided(&mut self, cycle: &Cycle<'_>) {
        self.0.push(CycleReport::of(cycle, &Explanation::default()).walked);
    }
}

#[test]
fn what_is_gone_around_is_said() {
    let (episode, mut walked) = (episode("pacing"), Walked::default());
    watch_episode(&episode, RunOptions::default(), std::slice::from_mut(&mut walked)).unwrap();
    let first = walked.0.iter().position(|discs| !discs.is_empty()).unwrap();
    assert!(
        first as f64 * episode.robots[0].robot.cycle_s > 2.0,
        "only after it has waited: {first}"
    );
    for [x, y, radius_m] in &walked.0[first] {
        assert!((x - 5.45).abs() < 0.2 && (2.3..4.1).contains(y), "{x} {y}");
        assert!((radius_m - 0.25).abs() < 0.1, "{radius_m}");
    }
}

#[test]
fn the_whole_footprint_turns_without_contact() {
    let (episode, report) = reached("turning_room");
    let room_m = episode.robots[0].start.position.x - 0.1;
    assert!(
        room_m < episode.robots[0].robot.footprint.circumscribed_radius_m(),
        "no room on the spot"
    );
    assert!(report.run.unwrap().min_clearance_m.unwrap() > 0.0);
}

#[test]
fn a_rectangle_turns_while_it_has_room_to() {
    let mut episode = episode("open_hall");
    // Backing up would help the robot, too.
    episode.robots[0].robot.limits.v_min_mps = 0.0;
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    let run = report.run.unwrap();
    assert!(run.min_clearance_m.unwrap() > 0.0 && run.time_s < 40.0);
}

/// The robot can neither turn nor back up: it leaves the wall on a wide arc.
#[test]
fn a_rectangle_close_beside_a_wall_gets_away() {
    let (_, report) = reached("beside_a_wall");
    let run = report.run.unwrap();
    assert!(run.min_clearance_m.unwrap() > 0.0 && run.time_s < 10.0, "{}", run.time_s);
}

#[test]
fn the_goal_is_met_with_its_heading() {
    let (episode, report) = reached("final_turn");
    let (end, controller) = (end(&report), &episode.robots[0].stack.controller);
    assert_eq!((end.v_mps, end.omega_radps), (0.0, 0.0));
    assert!(end.place.distance(episode.robots[0].goal.position) <= controller.goal_tolerance_m);
    let off_rad = wrap_angle(end.yaw_rad - episode.robots[0].goal.heading_rad.unwrap());
    assert!(off_rad.abs() <= controller.goal_yaw_tolerance_rad, "{off_rad}");
    // The final turn has a single direction, and is at most half a turn.
    let drive = drive(&report);
    let stands = drive.iter().rposition(|at| at.v_mps != 0.0).unwrap() + 1;
    assert_eq!(turning_back(&drive[stands..]), 0);
    let turned_rad: f64 = drive[stands..].iter().map(|at| at.omega_radps.abs()).sum::<f64>()
        * episode.robots[0].robot.cycle_s;
    assert!(turned_rad < std::f64::consts::PI + 0.1, "{turned_rad}");
}

#[test]
fn neither_zigzag_nor_along_the_walls() {
    let (_, report) = reached("zigzag");
    let run = report.run.as_ref().unwrap();
    // A bend of the route turns it once to each side; the last key point is the goal.
    let bends = report.key_points_m.as_ref().unwrap().len() - 1;
    assert!(turning_back(&drive(&report)) <= 2 * bends, "{bends} bends");
    assert!(run.length_m < 1.02 * report.smoothed.as_ref().unwrap().length_m);
    assert!(run.min_clearance_m.unwrap() > 0.005);
}

#[test]
fn a_dead_end_is_left_for_another_way() {
    let (_, report) = reached("dead_end");
    // It leaves as soon as it sees the dead end, 3.5 m ahead, not in front of it.
    let in_corridor = drive(&report).into_iter().filter(|at| at.place.y < 1.6 && at.place.x < 7.4);
    let farthest_m = in_corridor.map(|at| at.place.x).fold(0.0, f64::max);
    assert!(farthest_m < 6.0, "{farthest_m}");
    assert!(report.run.unwrap().time_s < 80.0);
}

#[test]
fn a_corridor_that_closes_is_left() {
    let (_, report) = reached("closing_corridor");
    assert!(drive(&report).iter().any(|at| at.place.y > 2.6), "by the other corridor");
    let run = report.run.unwrap();
    assert!(run.min_clearance_m.unwrap() > 0.0 && run.time_s < 80.0);
}

#[test]
fn a_wrong_heading_at_the_start_is_mended_backwards() {
    let (_, report) = reached("wrong_heading");
    assert!(drive(&report).iter().any(|at| at.v_mps < -0.05));
    assert!(report.run.unwrap().time_s < 60.0);
}

/// Every scene is on the page, and every test named by the page exists.
#[test]
fn the_page_lists_scenes_and_tests() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/lab/complaints.md");
    let page = std::fs::read_to_string(page).unwrap();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let is_scene = path.extension().is_some_and(|end| end == "toml") && name != "long.toml";
        assert!(!is_scene || page.contains(&format!("(../../scenes/complaints/{name})")), "{name}");
    }
    let here = include_str!("complaints.rs");
    let rows: Vec<&str> =
        page.lines().filter(|line| line.starts_with("| ") && line.contains(".toml")).collect();
    assert!(rows.len() > 10);
    for row in rows {
        let test = row.split('`').nth(1);
        let test = test.unwrap_or_else(|| panic!("no test in {row}"));
        assert!(here.contains(&format!("fn {test}()")), "{test}");
    }
}
