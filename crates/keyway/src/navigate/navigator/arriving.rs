//! Arrival at way-points and at the goal.

use super::Deciding;
use crate::geometry::Pose;
use crate::navigate::Step;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot, kept_room_m};
use crate::navigate::task::GivenPath;
use crate::navigate::watch::Watch;

impl Deciding<'_> {
    /// Advances to the next stop if the robot is at a way-point.
    pub(super) fn pass_way_point(&mut self) {
        let position = self.pose.point();
        let tolerance_m = self.stack.controller.goal_tolerance_m;
        let is_there = position.distance(self.task.next_stop()) <= tolerance_m;
        if is_there && !self.task.is_last_leg() {
            self.task.begin_next_leg();
            self.task.mode = Mode::Following;
            self.task.watch = Watch::NEW;
            self.replan();
        }
    }

    /// True if the robot is stationary at its goal, within the heading tolerance.
    pub(super) fn has_arrived(&self) -> bool {
        self.is_at_goal() && self.faces_as_it_should(self.pose) && self.stands()
    }

    fn faces_as_it_should(&self, pose: Pose) -> bool {
        let tolerance_rad = self.stack.controller.goal_yaw_tolerance_rad;
        self.task.goal.turn_left_rad(pose).is_none_or(|left| left.abs() <= tolerance_rad)
    }

    pub(super) fn is_at_goal(&self) -> bool {
        let tolerance_m = self.stack.controller.goal_tolerance_m;
        let is_there = self.pose.point().distance(self.task.goal.position) <= tolerance_m;
        // A path may pass its own end earlier.
        let is_at_end =
            |given: &GivenPath| given.covered_m >= given.path.length_m() - 2.0 * tolerance_m;
        is_there && self.task.is_last_leg() && self.task.given.as_ref().is_none_or(is_at_end)
    }

    /// At the goal: brakes, turns to the goal heading, stays. `None` if the robot is elsewhere or
    /// has no space to turn; it then drives on, to where it has space or faces the goal heading.
    pub(super) fn arrive(&mut self) -> Option<Step> {
        if !self.is_at_goal() {
            if matches!(self.task.mode, Mode::Arriving(_)) {
                self.task.mode = Mode::Following;
            }
            return None;
        }
        if self.has_arrived() {
            self.task.mode = Mode::Arriving(None);
            return Some(Step::Arrived);
        }
        let (pose, velocity) = (self.pose, self.velocity);
        let mode = std::mem::take(&mut self.task.mode);
        // The rest of a rotation may be too small for the motors.
        let (pose_then, velocity_then) = self.robot_then;
        let rests = self.robot.stands(velocity_then) && self.faces_as_it_should(pose_then);
        let turn = match mode {
            Mode::Arriving(turn @ Some(_)) if !rests => turn,
            mode => {
                let Some(turn_rad) = self.turn_at_goal(pose) else {
                    self.task.mode =
                        if matches!(mode, Mode::Arriving(_)) { Mode::Following } else { mode };
                    return None;
                };
                let begins = self.stands() && turn_rad != 0.0;
                begins.then(|| MotionUnderWay::new(Motion::Turn(turn_rad)))
            }
        };
        self.task.mode = Mode::Arriving(None);
        let braked = self.robot.limits.braked(velocity, self.robot.cycle_s);
        let Some(mut turn) = turn else { return Some(Step::Drive(braked)) };
        if let MotionStep::Moving(command) = turn.step(&self.moment(), &self.world.obstacles) {
            self.task.mode = Mode::Arriving(Some(turn));
            return Some(Step::Drive(self.beside_movers(command)));
        }
        Some(Step::Drive(braked))
    }

    /// The rotation to the goal heading, in the shorter direction that has space; 0 if the
    /// heading is within its tolerance.
    fn turn_at_goal(&self, pose: Pose) -> Option<f64> {
        let tolerance_rad = self.stack.controller.goal_yaw_tolerance_rad;
        let left_rad = self.task.goal.turn_left_rad(pose).unwrap_or_default();
        if left_rad.abs() <= tolerance_rad {
            return Some(0.0);
        }
        let (robot, obstacles) = (self.robot, &self.world.obstacles);
        let room_m = kept_room_m(robot, pose, obstacles);
        OnTheSpot { robot, obstacles, room_m }.turn(pose, left_rad)
    }
}
