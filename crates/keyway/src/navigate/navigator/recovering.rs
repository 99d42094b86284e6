//! Recoveries of a robot that makes no progress.

use super::Deciding;
use super::replanning::Replanned;
use crate::geometry::Velocity;
use crate::navigate::RecoveryKind;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{Motion, OnTheSpot, RecoveryUnderWay, kept_room_m};
use crate::navigate::watch::Watch;

impl Deciding<'_> {
    /// Starts the first recovery of the order that has an effect. Motions start while the robot
    /// is stationary.
    pub(super) fn recover(&mut self) {
        self.task.watch = Watch::NEW;
        self.task.mode = Mode::Following;
        self.task.takes_any_detour = true;
        for _ in 0..self.stack.controller.recoveries.len() {
            let order = &self.stack.controller.recoveries;
            let remaining_m = self.task.guidance.remaining_m;
            let Some(kind) = self.task.order.next(order, remaining_m) else { return };
            if kind != RecoveryKind::Replan && !self.stands() {
                self.task.order.put_off();
                self.task.mode = Mode::StoppingFor(kind);
                return;
            }
            if self.begin(kind) {
                self.record.counts.recoveries.add(kind);
                return;
            }
        }
    }

    /// Starts a recovery; returns false if it has no effect here.
    fn begin(&mut self, kind: RecoveryKind) -> bool {
        let config = &self.stack.controller;
        let (robot, pose, obstacles) = (self.robot, self.pose, &self.world.obstacles);
        let room_m = kept_room_m(robot, pose, obstacles);
        let spot = OnTheSpot { robot, obstacles, room_m };
        let motions = match kind {
            RecoveryKind::Replan => return self.replan() != Replanned::Alike,
            RecoveryKind::Turn => spot.turn_towards(pose, self.task.guidance.point),
            RecoveryKind::Manoeuvre => self.tight_place().manoeuvre(pose),
            RecoveryKind::BackUp => {
                let places = self.world.track.back(pose.point(), config.back_up_m);
                spot.back_up(pose, places, 0.5 * config.back_up_m)
            }
            RecoveryKind::Wait => Some(vec![Motion::Wait(config.wait_s)]),
        };
        let Some(motions) = motions else { return false };
        let begun = RecoveryUnderWay::begin(kind, motions, room_m);
        self.task.mode = begun.map_or(Mode::Following, Mode::Recovering);
        true
    }

    /// Continues a recovery, if one is active. After it, the route starts at the present pose.
    pub(super) fn go_on_recovering(&mut self) -> Option<(RecoveryKind, Velocity)> {
        if let Mode::StoppingFor(kind) = self.task.mode {
            if !self.stands() {
                let braked = self.robot.limits.braked(self.velocity, self.robot.cycle_s);
                return Some((kind, braked));
            }
            self.recover();
        }
        if self.record.guard.held_s() >= self.stack.controller.blocked_s {
            // The stop rule is stricter than the check that certifies its motions.
            if self.task.mode.is_recovering() {
                self.task.mode = Mode::Following;
            }
            self.task.watch = Watch::NEW;
        }
        let moment = self.moment();
        let Mode::Recovering(recovery) = &mut self.task.mode else { return None };
        let Some((kind, command)) = recovery.step(&moment, &self.world.obstacles) else {
            self.task.mode = Mode::Following;
            self.task.watch = Watch::NEW;
            self.replan();
            return None;
        };
        // The remaining distance is reported in every cycle.
        self.find_guide_point();
        Some((kind, self.beside_movers(command)))
    }
}
