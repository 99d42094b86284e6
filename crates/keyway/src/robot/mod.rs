//! What a robot is: its size, its limits, its sensor.

mod clamped;
mod footprint;
mod sensor;
mod standing;

use crate::ConfigError;
use crate::geometry::Velocity;
use crate::given::Given;
use serde::{Deserialize, Serialize};

#[cfg(test)]
pub(crate) use footprint::star;
pub use footprint::{Circle, Footprint, FootprintError, Polygon};
pub use sensor::RangeSensor;

/// A differential-drive robot with a planar range sensor at its centre of rotation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// The ground that it covers: `radius_m` of a disc, or `vertices_m` of a polygon.
    pub footprint: Footprint,
    /// Control cycle \[s\]: time between two commands, from 0.001 to 10.
    pub cycle_s: f64,
    /// Time from a command to its effect \[s\], up to 10. The controller decides for the instant at which its command
    /// acts, and simulated motors are as late.
    #[serde(default)]
    pub actuation_delay_s: f64,
    /// Velocity and acceleration limits.
    pub limits: Limits,
    /// The range sensor.
    pub sensor: RangeSensor,
}

/// Velocity and acceleration limits of a differential drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Smallest forward speed \[m/s\], at least -100; 0: no driving backwards.
    pub v_min_mps: f64,
    /// Largest forward speed \[m/s\], from 0.0001 to 100.
    pub v_max_mps: f64,
    /// Largest turn rate to either side \[rad/s\], from 0.0001 to 100.
    pub omega_max_radps: f64,
    /// Acceleration \[m/s²\], like those below from 0.0001 to 10000.
    pub acceleration_mps2: f64,
    /// Deceleration \[m/s²\], positive; the robot stops from full speed within a minute.
    pub deceleration_mps2: f64,
    /// Angular acceleration \[rad/s²\].
    pub angular_acceleration_radps2: f64,
    /// Angular deceleration \[rad/s²\], positive; from the full turn rate, too.
    pub angular_deceleration_radps2: f64,
}

impl Robot {
    /// Names of the bundled robots, for [`Self::by_name`].
    pub const NAMES: [&'static str; 3] = ["small", "jackal", "paper"];

    /// A bundled robot.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "small" => Some(Self::small()),
            "jackal" => Some(Self::jackal()),
            "paper" => Some(Self::paper()),
            _ => None,
        }
    }

    /// A small round indoor robot of `TurtleBot` size: radius 0.18 m, up to 0.5 m/s.
    pub fn small() -> Self {
        Self {
            footprint: bundled(Footprint::circle(0.18)),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps: 0.5,
                omega_max_radps: 1.5,
                acceleration_mps2: 0.5,
                deceleration_mps2: 0.5,
                angular_acceleration_radps2: 3.0,
                angular_deceleration_radps2: 3.0,
            },
            sensor: RangeSensor::new(360, 360.0, 3.5),
        }
    }

    /// Clearpath Jackal as in the BARN challenge: 0.508 m x 0.430 m, up to 2 m/s, lidar of 270 degrees and
    /// 30 m. It backs up at 0.5 m/s at most, as its lidar looks ahead. Its velocity controller would allow 20 m/s² and 25 rad/s²; the accelerations here are what its
    /// tyres hold.
    pub fn jackal() -> Self {
        Self {
            footprint: bundled(Footprint::rectangle(0.508, 0.430)),
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            limits: Limits {
                v_min_mps: -0.5,
                v_max_mps: 2.0,
                omega_max_radps: 3.0,
                acceleration_mps2: 3.0,
                deceleration_mps2: 3.0,
                angular_acceleration_radps2: 6.0,
                angular_deceleration_radps2: 6.0,
            },
            sensor: RangeSensor::new(720, 270.0, 30.0),
        }
    }

    /// The robot of \[You2021\], table 2: a point that drives at up to 1 m/s on a map of 1 m cells.
    pub fn paper() -> Self {
        let degree = std::f64::consts::PI / 180.0;
        Self {
            footprint: bundled(Footprint::circle(0.0)),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps: 1.0,
                omega_max_radps: 20.0 * degree,
                acceleration_mps2: 0.2,
                deceleration_mps2: 0.2,
                angular_acceleration_radps2: 50.0 * degree,
                angular_deceleration_radps2: 50.0 * degree,
            },
            sensor: RangeSensor::new(360, 360.0, 5.0),
        }
    }

    /// Checks every value. A footprint was checked when it was made.
    ///
    /// # Errors
    /// Names the first field that cannot be used, with the values that can. No robot on wheels is near the ends of
    /// these ranges; beyond them a simulation would take minutes for a second, or numbers would lose their meaning.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let Limits { v_min_mps, v_max_mps, omega_max_radps, .. } = self.limits;
        let Limits { acceleration_mps2, deceleration_mps2, .. } = self.limits;
        let Limits { angular_acceleration_radps2, angular_deceleration_radps2, .. } = self.limits;
        let (speeds, rates) = (1e-4..=100.0, 1e-4..=1e4);
        let (speed, rate) = ("a number from 0.0001 to 100", "a number from 0.0001 to 10000");
        let checks = [
            ("cycle_s", self.cycle_s, 1e-3..=10.0, "a time from 0.001 to 10 s"),
            ("actuation_delay_s", self.actuation_delay_s, 0.0..=10.0, "a time from 0 to 10 s"),
            ("limits.v_max_mps", v_max_mps, speeds.clone(), speed),
            (
                "limits.v_min_mps",
                v_min_mps,
                -100.0..=0.0,
                "0, or negative for a robot that backs up, and at least -100",
            ),
            ("limits.omega_max_radps", omega_max_radps, speeds, speed),
            ("limits.acceleration_mps2", acceleration_mps2, rates.clone(), rate),
            ("limits.deceleration_mps2", deceleration_mps2, rates.clone(), rate),
            (
                "limits.angular_acceleration_radps2",
                angular_acceleration_radps2,
                rates.clone(),
                rate,
            ),
            ("limits.angular_deceleration_radps2", angular_deceleration_radps2, rates, rate),
        ];
        if let Some((field, value, _, expected)) =
            checks.into_iter().find(|(_, value, usable, _)| !usable.contains(value))
        {
            return Err(ConfigError::must_be(field, expected, value));
        }
        self.sensor.validate().map_err(|error| error.within("sensor"))?;
        self.limits.check_stopping()
    }
}

/// The footprint of a bundled robot.
#[expect(clippy::expect_used, reason = "its numbers stand above")]
fn bundled(footprint: Result<Footprint, FootprintError>) -> Footprint {
    footprint.expect("a bundled robot covers some ground")
}

impl Robot {
    /// The distance that routes keep from obstacles where they can: the circumscribed radius, with
    /// which the robot can turn on the spot anywhere, and a cycle of driving at full speed \[m\].
    pub fn preferred_clearance_m(&self) -> f64 {
        self.footprint.circumscribed_radius_m() + self.limits.v_max_mps * self.cycle_s
    }

    /// What is kept from obstacles in addition to the footprint: a tenth of what the robot drives in a
    /// cycle at full speed \[m\].
    pub fn safety_margin_m(&self) -> f64 {
        0.1 * self.limits.v_max_mps * self.cycle_s
    }

    /// What is farther away than this hardly matters in one cycle: as far as any part of the robot comes at
    /// full speed in a cycle and twice the time to stop \[m\].
    pub fn decision_reach_m(&self) -> f64 {
        let drive_s = self.cycle_s + 2.0 * self.limits.stop_s();
        self.footprint.circumscribed_radius_m() + self.limits.v_max_mps * drive_s
    }
}

/// A time in whole cycles, and the rest as a part of one: 0.3 s are three cycles of 0.1 s although their quotient
/// is rounded to less.
pub fn in_cycles(duration_s: f64, cycle_s: f64) -> (usize, f64) {
    let count = duration_s / cycle_s;
    let nearest = count.round();
    if (count - nearest).abs() <= 1e-9 * nearest.max(1.0) {
        return (nearest as usize, 0.0);
    }
    (count.floor() as usize, count - count.floor())
}

impl Limits {
    /// The velocity after `duration_s` when `command` is requested: each component moves towards
    /// the command as far as its limits and accelerations allow.
    pub fn reached(&self, from: Velocity, command: Velocity, duration_s: f64) -> Velocity {
        let Velocity { v, omega } = self.clamped(command);
        Velocity::new(
            approach(from.v, v, self.acceleration_mps2, self.deceleration_mps2, duration_s),
            approach(
                from.omega,
                omega,
                self.angular_acceleration_radps2,
                self.angular_deceleration_radps2,
                duration_s,
            ),
        )
    }

    /// Forward speeds up to this are noise of a standing robot: a tenth of what it sheds in
    /// `cycle_s`, but at most a hundredth of its full speed.
    pub fn standing_mps(&self, cycle_s: f64) -> f64 {
        (0.1 * self.deceleration_mps2 * cycle_s).min(0.01 * self.v_max_mps)
    }

    /// The longest that a robot may take to stop \[s\].
    const LONGEST_STOP_S: f64 = 60.0;

    /// Refuses brakes that are too weak: all that looks ahead looks as far as the robot needs to stop.
    fn check_stopping(&self) -> Result<(), ConfigError> {
        let checks = [
            ("limits.deceleration_mps2", self.deceleration_mps2, self.v_max_mps, "v_max_mps"),
            ("limits.deceleration_mps2", self.deceleration_mps2, -self.v_min_mps, "v_min_mps"),
            (
                "limits.angular_deceleration_radps2",
                self.angular_deceleration_radps2,
                self.omega_max_radps,
                "omega_max_radps",
            ),
        ];
        let weak = checks
            .into_iter()
            .find(|(_, brakes, fastest, _)| fastest / brakes > Self::LONGEST_STOP_S * (1.0 + 1e-9));
        let Some((field, brakes, fastest, fastest_name)) = weak else { return Ok(()) };
        // Rounded up, so that what the message says can be used.
        let least = Given((fastest / Self::LONGEST_STOP_S * 1e6).ceil() / 1e6);
        let expected =
            format!("at least {least}, to stop from limits.{fastest_name} within a minute");
        Err(ConfigError::must_be(field, &expected, brakes))
    }

    /// Time to stop from full speed and full turn rate \[s\].
    pub fn stop_s(&self) -> f64 {
        (self.v_max_mps.max(-self.v_min_mps) / self.deceleration_mps2)
            .max(self.omega_max_radps / self.angular_deceleration_radps2)
    }

    /// Way to stop from full speed \[m\].
    pub fn stop_m(&self) -> f64 {
        self.v_max_mps * self.v_max_mps / (2.0 * self.deceleration_mps2)
    }

    /// The way on which the robot brakes to a stop in whole cycles ([`Self::braked`]) is never longer than what it covers in
    /// this time at the velocity from which it brakes: half of the time to stop and half of a cycle \[s\].
    ///
    /// Braking from the velocity u scales it: after k cycles of duration c it is g(k c) u, with g(t) = max(0, 1 - t / T)
    /// and the time to stop T; in between it changes linearly. Speed and turn rate fall in proportion, so the robot stays
    /// on its arc and covers of it what u covers in the time
    /// S = c (g(0) + g(c)) / 2 + c (g(c) + g(2 c)) / 2 + ... = c / 2 + c (g(c) + g(2 c) + ...).
    /// As g falls, c g(k c) is at most the integral of g over the k-th cycle, so S <= c / 2 + T / 2. Both terms are
    /// needed: a robot that could stop at once still needs a cycle, in which it drives half as far as at u.
    pub fn brakes_within_s(&self, cycle_s: f64) -> f64 {
        0.5 * (self.stop_s() + cycle_s)
    }

    /// The largest speed that a robot may have at the end of a cycle, when it had `from_mps` at its beginning, to stand
    /// within `within_m` of there, driving straight and braking in whole cycles \[m/s\]; 0 where none is small enough.
    ///
    /// In a cycle c a deceleration of b sheds b c. From the speed v = (n + f) b c, n whole and 0 <= f < 1, braking covers
    /// b c² (n² + 2 n f + f) / 2, and the cycle before it (`from_mps` + v) c / 2. Solved for n and f.
    pub fn stoppable_mps(&self, from_mps: f64, within_m: f64, cycle_s: f64) -> f64 {
        let shed_mps = self.deceleration_mps2 * cycle_s;
        // What is left for v, in units of b c² / 2, is n² + n + f (2 n + 2).
        let left = (2.0 * within_m / cycle_s - from_mps.abs()) / shed_mps;
        if left == f64::INFINITY {
            return left;
        }
        let left = left.max(0.0);
        let whole = (0.5 * ((1.0 + 4.0 * left).sqrt() - 1.0)).floor();
        let part = (left - whole * whole - whole) / (2.0 * whole + 2.0);
        shed_mps * (whole + part)
    }

    /// The velocity after braking for `duration_s` as hard as the curvature of the present arc
    /// allows: speed and turn rate fall in proportion, so that the robot stays on its arc.
    pub fn braked(&self, from: Velocity, duration_s: f64) -> Velocity {
        let stop_s = (from.v.abs() / self.deceleration_mps2)
            .max(from.omega.abs() / self.angular_deceleration_radps2);
        // The last step of an even number of them ends at rest, not a rounding error before it.
        if stop_s <= duration_s * (1.0 + 1e-9) {
            return Velocity::ZERO;
        }
        let kept = 1.0 - duration_s / stop_s;
        Velocity::new(from.v * kept, from.omega * kept)
    }
}

/// `from` moved towards `to`; speeding up and slowing down have limits of their own.
fn approach(from: f64, to: f64, acceleration: f64, deceleration: f64, duration_s: f64) -> f64 {
    let slower = to.abs() < from.abs() || to * from < 0.0;
    let step = if slower { deceleration } else { acceleration } * duration_s;
    from + (to - from).clamp(-step, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundled_robots_are_valid() {
        for name in Robot::NAMES {
            let robot = Robot::by_name(name).unwrap();
            assert_eq!(robot.validate(), Ok(()));
            let text = toml::to_string(&robot).unwrap();
            assert_eq!(toml::from_str::<Robot>(&text).unwrap(), robot);
        }
        assert_eq!(Robot::by_name("large"), None);
    }

    #[test]
    fn a_bad_value_is_named() {
        let mut robot = Robot::small();
        robot.limits.deceleration_mps2 = f64::NAN;
        assert_eq!(robot.validate().unwrap_err().path, "limits.deceleration_mps2");
        robot = Robot::small();
        robot.sensor.beams = 0;
        assert_eq!(robot.validate().unwrap_err().path, "sensor.beams");
    }

    #[test]
    fn what_no_robot_can_do_is_refused_with_field_and_value() {
        type Set = fn(&mut Robot, f64);
        let cases: [(Set, f64, &str); 10] = [
            (
                |r, x| r.cycle_s = x,
                1e9,
                "cycle_s must be a time from 0.001 to 10 s, got 1000000000",
            ),
            (|r, x| r.cycle_s = x, 1e-9, "cycle_s must be a time from 0.001 to 10 s, got 1e-9"),
            (
                |r, x| r.limits.v_max_mps = x,
                101.0,
                "v_max_mps must be a number from 0.0001 to 100, got 101",
            ),
            (|r, x| r.limits.v_min_mps = x, -1e30, "and at least -100, got -1e30"),
            (|r, x| r.limits.v_min_mps = x, -90.0, "to stop from limits.v_min_mps within a minute"),
            (
                |r, x| r.limits.omega_max_radps = x,
                1e6,
                "omega_max_radps must be a number from 0.0001 to 100, got 1000000",
            ),
            (
                |r, x| r.limits.acceleration_mps2 = x,
                1e5,
                "acceleration_mps2 must be a number from 0.0001 to 10000, got 100000",
            ),
            (
                |r, x| r.limits.deceleration_mps2 = x,
                0.001,
                "deceleration_mps2 must be at least 0.008334, to stop from limits.v_max_mps within a minute, got 0.001",
            ),
            (
                |r, x| r.limits.angular_deceleration_radps2 = x,
                0.02,
                "to stop from limits.omega_max_radps within a minute, got 0.02",
            ),
            (
                |r, x| r.sensor.range_m = x,
                1e300,
                "sensor.range_m must be a length from 0.001 to 10000 m, got 1e300",
            ),
        ];
        for (set, value, expected) in cases {
            let mut robot = Robot::small();
            set(&mut robot, value);
            let text = robot.validate().unwrap_err().to_string();
            assert!(text.contains(expected), "{text}");
        }
    }

    #[test]
    fn velocity_follows_the_command_within_the_limits() {
        let limits = Robot::small().limits;
        let from = Velocity::new(0.3, -0.2);
        let reached = limits.reached(from, Velocity::new(9.0, 0.05), 0.1);
        assert!((reached.v - 0.35).abs() < 1e-12 && (reached.omega - 0.05).abs() < 1e-12);
        let stopped = limits.reached(Velocity::new(0.02, 0.0), Velocity::ZERO, 0.1);
        assert_eq!(stopped, Velocity::ZERO);
    }

    #[test]
    fn braking_in_whole_cycles_needs_half_the_time_to_stop_and_half_a_cycle() {
        for (deceleration_mps2, cycle_s) in
            [(0.5, 0.1), (0.47, 0.3), (5.0, 0.5), (30.0, 0.1), (1.1, 0.4)]
        {
            let limits = Limits {
                deceleration_mps2,
                angular_deceleration_radps2: 1e9,
                ..Robot::small().limits
            };
            let (mut v, mut driven_m) = (limits.v_max_mps, 0.0);
            while v > 0.0 {
                let slower = limits.braked(Velocity::new(v, 0.0), cycle_s).v;
                driven_m += 0.5 * (v + slower) * cycle_s;
                v = slower;
            }
            let within_s = limits.brakes_within_s(cycle_s);
            let needed_s = driven_m / limits.v_max_mps;
            assert!(needed_s <= within_s, "{needed_s} {within_s}");
            // Not by much: c (n - 1/2 - n (n - 1) c / (2 T)) with n whole cycles.
            let stop_s = limits.stop_s();
            let n = (stop_s / cycle_s - 1e-9).ceil();
            let exact_s = cycle_s * (n - 0.5 - n * (n - 1.0) * cycle_s / (2.0 * stop_s));
            assert!((needed_s - exact_s).abs() < 1e-9, "{needed_s} {exact_s}");
        }
    }

    /// How far a robot drives in a cycle that takes it from one speed to another, and then until it stands \[m\].
    fn driven_m(limits: &Limits, from_mps: f64, to_mps: f64, cycle_s: f64) -> f64 {
        let (mut v, mut driven_m) = (to_mps, 0.5 * (from_mps + to_mps) * cycle_s);
        while v > 0.0 {
            let slower = limits.braked(Velocity::new(v, 0.0), cycle_s).v;
            driven_m += 0.5 * (v + slower) * cycle_s;
            v = slower;
        }
        driven_m
    }

    #[test]
    fn the_fastest_speed_that_still_stops_uses_up_the_way() {
        let limits = Robot::small().limits;
        for cycle_s in [0.02, 0.1, 0.37, 1.0, 5.0] {
            for (from_mps, within_m) in
                [(0.0, 0.1), (0.3, 0.4), (0.5, 2.0), (0.1, 0.3), (0.0, 1e-6)]
            {
                let v = limits.stoppable_mps(from_mps, within_m, cycle_s);
                let least_m = driven_m(&limits, from_mps, 0.0, cycle_s);
                let expected_m = within_m.max(least_m);
                let needed_m = driven_m(&limits, from_mps, v, cycle_s);
                assert!(
                    (needed_m - expected_m).abs() < 1e-9,
                    "{cycle_s} {from_mps} {within_m}: {v}"
                );
            }
        }
        assert_eq!(limits.stoppable_mps(0.2, f64::INFINITY, 0.1), f64::INFINITY);
        assert_eq!(limits.stoppable_mps(0.2, -1.0, 0.1), 0.0);
    }

    #[test]
    fn braking_stays_on_the_arc() {
        let limits = Robot::small().limits;
        // 0.4 m/s needs 0.8 s, 0.6 rad/s only 0.2 s: the speed decides.
        let braked = limits.braked(Velocity::new(0.4, 0.6), 0.1);
        assert!((braked.v - 0.35).abs() < 1e-12 && (braked.omega - 0.525).abs() < 1e-12);
        // 0.1 m/s needs 0.2 s, 1.2 rad/s 0.4 s: the turn rate decides.
        let turning = limits.braked(Velocity::new(0.1, -1.2), 0.1);
        assert!((turning.v - 0.075).abs() < 1e-12 && (turning.omega + 0.9).abs() < 1e-12);
        assert_eq!(limits.braked(Velocity::new(0.05, 0.0), 0.1), Velocity::ZERO);
        let mut velocity = Velocity::new(0.5, 0.09);
        for _ in 0..10 {
            velocity = limits.braked(velocity, 0.1);
        }
        assert_eq!(velocity, Velocity::ZERO);
    }
}
