use super::*;
use crate::random::Random;
use std::ops::Range;

/// Simulated motors of a robot, in steps of a millisecond: with a delay, a lag and a dead band.
struct Real {
    delay_ms: usize,
    lag_s: f64,
    dead_band: Velocity,
    noise: f64,
    random: Random,
    /// The command of each millisecond.
    given: Vec<Velocity>,
    wanted: Velocity,
    wheels: Velocity,
    pose: Pose,
}

impl Real {
    fn new(delay_ms: usize) -> Self {
        Self {
            delay_ms,
            lag_s: 0.0,
            dead_band: Velocity::ZERO,
            noise: 0.0,
            random: Random::new(7),
            given: Vec::new(),
            wanted: Velocity::ZERO,
            wheels: Velocity::ZERO,
            pose: Pose::default(),
        }
    }

    fn obey(&mut self, robot: &Robot, command: Velocity) {
        const STEP_S: f64 = 1e-3;
        let factor = |random: &mut Random| 1.0 + self.noise * (2.0 * random.unit() - 1.0);
        let beyond = |asked: f64, band: f64| if asked.abs() < band { 0.0 } else { asked };
        let command = Velocity::new(
            beyond(command.v, self.dead_band.v) * factor(&mut self.random),
            beyond(command.omega, self.dead_band.omega) * factor(&mut self.random),
        );
        let steps = (robot.cycle_s / STEP_S).round() as usize;
        for _ in 0..steps {
            self.given.push(command);
            let now = self.given.len() - 1;
            let acting = now.checked_sub(self.delay_ms).map_or(Velocity::ZERO, |at| self.given[at]);
            self.wanted = robot.limits.reached(self.wanted, acting, STEP_S);
            let part = if self.lag_s > 0.0 { STEP_S / self.lag_s } else { 1.0 };
            let before = self.wheels;
            self.wheels = before.lerp(self.wanted, part);
            self.pose = self.pose.after_ramp(before, self.wheels, STEP_S);
        }
    }
}

/// The motor model learned from a robot that is driven back and forth for a time.
fn driven(robot: &Robot, real: &mut Real, seconds: f64) -> Motors {
    driven_and_told(robot, real, seconds, |real| real.wheels)
}

fn driven_and_told(
    robot: &Robot,
    real: &mut Real,
    seconds: f64,
    told: impl Fn(&Real) -> Velocity,
) -> Motors {
    let mut motors = Motors::new(robot);
    go_on_and_tell(robot, (&mut motors, real), 0.0..seconds, told);
    motors
}

fn go_on(robot: &Robot, both: (&mut Motors, &mut Real), during_s: Range<f64>) {
    go_on_and_tell(robot, both, during_s, |real| real.wheels);
}

fn go_on_and_tell(
    robot: &Robot,
    (motors, real): (&mut Motors, &mut Real),
    during_s: Range<f64>,
    told: impl Fn(&Real) -> Velocity,
) {
    let cycles = |time_s: f64| (time_s / robot.cycle_s) as u32;
    for cycle in cycles(during_s.start)..cycles(during_s.end) {
        let now = at(f64::from(cycle) * robot.cycle_s);
        let velocity = motors.observe(now, real.pose, told(real));
        let (_, then) = motors.predicted(now, now, (real.pose, velocity));
        let t_s = f64::from(cycle) * robot.cycle_s;
        let wanted = Velocity::new(
            robot.limits.v_max_mps * (0.5 + 0.5 * libm::sin(1.3 * t_s)),
            robot.limits.omega_max_radps * 0.6 * libm::sin(0.9 * t_s),
        );
        let asked = robot.limits.reached(then, wanted, robot.cycle_s);
        let command = motors.within_reach(then, asked);
        motors.give(now, now, command);
        real.obey(robot, command);
    }
}

fn at(stamp_s: f64) -> Time {
    Time::of_stamp(stamp_s).unwrap()
}

#[test]
fn delays_that_nobody_told_are_learned() {
    for name in ["small", "jackal", "husky"] {
        let robot = Robot::by_name(name).unwrap();
        for delay_ms in [30, 50, 100, 130, 200, 250, 400] {
            for noise in [0.0, 0.08] {
                let mut real = Real { noise, ..Real::new(delay_ms) };
                let motors = driven(&robot, &mut real, 6.0);
                let off_s = motors.delay_s() - 1e-3 * delay_ms as f64;
                // Models are half a cycle apart.
                let within_s = 0.3 * robot.cycle_s + if noise > 0.0 { 0.015 } else { 0.0 };
                assert!(off_s.abs() <= within_s, "{name} {delay_ms} {noise}: {off_s}");
            }
        }
    }
}

#[test]
fn what_is_described_rightly_stays() {
    for (name, delay_ms, noise) in [("small", 0, 0.0), ("jackal", 0, 0.08), ("jackal", 100, 0.08)] {
        let mut robot = Robot::by_name(name).unwrap();
        robot.actuation_delay_s = 1e-3 * delay_ms as f64;
        let mut real = Real { noise, ..Real::new(delay_ms) };
        for seconds in [1.0, 3.0, 20.0] {
            let motors = driven(&robot, &mut real, seconds);
            assert_eq!(motors.learned_s(), None, "{name} {delay_ms} {noise} {seconds}");
            real = Real { noise, ..Real::new(delay_ms) };
        }
    }
}

/// A delay that is shorter than described is learned, too.
#[test]
fn motors_may_be_faster_than_described() {
    let robot = Robot { actuation_delay_s: 0.3, ..Robot::jackal() };
    let motors = driven(&robot, &mut Real::new(100), 6.0);
    assert!((motors.delay_s() - 0.1).abs() < 0.02, "{}", motors.delay_s());
}

/// A learned delay is given up when the robot behaves as described again.
#[test]
fn a_delay_may_end() {
    let robot = Robot::jackal();
    let mut motors = Motors::new(&robot);
    let mut real = Real::new(200);
    go_on(&robot, (&mut motors, &mut real), 0.0..4.0);
    assert!((motors.delay_s() - 0.2).abs() < 0.02, "{}", motors.delay_s());
    real.delay_ms = 0;
    go_on(&robot, (&mut motors, &mut real), 4.0..90.0);
    assert_eq!(motors.learned_s(), None);
}

/// For a steadily changing speed, a first-order lag acts like a delay of its time constant.
#[test]
fn a_lag_counts_as_a_delay() {
    for (delay_ms, lag_s) in [(0, 0.1), (0, 0.2), (100, 0.1)] {
        let mut real = Real { lag_s, ..Real::new(delay_ms) };
        let motors = driven(&Robot::jackal(), &mut real, 6.0);
        let late_s = 1e-3 * delay_ms as f64 + lag_s;
        assert!((motors.delay_s() - late_s).abs() < 0.25 * lag_s, "{late_s}: {}", motors.delay_s());
    }
}

#[test]
fn it_is_learned_within_the_first_second() {
    let robot = Robot::jackal();
    for delay_ms in [50, 100, 250] {
        let mut real = Real { noise: 0.08, ..Real::new(delay_ms) };
        let motors = driven(&robot, &mut real, 1.0);
        let off_s = motors.delay_s() - 1e-3 * delay_ms as f64;
        assert!(off_s.abs() <= 0.03, "{delay_ms}: {off_s}");
    }
}

#[test]
fn who_does_something_else_teaches_nothing() {
    let robot = Robot::jackal();
    // Its motors are off, or another source drives it.
    let told: [fn(&Real) -> Velocity; 2] = [
        |_| Velocity::new(0.0, 1e-9),
        |real| Velocity::new(1.0 + libm::sin(0.011 * real.given.len() as f64), 0.3),
    ];
    for told in told {
        let motors = driven_and_told(&robot, &mut Real::new(0), 10.0, told);
        assert_eq!(motors.learned_s(), None);
    }
}

/// The velocity follows from the commands, and the delay from the poses.
#[test]
fn a_robot_whose_velocity_is_never_told_drives_all_the_same() {
    let robot = Robot::small();
    for delay_ms in [0, 200] {
        let mut real = Real::new(delay_ms);
        let mut motors = driven_and_told(&robot, &mut real, 8.0, |_| Velocity::ZERO);
        assert!((motors.delay_s() - 1e-3 * delay_ms as f64).abs() < 0.03, "{}", motors.delay_s());
        let known = motors.observe(at(8.0), real.pose, Velocity::ZERO);
        assert!((known.v - real.wheels.v).abs() < 0.05, "{known:?}, {:?}", real.wheels);
        assert!((known.omega - real.wheels.omega).abs() < 0.2, "{known:?}, {:?}", real.wheels);
    }
    // The localisation jumps just after the robot has been told to turn.
    let mut motors = Motors::new(&robot);
    for (cycle, theta) in [0.0, 0.0, -1.5, -1.5].into_iter().enumerate() {
        let now = at(0.1 * cycle as f64);
        let velocity = motors.observe(now, Pose::new(0.0, 0.0, theta), Velocity::ZERO);
        assert_eq!(velocity, Velocity::ZERO, "{cycle}");
        motors.give(now, now, Velocity::new(0.0, -0.3));
    }
    // A robot that is never commanded to move, and whose pose creeps.
    let mut motors = Motors::new(&robot);
    for cycle in 0..100 {
        let pose = Pose::new(0.01 * f64::from(cycle), 0.0, 0.0);
        let now = at(0.1 * f64::from(cycle));
        assert_eq!(motors.observe(now, pose, Velocity::ZERO), Velocity::ZERO);
        motors.give(now, now, Velocity::ZERO);
    }
}

#[test]
fn commands_that_move_nothing_are_made_larger() {
    let robot = Robot::small();
    // Values of a Kobuki: its acceleration does not exceed them within a cycle.
    let mut real = Real { dead_band: Velocity::new(0.06, 0.24), ..Real::new(0) };
    let motors = driven(&robot, &mut real, 3.0);
    let too_small = motors.too_small();
    assert!((0.04..0.06).contains(&too_small.v), "{too_small:?}");
    assert!(real.pose.point().norm() > 0.3, "{:?}", real.pose);
    let stands = Velocity::ZERO;
    // A command of more than half of the smallest effective one is raised to it; a smaller one is
    // dropped, unless the robot is to creep.
    let least = motors.least();
    assert!((0.06..0.08).contains(&least.v), "{least:?}");
    assert_eq!(motors.within_reach(stands, Velocity::new(-0.05, 0.0)).v, -least.v);
    assert_eq!(motors.within_reach(stands, Velocity::new(0.001, 0.0)).v, least.v);
    assert_eq!(motors.within_reach(stands, Velocity::new(0.3, 0.0)).v, 0.3);
    assert_eq!(motors.within_reach(stands, Velocity::ZERO), Velocity::ZERO);
    // A robot that slows down is not sped up.
    assert_eq!(motors.within_reach(Velocity::new(0.09, 0.0), Velocity::new(0.05, 0.0)).v, 0.0);
}

/// A car-like robot does not turn on the spot: what does not move is its speed alone.
#[test]
fn commands_that_move_no_car_are_made_larger_on_the_same_arc() {
    let mut robot = Robot::small();
    (robot.limits.min_turning_radius_m, robot.limits.v_min_mps) = (0.3, -0.5);
    let mut real = Real { dead_band: Velocity::new(0.06, 0.0), ..Real::new(0) };
    let motors = driven(&robot, &mut real, 3.0);
    let (too_small, least) = (motors.too_small(), motors.least());
    assert!((0.04..0.06).contains(&too_small.v) && too_small.omega == 0.0, "{too_small:?}");
    assert!(real.pose.point().norm() > 0.3, "{:?}", real.pose);
    let given = |v, omega| motors.within_reach(Velocity::ZERO, Velocity::new(v, omega));
    let near = |a: Velocity, v: f64, omega: f64| {
        (a.v - v).abs() < 1e-12 && (a.omega - omega).abs() < 1e-12
    };
    assert!(near(given(0.001, 0.003), least.v, 3.0 * least.v));
    assert!(near(given(-0.05, 0.1), -least.v, 2.0 * least.v));
    assert!(near(given(0.3, 0.9), 0.3, 0.9));
    assert!(near(given(-0.8, 0.4), -0.5, 0.25), "{:?}", given(-0.8, 0.4));
    assert_eq!(given(0.0, 0.0), Velocity::ZERO);
}

#[test]
fn motors_without_a_dead_band_have_none() {
    for name in ["small", "jackal", "paper"] {
        let robot = Robot::by_name(name).unwrap();
        let mut real = Real { noise: 0.05, ..Real::new(100) };
        assert_eq!(driven(&robot, &mut real, 20.0).too_small(), Velocity::ZERO, "{name}");
    }
}

#[test]
fn what_was_learned_can_be_stored() {
    let robot = Robot::small();
    let motors = driven(&robot, &mut Real::new(200), 3.0);
    let mut again = Motors::new(&robot);
    assert!(again.take_up(motors.stored()));
    assert_eq!(again.learned_s(), motors.learned_s());
    assert!(!Motors::new(&Robot::jackal()).take_up(motors.stored()), "another robot");
    let mut stored = serde_json::to_value(motors.stored()).unwrap();
    stored["filter"]["learned_s"] = serde_json::json!(1e300);
    assert!(!Motors::new(&robot).take_up(serde_json::from_value(stored).unwrap()), "absurd");
}

#[test]
fn to_observe_allocates_nothing() {
    let robot = Robot::small();
    let mut motors = driven(&robot, &mut Real::new(200), 3.0);
    let info = allocation_counter::measure(|| {
        for cycle in 31..60 {
            let now = at(0.1 * f64::from(cycle));
            motors.observe(now, Pose::default(), Velocity::new(0.1, 0.0));
            motors.give(now, now, Velocity::new(0.2, 0.0));
        }
    });
    assert_eq!(info.count_total, 0);
}
