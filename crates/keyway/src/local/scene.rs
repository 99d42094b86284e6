//! What one decision may look at.

use crate::geometry::{Point, Polyline, Pose, Velocity};
use crate::map::DistanceField;

/// Everything a local planner sees in one control cycle; built by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Distances to the squares of all obstacles, known and sensed.
    pub obstacles: &'a DistanceField,
    /// Where the robot is.
    pub pose: Pose,
    /// How it moves.
    pub velocity: Velocity,
    /// Where it is to go.
    pub guide: Point,
    /// The smoothed route, from its beginning to the goal.
    pub path: &'a Polyline,
}
