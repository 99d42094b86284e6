//! Narrow ground is entered facing along the way.

use super::Controller;
use crate::geometry::{Pose, Velocity};
use crate::navigate::RecoveryKind;
use crate::navigate::recovery::{Motion, MotionStep, MotionUnderWay, OnTheSpot};
use crate::navigate::route::turning_clearance_m;
use crate::robot::Footprint;
use std::f64::consts::FRAC_PI_6;

impl Controller {
    /// The robot faces its guide point when that is less far to either side than this \[rad\].
    const FACING_RAD: f64 = FRAC_PI_6;

    /// Begins a turn towards the guide point where a command would lead off the ground on which a
    /// robot that is not round can turn around, and the guide point is aside: beyond, it could do
    /// neither, and a local planner does not see that coming.
    pub(super) fn turn_before(&mut self, pose: Pose, velocity: Velocity, command: Velocity) {
        let (robot, guide) = (&self.robot, self.guidance.point);
        let is_round = matches!(robot.footprint, Footprint::Circle(_));
        let may_turn = self.stack.controller.recoveries.contains(&RecoveryKind::Turn);
        let bearing_rad = pose.bearing_to(guide);
        let is_near = pose.point().distance(guide) <= robot.footprint.inscribed_radius_m();
        if is_round || !may_turn || is_near || bearing_rad.abs() <= Self::FACING_RAD {
            return;
        }
        let turning_m = turning_clearance_m(&self.stack, robot);
        let clearance = self.obstacles.clearance();
        let can_turn = |at: Pose| clearance.is_clear_point(at.point(), turning_m);
        // Where the robot would stand if it braked after this command.
        if !can_turn(pose) || can_turn(robot.stop_pose(pose, velocity, command)) {
            return;
        }
        let spot = OnTheSpot { robot, obstacles: &self.obstacles };
        let turn_rad = spot.turn(pose, bearing_rad);
        self.first_turn = turn_rad.map(|turn_rad| MotionUnderWay::new(Motion::Turn(turn_rad)));
    }

    /// Goes on with that turn, if one is under way.
    pub(super) fn turn_first(&mut self, pose: Pose, velocity: Velocity) -> Option<Velocity> {
        let turn = self.first_turn.as_mut()?;
        if let MotionStep::Moving(command) = turn.step(pose, velocity, &self.robot, &self.obstacles)
        {
            self.find_guide_point(pose.point());
            return Some(command);
        }
        self.first_turn = None;
        None
    }
}
