//! What one decision may look at.

use crate::geometry::{Point, Pose, Velocity};
use crate::map::Clearance;

/// Everything a local planner sees in one control cycle; built by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Distances to what stands: known obstacles and sensed ones.
    pub obstacles: Clearance<'a>,
    /// Where the robot is.
    pub pose: Pose,
    /// How it moves.
    pub velocity: Velocity,
    /// Where it shall go.
    pub guide: Point,
}
