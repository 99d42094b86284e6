//! Participants of a simulation, and the decisions of their controllers.

use super::{Disturbances, RunRules};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::Robot;
use keyway::sense::Observation;

/// Action that a controller requests for the next cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Drive at this velocity, within the robot's limits.
    Drive(Velocity),
    /// The controller considers the robot to be at the goal. The robot brakes, and the simulator
    /// tests its arrival ([`RunRules::goal_tolerance_m`](super::RunRules::goal_tolerance_m)).
    Arrived,
    /// Brake: the robot cannot continue for now.
    Stop,
    /// End the whole simulation immediately, without a result: it is no longer needed.
    GiveUp,
}

/// Decision of a controller in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Requested action.
    pub action: Action,
    /// Length of the remaining path \[m\], which measures progress. NaN or infinity: unknown,
    /// which is not progress.
    pub remaining_m: f64,
    /// Angle to that path, to either side \[rad\]: turning towards it is progress, too. 0 to
    /// ignore turns.
    pub turn_left_rad: f64,
    /// Number of the current route; a new one may be longer than the last.
    pub route: u32,
}

/// A robot that takes part in a simulation.
pub struct Participant<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Start pose, at rest.
    pub start: Pose,
    /// Goal in the world frame \[m\].
    pub goal: Point,
    /// Errors of the robot's sensor, motors and localisation; none by default.
    pub disturbances: Disturbances,
    /// Rules that end the robot's run without contact.
    pub rules: RunRules,
    /// Controller, called with the robot's measurements.
    pub controller: &'a mut (dyn FnMut(&Observation<'_>) -> Control + Send),
}
