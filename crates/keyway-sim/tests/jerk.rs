//! Whole runs of robots with jerk limits.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

mod hall;

use hall::hall;
use keyway::geometry::{Disc, Point, Pose};
use keyway::local::LocalConfig;
use keyway::map::{CellState, GridFrame, OccupancyGrid};
use keyway::navigate::{Goal, Stack};
use keyway::robot::{Footprint, Robot};
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, run_episode};
use keyway_sim::sim::Disturbances;
use std::f64::consts::FRAC_PI_2;

/// Drives a robot among unmapped posts.
fn driven(robot: &Robot, disturbances: &Disturbances) -> RobotReport {
    let (start, goal) = (Point::new(1.5, 1.5), Point::new(10.5, 6.5));
    let mut episode = Episode::new(hall(), robot.clone(), start, goal);
    let places = [(2.4, 3.6), (3.2, 5.8), (6.2, 4.4), (6.6, 2.2), (9.3, 3.5), (9.6, 4.9)];
    episode.obstacles = places.map(|(x, y)| Disc::new(Point::new(x, y), 0.2)).to_vec();
    episode.robots[0].disturbances = disturbances.clone();
    run_episode(&episode).unwrap().first()
}

/// A robot with jerk limits \[m/s³, rad/s³\].
fn limited(robot: Robot, jerk_mps3: f64, angular_jerk_radps3: f64) -> Robot {
    let mut robot = robot;
    robot.limits.jerk_mps3 = Some(jerk_mps3);
    robot.limits.angular_jerk_radps3 = Some(angular_jerk_radps3);
    robot
}

fn robots() -> [Robot; 3] {
    let long = Robot { footprint: Footprint::rectangle(0.5, 0.3).unwrap(), ..Robot::small() };
    [
        limited(Robot::jackal(), 10.0, 40.0),
        limited(Robot::small(), 2.0, 12.0),
        limited(long, 1.5, 15.0),
    ]
}

/// Checks that the robot reaches its goal without contact, and keeps its jerk limits.
fn check(robot: &Robot, report: &RobotReport) {
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    check_jerk(robot, report);
}

fn check_jerk(robot: &Robot, report: &RobotReport) {
    let run = report.run.as_ref().unwrap();
    let (jerk, angular) = (robot.limits.jerk_mps3, robot.limits.angular_jerk_radps3);
    assert!(run.max_jerk_mps3 <= jerk.unwrap() + 1e-9, "{}", run.max_jerk_mps3);
    assert!(run.max_angular_jerk_radps3 <= angular.unwrap() + 1e-9, "{run:?}");
    assert!(run.max_jerk_mps3 >= 0.3 * jerk.unwrap(), "{}", run.max_jerk_mps3);
}

#[test]
fn runs_keep_the_limits() {
    for robot in robots() {
        let report = driven(&robot, &Disturbances::default());
        check(&robot, &report);
        // The limits cost less than three stops, each later by the smoothing lag.
        let mut free = robot.clone();
        (free.limits.jerk_mps3, free.limits.angular_jerk_radps3) = (None, None);
        let time_s = |report: &RobotReport| report.run.as_ref().unwrap().time_s;
        let free = driven(&free, &Disturbances::default());
        let lost_s = time_s(&report) - time_s(&free);
        let limit_s = 6.0 * robot.smoothing_lag_s() + 0.1 * time_s(&free);
        assert!(lost_s < limit_s, "{lost_s} {}", time_s(&free));
        assert!(free.run.unwrap().max_jerk_mps3 > 2.0 * robot.limits.jerk_mps3.unwrap());
    }
}

/// With noise of sensors, motors and odometry, and with known and unknown delays.
#[test]
fn runs_with_errors_keep_the_limits() {
    for (index, robot) in robots().into_iter().enumerate() {
        for (known_s, unknown_s) in [(0.0, 0.0), (0.15, 0.0), (0.0, 0.1)] {
            let robot = Robot { actuation_delay_s: known_s, ..robot.clone() };
            let mut disturbances = Disturbances { seed: index as u64, ..Disturbances::default() };
            disturbances.sensor.range_m = 0.01;
            disturbances.actuation.delay_s = unknown_s;
            disturbances.actuation.v_relative = 0.05;
            disturbances.actuation.omega_relative = 0.05;
            disturbances.localisation.position_m = 0.005;
            disturbances.localisation.v_relative = 0.05;
            disturbances.localisation.omega_relative = 0.05;
            check(&robot, &driven(&robot, &disturbances));
        }
    }
}

/// With lagging wheels, and motors with a dead band.
#[test]
fn runs_with_weak_motors_keep_the_limits() {
    type Spoil = fn(&mut Disturbances);
    let spoils: [Spoil; 2] = [
        |it| it.actuation.lag_s = 0.1,
        |it| (it.actuation.dead_band_mps, it.actuation.dead_band_radps) = (0.06, 0.24),
    ];
    for robot in robots() {
        for spoil in spoils {
            let mut disturbances = Disturbances::default();
            spoil(&mut disturbances);
            check(&robot, &driven(&robot, &disturbances));
        }
    }
}

/// All stacks keep the limits; some of them do not get through the hall.
#[test]
fn runs_of_other_stacks_keep_the_limits() {
    let robot = limited(Robot::small(), 2.0, 12.0);
    for name in Stack::NAMES {
        let stack = Stack::by_name(name, &robot).unwrap();
        let (start, goal) = (Point::new(1.5, 1.5), Point::new(10.5, 6.5));
        let mut episode = Episode::new(hall(), robot.clone(), start, goal);
        episode.robots[0].stack = stack.with_stop_rule(&robot);
        let report = run_episode(&episode).unwrap().first();
        assert_ne!(report.outcome, EpisodeOutcome::Collided, "{name} {:?}", report.reason);
        check_jerk(&robot, &report);
    }
}

/// With a cost of jerk, turn rates change more gradually, and a run takes no longer.
#[test]
fn the_cost_of_jerk_makes_turns_smoother() {
    let robot = Robot::jackal();
    let (start, goal) = (Point::new(1.5, 1.5), Point::new(10.5, 6.5));
    let driven = |jerk: f64| {
        let mut episode = Episode::new(hall(), robot.clone(), start, goal);
        let LocalConfig::SpaceTime(local) = &mut episode.robots[0].stack.local else {
            panic!("the default stack has courses");
        };
        local.jerk = jerk;
        let report = run_episode(&episode).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        let turns: Vec<f64> = report.trajectory.unwrap().iter().map(|row| row[5]).collect();
        let changes = turns.windows(3).map(|turns| turns[0] - 2.0 * turns[1] + turns[2]);
        (changes.map(|change| change * change).sum::<f64>(), report.run.unwrap().time_s)
    };
    let ((smooth, time_s), (rough, rough_time_s)) = (driven(0.3), driven(0.0));
    assert!(smooth < 0.8 * rough, "{smooth} {rough}");
    assert!(time_s < 1.02 * rough_time_s, "{time_s} {rough_time_s}");
}

/// The average of a small turn is below the dead band of the motors: a robot that has its heading
/// within the tolerance has arrived.
#[test]
fn a_turn_that_moves_no_motor_ends() {
    let robot = limited(Robot::husky(), 1.01, 2.02);
    let frame = GridFrame::new(200, 120, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let goal = Goal { heading_rad: Some(FRAC_PI_2), ..Point::new(8.0, 3.0).into() };
    let mut episode = Episode::new(map, robot, Point::new(2.0, 3.0), goal);
    episode.robots[0].start.heading_rad = Some(0.0);
    let actuation = &mut episode.robots[0].disturbances.actuation;
    (actuation.dead_band_mps, actuation.dead_band_radps) = (0.03, 0.08);
    let report = run_episode(&episode).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
}
