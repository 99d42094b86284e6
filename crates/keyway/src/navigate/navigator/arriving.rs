//! Arrival at way-points and at the goal.

use super::Deciding;
use crate::geometry::Velocity;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot};
use crate::navigate::task::GivenPath;
use crate::navigate::watch::Watch;
use crate::navigate::{Blocked, Step};

impl Deciding<'_> {
    /// Goes on to the next stop when the robot is at a way-point.
    pub(super) fn pass_way_point(&mut self) {
        let position = self.pose.point();
        let tolerance_m = self.stack.controller.goal_tolerance_m;
        let is_there = position.distance(self.task.next_stop()) <= tolerance_m;
        if is_there && !self.task.is_last_leg() {
            self.task.passed += 1;
            self.task.mode = Mode::Following;
            self.task.watch = Watch::NEW;
            self.replan();
        }
    }

    /// True if the robot stands at its goal and faces as it should.
    pub(super) fn has_arrived(&self) -> bool {
        let (config, goal) = (&self.stack.controller, &self.task.goal);
        let left_rad = goal.turn_left_rad(self.pose);
        let is_facing = left_rad.is_none_or(|left| left.abs() <= config.goal_yaw_tolerance_rad);
        self.is_at_goal() && is_facing && self.robot.stands(self.velocity)
    }

    fn is_at_goal(&self) -> bool {
        let tolerance_m = self.stack.controller.goal_tolerance_m;
        let is_there = self.pose.point().distance(self.task.goal.position) <= tolerance_m;
        // A path may pass its own end before.
        let is_at_end =
            |given: &GivenPath| given.covered_m >= given.path.length_m() - 2.0 * tolerance_m;
        is_there && self.task.is_last_leg() && self.task.given.as_ref().is_none_or(is_at_end)
    }

    /// At the goal: brakes, turns to its heading, stays.
    pub(super) fn arrive(&mut self) -> Option<Step> {
        if !self.is_at_goal() {
            if matches!(self.task.mode, Mode::Arriving(_)) {
                self.task.mode = Mode::Following;
            }
            return None;
        }
        let (pose, velocity) = (self.pose, self.velocity);
        let turn = match std::mem::take(&mut self.task.mode) {
            Mode::Arriving(turn) => turn,
            _ => None,
        };
        self.task.mode = Mode::Arriving(None);
        if self.has_arrived() {
            return Some(Step::Arrived);
        }
        let braked = self.robot.limits.braked(velocity, self.robot.cycle_s);
        let turn = if turn.is_none() && self.robot.stands(velocity) {
            let left_rad = self.task.goal.turn_left_rad(pose).unwrap_or_default();
            let spot = OnTheSpot { robot: self.robot, obstacles: &self.world.obstacles };
            let Some(turn_rad) = spot.turn(pose, left_rad) else {
                return Some(Step::Blocked { command: Velocity::ZERO, why: Blocked::NoRoomToTurn });
            };
            Some(MotionUnderWay::new(Motion::Turn(turn_rad)))
        } else {
            turn
        };
        let Some(mut turn) = turn else { return Some(Step::Drive(braked)) };
        if let MotionStep::Moving(command) = turn.step(&self.moment(), &self.world.obstacles) {
            self.task.mode = Mode::Arriving(Some(turn));
            return Some(Step::Drive(self.beside_movers(command)));
        }
        Some(Step::Drive(braked))
    }
}
