//! Thresholds of contact and nearness. All lengths are in cells.

use super::motion::TurnRatePoses;
use crate::map::NearObstacles;
use std::ops::Range;

/// Thresholds of contact and nearness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    /// Anything nearer than this to the core is contact.
    pub(super) contact: f64,
    /// Clearance at which there is certainly no contact. More than the former for a centre that
    /// may touch something: there, a distance of 0 is ambiguous.
    pub(super) certain: f64,
    /// Larger distances count as this.
    pub(super) farthest: f64,
    /// True if the nearest of all poses counts; otherwise the last one alone.
    pub(super) counts_all: bool,
    /// Distance beyond which no doubt remains, at poses and between them.
    pub(super) enough: f64,
    /// True if the map's border can matter.
    pub(super) is_near_border: bool,
}

impl Counting {
    /// Range of poses, for the speeds between two, at which something may be near enough to
    /// count.
    pub(super) fn near_poses(
        &self,
        motion: &TurnRatePoses,
        surroundings: &NearObstacles<'_>,
        ends_mps: [f64; 2],
    ) -> Range<usize> {
        let is_near = |&pose: &usize| {
            let (middle, half_length) = motion.line(pose, ends_mps);
            self.is_near_border || !surroundings.is_beyond(middle, self.enough + half_length)
        };
        let mut poses = 0..motion.poses();
        let Some(first) = poses.find(is_near) else {
            return 0..0;
        };
        first..poses.rfind(is_near).unwrap_or(first) + 1
    }
}
