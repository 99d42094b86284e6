//! Drives with lag, a dead band or slip.

use super::*;

fn with_actuation(actuation: ActuationFaults) -> Disturbances {
    Disturbances { actuation, ..Disturbances::default() }
}

/// A robot that reaches any velocity within a cycle, so that only the fault limits it.
fn instant(cycle_s: f64) -> Robot {
    let mut robot = brisk(cycle_s);
    let limits = &mut robot.limits;
    (limits.deceleration_mps2, limits.angular_deceleration_radps2) = (1e4, 1e4);
    robot
}

/// The step response of a first-order lag is 1 - exp(-t / T), delayed or not.
#[test]
fn a_lagging_drive_follows_its_step_response_and_comes_to_rest() {
    for delay_s in [0.0, 0.1, 0.05] {
        let lag = ActuationFaults { lag_s: 0.4, delay_s, ..ActuationFaults::default() };
        let command = |cycle| if cycle < 20 { Velocity::new(1.0, -2.0) } else { Velocity::ZERO };
        let (run, _) = driven(&world(&[]), &instant(0.1), with_actuation(lag), 8.0, command);
        let driven = velocities(&run);
        let whole = (delay_s / 0.1_f64).round() as usize;
        for (cycle, velocity) in driven.iter().enumerate().skip(whole).take(20) {
            // With half a cycle of delay the velocity is half way between two of the response.
            let at = |cycles: usize| 1.0 - libm::exp(-0.1 * cycles as f64 / 0.4);
            let cycles = cycle - whole;
            let late = delay_s == 0.05;
            let expected = if late { 0.5 * (at(cycles) + at(cycles + 1)) } else { at(cycles) };
            assert!((velocity.v - expected).abs() < 1e-9, "{delay_s} {cycle}: {velocity:?}");
            assert!((velocity.omega + 2.0 * expected).abs() < 1e-9);
        }
        // 0.001 m/s is left after 0.4 s ln(1000) = 2.8 s, and of 2 rad/s after 3.04 s.
        assert!(driven[45].v > 0.0 && driven[54..].iter().all(|it| *it == Velocity::ZERO));
    }
}

#[test]
fn a_command_within_the_dead_band_drives_nothing() {
    let dead_band_mps = 0.1;
    let band =
        ActuationFaults { dead_band_mps, dead_band_radps: 0.2, ..ActuationFaults::default() };
    let commands = [(0.09, 0.19), (0.1, 0.19), (-0.09, 0.2), (-0.1, -0.2), (0.0, -0.19)];
    let command = |cycle: u64| {
        let (v, omega) = commands[cycle as usize % commands.len()];
        Velocity::new(v, omega)
    };
    let mut robot = instant(0.1);
    robot.limits.v_min_mps = -1.0;
    let (run, _) = driven(&world(&[]), &robot, with_actuation(band), 0.5, command);
    let driven: Vec<_> = velocities(&run)[1..].iter().map(|it| (it.v, it.omega)).collect();
    assert_eq!(driven, [(0.0, 0.0), (0.1, 0.0), (0.0, 0.2), (-0.1, -0.2), (0.0, 0.0)]);
}

/// Odometry counts the turns of the wheels.
#[test]
fn slipping_wheels_drive_less_than_they_turn() {
    let slip = ActuationFaults { v_slip: 0.25, omega_slip: 0.5, ..ActuationFaults::default() };
    let command = |_| Velocity::new(0.8, 1.0);
    let (run, told) = driven(&world(&[]), &instant(0.1), with_actuation(slip), 2.0, command);
    let driven = &velocities(&run)[1..];
    assert!(driven.iter().all(|it| (it.v - 0.6).abs() < 1e-9 && (it.omega - 0.5).abs() < 1e-9));
    let told = &told[1..];
    assert!(
        told.iter().all(|(_, it, _)| (it.v - 0.8).abs() < 1e-9 && (it.omega - 1.0).abs() < 1e-9)
    );
    // The reported pose is the true one: slip does not affect map-based localisation.
    assert!(told.iter().zip(&run.samples[1..]).all(|((pose, ..), sample)| *pose == sample.pose));
}
