//! Alignment with the route before a narrow passage.

use super::Deciding;
use crate::geometry::{Pose, Velocity};
use crate::navigate::RecoveryKind;
use crate::navigate::layers::turning_clearance_m;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot, kept_room_m};
use crate::robot::Footprint;
use std::f64::consts::FRAC_PI_6;

impl Deciding<'_> {
    /// Bearing of the guide point up to which the robot faces it \[rad\].
    const FACING_RAD: f64 = FRAC_PI_6;

    /// Starts a rotation towards the guide point if a command would lead a non-circular robot out
    /// of the space in which it can turn around, while the guide point is to its side. Beyond, it
    /// could neither turn nor drive on, which a local planner does not foresee.
    pub(super) fn turn_before(&mut self, command: Velocity) {
        let (robot, pose, guide) = (self.robot, self.pose, self.task.guidance.point);
        let is_round = matches!(robot.footprint, Footprint::Circle(_));
        let may_turn = matches!(self.task.mode, Mode::Following)
            && !self.local.turns_in_time()
            && self.stack.controller.recoveries.contains(&RecoveryKind::Turn);
        let bearing_rad = pose.bearing_to(guide);
        let is_near = pose.point().distance(guide) <= robot.footprint.inscribed_radius_m();
        if is_round || !may_turn || is_near || bearing_rad.abs() <= Self::FACING_RAD {
            return;
        }
        let turning_m = turning_clearance_m(self.stack, robot);
        let obstacles = &self.world.obstacles;
        let clearance = obstacles.clearance();
        let can_turn = |at: Pose| clearance.is_clear_point(at.point(), turning_m);
        // Pose at which the robot would stop if it braked after this command.
        if !can_turn(pose) || can_turn(robot.stop_pose(pose, self.velocity, command)) {
            return;
        }
        let room_m = kept_room_m(robot, pose, obstacles);
        if let Some(turn_rad) = (OnTheSpot { robot, obstacles, room_m }).turn(pose, bearing_rad) {
            self.task.mode = Mode::TurningFirst(MotionUnderWay::new(Motion::Turn(turn_rad)));
        }
    }

    /// Continues that rotation, if one is active.
    pub(super) fn turn_first(&mut self) -> Option<Velocity> {
        let moment = self.moment();
        let Mode::TurningFirst(turn) = &mut self.task.mode else { return None };
        if let MotionStep::Moving(command) = turn.step(&moment, &self.world.obstacles) {
            self.find_guide_point();
            return Some(command);
        }
        self.task.mode = Mode::Following;
        None
    }
}
