//! Narrow ground is entered facing along the way.

use super::Deciding;
use crate::geometry::{Pose, Velocity};
use crate::navigate::RecoveryKind;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot, kept_room_m};
use crate::navigate::route::turning_clearance_m;
use crate::robot::Footprint;
use std::f64::consts::FRAC_PI_6;

impl Deciding<'_> {
    /// The robot faces its guide point when that is less far to either side than this \[rad\].
    const FACING_RAD: f64 = FRAC_PI_6;

    /// Begins a turn towards the guide point where a command would lead off the ground on which a
    /// robot that is not round can turn around, and the guide point is aside: beyond, it could do
    /// neither, and a local planner does not see that coming.
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
        // Where the robot would stand if it braked after this command.
        if !can_turn(pose) || can_turn(robot.stop_pose(pose, self.velocity, command)) {
            return;
        }
        let room_m = kept_room_m(robot, pose, obstacles);
        if let Some(turn_rad) = (OnTheSpot { robot, obstacles, room_m }).turn(pose, bearing_rad) {
            self.task.mode = Mode::TurningFirst(MotionUnderWay::new(Motion::Turn(turn_rad)));
        }
    }

    /// Goes on with that turn, if one is under way.
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
