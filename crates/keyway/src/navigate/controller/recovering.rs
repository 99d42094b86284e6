//! What a robot does that gets no farther.

use super::Controller;
use super::replanning::Replanned;
use crate::geometry::{Pose, Velocity};
use crate::navigate::RecoveryKind;
use crate::navigate::recovery::{Motion, OnTheSpot, TightPlace};
use crate::navigate::watch::{RestOfRoute, Watch};

impl Controller {
    /// Begins the first kind of recovery in the order that can do something. Motions begin where
    /// the robot stands.
    pub(super) fn recover(&mut self, pose: Pose, velocity: Velocity) {
        self.watch = Watch::NEW;
        self.recovery.end();
        for _ in 0..self.stack.controller.recoveries.len() {
            let order = &self.stack.controller.recoveries;
            let Some(kind) = self.recovery.next(order, self.guidance.remaining_m) else { return };
            if kind != RecoveryKind::Replan && !self.robot.stands(velocity) {
                self.recovery.stop_for(kind);
                return;
            }
            if self.begin(kind, pose) {
                self.recovery.counts.add(kind);
                return;
            }
        }
    }

    /// Begins a recovery; false when it can do nothing here.
    fn begin(&mut self, kind: RecoveryKind, pose: Pose) -> bool {
        let config = &self.stack.controller;
        let (robot, obstacles) = (&self.robot, &self.obstacles);
        let spot = OnTheSpot { robot, obstacles };
        let motions = match kind {
            RecoveryKind::Replan => return self.replan(pose.point()) != Replanned::Alike,
            RecoveryKind::Turn => spot.turn_towards(pose, self.guidance.point),
            RecoveryKind::Manoeuvre => {
                let goal_tolerance_m = config.goal_tolerance_m;
                let RestOfRoute { path, covered_m } = self.rest();
                TightPlace { robot, obstacles, path, covered_m, goal_tolerance_m }.manoeuvre(pose)
            }
            RecoveryKind::BackUp => {
                let places = self.track.back(pose.point(), config.back_up_m);
                spot.back_up(pose, places, 0.5 * config.back_up_m)
            }
            RecoveryKind::Wait => Some(vec![Motion::Wait(config.wait_s)]),
        };
        let Some(motions) = motions else { return false };
        self.recovery.begin(kind, motions);
        true
    }

    /// Goes on with a recovery, if one is under way. After it the route begins where the robot then
    /// is.
    pub(super) fn go_on_recovering(
        &mut self,
        pose: Pose,
        velocity: Velocity,
    ) -> Option<(RecoveryKind, Velocity)> {
        if let Some(kind) = self.recovery.stopping_for() {
            if !self.robot.stands(velocity) {
                return Some((kind, self.robot.limits.braked(velocity, self.robot.cycle_s)));
            }
            self.recover(pose, velocity);
        }
        if self.guard.held_s() >= self.stack.controller.blocked_s {
            // The stop rule is stricter than what its motions are certified by.
            self.recovery.end();
            self.watch = Watch::NEW;
        }
        if !self.recovery.is_under_way() {
            return None;
        }
        let moving = self.recovery.step(pose, velocity, &self.robot, &self.obstacles);
        let Some((kind, command)) = moving else {
            self.watch = Watch::NEW;
            self.replan(pose.point());
            return None;
        };
        // What is left of the way is reported in every cycle.
        self.find_guide_point(pose.point());
        Some((kind, self.beside_movers(pose, velocity, command)))
    }
}
