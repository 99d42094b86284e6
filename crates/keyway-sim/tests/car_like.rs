//! Whole runs of car-like robots: of a differential drive with one limit more.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

#[path = "../../keyway/tests/support/driving.rs"]
mod driving;
mod hall;

use driving::bound_for;
use hall::hall;
use keyway::geometry::{Disc, Point, Pose, Velocity, wrap_angle};
use keyway::navigate::{Goal, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::Observation;
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, run_episode};
use keyway_sim::sim::{Action, Control, Disturbances, Participant, RunRules, World, simulate};

/// A robot with this turning radius \[m\], which drives backwards, too.
fn car(base: Robot, min_turning_radius_m: f64) -> Robot {
    let mut robot = base;
    robot.limits.min_turning_radius_m = min_turning_radius_m;
    robot.limits.v_min_mps = -0.6 * robot.limits.v_max_mps;
    robot
}

fn cars() -> [Robot; 3] {
    [car(Robot::small(), 0.3), car(Robot::jackal(), 0.6), car(Robot::waffle(), 0.5)]
}

/// From one corner of the hall to the other, around posts, and facing away from it.
fn episode(robot: &Robot, goal_rad: Option<f64>) -> Episode {
    let goal = Goal { heading_rad: goal_rad, ..Point::new(10.5, 6.5).into() };
    let mut episode = Episode::new(hall(), robot.clone(), Point::new(1.5, 1.5), goal);
    episode.robots[0].start.heading_rad = Some(-2.0);
    episode.obstacles =
        vec![Disc::new(Point::new(2.6, 6.2), 0.2), Disc::new(Point::new(5.6, 3.0), 0.2)];
    episode
}

/// Checks that no velocity turns more tightly than the robot can.
fn check(robot: &Robot, report: &RobotReport) {
    let radius_m = robot.limits.min_turning_radius_m;
    let rows = report.trajectory.as_ref().unwrap();
    assert!(rows.len() > 10);
    for [t_s, _, _, _, v, omega] in rows {
        assert!(omega.abs() <= v.abs() / radius_m + 1e-9, "{t_s} s: {v} m/s, {omega} rad/s");
    }
    // No direction is changed but at a stop.
    for pair in rows.windows(2) {
        assert!(pair[0][4] * pair[1][4] >= 0.0, "{pair:?}");
    }
}

#[test]
fn they_reach_their_goals_on_arcs() {
    for robot in cars() {
        let report = run_episode(&episode(&robot, None)).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        check(&robot, &report);
    }
}

/// The commands of a run, which the wheels of a real robot have to follow, with odometry that is
/// off by 5 %.
fn commands(robot: &Robot, stack: &Stack) -> Vec<Velocity> {
    let (map, start) = (hall(), Point::new(1.5, 1.5));
    let goal = Goal { heading_rad: Some(1.5), ..Point::new(10.5, 6.5).into() };
    let mut navigator = bound_for(&map, &stack.fit(robot).unwrap(), start, goal).unwrap();
    let mut commands = Vec::new();
    let mut decide = |observation: &Observation<'_>| {
        navigator.observe(observation);
        let step = navigator.step();
        commands.push(step.command());
        let action = match step {
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let remaining_m = navigator.guidance().unwrap().remaining_m;
        Control { action, remaining_m, route: navigator.routes_planned(), turn_left_rad: 0.0 }
    };
    let mut disturbances = Disturbances::default();
    disturbances.localisation.v_relative = 0.05;
    disturbances.localisation.omega_relative = 0.05;
    let rules = RunRules { time_limit_s: 60.0, ..RunRules::default() };
    let world = World::from_known(&map, vec![Disc::new(Point::new(5.6, 3.0), 0.2)]).unwrap();
    let participant = Participant {
        robot,
        start: Pose::new(start.x, start.y, 0.0),
        goal: Point::new(10.5, 6.5),
        disturbances,
        rules,
        controller: &mut decide,
    };
    simulate(&world, &mut [participant]).unwrap();
    commands
}

#[test]
fn no_command_turns_more_tightly_than_the_wheels_can() {
    for robot in cars() {
        for name in ["keyway", "key-point-fusion", "dwa-to-goal", "astar-follow"] {
            let commands = commands(&robot, &Stack::by_name(name, &robot).unwrap());
            assert!(commands.len() > 10 && commands.iter().any(|command| command.omega != 0.0));
            let radius_m = robot.limits.min_turning_radius_m;
            // The wheels stop before they change their direction.
            assert!(commands.windows(2).all(|pair| pair[0].v * pair[1].v >= 0.0), "{name}");
            for Velocity { v, omega, .. } in commands {
                assert!(omega.abs() <= v.abs() / radius_m + 1e-9, "{name}: {v} {omega}");
            }
        }
    }
}

/// At the goal there is no last turn in place: the robot arrives as it has to, or drives to and
/// fro.
#[test]
fn they_arrive_with_a_heading() {
    for robot in cars() {
        for goal_rad in [0.0, 1.5, -1.6, 3.1] {
            let report = run_episode(&episode(&robot, Some(goal_rad))).unwrap().first();
            assert_eq!(report.outcome, EpisodeOutcome::Reached, "{goal_rad} {:?}", report.reason);
            check(&robot, &report);
            let end = report.trajectory.unwrap().last().copied().unwrap();
            assert!(wrap_angle(end[3] - goal_rad).abs() <= 0.1 + 1e-9, "{goal_rad}: {end:?}");
        }
    }
}

/// Behind the stop rule, with late and noisy motors, sensors and poses.
#[test]
fn disturbed_ones_touch_nothing() {
    for (index, robot) in cars().into_iter().enumerate() {
        let robot = Robot { safety_margin_m: Some(0.03), ..robot };
        let mut episode = episode(&robot, None);
        let one = &mut episode.robots[0];
        one.stack = Stack::keyway(&robot).with_stop_rule(&robot);
        one.disturbances.seed = index as u64;
        one.disturbances.sensor.range_m = 0.01;
        one.disturbances.actuation.delay_s = 0.1;
        one.disturbances.actuation.lag_s = 0.1;
        one.disturbances.localisation.position_m = 0.005;
        one.disturbances.localisation.v_relative = 0.05;
        one.disturbances.localisation.omega_relative = 0.05;
        let report = run_episode(&episode).unwrap().first();
        assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
        // Late wheels may turn a little more tightly than wanted ones: only the motion is checked.
        assert!(report.run.unwrap().min_clearance_m.is_some_and(|clearance_m| clearance_m > 0.0));
    }
}

/// Every stack commands what the wheels can do; most do not get through the hall.
#[test]
fn other_stacks_keep_the_turning_radius() {
    let robot = car(Robot::small(), 0.3);
    for name in Stack::NAMES {
        let stack = Stack::by_name(name, &robot).unwrap();
        let mut episode = episode(&robot, None);
        episode.robots[0].stack = stack.with_stop_rule(&robot);
        let report = run_episode(&episode).unwrap().first();
        assert_ne!(report.outcome, EpisodeOutcome::Collided, "{name} {:?}", report.reason);
        check(&robot, &report);
    }
}
