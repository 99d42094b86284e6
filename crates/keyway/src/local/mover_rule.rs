//! Rule against velocities that lead into a moving obstacle.
//!
//! # The rule
//! | symbol | meaning | unit |
//! |---|---|---|
//! | t | from now, up to the horizon | s |
//! | c, v, r | centre, velocity and radius of a [`Mover`] | m, m/s, m |
//! | e, f | a third of its uncertainties of position and velocity: a standard deviation | m, m/s |
//! | P(t) | the footprint on the predicted motion: one cycle of velocity change, then the arc | |
//! | D(t) | the disc around c + v t of radius r + e + f t: the moving obstacle at constant velocity | |
//!
//! A velocity is refused if at some t the distance between P(t) and D(t) is less than the margin,
//! **and** less than that between P(0) and D(t), the distance of a robot that had stayed at its
//! pose. Times after the first at which D(t) would reach a robot that had stayed do not count, as
//! staying is no better then. So standstill is never refused: a robot waits until a moving
//! obstacle has passed, one that is followed may drive on, and one that is inside a disc may
//! leave it.
//!
//! # Limitations
//! A moving obstacle that turns or speeds up by more than its uncertainty is only detected in the
//! next cycle. The rule does not check if the robot could still stop then: that is the [stop
//! rule](super::StopRule). A moving obstacle may run into a stationary robot.
//!
//! # Errors / cost
//! None. Per velocity and moving obstacle at least ten poses with two distances each; steps are
//! no longer than the clearance, but at least 1 cm, so a disc may be grazed by as much. Costs
//! nothing without moving obstacles. Allocates nothing.

use crate::geometry::{Pose, Velocity};
use crate::map::Core;
use crate::robot::Robot;
use crate::sense::Mover;

/// The rule for one cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MoverRule<'a> {
    robot: &'a Robot,
    movers: &'a [Mover],
    pose: Pose,
    velocity: Velocity,
    /// Horizon of the predictions \[s\].
    horizon_s: f64,
    /// Less clearance than this counts as a contact \[m\].
    margin_m: f64,
}

impl<'a> MoverRule<'a> {
    /// Fraction of the uncertainty of a moving obstacle, which is three standard deviations, that
    /// counts.
    const UNCERTAIN_PART: f64 = 1.0 / 3.0;

    /// Least number of steps in a horizon.
    const LEAST_STEPS: f64 = 10.0;

    /// Resolution of the clearance \[m\].
    const LEAST_STEP_M: f64 = 0.01;

    /// Differences of distances up to this are rounding errors \[m\].
    pub(crate) const ROUNDING_M: f64 = 1e-9;

    /// The rule for a robot at a pose that moves with a velocity.
    pub(crate) const fn new(
        robot: &'a Robot,
        movers: &'a [Mover],
        (pose, velocity): (Pose, Velocity),
        [horizon_s, margin_m]: [f64; 2],
    ) -> Self {
        Self { robot, movers, pose, velocity, horizon_s, margin_m }
    }

    /// True if a velocity leads into one of the moving obstacles.
    pub(crate) fn refuses(&self, candidate: Velocity) -> bool {
        self.room_m(candidate).is_none()
    }

    /// The least clearance of a velocity from any moving obstacle, as far as it counts \[m\],
    /// infinite without moving obstacles; `None` if it is refused.
    #[inline]
    pub(crate) fn room_m(&self, candidate: Velocity) -> Option<f64> {
        if self.movers.is_empty() { Some(f64::INFINITY) } else { self.least_room_m(candidate) }
    }

    fn least_room_m(&self, candidate: Velocity) -> Option<f64> {
        let (core, radius_m) = self.robot.footprint.core();
        let ramped = self.pose.after_ramp(self.velocity, candidate, self.robot.cycle_s);
        let way = Way { rule: self, core, radius_m, candidate, ramped };
        let mut usable = self.movers.iter().filter(|mover| mover.is_usable());
        usable.try_fold(f64::INFINITY, |least_m, mover| Some(way.least_room_m(mover)?.min(least_m)))
    }
}

/// The predicted motion of a velocity.
struct Way<'r, 'a> {
    rule: &'r MoverRule<'a>,
    core: Core<'a>,
    radius_m: f64,
    candidate: Velocity,
    /// The pose after the first cycle.
    ramped: Pose,
}

impl Way<'_, '_> {
    fn pose(&self, after_s: f64) -> Pose {
        let MoverRule { robot, pose, velocity, .. } = self.rule;
        let cycle_s = robot.cycle_s;
        if after_s >= cycle_s {
            return self.ramped.after_arc(self.candidate, after_s - cycle_s);
        }
        let to = velocity.lerp(self.candidate, after_s / cycle_s);
        pose.after_ramp(*velocity, to, after_s)
    }

    /// The uncertainty that counts at a time \[m\].
    fn off_m(mover: &Mover, after_s: f64) -> f64 {
        let all_m = mover.position_uncertainty_m + mover.velocity_uncertainty_mps * after_s;
        MoverRule::UNCERTAIN_PART * all_m
    }

    /// Clearance between the footprint at a pose and a moving obstacle at that time \[m\];
    /// negative on overlap.
    fn room_m(&self, pose: Pose, mover: &Mover, after_s: f64) -> f64 {
        let centre = mover.centre + mover.velocity_mps * after_s;
        let disc_m = mover.radius_m + Self::off_m(mover, after_s);
        self.core.distance_to_m(pose, centre) - self.radius_m - disc_m
    }

    /// Upper bound of the rate at which the clearance decreases \[m/s\].
    fn approach_mps(&self, mover: &Mover) -> f64 {
        let (from, to) = (self.rule.velocity, self.candidate);
        let v = from.v.abs().max(to.v.abs());
        let omega = from.omega.abs().max(to.omega.abs());
        let spread_mps = MoverRule::UNCERTAIN_PART * mover.velocity_uncertainty_mps;
        self.core.moves_m(v, omega) + mover.velocity_mps.norm() + spread_mps
    }

    /// The least clearance from a moving obstacle; `None` if the rule refuses the motion.
    fn least_room_m(&self, mover: &Mover) -> Option<f64> {
        let MoverRule { pose, horizon_s, margin_m, .. } = *self.rule;
        let approach_mps = self.approach_mps(mover);
        let begins_inside = self.room_m(pose, mover, 0.0) < margin_m;
        let (mut after_s, mut least_m) = (0.0, f64::INFINITY);
        while after_s <= horizon_s {
            let room_m = self.room_m(self.pose(after_s), mover, after_s);
            let stayed_m = self.room_m(pose, mover, after_s);
            if room_m < margin_m && room_m < stayed_m - MoverRule::ROUNDING_M {
                return None;
            }
            least_m = least_m.min(room_m);
            if stayed_m < margin_m && !begins_inside {
                break;
            }
            let free_m = (room_m.min(stayed_m) - margin_m).max(MoverRule::LEAST_STEP_M);
            after_s += (free_m / approach_mps).min(horizon_s / MoverRule::LEAST_STEPS);
        }
        Some(least_m.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::robot::Footprint;
    use proptest::prelude::*;

    const AHEAD: Velocity = Velocity::new(0.5, 0.0);

    fn walker(x: f64, y: f64, vx: f64, vy: f64) -> Mover {
        let velocity_mps = Point::new(vx, vy);
        Mover { velocity_mps, ..Mover::standing(0, Point::new(x, y), 0.3) }
    }

    /// True if a small robot at the origin with a velocity may take another one, for 2 s and with
    /// 2 cm of clearance.
    fn admits(velocity: Velocity, candidate: Velocity, mover: Mover) -> bool {
        let (robot, movers) = (Robot::small(), [mover]);
        let start = (Pose::default(), velocity);
        !MoverRule::new(&robot, &movers, start, [2.0, 0.02]).refuses(candidate)
    }

    #[test]
    fn meetings_by_hand() {
        // Radii of 0.18 and 0.3 m, clearance of 0.02 m: within 2 s the robot drives 1 m.
        assert!(!admits(AHEAD, AHEAD, walker(1.49, 0.0, 0.0, 0.0)));
        assert!(admits(AHEAD, AHEAD, walker(1.51, 0.0, 0.0, 0.0)));
        // Oncoming at 0.5 m/s: both drive 1 m.
        assert!(!admits(AHEAD, AHEAD, walker(2.49, 0.0, -0.5, 0.0)));
        assert!(admits(AHEAD, AHEAD, walker(2.51, 0.0, -0.5, 0.0)));
        // Ahead at the same speed it is never reached.
        assert!(admits(AHEAD, AHEAD, walker(0.55, 0.0, 0.5, 0.0)));
        // Crossing: behind it there is enough space, in front of it there is not.
        assert!(admits(AHEAD, AHEAD, walker(0.5, 0.6, 0.0, 0.6)));
        assert!(!admits(AHEAD, AHEAD, walker(0.6, 0.6, 0.0, -0.5)));
        assert!(!admits(AHEAD, AHEAD, walker(0.6, 0.9, 0.0, -0.6)));
        // Uncertainty reduces the clearance as well.
        let uncertain = Mover { velocity_uncertainty_mps: 0.3, ..walker(1.65, 0.0, 0.0, 0.0) };
        assert!(!admits(AHEAD, AHEAD, uncertain));
    }

    #[test]
    fn who_is_run_after_may_drive_on() {
        // It reaches the origin after 0.5 s, whatever the robot does.
        let behind = walker(-1.0, 0.0, 1.0, 0.0);
        assert!(admits(Velocity::ZERO, Velocity::new(0.05, 0.0), behind));
        assert!(admits(AHEAD, AHEAD, behind));
        // But not towards it.
        assert!(!admits(Velocity::ZERO, Velocity::new(-0.05, 0.0), behind));
    }

    #[test]
    fn who_stands_may_stand_and_who_is_inside_may_leave() {
        let rest = Velocity::ZERO;
        let oncoming = walker(0.9, 0.0, -1.0, 0.0);
        let beside = walker(0.3, 0.0, 0.0, 0.0);
        for mover in [oncoming, beside] {
            assert!(admits(rest, rest, mover));
            assert!(admits(rest, Velocity::new(0.0, 0.5), mover), "a disc on the spot");
            assert!(!admits(rest, Velocity::new(0.05, 0.0), mover));
        }
        assert!(admits(rest, Velocity::new(-0.05, 0.0), beside));
        assert!(admits(rest, rest, walker(f64::NAN, 0.0, 0.0, 0.0)));
    }

    proptest! {
        /// Against the definition, at closely spaced times.
        #[test]
        fn what_is_refused_meets_and_what_is_not_does_not(
            at in (-2.5..2.5f64, -2.5..2.5f64), velocity_mps in (-1.0..1.0f64, -1.0..1.0f64), radius_m in 0.05..0.5f64,
            off in (0.0..0.1f64, 0.0..0.3f64), from in (-0.2..0.5f64, -1.0..1.0f64), to in (-0.2..0.5f64, -1.0..1.0f64), is_long: bool,
        ) {
            let long = Footprint::rectangle(0.6, 0.3).unwrap();
            let small = Robot::small();
            let robot = if is_long { Robot { footprint: long, ..small } } else { small };
            let mover = Mover {
                velocity_mps: Point::new(velocity_mps.0, velocity_mps.1), position_uncertainty_m: off.0, velocity_uncertainty_mps: off.1,
                ..Mover::standing(0, Point::new(at.0, at.1), radius_m)
            };
            let (from, to) = (Velocity::new(from.0, from.1), Velocity::new(to.0, to.1));
            let movers = [mover];
            let start = Pose::new(0.1, -0.2, 0.3);
            let rule = MoverRule::new(&robot, &movers, (start, from), [2.0, 0.02]);
            let (core, radius_m) = robot.footprint.core();
            let room_m = |pose: Pose, t_s: f64| {
                let disc_m = mover.radius_m + (off.0 + off.1 * t_s) / 3.0;
                core.distance_to_m(pose, mover.centre + mover.velocity_mps * t_s) - disc_m - radius_m
            };
            let begins_inside = room_m(start, 0.0) < 0.02;
            let meets = |by_m: f64| (0..=2000).map(|step| 1e-3 * f64::from(step)).find_map(|t_s| {
                let pose = if t_s < 0.1 { start.after_ramp(from, from.lerp(to, 10.0 * t_s), t_s) }
                    else { start.after_ramp(from, to, 0.1).after_arc(to, t_s - 0.1) };
                let (moved_m, stayed_m) = (room_m(pose, t_s), room_m(start, t_s));
                let is_met = moved_m < 0.02 - by_m && moved_m < stayed_m - by_m;
                let is_over = !begins_inside && stayed_m < 0.02 + by_m;
                (is_met || is_over).then_some(is_met)
            }) == Some(true);
            // Steps of 1 cm may miss as much.
            if meets(0.0101) {
                prop_assert!(rule.refuses(to));
            }
            if rule.refuses(to) {
                prop_assert!(meets(-0.0101));
            }
        }
    }
}
