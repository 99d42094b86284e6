//! Runs of disturbed robots.

mod weak_drive;

use super::*;
use crate::sim::{ActuationFaults, Arrival, LocalisationFaults, ReachedBy, SensorFaults};

/// Pose, velocity and ranges that were reported to the controller in a cycle.
type Told = (Pose, Velocity, Vec<f64>);

/// Drives a run with a given command for every cycle, independent of the controller's inputs;
/// returns it with these inputs.
fn driven(
    world: &World,
    robot: &Robot,
    disturbances: Disturbances,
    time_limit_s: f64,
    command: impl Fn(u64) -> Velocity + Sync,
) -> (Run, Vec<Told>) {
    let (mut cycle, mut told) = (0, vec![]);
    let mut controller = |&Observation { pose, velocity, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        told.push((pose, velocity, scan.owned().ranges_m));
        cycle += 1;
        let action = Action::Drive(command(cycle - 1));
        Control { action, remaining_m: 1e6 - cycle as f64, route: 1, turn_left_rad: 0.0 }
    };
    let start = Pose::new(0.5, -0.25, 0.3);
    let participant = Participant {
        robot,
        start,
        goal: FAR,
        disturbances,
        rules: limit(time_limit_s),
        controller: &mut controller,
    };
    let run = simulate(world, &mut [participant]).unwrap().remove(0);
    (run, told)
}

/// Drives to and fro, and turns.
fn wavy(cycle: u64) -> Velocity {
    let phase = cycle as f64;
    Velocity::new(0.3 + 0.4 * libm::sin(0.7 * phase), 1.2 * libm::cos(0.4 * phase))
}

fn late(delay_s: f64) -> Disturbances {
    let actuation = ActuationFaults { delay_s, ..ActuationFaults::default() };
    Disturbances { actuation, ..Disturbances::default() }
}

fn velocities(run: &Run) -> Vec<Velocity> {
    run.samples.iter().map(|sample| sample.velocity).collect()
}

#[test]
fn without_disturbances_all_is_exact_to_the_bit() {
    let (world, robot) = (world(&[(3.0, 2.5, 1.0), (-2.0, -2.0, 0.5)]), robot());
    let none = Disturbances { seed: 77, ..Disturbances::default() };
    let (run, told) = driven(&world, &robot, none, 6.0, wavy);
    assert_eq!((run.cycles, told.len()), (60, 60));
    // Recomputes the motion from its definition, cycle by cycle.
    let (mut pose, mut velocity) = (run.samples[0].pose, Velocity::ZERO);
    for (cycle, (told_pose, told_velocity, ranges_m)) in told.iter().enumerate() {
        assert_eq!((*told_pose, *told_velocity), (pose, velocity));
        assert_eq!(*ranges_m, world.at(0.0).cast(pose, &robot.sensors[0]).ranges_m);
        let reached = robot.limits.reached(velocity, wavy(cycle as u64), robot.cycle_s);
        pose = pose.after_ramp(velocity, reached, robot.cycle_s);
        // The reached velocity, by the linear interpolation.
        velocity = velocity.lerp(reached, 1.0);
        let sample = run.samples[cycle + 1];
        assert_eq!((sample.pose, sample.velocity), (pose, velocity), "{cycle}");
    }
}

#[test]
fn a_command_has_its_effect_after_the_delay() {
    for cycle_s in [0.1, 0.04] {
        let robot = Robot { cycle_s, ..robot() };
        for delay_s in [0.0, 0.003, 0.04, 0.07, 0.1, 0.25, 0.3, 1.0] {
            // Commanded to stay for five cycles, then to drive.
            let drive_s = 5.0 * cycle_s;
            let command = |cycle| Velocity::new(if cycle < 5 { 0.0 } else { 9.0 }, 0.0);
            let (run, _) = driven(&world(&[]), &robot, late(delay_s), 4.0, command);
            for sample in &run.samples {
                // 0.5 m/s² up to 0.5 m/s.
                let since_s = (sample.t_s - drive_s - delay_s).max(0.0);
                let speeding_up_s = since_s.min(1.0);
                let driven_m = 0.25 * speeding_up_s.powi(2) + 0.5 * (since_s - speeding_up_s);
                let start = run.samples[0].pose.point();
                assert!(
                    (sample.pose.point().distance(start) - driven_m).abs() < 1e-9,
                    "{delay_s} s: {sample:?}"
                );
                assert!((sample.velocity.v - 0.5 * since_s.min(1.0)).abs() < 1e-9);
            }
            assert!(run.length_m > 0.5);
        }
    }
}

#[test]
fn the_same_commands_drive_the_same_velocities_later() {
    let (world, robot) = (world(&[]), robot());
    let velocities_after = |delay_s| {
        let (run, told) = driven(&world, &robot, late(delay_s), 6.0, wavy);
        // Odometry reports the driven velocity, not the commanded one.
        let told: Vec<_> = told.iter().map(|told| told.1).collect();
        assert_eq!(told, velocities(&run)[..60]);
        velocities(&run)
    };
    let at_once = velocities_after(0.0);
    // 0.3 s is three cycles, although 0.3 / 0.1 is rounded to less.
    for (delay_s, cycles) in [(0.1, 1), (0.2, 2), (0.3, 3), (1.0, 10)] {
        let later = velocities_after(delay_s);
        assert!(later[..=cycles].iter().all(|velocity| *velocity == Velocity::ZERO));
        assert_eq!(later[cycles..], at_once[..at_once.len() - cycles], "{delay_s} s");
    }
    // Between two samples the velocity changes linearly.
    for (delay_s, cycles, part) in [(0.03, 0, 0.3), (0.17, 1, 0.7), (0.25, 2, 0.5)] {
        let later = velocities_after(delay_s);
        for cycle in 1..at_once.len() - cycles {
            let expected = at_once[cycle].lerp(at_once[cycle - 1], part);
            let velocity = later[cycle + cycles];
            let off = (velocity.v - expected.v).abs() + (velocity.omega - expected.omega).abs();
            assert!(off < 1e-12, "{delay_s} s, {cycle}: {velocity:?} {expected:?}");
        }
    }
}

/// A delay postpones a contact on a motion with a knee.
#[test]
fn a_late_robot_touches_later() {
    let touch_s = |delay_s| {
        let disturbances = late(delay_s);
        let command = |_| Velocity::new(2.0, 0.0);
        let robot = Robot { cycle_s: 0.5, ..brisk(0.5) };
        let start = Pose::new(0.5, -0.25, 0.3);
        let post = start.world_from_body(Point::new(3.0, 0.0));
        let world = world(&[(post.x, post.y, 0.1)]);
        let (run, _) = driven(&world, &robot, disturbances, 9.0, command);
        let touched = Outcome::Collided {
            pose: run.samples.last().unwrap().pose,
            with: Obstacle::Circle(0),
            robot_stood: false,
            jumped_onto: false,
            mover_speed_mps: None,
        };
        assert_eq!(run.outcome, touched);
        assert!((run.length_m - (3.0 - 0.1 - 0.18)).abs() < 1e-4);
        run.samples.last().unwrap().t_s
    };
    let at_once_s = touch_s(0.0);
    for delay_s in [0.01, 0.2, 0.499, 0.5, 1.3] {
        assert!((touch_s(delay_s) - at_once_s - delay_s).abs() < 1e-4, "{delay_s}");
    }
}

#[test]
fn a_robot_with_a_command_on_its_way_has_not_arrived() {
    let rules = RunRules { arrival: Arrival::Standing, goal_tolerance_m: 1.0, ..limit(20.0) };
    let cycles = |delay_s| {
        let mut cycle = 0;
        let mut controller = |_: &Observation<'_>| {
            cycle += 1;
            let is_first = cycle == 1;
            let drive = Action::Drive(Velocity::new(0.05, 0.0));
            let action = if is_first { drive } else { Action::Arrived };
            Control { action, remaining_m: 1.0, route: 1, turn_left_rad: 0.0 }
        };
        let participant = Participant {
            robot: &robot(),
            start: Pose::default(),
            goal: Point::default(),
            disturbances: late(delay_s),
            rules: rules.clone(),
            controller: &mut controller,
        };
        let run = simulate(&world(&[]), &mut [participant]).unwrap().remove(0);
        assert_eq!(run.outcome, Outcome::Reached);
        assert!((run.length_m - 0.005).abs() < 1e-9, "{}", run.length_m);
        run.cycles
    };
    // Speeds up in one cycle and brakes in the next.
    assert_eq!([0.0, 0.1, 0.5, 0.55].map(cycles), [2, 3, 7, 8]);
}

/// Changes from reverse to forward, half a cycle late: at the end of a cycle the robot is
/// stationary for an instant.
#[test]
fn a_robot_that_turns_back_has_not_arrived() {
    let rules = RunRules { arrival: Arrival::Standing, goal_tolerance_m: 1.0, ..limit(20.0) };
    let mut robot = brisk(0.1);
    let limits = &mut robot.limits;
    (limits.v_min_mps, limits.deceleration_mps2) = (-10.0, 1e4);
    let mut told = vec![];
    let mut controller = |&Observation { velocity, .. }: &Observation<'_>| {
        told.push(velocity.v);
        let action = match told.len() {
            1 => Action::Drive(Velocity::new(-1.0, 0.0)),
            2 => Action::Drive(Velocity::new(1.0, 0.0)),
            _ => Action::Arrived,
        };
        Control { action, remaining_m: 1.0, route: 1, turn_left_rad: 0.0 }
    };
    let participant = Participant {
        robot: &robot,
        start: Pose::default(),
        goal: Point::default(),
        disturbances: late(0.05),
        rules,
        controller: &mut controller,
    };
    let run = simulate(&world(&[]), &mut [participant]).unwrap().remove(0);
    assert_eq!((run.outcome, told), (Outcome::Reached, vec![0.0, -0.5, 0.0, 0.5, 0.0]));
}

#[test]
fn driven_velocities_deviate_as_told() {
    let actuation =
        ActuationFaults { v_relative: 0.05, omega_relative: 0.1, ..ActuationFaults::default() };
    let disturbances = Disturbances { seed: 4, actuation, ..Disturbances::default() };
    // Strong enough to reach any velocity within a cycle, in a small circle.
    let mut robot = brisk(0.01);
    let limits = &mut robot.limits;
    (limits.deceleration_mps2, limits.angular_deceleration_radps2) = (1e4, 1e4);
    let (run, _) = driven(&world(&[]), &robot, disturbances, 200.0, |_| Velocity::new(1.0, -2.0));
    let driven = &velocities(&run)[1..];
    let count = driven.len() as f64;
    assert_eq!(count, 20_000.0);
    let mean = |of: &dyn Fn(&Velocity) -> f64| driven.iter().map(of).sum::<f64>() / count;
    // In units of the standard deviations.
    let v = |velocity: &Velocity| (velocity.v - 1.0) / 0.05;
    let omega = |velocity: &Velocity| (velocity.omega / -2.0 - 1.0) / 0.1;
    let tolerance = 4.0 / count.sqrt();
    assert!(mean(&v).abs() < tolerance, "{}", mean(&v));
    assert!(mean(&omega).abs() < tolerance, "{}", mean(&omega));
    for square in [mean(&|velocity| v(velocity).powi(2)), mean(&|velocity| omega(velocity).powi(2))]
    {
        assert!((square - 0.995).abs() < 1.5 * tolerance, "{square}");
    }
    assert!(mean(&|velocity| v(velocity) * omega(velocity)).abs() < tolerance);
    let next = driven.windows(2).map(|pair| v(&pair[0]) * v(&pair[1])).sum::<f64>() / count;
    assert!(next.abs() < tolerance, "drawn anew in every cycle: {next}");
    assert!(driven.iter().all(|velocity| v(velocity).abs() < 3.0 + 1e-9));
}

#[test]
fn limits_are_kept_and_who_is_told_to_stand_stands() {
    let robot = robot();
    let limits = &robot.limits;
    for (seed, delay_s) in [(1, 0.0), (2, 0.1), (3, 0.13), (4, 0.28)] {
        let noisy =
            ActuationFaults { v_relative: 0.3, omega_relative: 0.3, ..ActuationFaults::default() };
        let actuation = ActuationFaults { delay_s, ..noisy };
        let disturbances = Disturbances { seed, actuation, ..Disturbances::default() };
        // From one limit to another, then to a stop.
        let command = |cycle: u64| match cycle {
            150.. => Velocity::ZERO,
            cycle if cycle / 7 % 3 == 0 => Velocity::new(9.0, -9.0),
            cycle => Velocity::new(0.5, 1.5 * libm::sin(cycle as f64)),
        };
        let (run, _) = driven(&world(&[]), &robot, disturbances.clone(), 30.0, command);
        let driven = velocities(&run);
        assert_eq!(driven.len(), 301);
        for pair in driven.windows(2) {
            assert!(pair[1].v >= limits.v_min_mps && pair[1].v <= limits.v_max_mps);
            assert!(pair[1].omega.abs() <= limits.omega_max_radps);
            let change = [pair[1].v - pair[0].v, pair[1].omega - pair[0].omega];
            assert!(change[0].abs() <= 0.5 * 0.1 + 1e-12, "{pair:?}");
            assert!(change[1].abs() <= 3.0 * 0.1 + 1e-12, "{pair:?}");
        }
        // Braking is as hard as without a delay: within a second, plus a cycle for rounding.
        let stands = 150 + 11 + (delay_s / 0.1).ceil() as usize;
        assert!(driven[stands..].iter().all(|velocity| *velocity == Velocity::ZERO), "{delay_s}");
        let (never, _) = driven_never(&robot, disturbances);
        assert!(never.samples.iter().all(|sample| sample.velocity == Velocity::ZERO));
        assert_eq!(never.length_m, 0.0);
    }
}

fn driven_never(robot: &Robot, disturbances: Disturbances) -> (Run, Vec<Told>) {
    driven(&world(&[]), robot, disturbances, 3.0, |_| Velocity::ZERO)
}

/// Without localisation errors, the reported pose is the true one.
#[test]
fn without_disturbances_truth_and_belief_are_the_same_run() {
    let (world, robot) = (world(&[]), robot());
    let run = |reached_by| {
        let mut ahead = |&Observation { pose, .. }: &Observation<'_>| {
            let action = Action::Drive(Velocity::new(0.4, 0.0));
            Control { action, remaining_m: -pose.x, route: 1, turn_left_rad: 0.0 }
        };
        let participant = Participant {
            robot: &robot,
            start: Pose::default(),
            goal: Point::new(2.0, 0.0),
            disturbances: Disturbances::default(),
            rules: RunRules { reached_by, ..limit(60.0) },
            controller: &mut ahead,
        };
        simulate(&world, &mut [participant]).unwrap().remove(0)
    };
    let truth = run(ReachedBy::Truth);
    assert_eq!(truth.outcome, Outcome::Reached);
    assert_eq!(truth, run(ReachedBy::Belief));
}

/// A pose with a constant error: with `ReachedBy::Belief`, the goal is reached by the reported
/// pose alone.
#[test]
fn a_goal_is_reached_by_truth_or_by_belief() {
    let localisation = LocalisationFaults {
        jump_m: 2.0,
        jump_every_s: 100.0,
        jump_for_s: 100.0,
        ..LocalisationFaults::default()
    };
    let disturbances = Disturbances { seed: 3, localisation, ..Disturbances::default() };
    let robot = robot();
    let outcome = |reached_by, arrival, by_told: bool| {
        let goal = Point::new(2.0, 0.0);
        let mut all_told = Vec::new();
        let mut controller = |&Observation { pose: told, .. }: &Observation<'_>| {
            all_told.push(told);
            // Drives to the true goal, or to the goal by the reported pose.
            let at = if by_told { told.point() } else { told.point() - all_told[0].point() };
            let to_goal = goal - at;
            let heading = to_goal.heading() - told.theta;
            let is_there = to_goal.norm() < 0.05;
            let velocity = Velocity::new(if heading.abs() < 0.1 { 0.3 } else { 0.0 }, heading);
            let action = if is_there { Action::Arrived } else { Action::Drive(velocity) };
            Control { action, remaining_m: -(all_told.len() as f64), route: 1, turn_left_rad: 0.0 }
        };
        let rules = RunRules { arrival, reached_by, goal_tolerance_m: 0.2, ..limit(60.0) };
        let participant = Participant {
            robot: &robot,
            start: Pose::default(),
            goal,
            disturbances: disturbances.clone(),
            rules,
            controller: &mut controller,
        };
        let run = simulate(&world(&[]), &mut [participant]).unwrap().remove(0);
        assert!(all_told[0].point().norm() > 0.5, "the pose is off: {:?}", all_told[0]);
        run.outcome
    };
    for arrival in [Arrival::Passing, Arrival::Standing] {
        assert_eq!(outcome(ReachedBy::Belief, arrival, true), Outcome::Reached);
        assert_eq!(outcome(ReachedBy::Truth, arrival, false), Outcome::Reached);
        assert_eq!(outcome(ReachedBy::Truth, arrival, true), Outcome::Timeout);
        assert_eq!(outcome(ReachedBy::Belief, arrival, false), Outcome::Timeout);
    }
}

/// Errors of the sensor and the localisation change only the controller's inputs.
#[test]
fn what_is_recorded_is_the_truth() {
    let disturbances = Disturbances {
        seed: 8,
        sensor: SensorFaults { range_m: 0.1, dropped_beams: 0.1, ..SensorFaults::default() },
        localisation: LocalisationFaults {
            position_m: 0.2,
            heading_rad: 0.1,
            correlation_s: 2.0,
            v_relative: 0.1,
            omega_relative: 0.1,
            ..LocalisationFaults::default()
        },
        ..Disturbances::default()
    };
    let (world, robot) = (world(&[(3.0, 2.5, 1.0), (-2.0, -2.0, 0.5)]), robot());
    let (ideal, exact) = driven(&world, &robot, Disturbances::default(), 6.0, wavy);
    let (run, told) = driven(&world, &robot, disturbances, 6.0, wavy);
    assert_eq!(run, ideal);
    assert_eq!(told.len(), exact.len());
    // Poses differ from the first cycle on. The robot is stationary then, and its odometry
    // reports so.
    assert_ne!(told[0].0, exact[0].0);
    assert_eq!(told[0].1, Velocity::ZERO);
    assert!(told.iter().zip(&exact).skip(1).all(|(told, exact)| told.0 != exact.0));
    let is_hit = |range_m: &f64| range_m.is_finite();
    assert!(exact.iter().any(|(.., ranges_m)| ranges_m.iter().any(is_hit)));
    let (mut dropped, mut off) = (0, 0);
    for ((.., told), (.., exact)) in told.iter().zip(&exact) {
        dropped += told.iter().filter(|range_m| range_m.is_nan()).count();
        off += told
            .iter()
            .zip(exact)
            .filter(|(told, exact)| told.is_finite() && told != exact)
            .count();
        for (told_m, exact_m) in told.iter().zip(exact).filter(|(told_m, _)| !told_m.is_nan()) {
            // Ranges are measured from the true pose.
            assert_eq!(told_m.is_finite(), exact_m.is_finite());
            assert!(exact_m.is_infinite() || (told_m - exact_m).abs() <= 0.3 + 1e-9);
        }
    }
    // A tenth of 480 beams are dropped, and most of the beams that hit something have an error.
    assert!(dropped > 20 && off > 20, "{dropped} {off}");
}

/// Two robots with the same commands far apart, and one of them alone.
#[test]
fn every_robot_has_its_own_numbers() {
    let robot = robot();
    let actuation = ActuationFaults { v_relative: 0.1, ..ActuationFaults::default() };
    let disturbances = Disturbances { seed: 3, actuation, ..Disturbances::default() };
    let run_of = |starts: &[Pose]| {
        let mut controllers = [(), ()].map(|()| {
            let mut left = 1e6;
            move |_: &Observation<'_>| {
                left -= 1.0;
                let action = Action::Drive(Velocity::new(0.3, 0.0));
                Control { action, remaining_m: left, route: 1, turn_left_rad: 0.0 }
            }
        });
        let mut participants: Vec<Participant<'_>> = starts
            .iter()
            .zip(&mut controllers)
            .map(|(&start, controller)| Participant {
                robot: &robot,
                start,
                goal: FAR,
                disturbances: disturbances.clone(),
                rules: limit(5.0),
                controller,
            })
            .collect();
        let runs = simulate(&world(&[]), &mut participants).unwrap();
        runs.iter().map(velocities).collect::<Vec<_>>()
    };
    let starts = [Pose::new(0.0, -8.0, 0.0), Pose::new(0.0, 8.0, 0.0)];
    let (both, alone) = (run_of(&starts), run_of(&starts[..1]));
    assert_eq!(both[0], alone[0]);
    assert_ne!(both[0], both[1]);
}

#[test]
fn what_cannot_disturb_is_refused() {
    let mut disturbances = [Disturbances::default(), Disturbances::default()];
    disturbances[1].sensor.range_m = -1.0;
    let robot = robot();
    let error = |disturbances: &[Disturbances]| {
        let refused = |_: &Observation<'_>| -> Control { unreachable!() };
        let mut controllers = [refused; 2];
        let mut participants: Vec<Participant<'_>> = disturbances
            .iter()
            .zip(&mut controllers)
            .map(|(disturbances, controller)| Participant {
                robot: &robot,
                start: Pose::default(),
                goal: FAR,
                disturbances: disturbances.clone(),
                rules: limit(1.0),
                controller,
            })
            .collect();
        simulate(&world(&[]), &mut participants).unwrap_err().to_string()
    };
    let expected = "disturbances.sensor.range_m must be a length from 0 to 100 m, got -1";
    assert_eq!(error(&disturbances[1..]), expected);
    assert_eq!(error(&disturbances), format!("participants[1].{expected}"));
}
