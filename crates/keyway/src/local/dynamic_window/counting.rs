//! What counts as contact and as near. All lengths are in cells.

use super::motion::Motion;
use crate::map::NearObstacles;
use std::ops::Range;

/// What counts as contact and as near.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    /// Anything nearer than this to the core is contact.
    pub(super) contact: f64,
    /// With so much room it surely touches nothing. More than the former for a centre that may
    /// touch something: there, a distance of 0 says nothing.
    pub(super) certain: f64,
    /// Distances that are at least this count as this.
    pub(super) farthest: f64,
    /// True if the nearest of all poses counts, or the last one alone.
    pub(super) counts_all: bool,
    /// What is at least so far away leaves no doubt, neither between two poses.
    pub(super) enough: f64,
    /// True if the map's border can matter.
    pub(super) is_near_border: bool,
}

impl Counting {
    /// From the first to the last pose of the speeds between two at which something may be near
    /// enough to count.
    pub(super) fn near_poses(
        &self,
        motion: &Motion,
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
