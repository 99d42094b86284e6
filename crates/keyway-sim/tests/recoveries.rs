//! Whole runs with dead ends, wrong headings, corridors that close, hidden guide points, goals
//! with a heading, and way-points.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

#[path = "../../keyway/tests/support/driving.rs"]
mod driving;

use driving::bound_for;
use keyway::geometry::{Disc, Point, wrap_angle};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{Goal, NavigateError, RecoveryCounts, RecoveryKind, Stack};
use keyway::robot::{Footprint, Limits, Robot};
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, Start, run_episode};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// A map with cells of 0.1 m from a drawing of square blocks.
fn drawn(rows: &[&str], cells_per_block: u64) -> OccupancyGrid {
    let coarse = OccupancyGrid::from_ascii(rows);
    let (width, height) = (coarse.frame().width(), coarse.frame().height());
    let cells = |blocks: u32| u64::from(blocks) * cells_per_block;
    let origin = keyway::geometry::Pose::default();
    let frame = GridFrame::new(cells(width), cells(height), 0.1, origin).unwrap();
    let block = cells_per_block as i32;
    OccupancyGrid::from_fn(frame, |cell| {
        coarse.state(keyway::map::Cell::new(cell.x / block, cell.y / block)).unwrap()
    })
}

/// Two corridors of 1 m from a hall on the left to one on the right; the lower one is shorter.
fn two_corridors() -> OccupancyGrid {
    drawn(
        &[
            "####################",
            "#..................#",
            "#..................#",
            "#...############...#",
            "#...############...#",
            "#..................#",
            "#..................#",
            "####################",
        ],
        5,
    )
}

/// Discs of radius 0.1 m side by side.
fn fence(from: [f64; 2], to: [f64; 2]) -> Vec<Disc> {
    let (from, to) = (Point::from(from), Point::from(to));
    let count = (from.distance(to) / 0.15).ceil();
    let place = |i: i32| from.lerp(to, f64::from(i) / count);
    (0..=count as i32).map(|i| Disc::new(place(i), 0.1)).collect()
}

fn clearance_m(report: &RobotReport) -> f64 {
    report.run.as_ref().unwrap().min_clearance_m.unwrap()
}

fn tried(report: &RobotReport) -> RecoveryCounts {
    report.run.as_ref().unwrap().recoveries
}

/// Pose and velocity at the end: x, y, yaw, v, omega.
fn end(report: &RobotReport) -> [f64; 5] {
    let [_, end @ ..] = *report.trajectory.as_ref().unwrap().last().unwrap();
    end
}

fn across(obstacles: Vec<Disc>) -> Episode {
    let (start, goal) = (Point::new(1.0, 1.2), Point::new(9.0, 1.0));
    Episode { obstacles, ..Episode::new(two_corridors(), Robot::small(), start, goal) }
}

#[test]
fn a_corridor_that_is_closed_is_left_for_the_other_one() {
    // At the far end of the lower corridor, beyond the sensor's range at its entrance.
    let report = run_episode(&across(fence([7.5, 0.5], [7.5, 1.5]))).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(clearance_m(&report) > 0.0);
    let rows = report.trajectory.as_ref().unwrap();
    assert!(rows.iter().any(|row| row[2] > 2.6), "through the upper corridor");
    // The robot turns back as soon as it senses the fence, 3.5 m ahead, not in front of it.
    let farthest_m = rows.iter().filter(|row| row[2] < 1.6).map(|row| row[1]);
    let farthest_m = farthest_m.filter(|x| *x < 7.5).fold(0.0, f64::max);
    assert!(farthest_m < 6.0, "{farthest_m}");
}

#[test]
fn where_both_corridors_are_closed_the_run_ends_soon_and_says_why() {
    let mut fences = fence([7.5, 0.5], [7.5, 1.5]);
    fences.extend(fence([7.5, 2.5], [7.5, 3.5]));
    let report = run_episode(&across(fences)).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck);
    assert!(clearance_m(&report) > 0.0);
    let reason = report.reason.as_ref().unwrap();
    assert!(reason.contains("with the sensed obstacles, no path to the goal exists"), "{reason}");
    // Twice through a corridor of 6 m at 0.5 m/s, plus 20 s without progress.
    let time_s = report.run.as_ref().unwrap().time_s;
    assert!(time_s < 80.0, "{time_s}");
}

#[test]
fn a_key_point_under_an_obstacle_is_replaced() {
    // Around the corner of the wall, where the route turns.
    let map = drawn(
        &[
            "##########",
            "#........#",
            "#........#",
            "######...#",
            "#........#",
            "#........#",
            "##########",
        ],
        5,
    );
    let (start, goal) = (Point::new(1.0, 0.9), Point::new(1.0, 2.6));
    let clear =
        run_episode(&Episode::new(map.clone(), Robot::small(), start, goal)).unwrap().first();
    let corner = clear.key_points_m.as_ref().unwrap()[0];
    let obstacles = vec![Disc::new(corner, 0.12)];
    let episode = Episode { obstacles, ..Episode::new(map, Robot::small(), start, goal) };
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(clearance_m(&report) > 0.0);
    // No waiting in front of the obstacle.
    let [time_s, clear_s] = [&report, &clear].map(|one| one.run.as_ref().unwrap().time_s);
    assert!(time_s < clear_s + 8.0, "{time_s} s instead of {clear_s} s");
}

/// A slot slightly narrower than the length of a rectangle, which opens into a hall.
fn slot() -> OccupancyGrid {
    drawn(
        &[
            "######################",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#....................#",
            "#.....################",
            "#.....################",
            "#.....################",
            "#.....################",
            "#.....################",
            "#.....################",
            "#.....################",
            "######################",
        ],
        1,
    )
}

/// A robot of 0.56 m x 0.34 m, which cannot turn around in the slot of 0.5 m.
fn long_robot(v_min_mps: f64) -> Robot {
    let small = Robot::small();
    let limits = Limits { v_min_mps, ..small.limits };
    Robot { footprint: Footprint::rectangle(0.56, 0.34).unwrap(), limits, ..small }
}

fn facing(episode: Episode, start: Start) -> Episode {
    episode.with_each_robot(|robot| robot.start = start)
}

fn out_of_the_slot(robot: Robot, yaw_deg: f64) -> Episode {
    let (position, goal) = (Point::new(0.35, 0.45), Point::new(1.7, 1.2));
    let start = Start { position, heading_rad: Some(yaw_deg.to_radians()) };
    facing(Episode::new(slot(), robot, position, goal), start)
}

#[test]
fn a_wrong_heading_at_the_start() {
    let report = run_episode(&out_of_the_slot(long_robot(0.0), 100.0)).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(clearance_m(&report) > 0.0);
    // Facing the dead end, the robot backs out: with a dynamic window by a recovery, with
    // space-time trajectories without one.
    let mut backs_out = out_of_the_slot(long_robot(-0.3), -90.0);
    for (stack, is_recovery) in [("key-point-fusion", true), ("keyway", false)] {
        backs_out.robots[0].stack = Stack::by_name(stack, &backs_out.robots[0].robot).unwrap();
        let report = run_episode(&backs_out).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        assert!(clearance_m(&report) > 0.0);
        assert_eq!(tried(&report).manoeuvre > 0, is_recovery, "{:?}", tried(&report));
        let rows = report.trajectory.as_ref().unwrap();
        assert!(rows.iter().any(|row| row[4] < -0.05), "it drove backwards");
    }
}

/// Two rooms of 4.7 m x 3.1 m, one above the other, and a door of 0.55 m between them.
fn rooms_with_a_door() -> OccupancyGrid {
    let origin = keyway::geometry::Pose { x: -5.0, y: -5.0, theta: 0.0 };
    let frame = GridFrame::new(200, 200, 0.05, origin).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let Point { x, y } = frame.world_from_cell(cell);
        let is_outside = x.abs() > 2.34 || y.abs() > 3.18;
        let is_wall = y.abs() < 0.05 && !(-0.09..0.445).contains(&x);
        if is_outside || is_wall { CellState::Occupied } else { CellState::Free }
    })
}

/// The goal is beside the door: the robot must not turn towards it with its front in the door.
#[test]
fn a_long_nose_without_a_reverse_gear_comes_through_a_door() {
    let corners = [[0.55, 0.195], [-0.22, 0.195], [-0.22, -0.195], [0.55, -0.195]];
    let mut robot = Robot::small();
    robot.footprint = Footprint::polygon(corners.map(Point::from).to_vec()).unwrap();
    robot.cycle_s = 0.05;
    robot.limits = Limits {
        v_min_mps: 0.0,
        v_max_mps: 2.97,
        omega_max_radps: 3.0,
        acceleration_mps2: 2.5,
        deceleration_mps2: 2.5,
        angular_acceleration_radps2: 6.0,
        angular_deceleration_radps2: 6.0,
        ..robot.limits
    };
    (robot.sensors[0].beams, robot.sensors[0].range_m) = (720, 20.0);
    let (position, goal) = (Point::new(0.992, 2.171), Point::new(1.217, -0.451));
    let start = Start { position, heading_rad: Some(66.7f64.to_radians()) };
    let episode = Episode::new(rooms_with_a_door(), robot, position, goal);
    let report = run_episode(&facing(episode, start)).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert!(clearance_m(&report) > 0.0);
}

#[test]
fn a_dead_end_that_nothing_leads_out_of() {
    // The robot can neither turn around nor drive backwards.
    let report = run_episode(&out_of_the_slot(long_robot(0.0), -90.0)).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck);
    assert!(clearance_m(&report) > 0.0);
    let run = report.run.as_ref().unwrap();
    assert!(run.time_s < 40.0 && tried(&report).wait > 0, "{} s {:?}", run.time_s, tried(&report));
}

#[test]
fn recoveries_are_data() {
    let mut episode = out_of_the_slot(long_robot(-0.3), -90.0);
    episode.robots[0].stack = Stack::key_point_fusion(&episode.robots[0].robot);
    episode.robots[0].stack.controller.recoveries = vec![RecoveryKind::Wait].into();
    let report = run_episode(&episode).unwrap().first();
    let RecoveryCounts { replan, turn, manoeuvre, back_up, wait, .. } = tried(&report);
    assert_eq!((replan, turn, manoeuvre, back_up), (0, 0, 0, 0));
    assert!(wait > 1, "{wait}");
    episode.robots[0].stack.controller.recoveries = vec![].into();
    assert_eq!(tried(&run_episode(&episode).unwrap().first()), RecoveryCounts::default());
}

#[test]
fn a_goal_is_reached_standing_and_facing_where_it_is_to() {
    for robot in [Robot::small(), Robot::jackal()] {
        for heading_rad in
            [None, Some(0.0), Some(120.0), Some(-135.0)].map(|deg| deg.map(f64::to_radians))
        {
            let goal = Goal { position: Point::new(8.6, 1.1), heading_rad };
            let map = two_corridors();
            let episode = Episode::new(map, robot.clone(), Point::new(6.0, 1.0), goal);
            let report = run_episode(&episode).unwrap().first();
            assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
            let [x, y, yaw, v, omega] = end(&report);
            assert_eq!([v, omega], [0.0, 0.0], "it stands");
            let tolerance_m = episode.robots[0].stack.controller.goal_tolerance_m;
            assert!(Point::new(x, y).distance(goal.position) <= tolerance_m);
            let Some(heading_rad) = heading_rad else { continue };
            let off_rad = wrap_angle(yaw - heading_rad);
            assert!(off_rad.abs() <= episode.robots[0].stack.controller.goal_yaw_tolerance_rad);
            // Once stationary at the goal, the robot turns in one direction only, by at most half
            // a turn.
            let rows = report.trajectory.as_ref().unwrap();
            let first = rows.iter().rposition(|row| row[4] != 0.0).unwrap() + 1;
            let turns = rows[first..].iter().map(|row| row[5]).filter(|omega| *omega != 0.0);
            let turns: Vec<f64> = turns.collect();
            assert!(turns.windows(2).all(|pair| pair[0] * pair[1] > 0.0), "{turns:?}");
            let turned_rad: f64 = turns.iter().sum::<f64>().abs() * robot.cycle_s;
            assert!(turned_rad < PI + 0.1, "{turned_rad}");
        }
    }
}

/// Turning towards the path, or to the heading at the goal, is progress. Neither takes a
/// recovery.
#[test]
fn who_turns_slowly_is_not_stuck() {
    let slow = |omega_max_radps: f64| {
        let mut robot = Robot::small();
        robot.limits.omega_max_radps = omega_max_radps;
        robot
    };
    let room = || drawn(&["#########", "#.......#", "#.......#", "#.......#", "#########"], 10);
    let (start, goal) = (Point::new(2.0, 2.5), Point::new(7.0, 2.5));
    let away = Start { position: start, heading_rad: Some(PI) };
    // Half a circle at 0.1 rad/s takes 31 s, and a run is stuck after 20 s without progress.
    let report = run_episode(&facing(Episode::new(room(), slow(0.1), start, goal), away));
    let report = report.unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert_eq!(tried(&report).total(), 0);
    let turned = Start { position: start, heading_rad: Some(0.0) };
    let goal = Goal { position: start, heading_rad: Some(PI) };
    let report = run_episode(&facing(Episode::new(room(), slow(0.5), start, goal), turned));
    let report = report.unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    // 6.3 s at full turn rate, plus acceleration and deceleration.
    let time_s = report.run.as_ref().unwrap().time_s;
    assert!(time_s < 1.2 * 6.4, "{time_s}");
}

#[test]
fn a_goal_without_room_for_its_heading_is_not_reached() {
    // At the bottom of the slot only the heading along it fits. The slot is unmapped.
    let goal = Goal { position: Point::new(0.35, 0.5), heading_rad: Some(0.0) };
    let position = Point::new(0.45, 1.3);
    let start = Start { position, heading_rad: Some(-FRAC_PI_2) };
    let (slot, robot) = (slot(), long_robot(0.0));
    let known = OccupancyGrid::from_fn(*slot.frame(), |_| CellState::Free);
    let hidden_cells = slot.frame().cells().filter(|&cell| slot.occupied().get(cell)).collect();
    let episode = Episode::new(known, robot, position, goal);
    let report = run_episode(&Episode { hidden_cells, ..facing(episode, start) }).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck, "{:?}", end(&report));
    let reason = report.reason.unwrap();
    assert!(reason.contains("no space at the goal to turn"), "{reason}");
}

/// If the footprint does not fit on the map with the heading at the goal, the goal is refused.
#[test]
fn a_goal_at_whose_heading_the_footprint_does_not_fit_is_refused() {
    let (map, robot) = (slot(), long_robot(0.0));
    let stack = Stack::keyway(&robot);
    let ask = |yaw_deg: f64| {
        let goal = Goal::try_from(vec![0.35, 0.5, yaw_deg]).unwrap();
        bound_for(&map, &stack.fit(&robot).unwrap(), Point::new(0.45, 1.3), goal).map(drop)
    };
    let refused = ask(0.0).unwrap_err();
    let NavigateError::GoalHeading { heading_rad, fits, .. } = &refused else {
        panic!("{refused}")
    };
    assert_eq!((*heading_rad, fits.len()), (0.0, 2), "{refused}");
    let text = refused.to_string();
    assert!(text.starts_with("at the goal (0.35, 0.5) the robot ("), "{text}");
    assert!(
        text.contains("does not fit with a yaw of 0 deg; it fits there with a yaw of -"),
        "{text}"
    );
    // The reported range fits, and headings beyond it do not.
    for range in fits {
        assert_eq!((ask(range.from_deg), ask(range.to_deg)), (Ok(()), Ok(())));
        let off_deg = 1.0 + stack.controller.goal_yaw_tolerance_rad.to_degrees();
        assert!(ask(range.from_deg - off_deg).is_err() && ask(range.to_deg + off_deg).is_err());
    }
}

#[test]
fn way_points_are_passed_in_their_order() {
    let via = vec![Point::new(9.0, 3.0), Point::new(1.0, 3.0)];
    let episode = across(vec![]).with_each_robot(|robot| robot.via = via.clone());
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    let passed = report.run.as_ref().unwrap().way_points.as_ref().unwrap();
    let times: Vec<f64> = passed.iter().map(|part| part.passed_s.unwrap()).collect();
    assert!(times[0] > 10.0 && times[1] > times[0] + 10.0, "{times:?}");
    let tolerance_m = episode.robots[0].stack.controller.goal_tolerance_m;
    let rows = report.trajectory.as_ref().unwrap();
    for (point, time_s) in via.iter().zip(&times) {
        let row = rows.iter().find(|row| (row[0] - time_s).abs() < 1e-6).unwrap();
        assert!(Point::new(row[1], row[2]).distance(*point) <= tolerance_m);
        assert!(row[4] > 0.0, "a way-point is no stop");
    }
    assert_eq!(report.inputs.via, Some(via));
    assert_eq!(run_episode(&across(vec![])).unwrap().first().run.unwrap().way_points, None);
    let inside = vec![Point::new(9.0, 3.0), Point::new(5.0, 2.0)];
    let inside = across(vec![]).with_each_robot(|robot| robot.via = inside.clone());
    let error = run_episode(&inside).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("way-point 2: goal (5, 2) has too little clearance"), "{text}");
    let keyway_sim::episode::RunError::Navigate(error) = error.why else { panic!("{text}") };
    assert!(matches!(error, NavigateError::WayPoint { number: 2, .. }));
}

/// A disc extends by less than a millimetre into a square that the robot covers. The robot turns
/// away from the disc, not into the adjacent squares.
#[test]
fn a_square_of_which_a_disc_fills_a_corner_is_no_way_into_the_disc() {
    let frame = GridFrame::new(26, 26, 0.1, keyway::geometry::Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let position = Point::new(1.7778, 0.8987);
    let start = Start { position, heading_rad: Some(42.84f64.to_radians()) };
    let discs = [(Point::new(1.2227, 1.6275), 0.03), (Point::new(1.8043, 0.4905), 0.1103)];
    let obstacles = discs.map(|(centre, radius_m)| Disc::new(centre, radius_m)).to_vec();
    let episode = Episode::new(map, long_robot(0.0), position, Point::new(0.5, 0.5));
    let report = run_episode(&Episode { obstacles, ..facing(episode, start) }).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// In narrow and cluttered rooms with unmapped obstacles, no recovery causes a collision.
    #[test]
    fn recoveries_touch_nothing(walls in prop::collection::vec(prop::bool::weighted(0.03), 26 * 26),
            hidden in prop::collection::vec((0.4..2.2f64, 0.4..2.2f64, 0.03..0.15f64), 0..4),
            start in (0.5..2.1f64, 0.5..2.1f64, -180.0..180.0f64), goal in (0.5..2.1f64, 0.5..2.1f64),
            reverses in prop::bool::ANY) {
        let frame = GridFrame::new(26, 26, 0.1, keyway::geometry::Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| {
            let is_wall = walls[(cell.y * 26 + cell.x) as usize];
            if is_wall { CellState::Occupied } else { CellState::Free }
        });
        let robot = long_robot(if reverses { -0.3 } else { 0.0 });
        let position = Point::new(start.0, start.1);
        let start = Start { position, heading_rad: Some(start.2.to_radians()) };
        let hidden = hidden.iter().map(|&(x, y, radius_m)| Disc::new(Point::new(x, y), radius_m));
        let goal = Point::new(goal.0, goal.1);
        let episode = facing(Episode::new(map, robot, position, goal), start);
        let episode = Episode { obstacles: hidden.collect(), ..episode };
        // A start or goal without clearance is refused.
        let Ok(report) = run_episode(&episode) else { return Err(TestCaseError::reject("no room")) };
        let report = report.first();
        let rows = report.trajectory.as_ref().map_or(0, Vec::len);
        prop_assume!(rows != 1);
        prop_assert_ne!(report.outcome, EpisodeOutcome::Collided, "{:?}", report.reason);
    }
}
