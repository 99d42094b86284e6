//! The drive model: motion, braking and stopping of a robot.
//!
//! A differential drive turns in place; a car-like one has a smallest turning radius
//! (`turning.rs`). The model gives the velocity that a robot reaches in a cycle, its braking, the
//! test for standstill, and its motion until it stops. Dynamic windows, the space-time search, the
//! stop rule and the recovery motions integrate (v, omega) with formulas of their own, and ask here
//! which velocities there are.

use super::{Limits, Robot};
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
use crate::given::Given;

/// The motion of one cycle, in which the velocity changes linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ramp {
    /// Pose at its beginning.
    pub start: Pose,
    /// Velocity at its beginning.
    pub from: Velocity,
    /// Velocity at its end.
    pub to: Velocity,
    /// Pose at its end.
    pub end: Pose,
}

impl Robot {
    /// The motion of a robot that is given a command and brakes from the next cycle on, cycle by
    /// cycle, until it stops: at least one cycle. While braking, it stays on its arc.
    pub fn motion_to_stop(
        &self,
        pose: Pose,
        velocity: Velocity,
        command: Velocity,
    ) -> impl Iterator<Item = Ramp> + '_ {
        let first = self.ramp(pose, velocity, command);
        std::iter::successors(Some(first), |last| {
            let stands = last.to == Velocity::ZERO;
            let braked = || self.limits.braked(last.to, self.cycle_s);
            (!stands).then(|| self.ramp(last.end, last.to, braked()))
        })
    }

    /// Pose at which a robot stops that is given a command and brakes from the next cycle on.
    pub(crate) fn stop_pose(&self, pose: Pose, velocity: Velocity, command: Velocity) -> Pose {
        self.motion_to_stop(pose, velocity, command).fold(pose, |_, motion| motion.end)
    }

    /// The motion of the next cycle under a command.
    pub fn ramp(&self, pose: Pose, from: Velocity, command: Velocity) -> Ramp {
        let to = self.limits.reached(from, command, self.cycle_s);
        Ramp { start: pose, from, to, end: pose.after_ramp(from, to, self.cycle_s) }
    }

    /// True if the robot is stationary: so small a velocity is odometry noise.
    pub(crate) fn stands(&self, velocity: Velocity) -> bool {
        let standing = self.standing();
        velocity.v.abs() <= standing.v && velocity.omega.abs() <= standing.omega
    }

    /// The largest speed and turn rate that the odometry of a stationary robot shows.
    pub(crate) fn standing(&self) -> Velocity {
        let (limits, cycle_s) = (&self.limits, self.cycle_s);
        let standing_radps = 0.1 * limits.angular_deceleration_radps2 * cycle_s;
        Velocity::new(limits.standing_mps(cycle_s), standing_radps)
    }

    /// The longest time from a scan to rest \[s\], if the robot backs up at full speed for one
    /// more cycle.
    pub(crate) fn backing_s(&self) -> f64 {
        let stop_s = -self.limits.v_min_mps / self.limits.deceleration_mps2;
        self.actuation_delay_s + 2.0 * self.cycle_s + stop_s + 2.0 * self.smoothing_lag_s()
    }
}

/// A time in cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CycleCount {
    /// Whole cycles.
    pub whole: usize,
    /// The remainder, as a fraction of a cycle.
    pub part: f64,
}

impl CycleCount {
    /// A time in cycles: 0.3 s are three cycles of 0.1 s, although rounding makes their quotient
    /// smaller.
    pub fn of(duration_s: f64, cycle_s: f64) -> Self {
        let count = duration_s / cycle_s;
        let nearest = count.round();
        if (count - nearest).abs() <= 1e-9 * nearest.max(1.0) {
            return Self { whole: nearest as usize, part: 0.0 };
        }
        Self { whole: count.floor() as usize, part: count - count.floor() }
    }
}

impl Limits {
    /// The nearest velocity within the limits, component by component; 0 for a component that is
    /// NaN. A turn rate that needs a smaller turning radius than the robot's is reduced.
    pub fn clamped(&self, velocity: Velocity) -> Velocity {
        self.steered(self.clamped_apart(velocity))
    }

    /// The same without a turning radius.
    fn clamped_apart(&self, velocity: Velocity) -> Velocity {
        let known = |value: f64| if value.is_nan() { 0.0 } else { value };
        Velocity::new(
            known(velocity.v).clamp(self.v_min_mps, self.v_max_mps),
            known(velocity.omega).clamp(-self.omega_max_radps, self.omega_max_radps),
        )
    }

    /// The velocity after `duration_s` if `command` is requested: each component moves towards the
    /// command as far as its limits and accelerations allow. The turn rate of a car-like robot
    /// also falls with its speed, and it stops before it changes its direction of travel.
    pub fn reached(&self, from: Velocity, command: Velocity, duration_s: f64) -> Velocity {
        let reached = self.reached_apart(from, self.clamped(command), duration_s);
        self.steered_from(from, reached)
    }

    /// The same without a turning radius: the speed and the turn rate, each on its own, that are
    /// reached with some value of the other.
    pub(crate) fn reached_apart(
        &self,
        from: Velocity,
        command: Velocity,
        duration_s: f64,
    ) -> Velocity {
        let Velocity { v, omega, .. } = self.clamped_apart(command);
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

    /// Forward speeds up to this are noise of a stationary robot: a tenth of the speed that it
    /// loses in `cycle_s` of braking, but at most a hundredth of its full speed.
    pub(crate) fn standing_mps(&self, cycle_s: f64) -> f64 {
        (0.1 * self.deceleration_mps2 * cycle_s).min(0.01 * self.v_max_mps)
    }

    /// Maximum time to stop \[s\].
    const LONGEST_STOP_S: f64 = 60.0;

    /// Refuses brakes that are too weak: every look-ahead covers the distance that the robot needs
    /// to stop.
    pub(super) fn check_stopping(&self) -> Result<(), ConfigError> {
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
        // Rounded up, so that the value in the message is valid.
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

    /// Braking distance from full speed \[m\].
    pub fn stop_m(&self) -> f64 {
        self.v_max_mps * self.v_max_mps / (2.0 * self.deceleration_mps2)
    }

    /// Upper bound of the braking distance, as a time \[s\]: braking to a stop in whole cycles
    /// ([`Self::braked`]) takes at most the distance that the initial velocity covers in this
    /// time. It is half of the time to stop plus half of a cycle.
    ///
    /// Braking from the velocity u scales it: after k cycles of duration c it is g(k c) u, with
    /// g(t) = max(0, 1 - t / T) and the time to stop T; in between it changes linearly. Speed and
    /// turn rate fall in proportion, so the robot stays on its arc and covers the part of it that
    /// u covers in the time S = c (g(0) + g(c)) / 2 + c (g(c) + g(2 c)) / 2 + ... = c / 2 + c
    /// (g(c) + g(2 c) + ...). As g falls, c g(k c) is at most the integral of g over the k-th
    /// cycle, so S <= c / 2 + T / 2. Both terms are needed: even a robot that could stop instantly
    /// needs a cycle, in which it drives half as far as at u.
    pub fn brakes_within_s(&self, cycle_s: f64) -> f64 {
        0.5 * (self.stop_s() + cycle_s)
    }

    /// The largest speed at the end of a cycle, after `from_mps` at its beginning, from which the
    /// robot stops within `within_m` of its position at the beginning \[m/s\]. It drives straight
    /// and brakes in whole cycles; 0 if no speed is small enough.
    pub(crate) fn stoppable_mps(&self, from_mps: f64, within_m: f64, cycle_s: f64) -> f64 {
        stoppable(from_mps, within_m, self.deceleration_mps2, cycle_s)
    }

    /// As [`Self::stoppable_mps`], for turning in place \[rad/s\].
    pub(crate) fn stoppable_radps(&self, from_radps: f64, within_rad: f64, cycle_s: f64) -> f64 {
        stoppable(from_radps, within_rad, self.angular_deceleration_radps2, cycle_s)
    }

    /// The velocity after braking for `duration_s` as hard as the curvature of the current arc
    /// allows: speed and turn rate fall in proportion, so the robot stays on its arc.
    pub fn braked(&self, from: Velocity, duration_s: f64) -> Velocity {
        let stop_s = (from.v.abs() / self.deceleration_mps2)
            .max(from.omega.abs() / self.angular_deceleration_radps2);
        // The last of several equal steps ends at rest, not a rounding error before it.
        if stop_s <= duration_s * (1.0 + 1e-9) {
            return Velocity::ZERO;
        }
        let kept = 1.0 - duration_s / stop_s;
        Velocity::new(from.v * kept, from.omega * kept)
    }
}

/// The largest velocity at the end of a cycle from which a stop is possible in whole cycles. A
/// velocity in the opposite direction at its beginning counts as one ahead.
///
/// In a cycle c, a deceleration of b reduces the velocity by b c. From the velocity v = (n + f) b
/// c, n integer and 0 <= f < 1, braking covers b c² (n² + 2 n f + f) / 2, and the cycle before it
/// (`from` + v) c / 2. Solved for n and f.
fn stoppable(from: f64, within: f64, deceleration: f64, cycle_s: f64) -> f64 {
    let shed = deceleration * cycle_s;
    // The distance left for v, in units of b c² / 2, is n² + n + f (2 n + 2).
    let left = (2.0 * within / cycle_s - from.abs()) / shed;
    if left == f64::INFINITY {
        return left;
    }
    let left = left.max(0.0);
    let whole = (0.5 * ((1.0 + 4.0 * left).sqrt() - 1.0)).floor();
    let part = (left - whole * whole - whole) / (2.0 * whole + 2.0);
    shed * (whole + part)
}

/// Moves `from` towards `to`; speeding up and slowing down have separate limits.
fn approach(from: f64, to: f64, acceleration: f64, deceleration: f64, duration_s: f64) -> f64 {
    let slower = to.abs() < from.abs() || to * from < 0.0;
    let step = if slower { deceleration } else { acceleration } * duration_s;
    from + (to - from).clamp(-step, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_stands_where_it_has_braked() {
        let robot = Robot::small();
        let start = Pose::new(1.0, 2.0, 0.0);
        let stop = |from, command| robot.stop_pose(start, from, command);
        // 0.05 m in a cycle at 0.5 m/s, and 0.25 m in ten cycles of braking.
        let ahead = Velocity::new(0.5, 0.0);
        assert!((stop(ahead, ahead).x - 1.3).abs() < 1e-12);
        assert_eq!(stop(Velocity::ZERO, Velocity::ZERO), start);
        // It stays on its arc of 0.5 m: 0.6 rad.
        let arc = Velocity::new(0.5, 1.0);
        let end = stop(arc, arc);
        assert!((end.theta - 0.6).abs() < 1e-12, "{end:?}");
        assert!((end.x - 1.0 - 0.5 * libm::sin(0.6)).abs() < 1e-3, "{end:?}");
    }

    #[test]
    fn noise_is_no_motion() {
        let robot = Robot::small();
        assert!(robot.stands(Velocity::new(0.004, 0.02)));
        assert!(!robot.stands(Velocity::new(0.006, 0.0)));
        assert!(!robot.stands(Velocity::new(0.0, 0.04)));
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
            // The bound is tight; exact: c (n - 1/2 - n (n - 1) c / (2 T)) with n whole cycles.
            let stop_s = limits.stop_s();
            let n = (stop_s / cycle_s - 1e-9).ceil();
            let exact_s = cycle_s * (n - 0.5 - n * (n - 1.0) * cycle_s / (2.0 * stop_s));
            assert!((needed_s - exact_s).abs() < 1e-9, "{needed_s} {exact_s}");
        }
    }

    /// The distance that a robot drives in a cycle that takes it from one speed to another, and
    /// then until it stops \[m\].
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
