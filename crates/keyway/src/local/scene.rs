//! The input of one decision.

use super::JerkLimited;
use crate::geometry::{Disc, Point, Polyline, Pose, Velocity};
use crate::map::{BitGrid, DistanceField};
use crate::sense::{Mover, SeenCells};

/// Everything that a local planner uses in one control cycle; built by the caller. It describes
/// the instant at which the command acts: now, or
/// [`Robot::actuation_delay_s`](crate::robot::Robot::actuation_delay_s) later.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Distances to the squares of all stationary obstacles, mapped and sensed.
    pub obstacles: &'a DistanceField,
    /// Sensed obstacle cells that are not in the known map.
    pub sensed: &'a BitGrid,
    /// Cells that the robot has seen or covered ([`SeenGround`](crate::sense::SeenGround)).
    pub seen: SeenCells<'a>,
    /// All known moving obstacles.
    pub movers: &'a [Mover],
    /// Ground on which moving obstacles walk, and around which the route leads since the robot
    /// has waited for them; usually empty.
    pub walked: &'a [Disc],
    /// Pose of the robot.
    pub pose: Pose,
    /// Velocity of the robot.
    pub velocity: Velocity,
    /// Guide point: the target of the local planner.
    pub guide: Point,
    /// The smoothed route, from its start to the goal.
    pub path: &'a Polyline,
    /// Heading at the end of the route \[rad\], counter-clockwise from the x axis; `None` if any
    /// is right.
    pub goal_heading_rad: Option<f64>,
    /// Remaining distance to the point at which the robot is to stop \[m\]; infinite if it need
    /// not stop. A local planner issues no command after which the robot could not stop within
    /// this distance.
    pub remaining_m: f64,
    /// The robot itself, if its commands are averaged. `pose` and `velocity` are then those of
    /// its reference, for which a local planner decides.
    pub jerk_limited: Option<JerkLimited<'a>>,
}
