use super::*;
use crate::sim::{Control, Disturbances, Obstacle, Outcome, RunRules};
use keyway::geometry::Disc;
use keyway::map::{GridFrame, OccupancyGrid};
use keyway::robot::Robot;
use keyway::sense::Observation;
use std::f64::consts::FRAC_PI_2;

/// A world of 20 m x 20 m around the origin.
fn world(circles: &[(f64, f64, f64)]) -> World {
    let frame = GridFrame::new(200, 200, 0.1, Pose::new(-10.0, -10.0, 0.0)).unwrap();
    let circle = |&(x, y, radius_m)| Disc::new(Point::new(x, y), radius_m);
    let circles = circles.iter().map(circle).collect();
    World::from_known(&OccupancyGrid::all_free(frame), circles).unwrap()
}

/// The small robot (0.5 m/s², 0.5 m/s, radius 0.18 m) with a sparse sensor.
fn robot() -> Robot {
    let mut robot = Robot::small();
    robot.sensors[0].beams = 8;
    robot
}

/// A robot with practically no acceleration limits.
fn brisk(cycle_s: f64) -> Robot {
    let mut robot = Robot { cycle_s, ..robot() };
    let limits = &mut robot.limits;
    (limits.v_max_mps, limits.omega_max_radps) = (10.0, 10.0);
    (limits.acceleration_mps2, limits.angular_acceleration_radps2) = (1e4, 1e4);
    robot
}

const FAR: Point = Point::new(9.5, 9.5);

/// Runs a single robot.
fn alone(
    world: &World,
    robot: &Robot,
    start: Pose,
    goal: Point,
    rules: &RunRules,
    mut controller: impl FnMut(&Observation<'_>) -> Control + Send,
) -> Result<Run, SimError> {
    let participant = Participant {
        robot,
        start,
        goal,
        disturbances: Disturbances::default(),
        rules: rules.clone(),
        controller: &mut controller,
    };
    let mut runs = simulate(world, &mut [participant])?;
    assert_eq!(runs.len(), 1);
    Ok(runs.remove(0))
}

fn drive(world: &World, robot: &Robot, goal: Point, rules: &RunRules, command: Velocity) -> Run {
    let mut left = 1e6;
    alone(world, robot, Pose::default(), goal, rules, |_| {
        left -= 1.0;
        Control { action: Action::Drive(command), remaining_m: left, route: 1, turn_left_rad: 0.0 }
    })
    .unwrap()
}

fn limit(time_limit_s: f64) -> RunRules {
    RunRules { time_limit_s, ..RunRules::default() }
}

#[test]
fn a_straight_drive_accelerates_then_cruises() {
    let run = drive(&world(&[]), &robot(), FAR, &limit(5.0), Velocity::new(9.0, 0.0));
    // 0.5 m/s after 1 s, x = t²/4 until then and 0.25 + 0.5 (t - 1) afterwards.
    for sample in &run.samples {
        let t = sample.t_s;
        let x = if t < 1.0 { 0.25 * t * t } else { 0.25 + 0.5 * (t - 1.0) };
        assert!((sample.pose.x - x).abs() < 1e-9, "{sample:?}");
        assert!((sample.velocity.v - (0.5 * t).min(0.5)).abs() < 1e-9);
    }
    assert_eq!((run.outcome, run.cycles, run.samples.len()), (Outcome::Timeout, 50, 51));
    assert!((run.length_m - 2.25).abs() < 1e-9);
    assert_eq!(run.min_clearance_m, None);
}

#[test]
fn a_circle_closes() {
    let robot = brisk(0.1);
    let command = Velocity::new(1.0, 1.0);
    let run = drive(&world(&[(0.0, 1.0, 0.25)]), &robot, FAR, &limit(10.0), command);
    // After the first cycle, which ramps up, a circle of 1 m radius.
    let first = run.samples[1].pose;
    let centre = first.world_from_body(Point::new(0.0, 1.0));
    for sample in &run.samples[1..] {
        assert!((sample.pose.point().distance(centre) - 1.0).abs() < 1e-12);
        assert!((sample.pose.theta.sin() - (first.theta + sample.t_s - 0.1).sin()).abs() < 1e-9);
    }
    assert!((run.length_m - 9.95).abs() < 1e-9);
    let nearest =
        1.0 - centre.distance(Point::new(0.0, 1.0)) - 0.25 - robot.footprint.inscribed_radius_m();
    assert!((run.min_clearance_m.unwrap() - nearest).abs() < 1e-4);
}

#[test]
fn reached_at_the_end_of_a_cycle() {
    // The goal tolerance begins at x = 1.88 m: x is 1.85 m after 4.2 s, 1.9 m after 4.3 s.
    let goal = Point::new(2.03, 0.0);
    let run = drive(&world(&[]), &robot(), goal, &limit(60.0), Velocity::new(0.5, 0.0));
    assert_eq!((run.outcome, run.cycles), (Outcome::Reached, 43));
    let there = drive(&world(&[]), &robot(), Point::new(0.1, 0.0), &limit(60.0), Velocity::ZERO);
    assert_eq!((there.outcome, there.cycles, there.samples.len()), (Outcome::Reached, 0, 1));
}

#[test]
fn hardly_moving_far_from_everything_is_no_contact() {
    for v in [1e-300, 1e-17, 1e-12, 1e-5] {
        let run =
            drive(&world(&[]), &robot(), Point::new(9.0, 0.0), &limit(1.0), Velocity::new(v, 0.0));
        assert_eq!(run.outcome, Outcome::Timeout, "{v}");
    }
}

#[test]
fn a_thin_obstacle_between_two_cycle_ends_is_contact() {
    // 2 m per cycle over a post of 1 cm at x = 4: the cycles end at x = 1, 3, 5.
    let robot = brisk(1.0);
    let command = Velocity::new(2.0, 0.0);
    let run = drive(&world(&[(4.0, 0.0, 0.005)]), &robot, FAR, &limit(4.0), command);
    let Outcome::Collided { pose, with, robot_stood: false, .. } = run.outcome else {
        panic!("{:?}", run.outcome)
    };
    assert_eq!(with, Obstacle::Circle(0));
    let touching = 4.0 - 0.005 - robot.footprint.inscribed_radius_m();
    assert!(pose.x <= touching && pose.x > touching - 1e-4, "{pose:?}");
    let last = run.samples.last().unwrap();
    assert_eq!((last.pose, run.cycles, run.samples.len()), (pose, 3, 4));
    assert!((last.t_s - (2.0 + (pose.x - 3.0) / 2.0)).abs() < 1e-9);
    assert!((run.length_m - pose.x).abs() < 1e-9);
    assert_eq!(run.min_clearance_m, Some(0.0));
}

#[test]
fn two_millimetres_are_not_contact() {
    // 0.2 mm is not contact either; a gap below the tolerance is.
    for (gap_m, touches) in [(0.002, false), (0.0002, false), (0.00001, true), (-0.002, true)] {
        let beside = 0.18 + 0.005 + gap_m;
        let world = world(&[(4.0, beside, 0.005), (2.0, -beside, 0.005)]);
        let run = drive(&world, &brisk(1.0), FAR, &limit(4.0), Velocity::new(2.0, 0.0));
        if touches {
            let Outcome::Collided { with, .. } = run.outcome else { panic!("{:?}", run.outcome) };
            assert_eq!(with, Obstacle::Circle(1), "the nearer one first");
        } else {
            assert_eq!(run.outcome, Outcome::Timeout);
            assert!((run.min_clearance_m.unwrap() - gap_m).abs() < 1e-4);
        }
    }
}

#[test]
fn contact_at_the_start_and_with_the_border() {
    let run = drive(&world(&[(0.1, 0.0, 0.0)]), &robot(), FAR, &limit(4.0), Velocity::ZERO);
    assert!(matches!(run.outcome, Outcome::Collided { with: Obstacle::Circle(0), .. }));
    assert_eq!((run.cycles, run.min_clearance_m), (0, Some(0.0)));
    let far_off = world(&[(0.0, 5.0, 1.0)]);
    let run = drive(&far_off, &brisk(0.5), FAR, &limit(40.0), Velocity::new(3.0, 0.0));
    let Outcome::Collided { pose, with: Obstacle::Border, .. } = run.outcome else { panic!() };
    assert!((pose.x - (10.0 - 0.18)).abs() < 1e-4);
    assert!((run.min_clearance_m.unwrap() - (4.0 - 0.18)).abs() < 1e-4);
}

#[test]
fn timeout_at_the_exact_time() {
    for (time_limit_s, cycles) in [(0.3, 3), (60.0, 600), (0.25, 3)] {
        let run = drive(&world(&[]), &robot(), FAR, &limit(time_limit_s), Velocity::ZERO);
        assert_eq!((run.outcome, run.cycles), (Outcome::Timeout, cycles));
        assert_eq!(run.samples.last().unwrap().t_s, cycles as f64 * 0.1);
    }
}

#[test]
fn stuck_at_the_exact_time() {
    let world = world(&[]);
    let stuck_at = |remaining: &(dyn Fn(u64) -> f64 + Sync)| {
        let mut cycle = 0;
        let run = alone(&world, &robot(), Pose::default(), FAR, &limit(60.0), |_| {
            cycle += 1;
            let remaining_m = remaining(cycle - 1);
            // A path longer than 20 m is a second route.
            let route = if remaining_m > 20.0 { 2 } else { 1 };
            Control { action: Action::Stop, remaining_m, route, turn_left_rad: 0.0 }
        });
        let run = run.unwrap();
        (run.outcome, run.cycles)
    };
    assert_eq!(stuck_at(&|_| 5.0), (Outcome::Stuck, 200));
    assert_eq!(stuck_at(&|_| f64::NAN), (Outcome::Stuck, 200));
    assert_eq!(stuck_at(&|_| f64::INFINITY), (Outcome::Stuck, 200));
    // Progress in cycle 150, then only longer paths.
    assert_eq!(stuck_at(&|n| if n < 150 { 5.0 } else { 4.0 + n as f64 }), (Outcome::Stuck, 200));
    // A detour: longer than before, but the robot makes progress.
    let detour = |n: u64| if n < 100 { 5.0 } else { 60.0 - n as f64 * 0.05 };
    assert_eq!(stuck_at(&detour), (Outcome::Timeout, 600));
    // To and fro on one route is no progress.
    let swinging = |n: u64| 5.0 + 0.1 * libm::sin(n as f64 * 0.05);
    assert_eq!(stuck_at(&swinging).0, Outcome::Stuck);
    assert_eq!(stuck_at(&|n| if n == 150 { 4.9 } else { 5.0 }), (Outcome::Stuck, 350));
    // 0.04 m in 20 s is not enough, 0.06 m is: the time limit comes first.
    assert_eq!(stuck_at(&|n| 5.0 - n as f64 * 0.04 / 200.0), (Outcome::Stuck, 200));
    assert_eq!(stuck_at(&|n| 5.0 - n as f64 * 0.06 / 200.0), (Outcome::Timeout, 600));
}

#[test]
fn stop_and_arrived_brake() {
    let mut cycle = 0;
    let world = world(&[]);
    let run = alone(&world, &robot(), Pose::default(), FAR, &limit(3.0), |_| {
        cycle += 1;
        let action = match cycle {
            1..=10 => Action::Drive(Velocity::new(0.5, 0.0)),
            11..=15 => Action::Stop,
            _ => Action::Arrived,
        };
        Control { action, remaining_m: 1.0, route: 1, turn_left_rad: 0.0 }
    });
    let run = run.unwrap();
    // 0.25 m to accelerate in 1 s, and as much to brake.
    assert!(run.samples.last().unwrap().velocity.v.abs() < 1e-12);
    assert!((run.length_m - 0.5).abs() < 1e-9);
}

#[test]
fn the_controller_sees_the_state_and_a_scan() {
    let world = world(&[(3.0, 0.0, 1.0)]);
    let mut seen = Vec::new();
    let run = alone(&world, &robot(), Pose::default(), FAR, &limit(1.0), |observation| {
        let Observation { pose, velocity: v, scans, .. } = *observation;
        let scan = scans[0].scan;
        // Beam 4 of 8 points straight ahead.
        assert!((scan.ranges_m.get(4).unwrap() - (2.0 - pose.x)).abs() < 1e-9);
        seen.push((pose, v));
        Control {
            action: Action::Drive(Velocity::new(0.5, 0.0)),
            remaining_m: 9.0,
            route: 1,
            turn_left_rad: 0.0,
        }
    });
    let run = run.unwrap();
    let driven: Vec<_> = run.samples[..10].iter().map(|s| (s.pose, s.velocity)).collect();
    assert_eq!(seen, driven);
}

#[test]
fn a_rerun_gives_the_same_bytes() {
    let world = world(&[(1.0, 0.5, 0.1), (-1.0, -1.0, 0.3)]);
    let bytes = || {
        let start = Pose::new(0.0, 0.0, FRAC_PI_2);
        let run = alone(
            &world,
            &robot(),
            start,
            FAR,
            &limit(30.0),
            |&Observation { pose, scans, .. }| {
                let scan = scans[0].scan;
                let nearest = scan.ranges_m.iter().fold(3.5, f64::min);
                let command = Velocity::new(0.2 * nearest, libm::sin(3.0 * pose.x + pose.y));
                Control {
                    action: Action::Drive(command),
                    remaining_m: f64::NAN,
                    route: 1,
                    turn_left_rad: 0.0,
                }
            },
        );
        serde_json::to_vec(&run.unwrap()).unwrap()
    };
    let first = bytes();
    assert!(first == bytes());
    let back: Run = serde_json::from_slice(&first).unwrap();
    assert_eq!((back.outcome, back.cycles, back.samples.len()), (Outcome::Stuck, 200, 201));
}

#[test]
fn refuses_what_cannot_be() {
    let world = world(&[]);
    let run = |robot: &Robot, start: Pose, rules: &RunRules, v: f64| {
        let action = Action::Drive(Velocity::new(v, 0.0));
        alone(&world, robot, start, FAR, rules, |_| Control {
            action,
            remaining_m: 1.0,
            route: 1,
            turn_left_rad: 0.0,
        })
    };
    let (start, rules) = (Pose::default(), limit(1.0));
    let bad_robot = Robot { cycle_s: 0.0, ..robot() };
    let error = run(&bad_robot, start, &rules, 0.0).unwrap_err();
    assert!(
        error.to_string().starts_with("robot.cycle_s must be a time from 0.001 to 10 s, got 0")
    );
    let nowhere = Pose { theta: f64::NAN, ..start };
    let error = run(&robot(), nowhere, &rules, 0.0).unwrap_err();
    assert!(error.to_string().starts_with("start.theta must be finite"));
    let error = run(&robot(), start, &limit(f64::NAN), 0.0).unwrap_err();
    assert!(error.to_string().starts_with("rules.time_limit_s must be a positive number"));
    let error = run(&robot(), start, &rules, f64::NAN).unwrap_err();
    assert!(matches!(error, SimError::Command { robot: 0, cycle: 0, .. }));
    // An infinite velocity counts as the highest one.
    assert_eq!(run(&robot(), start, &rules, f64::INFINITY).unwrap().cycles, 10);
    let mut warp = brisk(0.1);
    (warp.limits.v_max_mps, warp.limits.deceleration_mps2) = (100.0, 10.0);
    let collided = run(&warp, start, &rules, f64::INFINITY).unwrap();
    assert!(matches!(collided.outcome, Outcome::Collided { .. }), "{:?}", collided.outcome);
    warp.limits.v_max_mps = f64::MAX;
    let error = run(&warp, start, &rules, 0.0).unwrap_err().to_string();
    assert!(error.starts_with("robot.limits.v_max_mps must be a number from"), "{error}");
}

mod disturbed;
mod giving_way;
mod movers;
mod several;
