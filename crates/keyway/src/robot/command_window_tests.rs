//! Closed forms; limits and travelled distances of commands, for arbitrary decisions.

use super::*;
use proptest::prelude::*;

/// A robot with jerk limits [m/s³, rad/s³].
fn robot(name: &str, jerk_mps3: f64, angular_jerk_radps3: f64) -> Robot {
    let mut robot = Robot::by_name(name).unwrap();
    robot.limits.jerk_mps3 = Some(jerk_mps3);
    robot.limits.angular_jerk_radps3 = Some(angular_jerk_radps3);
    robot
}

#[test]
fn windows_are_as_long_as_the_limits_ask_for() {
    let cycles = |robot: &Robot| robot.limits.smoothing_cycles(robot.cycle_s);
    assert_eq!(cycles(&Robot::jackal()), 1);
    assert_eq!(CommandWindow::of(&Robot::jackal()), None);
    // 6 m/s² in 0.05 s: 120 m/s³; 12 rad/s²: 240 rad/s³.
    for (jerk_mps3, angular, expected) in
        [(120.0, 240.0, 1), (119.0, 240.0, 2), (20.0, 240.0, 6), (20.0, 20.0, 12), (3.0, 6.0, 40)]
    {
        assert_eq!(cycles(&robot("jackal", jerk_mps3, angular)), expected, "{jerk_mps3} {angular}");
    }
    // A robot that does not back up never changes from deceleration to backward acceleration.
    let mut uneven = robot("small", 1.0, 100.0);
    (uneven.limits.acceleration_mps2, uneven.limits.deceleration_mps2) = (0.2, 0.8);
    assert_eq!(cycles(&uneven), 10);
    uneven.limits.v_min_mps = -0.1;
    assert_eq!(cycles(&uneven), 16);
    let lag_s = robot("jackal", 20.0, 240.0).smoothing_lag_s();
    assert!((lag_s - 0.125).abs() < 1e-12 && Robot::small().smoothing_lag_s() == 0.0);
}

#[test]
fn limits_that_cannot_be_kept_are_refused() {
    let error = |jerk: f64, angular: f64| robot("jackal", jerk, angular).validate().err();
    assert_eq!((error(3.0, 6.0), error(1e9, 1e9)), (None, None));
    let text = |jerk, angular| error(jerk, angular).unwrap().to_string();
    let expected = "limits.jerk_mps3 must be at least 3, so that commands are averaged over at most 2 s (reduce the accelerations to allow less), got 2.9";
    assert_eq!(text(2.9, 6.0), expected);
    assert!(text(3.0, 5.0).starts_with("limits.angular_jerk_radps3 must be at least 6, so that"));
    assert_eq!(text(0.0, 6.0), "limits.jerk_mps3 must be a positive number, got 0");
    assert!(text(f64::NAN, 6.0).contains("limits.jerk_mps3 must be a positive number"));
    assert!(text(6.0, f64::INFINITY).contains("limits.angular_jerk_radps3 must be finite"));
    // With cycles that do not divide 2 s, the value in the message is valid, and no cycle is too
    // long.
    let mut slow = robot("small", 0.1, 100.0);
    slow.cycle_s = 0.3;
    assert!(slow.validate().unwrap_err().to_string().contains("at least 0.555556, "));
    slow.limits.jerk_mps3 = Some(0.555_556);
    assert_eq!(slow.validate(), Ok(()));
    (slow.cycle_s, slow.limits.jerk_mps3) = (9.0, Some(0.2));
    assert_eq!((slow.validate(), slow.limits.smoothing_cycles(9.0)), (Ok(()), 1));
}

#[test]
fn a_step_becomes_a_ramp() {
    let mut window = CommandWindow::of(&robot("jackal", 30.0, 240.0)).unwrap();
    let one = Velocity::new(1.0, -2.0);
    let commands: Vec<f64> = (0..5).map(|_| window.push(one).v).collect();
    assert_eq!(commands, [0.25, 0.5, 0.75, 1.0, 1.0]);
    assert_eq!((window.command(), window.reference()), (one, one));
    window.push(Velocity::ZERO);
    assert!(window.reference() == Velocity::ZERO && window.command().omega == -1.5);
    window.refill(Velocity::new(0.3, 0.0));
    assert_eq!(window.push(Velocity::new(0.3, 0.0)), Velocity::new(0.3, 0.0));
    // Predicted commands: the mean of the current references and of 1, 0.5, 0.
    let coming = [1.0, 0.5, 0.0].map(|v| Velocity::new(v, 0.0));
    let speeds: Vec<f64> = window.commands(coming.into_iter()).map(|it| it.v).collect();
    for (speed, expected) in speeds.iter().zip([0.475, 0.525, 0.45, 0.375, 0.125, 0.0]) {
        assert!((speed - expected).abs() < 1e-12, "{speeds:?}");
    }
    assert_eq!((speeds.len(), speeds[5]), (6, 0.0));
}

/// At a constant velocity the reference is ahead by the lag, along the arc.
#[test]
fn the_reference_is_ahead_on_the_arc() {
    let robot = robot("jackal", 10.0, 20.0);
    let (pose, lag_s) = (Pose::new(1.0, 2.0, 0.3), robot.smoothing_lag_s());
    for velocity in [Velocity::new(1.2, 0.0), Velocity::new(0.0, -1.1), Velocity::new(0.9, 1.4)] {
        let mut window = CommandWindow::of(&robot).unwrap();
        assert_eq!(window.reference_pose(pose, Velocity::ZERO, robot.cycle_s), pose);
        window.refill(velocity);
        let ahead = window.reference_pose(pose, velocity, robot.cycle_s);
        let expected = pose.after_arc(velocity, lag_s);
        assert!(ahead.point().distance(expected.point()) < 1e-12, "{ahead:?}");
        assert!((ahead.theta - expected.theta).abs() < 1e-12);
    }
}

fn robots() -> impl Strategy<Value = Robot> {
    (0..Robot::NAMES.len(), 0.05..1.0f64, 0.05..1.0f64, any::<bool>()).prop_map(
        |(index, straight, turning, backs_up)| {
            let mut robot = Robot::by_name(Robot::NAMES[index]).unwrap();
            let (limits, cycle_s) = (&mut robot.limits, robot.cycle_s);
            if !backs_up {
                limits.v_min_mps = 0.0;
            }
            let [(_, _, range, _), (_, _, turning_range, _)] = limits.jerks();
            limits.jerk_mps3 = Some((straight * range / cycle_s).max(range / 1.9));
            limits.angular_jerk_radps3 =
                Some((turning * turning_range / cycle_s).max(turning_range / 1.9));
            robot
        },
    )
}

/// Requested velocities as fractions of the limits, each for some cycles.
fn asked() -> impl Strategy<Value = Vec<(f64, f64, usize)>> {
    prop::collection::vec((-1.5..1.5f64, -1.5..1.5f64, 1..15usize), 1..12)
}

proptest! {
    /// Commands keep the limits for every decision, and they are as predicted.
    #[test]
    fn commands_keep_the_limits(robot in robots(), asked in asked()) {
        prop_assert_eq!(robot.validate(), Ok(()));
        let Robot { limits, cycle_s, .. } = &robot;
        let Some(mut window) = CommandWindow::of(&robot) else { return Ok(()) };
        let mut commands = vec![Velocity::ZERO; 2];
        let mut go = |window: &mut CommandWindow, to: Velocity| {
            let foretold = window.commands([to].into_iter()).next();
            let command = window.push(to);
            let foretold = foretold.unwrap();
            prop_assert!((command.v - foretold.v).abs() < 1e-12 && (command.omega - foretold.omega).abs() < 1e-12);
            commands.push(command);
            Ok(())
        };
        for (v, omega, cycles) in asked {
            for _ in 0..cycles {
                let wanted = Velocity::new(v * limits.v_max_mps, omega * limits.omega_max_radps);
                let to = limits.reached(window.reference(), wanted, *cycle_s);
                go(&mut window, to)?;
            }
        }
        while window.reference() != Velocity::ZERO {
            let braked = limits.braked(window.reference(), *cycle_s);
            go(&mut window, braked)?;
        }
        while !window.is_zero() {
            go(&mut window, Velocity::ZERO)?;
        }
        let is_within = |values: [f64; 3], jerk: Option<f64>, most: f64| {
            let [a, b, c] = values;
            let (before, after) = ((b - a) / cycle_s, (c - b) / cycle_s);
            ((after - before) / cycle_s).abs() <= jerk.unwrap() + 1e-9 && after.abs() <= most + 1e-9
        };
        let most = limits.acceleration_mps2.max(limits.deceleration_mps2);
        let most_angular = limits.angular_acceleration_radps2.max(limits.angular_deceleration_radps2);
        for three in commands.windows(3) {
            let parts = |part: fn(&Velocity) -> f64| [part(&three[0]), part(&three[1]), part(&three[2])];
            prop_assert!(is_within(parts(|it| it.v), limits.jerk_mps3, most), "{three:?}");
            prop_assert!(is_within(parts(|it| it.omega), limits.angular_jerk_radps3, most_angular), "{three:?}");
            let allowed = limits.clamped(three[2]);
            prop_assert!((allowed.v - three[2].v).abs() < 1e-12);
            prop_assert!((allowed.omega - three[2].omega).abs() < 1e-12);
        }
    }

    /// On a straight, and turning in place, the robot travels as far as its reference, and
    /// `reference_pose` gives the pose of the reference at any time.
    #[test]
    fn nothing_of_the_way_is_lost(robot in robots(), asked in asked(), turns in any::<bool>()) {
        let Robot { limits, cycle_s, .. } = &robot;
        let Some(mut window) = CommandWindow::of(&robot) else { return Ok(()) };
        let (mut reference, mut pose) = (Pose::default(), Pose::default());
        let mut command = Velocity::ZERO;
        for (part, _, cycles) in asked {
            for _ in 0..cycles {
                let wanted = if turns { Velocity::new(0.0, part) } else { Velocity::new(part, 0.0) };
                let from = window.reference();
                let to = limits.reached(from, wanted, *cycle_s);
                reference = reference.after_ramp(from, to, *cycle_s);
                let next = window.push(to);
                pose = pose.after_ramp(command, next, *cycle_s);
                command = next;
                let ahead = window.reference_pose(pose, command, *cycle_s);
                prop_assert!((ahead.x - reference.x).abs() < 1e-9, "{ahead:?} {reference:?}");
                let turned = crate::geometry::wrap_angle(ahead.theta - reference.theta);
                prop_assert!(turned.abs() < 1e-9, "{ahead:?} {reference:?}");
            }
        }
    }
}
