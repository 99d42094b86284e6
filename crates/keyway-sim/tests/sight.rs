//! A robot drives only through observed free space, and no faster than it can stop there.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

#[path = "../../keyway/tests/support/driving.rs"]
mod driving;

use driving::{bound_for, next_step};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{Blocked, Stack, Step};
use keyway::robot::{Footprint, RangeSensor, Robot};
use keyway::sense::{Observation, Scan};
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, run_episode};
use keyway_sim::sim::{
    Action, Control, Disturbances, Outcome, Participant, RunRules, StandingPolygon, World, simulate,
};

/// An empty hall of 16 m x 4 m in cells of 5 cm, with walls around it.
fn hall() -> OccupancyGrid {
    let frame = GridFrame::new(320, 80, 0.05, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(319 - cell.x).min(79 - cell.y);
        if edge < 1 { CellState::Occupied } else { CellState::Free }
    })
}

fn with_stop_rule(stack: Stack, robot: &Robot) -> Stack {
    Stack { controller: stack.controller.with_stop_rule(robot), ..stack }
}

/// Stacks for a robot, with their names: the default with and without the stop rule, and others
/// with it.
fn stacks(robot: &Robot) -> Vec<(String, Stack)> {
    let named = |name: &str| Stack::by_name(name, robot).unwrap();
    let others =
        ["keyway", "key-point-fusion", "s0-key-point", "s1-adaptive", "s4-guided", "astar-follow"];
    let safe = others.map(|name| (format!("{name}, safe"), with_stop_rule(named(name), robot)));
    let mut stacks = vec![("keyway".to_owned(), named("keyway"))];
    stacks.extend(safe);
    stacks
}

/// Robots with long stopping distances, and an unmapped wall across three quarters of the hall.
#[test]
fn nothing_is_touched_that_stands_beyond_the_range() {
    let wall = [[8.0, 0.0], [8.2, 0.0], [8.2, 3.0], [8.0, 3.0]].map(Point::from).to_vec();
    for (v_max_mps, brakes_mps2, period_s) in
        [(2.0, 0.5, None), (1.0, 0.13, None), (1.5, 0.3, None), (2.0, 0.5, Some(0.5))]
    {
        let mut robot = Robot::small();
        robot.limits.v_max_mps = v_max_mps;
        robot.limits.acceleration_mps2 = brakes_mps2;
        robot.limits.deceleration_mps2 = brakes_mps2;
        robot.sensors[0].period_s = period_s;
        for (name, stack) in stacks(&robot) {
            let (start, goal) = (Point::new(1.0, 2.0), Point::new(15.0, 2.0));
            let mut episode = Episode::new(hall(), robot.clone(), start, goal);
            episode.polygons = vec![StandingPolygon::new(wall.clone()).unwrap()];
            episode.robots[0].stack = stack;
            let RobotReport { outcome, trajectory, .. } = run_episode(&episode).unwrap().first();
            assert_ne!(outcome, EpisodeOutcome::Collided, "{name} {v_max_mps} {brakes_mps2}");
            if name == "keyway" {
                assert_eq!(outcome, EpisodeOutcome::Reached, "{v_max_mps} {brakes_mps2}");
                // In the free space before the wall the speed is limited only by the sensing
                // range.
                let fastest_mps = trajectory.unwrap().iter().map(|row| row[4]).fold(0.0, f64::max);
                let sight_mps = robot.sight_mps().min(v_max_mps);
                assert!(fastest_mps > 0.8 * sight_mps, "{fastest_mps} {sight_mps}");
            }
        }
    }
}

/// Known walls beside and behind unobserved space do not make it observed: in a corridor as wide
/// as one or two large cells, a robot does not see farther either.
#[test]
fn nothing_is_touched_that_stands_beyond_the_range_of_a_narrow_corridor() {
    let mut robot = Robot::small();
    robot.limits.v_max_mps = 2.0;
    robot.limits.acceleration_mps2 = 0.5;
    robot.limits.deceleration_mps2 = 0.5;
    for (cell_m, rows) in [(1.0, 1), (0.5, 2)] {
        let (columns, y) = ((30.0 / cell_m) as u64, 0.5 * f64::from(rows + 2) * cell_m);
        let frame = GridFrame::new(columns, rows as u64 + 2, cell_m, Pose::default()).unwrap();
        let corridor = OccupancyGrid::from_fn(frame, |cell| {
            let is_inside =
                (1..=rows).contains(&cell.y) && (1..columns as i32 - 1).contains(&cell.x);
            if is_inside { CellState::Free } else { CellState::Occupied }
        });
        for (name, stack) in stacks(&robot) {
            let (start, goal) = (Point::new(1.5, y), Point::new(28.5, y));
            let mut episode = Episode::new(corridor.clone(), robot.clone(), start, goal);
            episode.obstacles = vec![Disc::new(Point::new(20.0, y), 0.4)];
            episode.robots[0].stack = stack;
            let RobotReport { outcome, run, .. } = run_episode(&episode).unwrap().first();
            assert_ne!(outcome, EpisodeOutcome::Collided, "{name}, cells of {cell_m} m");
            let driven_m = run.unwrap().length_m;
            assert!(driven_m > 12.0 || name != "keyway", "cells of {cell_m} m: {driven_m}");
        }
    }
}

/// A post of 6 cm that is between two of 36 beams until the robot is close.
#[test]
fn nothing_is_touched_that_is_between_two_beams() {
    for robot in [Robot::small(), Robot::jackal()] {
        let robot = Robot { sensors: vec![RangeSensor::new(36, 360.0, 8.0)], ..robot };
        for aside in 0..8 {
            let (start, goal) = (Point::new(1.0, 2.0), Point::new(6.0, 2.0));
            let mut episode = Episode::new(hall(), robot.clone(), start, goal);
            let post = Point::new(4.0, 1.85 + 0.04 * f64::from(aside));
            episode.obstacles = vec![Disc::new(post, 0.03)];
            let RobotReport { outcome, .. } = run_episode(&episode).unwrap().first();
            assert_eq!(outcome, EpisodeOutcome::Reached, "{aside}");
        }
    }
}

/// With 19 beams the guaranteed sensing range ends at the robot's own front: it creeps, and its
/// recoveries keep their usual speed.
#[test]
fn who_surely_sees_nothing_creeps() {
    let mut robot = Robot::small();
    robot.sensors = vec![RangeSensor::new(19, 360.0, 8.0)];
    robot.limits.v_min_mps = -0.5;
    assert_eq!(robot.sight_mps(), 0.0);
    let (start, goal) = (Point::new(1.0, 2.0), Point::new(3.0, 2.0));
    let mut episode = Episode::new(hall(), robot, start, goal);
    episode.obstacles = vec![Disc::new(Point::new(2.0, 2.05), 0.03)];
    let RobotReport { outcome, trajectory, .. } = run_episode(&episode).unwrap().first();
    assert_ne!(outcome, EpisodeOutcome::Collided);
    let speeds = trajectory.unwrap().into_iter().map(|row| row[4].abs());
    assert!(speeds.fold(0.0, f64::max) <= 0.25 * 0.5 + 1e-9);
}

/// Command of a step, and the time since the last scan if the sensor is silent.
fn command(step: &Step) -> (Velocity, Option<f64>) {
    match step {
        Step::Blocked { command, why: Blocked::SensorSilent { silent_s, .. } } => {
            (*command, Some(*silent_s))
        }
        step => (step.command(), None),
    }
}

/// Scans without information.
fn silent_scans(robot: &Robot) -> [Scan; 4] {
    let nothing = Scan::of_nothing(&robot.sensors[0]);
    let all =
        |range_m: f64| Scan { ranges_m: vec![range_m; nothing.ranges_m.len()], ..nothing.clone() };
    [Scan::default(), all(f64::NAN), all(0.0), Scan { ranges_m: vec![], ..nothing.clone() }]
}

#[test]
fn a_robot_that_has_never_seen_anything_stands() {
    for robot in [Robot::small(), Robot::jackal()] {
        for (name, stack) in stacks(&robot) {
            for scan in silent_scans(&robot) {
                let (start, goal) = (Point::new(1.0, 2.0), Point::new(15.0, 2.0));
                let mut navigator =
                    bound_for(&hall(), &stack.fit(&robot).unwrap(), start, goal).unwrap();
                let pose = Pose::new(1.0, 2.0, 0.0);
                for _ in 0..30 {
                    let step = next_step(&mut navigator, pose, Velocity::ZERO, &scan);
                    assert_eq!(command(&step), (Velocity::ZERO, Some(f64::INFINITY)), "{name}");
                }
                let step = next_step(
                    &mut navigator,
                    pose,
                    Velocity::ZERO,
                    &Scan::of_nothing(&robot.sensors[0]),
                );
                assert!(matches!(step, Step::Drive(command) if command.v > 0.0), "{name} {step:?}");
            }
        }
    }
}

/// The sensor fails at full speed, and recovers.
#[test]
fn a_sensor_that_falls_silent_stops_the_robot_until_it_is_back() {
    for robot in [Robot::small(), Robot::jackal()] {
        for (name, stack) in stacks(&robot) {
            for silent in silent_scans(&robot) {
                let (start, goal) = (Point::new(1.0, 2.0), Point::new(15.0, 2.0));
                let mut navigator =
                    bound_for(&hall(), &stack.fit(&robot).unwrap(), start, goal).unwrap();
                let world = World::from_known(&hall(), vec![]).unwrap();
                let (mut pose, mut velocity) = (Pose::new(1.0, 2.0, 0.0), Velocity::ZERO);
                let mut cycle = 0.0;
                let mut drive = |for_s: f64, is_silent: bool| {
                    let mut last = (Velocity::ZERO, None);
                    for _ in 0..(for_s / robot.cycle_s).round() as u32 {
                        let seen = world.at(cycle * robot.cycle_s).cast(pose, &robot.sensors[0]);
                        let step = next_step(
                            &mut navigator,
                            pose,
                            velocity,
                            if is_silent { &silent } else { &seen },
                        );
                        last = command(&step);
                        let next = robot.limits.reached(velocity, last.0, robot.cycle_s);
                        pose = pose.after_ramp(velocity, next, robot.cycle_s);
                        (velocity, cycle) = (next, cycle + 1.0);
                    }
                    (last, velocity.v)
                };
                let ((_, since), v) = drive(2.0, false);
                assert!(since.is_none() && v > 0.3, "{name} {v}");
                // Before the time-out it drives on, as after lost scans.
                let ((_, since), _) = drive(0.4, true);
                assert_eq!(since, None, "{name}");
                let ((_, since), v) = drive(0.2 + robot.limits.stop_s(), true);
                assert!(since.is_some_and(|since| since > 0.5) && v == 0.0, "{name} {since:?} {v}");
                let ((_, since), v) = drive(1.0, false);
                assert!(since.is_none() && v > 0.1, "{name} {v}");
            }
        }
    }
}

/// A published stack without a check for scans does not wait for them.
#[test]
fn a_published_stack_does_not_ask_for_scans() {
    let robot = Robot::paper();
    let stack = Stack::published_by_name("s0-key-point").unwrap();
    let known = OccupancyGrid::from_ascii(&["...................."; 9]);
    let (start, goal) = (Point::new(1.5, 4.5), Point::new(18.5, 4.5));
    let mut navigator = bound_for(&known, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    let step =
        next_step(&mut navigator, Pose::new(1.5, 4.5, 0.0), Velocity::ZERO, &Scan::default());
    assert!(matches!(step, Step::Drive(command) if command.v > 0.0), "{step:?}");
}

/// Slow lidars with a correct description, and lossy ones.
#[test]
fn slow_and_lossy_sensors_drive() {
    for (period_s, dropped_scans) in [
        (None, 0.0),
        (Some(0.2), 0.0),
        (Some(0.5), 0.0),
        (Some(1.0), 0.0),
        (None, 0.5),
        (Some(0.2), 0.3),
    ] {
        let mut robot = Robot::small();
        robot.sensors[0].period_s = period_s;
        let (start, goal) = (Point::new(1.0, 2.0), Point::new(15.0, 2.0));
        let mut episode = Episode::new(hall(), robot, start, goal);
        episode.obstacles = vec![Disc::new(Point::new(8.0, 2.1), 0.3)];
        episode.robots[0].disturbances = Disturbances { seed: 3, ..Disturbances::default() };
        episode.robots[0].disturbances.sensor.dropped_scans = dropped_scans;
        let RobotReport { outcome, run, .. } = run_episode(&episode).unwrap().first();
        assert_eq!(outcome, EpisodeOutcome::Reached, "{period_s:?} {dropped_scans}");
        // 14 m at 0.5 m/s.
        let time_s = run.unwrap().time_s;
        assert!(time_s < 33.0, "{period_s:?} {dropped_scans} {time_s}");
    }
}

/// Drives a robot through a world with modified scans; returns the outcome of its run.
fn drive_changed(robot: &Robot, unknown: Vec<Disc>, change: impl Fn(&mut Scan) + Sync) -> Outcome {
    let (start, goal) = (Point::new(1.0, 2.0), Point::new(7.0, 2.0));
    let stack = Stack::keyway(robot);
    let mut navigator = bound_for(&hall(), &stack.fit(robot).unwrap(), start, goal).unwrap();
    let world = World::from_known(&hall(), unknown).unwrap();
    let mut decide = |&Observation { pose, velocity, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        let mut scan = scan.owned();
        change(&mut scan);
        let step = next_step(&mut navigator, pose, velocity, &scan);
        let action = match step {
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let remaining_m = navigator.guidance().unwrap().remaining_m;
        Control { action, remaining_m, route: navigator.ways_taken(), turn_left_rad: 0.0 }
    };
    let goal_tolerance_m = stack.controller.goal_tolerance_m;
    let participant = Participant {
        robot,
        start: Pose::new(start.x, start.y, 0.0),
        goal,
        disturbances: Disturbances::default(),
        rules: RunRules { goal_tolerance_m, time_limit_s: 60.0, ..RunRules::default() },
        controller: &mut decide,
    };
    simulate(&world, &mut [participant]).unwrap().remove(0).outcome
}

/// Four posts of the housing appear in every scan.
#[test]
fn a_robot_does_not_stop_for_its_own_housing() {
    let long = Robot { footprint: Footprint::rectangle(0.5, 0.3).unwrap(), ..Robot::small() };
    for robot in [Robot::small(), long] {
        let housing = |scan: &mut Scan| {
            for post in [45, 135, 225, 315] {
                scan.ranges_m[post - 3..post + 4].fill(0.12);
            }
        };
        let post = Disc::new(Point::new(4.0, 2.0), 0.2);
        assert_eq!(drive_changed(&robot, vec![post], housing), Outcome::Reached, "{robot:?}");
    }
    // The same with the minimum range of the sensor, which may be larger than the robot.
    let mut robot = Robot::small();
    robot.sensors[0].range_min_m = 0.25;
    let housing = |scan: &mut Scan| scan.ranges_m[170..190].fill(0.24);
    assert_eq!(drive_changed(&robot, vec![], housing), Outcome::Reached);
}

/// Space in a direction without valid beams is not observed.
#[test]
fn nothing_is_touched_in_a_blind_sector() {
    // 180 is straight ahead.
    for (from, to) in [(120, 240), (150, 210), (170, 190), (0, 360)] {
        let blind = |scan: &mut Scan| scan.ranges_m[from..to].fill(f64::NAN);
        for y in [1.8, 2.0, 2.15] {
            let post = Disc::new(Point::new(4.0, y), 0.15);
            let outcome = drive_changed(&Robot::small(), vec![post], blind);
            assert!(!matches!(outcome, Outcome::Collided { .. }), "{from} {to} {y} {outcome:?}");
        }
    }
}

/// Cells may be larger than the robot: on observed open ground, no command is refused.
#[test]
fn large_cells_of_open_ground_hold_nobody_up() {
    for cell_m in [0.02, 0.05, 0.3, 1.0] {
        let side = (12.0 / cell_m) as u64;
        let frame = GridFrame::new(side, side, cell_m, Pose::default()).unwrap();
        let known = OccupancyGrid::from_fn(frame, |_| CellState::Free);
        for robot in [Robot::small(), Robot::jackal()] {
            let (start, goal) = (Point::new(2.5, 2.5), Point::new(9.5, 8.5));
            let mut episode = Episode::new(known.clone(), robot.clone(), start, goal);
            episode.robots[0].stack = episode.robots[0].stack.clone().with_stop_rule(&robot);
            let RobotReport { outcome, run, .. } = run_episode(&episode).unwrap().first();
            assert_eq!(outcome, EpisodeOutcome::Reached, "{cell_m}");
            let refused = run.unwrap().unsafe_commands.unwrap().out_of_sight;
            assert_eq!(refused, 0, "{cell_m} {}", robot.footprint);
        }
    }
}
