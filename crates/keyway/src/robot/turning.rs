//! The turning radius: the velocities that the wheels of a robot can have.
//!
//! A robot with a differential drive turns in place. A car-like one cannot: it needs a speed v of
//! at least r |omega|, with its smallest turning radius r. Every velocity that the robot reaches is
//! one of these. Between two of them with the same direction of travel all others are as well, and
//! the robot stops before it changes that direction: it never turns more tightly.

use super::{Limits, Robot};
use crate::ConfigError;
use crate::geometry::Velocity;

impl Limits {
    /// True for a robot that can turn in place.
    pub fn turns_in_place(&self) -> bool {
        self.min_turning_radius_m == 0.0
    }

    /// The largest turn rate at a speed \[rad/s\].
    pub fn turn_rate_at(&self, v_mps: f64) -> f64 {
        if self.turns_in_place() {
            return self.omega_max_radps;
        }
        self.omega_max_radps.min(v_mps.abs() / self.min_turning_radius_m)
    }

    /// A velocity at the same speed that turns no more than the robot can.
    pub(super) fn steered(&self, velocity: Velocity) -> Velocity {
        let most_radps = self.turn_rate_at(velocity.v);
        Velocity::new(velocity.v, velocity.omega.clamp(-most_radps, most_radps))
    }

    /// The velocity that is reached instead of one that the wheels cannot have.
    pub(super) fn steered_from(&self, from: Velocity, to: Velocity) -> Velocity {
        if self.turns_in_place() {
            return to;
        }
        let reverses = from.v * to.v < 0.0;
        if reverses { Velocity::ZERO } else { self.steered(to) }
    }

    /// Refuses a radius that no robot has, and jerk limits of a car-like robot: the mean of a
    /// velocity ahead and one back is none that its wheels can have.
    pub(super) fn check_turning(&self) -> Result<(), ConfigError> {
        if self.turns_in_place() {
            return Ok(());
        }
        let radius_m = self.min_turning_radius_m;
        if !(1e-4..=100.0).contains(&radius_m) {
            let expected = "0, or a length from 0.0001 to 100 m";
            return Err(ConfigError::must_be("limits.min_turning_radius_m", expected, radius_m));
        }
        let limited = [
            ("limits.jerk_mps3", self.jerk_mps3),
            ("limits.angular_jerk_radps3", self.angular_jerk_radps3),
        ];
        let limited = limited.into_iter().find_map(|(field, jerk)| Some((field, jerk?)));
        let Some((field, jerk)) = limited else { return Ok(()) };
        let expected = "left out for a robot with limits.min_turning_radius_m";
        Err(ConfigError::must_be(field, expected, jerk))
    }
}

impl Robot {
    /// A measured velocity without the noise that the wheels of a car-like robot cannot have. At
    /// rest, a slow motion against the present command would have to be braked first.
    pub(crate) fn without_noise(&self, measured: Velocity, command: Velocity) -> Velocity {
        let limits = &self.limits;
        if limits.turns_in_place() {
            return measured;
        }
        // A motion along the command is how every start begins.
        let is_noise = measured.v.abs() <= self.standing().v && measured.v * command.v <= 0.0;
        if is_noise { Velocity::ZERO } else { limits.steered(measured) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn car() -> Limits {
        Limits { min_turning_radius_m: 0.6, v_min_mps: -0.5, ..Robot::jackal().limits }
    }

    #[test]
    fn a_car_turns_only_while_it_drives() {
        let limits = car();
        let clamped = |v, omega| limits.clamped(Velocity::new(v, omega));
        assert_eq!(clamped(0.0, 2.0), Velocity::ZERO);
        assert_eq!(clamped(0.3, 2.0), Velocity::new(0.3, 0.5));
        assert_eq!(clamped(-0.3, -2.0), Velocity::new(-0.3, -0.5));
        assert_eq!(clamped(2.0, 9.0), Velocity::new(2.0, 3.0), "3 rad/s at most");
        assert_eq!(clamped(0.3, 0.2), Velocity::new(0.3, 0.2));
        let differential = Robot::jackal().limits;
        assert_eq!(differential.clamped(Velocity::new(0.0, 2.0)), Velocity::new(0.0, 2.0));
    }

    #[test]
    fn it_stops_before_it_changes_its_direction() {
        let limits = car();
        let from = Velocity::new(0.1, 0.1);
        let reached = limits.reached(from, Velocity::new(-0.5, 0.5), 0.1);
        assert_eq!(reached, Velocity::ZERO);
        assert!(limits.reached(reached, Velocity::new(-0.5, 0.5), 0.1).v < 0.0);
    }

    #[test]
    fn noise_at_rest_is_no_motion() {
        let robot = Robot { limits: car(), ..Robot::jackal() };
        let ahead = Velocity::new(0.1, 0.0);
        let without_noise = |v, omega| robot.without_noise(Velocity::new(v, omega), ahead);
        assert_eq!(without_noise(-0.01, 0.3), Velocity::ZERO);
        assert_eq!(without_noise(-0.06, 0.3), Velocity::new(-0.06, 0.1));
        assert_eq!(without_noise(1.0, 0.3), Velocity::new(1.0, 0.3));
        assert_eq!(robot.without_noise(Velocity::new(0.01, 0.0), Velocity::ZERO), Velocity::ZERO);
        let differential = Velocity::new(-0.01, 0.3);
        assert_eq!(Robot::jackal().without_noise(differential, ahead), differential);
    }

    /// Each command is what is reached from the last velocity within a cycle, which may be less
    /// than what counts as standing.
    #[test]
    fn a_slow_start_is_no_noise() {
        let mut robot = Robot { limits: car(), ..Robot::jackal() };
        robot.limits.acceleration_mps2 = 0.05 * robot.limits.deceleration_mps2;
        let mut velocity = Velocity::ZERO;
        for _ in 0..100 {
            let known = robot.without_noise(velocity, velocity);
            velocity = robot.limits.reached(known, Velocity::new(1.0, 0.0), robot.cycle_s);
        }
        assert!(velocity.v > 0.5, "{velocity:?}");
    }

    #[test]
    fn jerk_limits_of_a_car_are_refused() {
        let mut robot = Robot { limits: car(), ..Robot::jackal() };
        assert_eq!(robot.validate(), Ok(()));
        robot.limits.jerk_mps3 = Some(50.0);
        assert_eq!(robot.validate().unwrap_err().path, "limits.jerk_mps3");
        robot.limits.min_turning_radius_m = -0.1;
        assert_eq!(robot.validate().unwrap_err().path, "limits.min_turning_radius_m");
    }

    proptest! {
        /// On the whole ramp from one reached velocity to the next, and while it brakes.
        #[test]
        fn no_motion_is_tighter_than_the_turning_radius(
            commands in proptest::collection::vec((-2.0..3.0_f64, -4.0..4.0_f64), 1..20),
            cycle_s in 0.01..0.5_f64,
        ) {
            let limits = car();
            let is_wide = |it: Velocity| {
                it.omega.abs() <= it.v.abs() / limits.min_turning_radius_m + 1e-9
            };
            let mut velocity = Velocity::ZERO;
            for (v, omega) in commands {
                let to = limits.reached(velocity, Velocity::new(v, omega), cycle_s);
                let stops = limits.braked(to, cycle_s);
                for part in [0.0, 0.2, 0.5, 0.9, 1.0] {
                    prop_assert!(is_wide(velocity.lerp(to, part)), "{:?} {:?}", velocity, to);
                    prop_assert!(is_wide(to.lerp(stops, part)), "{:?} {:?}", to, stops);
                }
                velocity = to;
            }
        }
    }
}
