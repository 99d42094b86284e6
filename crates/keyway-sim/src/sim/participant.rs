//! Who takes part in a simulation, and what a controller answers.

use super::{Disturbances, RunRules};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::Robot;
use keyway::sense::Scan;

/// What a controller wants in the next cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Drive at this velocity, as far as the robot's limits allow.
    Drive(Velocity),
    /// It considers itself to be at the goal. The robot brakes; whether it has arrived is the
    /// simulator's judgement ([`RunRules::goal_tolerance_m`](super::RunRules::goal_tolerance_m)).
    Arrived,
    /// Brake: there is no way on for now.
    Stop,
    /// End the whole simulation at once, without a result: nobody waits for it any more.
    GiveUp,
}

/// A controller's answer to one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// What to do.
    pub action: Action,
    /// Length of the remaining path \[m\], by which progress is judged. NaN or infinity: unknown,
    /// and no progress.
    pub remaining_m: f64,
    /// Number of the route that is followed: a new one may be longer than the last.
    pub route: u32,
}

/// A robot that takes part in a simulation.
pub struct Participant<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Where it stands at the beginning, at rest.
    pub start: Pose,
    /// Where it is to go, in the world frame \[m\].
    pub goal: Point,
    /// What its sensor, its motors and its localisation get wrong; nothing by default.
    pub disturbances: Disturbances,
    /// When its run ends without contact.
    pub rules: RunRules,
    /// What decides for it, from its pose, its velocity and a scan.
    pub controller: &'a mut (dyn FnMut(Pose, Velocity, &Scan) -> Control + Send),
}
