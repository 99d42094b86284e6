//! How a robot stops at its stops.

use super::Controller;
use crate::geometry::{Point, Pose, Velocity};
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot};
use crate::navigate::watch::Watch;
use crate::navigate::{Blocked, Step};

impl Controller {
    /// Goes on to the next stop when the robot is at a way-point.
    pub(super) fn pass_way_point(&mut self, position: Point) {
        let is_there =
            position.distance(self.next_stop()) <= self.stack.controller.goal_tolerance_m;
        if is_there && self.passed + 1 < self.stops.len() {
            self.passed += 1;
            self.recovery.end();
            self.watch = Watch::NEW;
            self.replan(position);
        }
    }

    /// True if the robot stands at its goal and faces as it should.
    pub(super) fn has_arrived(&self, pose: Pose, velocity: Velocity) -> bool {
        let config = &self.stack.controller;
        let is_there = pose.point().distance(self.goal.position) <= config.goal_tolerance_m;
        let left_rad = self.goal.turn_left_rad(pose);
        let is_facing = left_rad.is_none_or(|left| left.abs() <= config.goal_yaw_tolerance_rad);
        let is_last = self.passed + 1 == self.stops.len();
        is_there && is_last && is_facing && self.robot.stands(velocity)
    }

    /// At the goal: brakes, turns to its heading, stays.
    pub(super) fn arrive(&mut self, pose: Pose, velocity: Velocity) -> Option<Step> {
        let config = &self.stack.controller;
        let is_there = pose.point().distance(self.goal.position) <= config.goal_tolerance_m;
        if !is_there || self.passed + 1 < self.stops.len() {
            self.final_turn = None;
            return None;
        }
        self.recovery.end();
        if self.has_arrived(pose, velocity) {
            self.final_turn = None;
            return Some(Step::Arrived);
        }
        if self.robot.stands(velocity) && self.final_turn.is_none() {
            let left_rad = self.goal.turn_left_rad(pose);
            let spot = OnTheSpot { robot: &self.robot, obstacles: &self.obstacles };
            let Some(turn_rad) = spot.turn(pose, left_rad.unwrap_or_default()) else {
                return Some(Step::Blocked { command: Velocity::ZERO, why: Blocked::NoRoomToTurn });
            };
            self.final_turn = Some(MotionUnderWay::new(Motion::Turn(turn_rad)));
        }
        if let Some(turn) = &mut self.final_turn {
            match turn.step(pose, velocity, &self.robot, &self.obstacles) {
                MotionStep::Moving(command) => {
                    let command = self.beside_movers(pose, velocity, command);
                    return Some(Step::Drive(command));
                }
                MotionStep::Done | MotionStep::Refused => self.final_turn = None,
            }
        }
        Some(Step::Drive(self.robot.limits.braked(velocity, self.robot.cycle_s)))
    }
}
