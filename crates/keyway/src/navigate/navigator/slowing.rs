//! Speed limits in effect.

use super::Navigator;
use crate::geometry::{Point, Velocity};
use crate::local::LocalPlanner;
use crate::navigate::Step;
use crate::robot::Robot;
use std::sync::Arc;

/// The parts of a navigator that depend on the maximum speed, for a lower speed.
pub(super) struct Slow {
    /// Speed limit \[m/s\].
    speed_mps: f64,
    robot: Arc<Robot>,
    pub(super) local: Arc<dyn LocalPlanner + Send + Sync>,
}

impl Navigator {
    /// Builds the parts for the speed limit at a position, or for a higher speed from which the
    /// robot brakes down to it.
    pub(super) fn slow_down(&mut self, place: Point, velocity: Velocity) {
        let Robot { limits, cycle_s, .. } = &*self.parts.robot;
        let limit_mps =
            self.world.masks.limit_mps(place).min(self.speed_limit_mps.unwrap_or(f64::INFINITY));
        let braked_mps = velocity.v.abs() - limits.deceleration_mps2 * cycle_s;
        let speed_mps = limit_mps.max(braked_mps);
        if speed_mps >= limits.v_max_mps.max(-limits.v_min_mps) {
            self.slow = None;
            return;
        }
        if self.slow.as_ref().is_none_or(|slow| slow.speed_mps != speed_mps) {
            let (robot, local) = self.parts.slowed(speed_mps);
            self.slow = Some(Slow { speed_mps, robot, local });
        }
    }
}

/// The same step within a speed limit, on the same arc.
pub(super) fn slowed(slow: Option<&Slow>, step: Step) -> Step {
    let Some(Slow { robot, .. }) = slow else { return step };
    let Velocity { v, omega, .. } = step.command();
    let slow = robot.limits.clamped(step.command()).v;
    if slow == v {
        return step;
    }
    step.commanding(Velocity::new(slow, omega * slow / v))
}
