//! Participants of a simulation, and the answers of their controllers.

use super::{Disturbances, RunRules};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::Robot;
use keyway::sense::Observation;

/// Action that a controller asks for in the next cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Drive at this velocity, as far as the robot's limits allow.
    Drive(Velocity),
    /// The controller considers the robot to be at the goal. The robot brakes; the simulator judges
    /// whether it has arrived ([`RunRules::goal_tolerance_m`](super::RunRules::goal_tolerance_m)).
    Arrived,
    /// Brake: there is no way on for now.
    Stop,
    /// End the whole simulation at once, without a result: it is no longer needed.
    GiveUp,
}

/// A controller's answer to one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Requested action.
    pub action: Action,
    /// Length of the remaining path \[m\], which measures progress. NaN or infinity: unknown, and
    /// no progress.
    pub remaining_m: f64,
    /// Angle to that path, to either side \[rad\]: turning towards it is progress, too. 0 where that
    /// is not to count.
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
    /// Errors of its sensor, motors and localisation; none by default.
    pub disturbances: Disturbances,
    /// Rules that end its run without contact.
    pub rules: RunRules,
    /// Controller, called with what the robot has measured.
    pub controller: &'a mut (dyn FnMut(&Observation<'_>) -> Control + Send),
}
