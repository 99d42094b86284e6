//! What one decision may look at.

use crate::geometry::{Point, Polyline, Pose, Velocity};
use crate::map::{BitGrid, DistanceField};

/// Everything a local planner sees in one control cycle; built by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Distances to the squares of all obstacles, known and sensed.
    pub obstacles: &'a DistanceField,
    /// Those of the obstacle cells that were sensed and that the known map does not have.
    pub sensed: &'a BitGrid,
    /// Where the robot is.
    pub pose: Pose,
    /// How it moves.
    pub velocity: Velocity,
    /// Where it is to go.
    pub guide: Point,
    /// The smoothed route, from its beginning to the goal.
    pub path: &'a Polyline,
}
