//! Robots with known and unknown actuation delays.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

mod hall;

use hall::hall;
use keyway::geometry::{Disc, Point};
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, run_episode};
use keyway_sim::sim::Disturbances;

fn episode(robot: Robot) -> Episode {
    let (start, goal) = (Point::new(1.5, 1.5), Point::new(10.5, 6.5));
    Episode::new(hall(), robot, start, goal)
}

fn driven(episode: &Episode) -> RobotReport {
    run_episode(episode).unwrap().first()
}

/// In a fully known world, nothing depends on the time of sensing, except for a stack that stops
/// within its sensing range and a robot that drives far before its commands act.
#[test]
fn the_same_run_later() {
    let (own, other) = (Stack::DEFAULT, "key-point-fusion");
    for (name, cycles, stack) in
        [("small", 1, own), ("small", 4, own), ("jackal", 2, other), ("jackal", 7, other)]
    {
        let robot = Robot::by_name(name).unwrap();
        let delay_s = cycles as f64 * robot.cycle_s;
        let driven = |robot: Robot| {
            let stack = Stack::by_name(stack, &robot).unwrap();
            driven(&episode(robot).with_each_robot(|robot| robot.stack = stack.clone()))
        };
        let late = driven(Robot { actuation_delay_s: delay_s, ..robot.clone() });
        let prompt = driven(robot);
        assert_eq!(
            (prompt.outcome, late.outcome),
            (EpisodeOutcome::Reached, EpisodeOutcome::Reached)
        );
        let [prompt, late] = [prompt, late].map(|report| report.trajectory.unwrap());
        assert!(prompt.len() > 100, "{}", prompt.len());
        assert_eq!(late.len(), prompt.len() + cycles, "{name}");
        // The robot is stationary until the first command acts.
        let (waits, drives) = late.split_at(cycles);
        assert!(waits.iter().all(|row| row[1..] == late[0][1..]));
        for (late, prompt) in drives.iter().zip(&prompt) {
            assert!((late[0] - prompt[0] - delay_s).abs() < 1e-9);
            let off = (1..late.len()).map(|i| (late[i] - prompt[i]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{name}: {late:?} {prompt:?}");
        }
    }
}

/// A delay that is not a whole number of cycles, with obstacles sensed along the route; and the
/// same delay, unknown to the robot. Obstacles behind a corner are more than 1.95 m from it:
/// 0.8 m that `jackal` drives at 2 m/s before its command acts, 0.7 m to stop, and 0.45 m for the
/// robot and the obstacle.
#[test]
fn what_is_seen_on_the_way_is_not_touched() {
    let outcome = |known_s: f64, unknown_s: f64, name: &str| {
        let robot = Robot { actuation_delay_s: known_s, ..Robot::by_name(name).unwrap() };
        let mut episode = episode(robot);
        episode.robots[0].disturbances.actuation.delay_s = unknown_s;
        let places = [(2.4, 3.6), (3.2, 5.8), (6.2, 4.4), (6.6, 2.2), (9.3, 3.5), (9.6, 4.9)];
        let disc = |(x, y)| Disc::new(Point::new(x, y), 0.2);
        episode.obstacles = places.map(disc).to_vec();
        driven(&episode).outcome
    };
    for name in ["small", "jackal"] {
        for delay_s in [0.0, 0.07, 0.1, 0.23, 0.4] {
            for (known_s, unknown_s) in [(delay_s, 0.0), (0.0, delay_s)] {
                let outcome = outcome(known_s, unknown_s, name);
                assert_eq!(outcome, EpisodeOutcome::Reached, "{name} {known_s} {unknown_s}");
            }
        }
    }
}

/// Known and unknown delays add up.
#[test]
fn a_part_of_the_delay_may_be_known() {
    let run = |known_s: f64, unknown_s: f64| {
        let mut episode = episode(Robot { actuation_delay_s: known_s, ..Robot::small() });
        episode.robots[0].disturbances.actuation.delay_s = unknown_s;
        driven(&episode)
    };
    let first_motion_s = |report: RobotReport| {
        let trajectory = report.trajectory.unwrap();
        let moves = trajectory.iter().position(|row| row[1..3] != trajectory[0][1..3]).unwrap();
        trajectory[moves - 1][0]
    };
    for (known_s, unknown_s) in [(0.3, 0.0), (0.1, 0.2), (0.0, 0.3)] {
        assert!((first_motion_s(run(known_s, unknown_s)) - 0.3).abs() < 1e-9);
    }
}

/// A report contains the learned delay, so that a user can write it into the robot's file.
#[test]
fn what_was_learned_is_reported() {
    let noticed = |known_s: f64, unknown_s: f64| {
        let mut episode = episode(Robot { actuation_delay_s: known_s, ..Robot::jackal() });
        episode.robots[0].disturbances.actuation.delay_s = unknown_s;
        driven(&episode).noticed.unwrap()
    };
    assert_eq!(noticed(0.0, 0.0), Vec::<String>::new());
    assert_eq!(noticed(0.25, 0.0), Vec::<String>::new());
    let said = noticed(0.1, 0.15);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("0.25 s, not 0.10 s: set actuation_delay_s = 0.25"), "{said:?}");
}

/// A description of a fault, and a function that causes it.
type Spoil<'a> = (&'a str, &'a dyn Fn(&mut Disturbances));

/// In the same hall, with faulty motors, odometry and scans.
#[test]
fn what_is_wrong_with_a_robot_costs_it_little() {
    let run = |spoil: &dyn Fn(&mut Disturbances)| {
        let mut episode = episode(Robot::small());
        episode.obstacles = vec![Disc::new(Point::new(6.2, 4.4), 0.2)];
        spoil(&mut episode.robots[0].disturbances);
        driven(&episode)
    };
    let time_s = |report: &RobotReport| report.run.as_ref().unwrap().time_s;
    let good_s = time_s(&run(&|_| {}));
    let all: [Spoil<'_>; 4] = [
        ("do not move", &|it| {
            it.actuation.dead_band_mps = 0.06;
            it.actuation.dead_band_radps = 0.24;
        }),
        ("always 0", &|it| it.localisation.velocity_is_zero = true),
        ("the actuation delay is", &|it| it.actuation.lag_s = 0.2),
        ("same scan", &|it| {
            it.sensor.period_s = 0.2;
            it.sensor.held_scans = true;
        }),
    ];
    for (said, spoil) in all {
        let report = run(spoil);
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{said}: {:?}", report.reason);
        assert!(time_s(&report) < 1.3 * good_s, "{said}: {} {good_s}", time_s(&report));
        let noticed = report.noticed.unwrap();
        assert!(noticed.iter().any(|doubt| doubt.contains(said)), "{said}: {noticed:?}");
    }
}
