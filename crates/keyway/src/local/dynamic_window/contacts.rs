//! Speeds of one turn rate with a certain contact. All lengths are in cells.
//!
//! Among many obstacles most candidates have one, and that is computed faster than the clearance
//! of the others: at a pose the positions of all speeds lie on a line, and the part of it on
//! which a convex core meets a box is found by cutting it once for each side of either
//! ([`NearObstacles::meets`]).

use super::counting::Counting;
use super::motion::TurnRatePoses;
use crate::map::{Core, NearObstacles, Placement, Sweep, Turned};
use std::ops::Range;

/// The search for contacts.
#[derive(Debug)]
pub(super) struct Contacts<'w, 'a> {
    pub(super) counting: &'w Counting,
    pub(super) motion: &'w TurnRatePoses,
    pub(super) surroundings: &'w mut NearObstacles<'a>,
    pub(super) core: &'w Core<'w>,
    pub(super) all_mps: &'w [f64],
    /// Memory for the core at a pose.
    pub(super) turned: &'w mut Turned,
}

impl Contacts<'_, '_> {
    /// Stride of the poses that are checked first: a box in the robot's path is met at several
    /// poses.
    const POSES_AT_ONCE: usize = 6;

    /// Determines for each speed if it certainly touches something at some poses. Nothing is
    /// known about the others.
    pub(super) fn find(&mut self, poses: &Range<usize>, touching: &mut Vec<bool>) {
        touching.clear();
        touching.resize(self.all_mps.len(), false);
        if self.counting.contact <= 0.0 {
            return;
        }
        let mut free = 0..touching.len();
        for first in 0..Self::POSES_AT_ONCE {
            for pose in poses.clone().skip(first).step_by(Self::POSES_AT_ONCE) {
                self.find_at(pose, free.clone(), touching);
                free.start += touching[free.clone()].iter().take_while(|is| **is).count();
                free.end -= touching[free.clone()].iter().rev().take_while(|is| **is).count();
                if free.is_empty() {
                    return;
                }
            }
        }
    }

    /// The same for some speeds at one pose.
    fn find_at(&mut self, pose: usize, speeds: Range<usize>, touching: &mut [bool]) {
        let ends_mps = [self.all_mps[speeds.start], self.all_mps[speeds.end - 1]];
        let (origin, half_length) = self.motion.line(pose, ends_mps);
        let enough = self.counting.contact + half_length;
        if !self.counting.is_near_border && self.surroundings.is_beyond(origin, enough) {
            return;
        }
        self.turned.turn(self.core, self.motion.ahead(pose));
        let half = self.motion.half(pose, ends_mps);
        let middle = Placement { origin, turned: self.turned };
        let sweep = Sweep { middle, half, half_length };
        let (middle_mps, half_mps) =
            (0.5 * (ends_mps[0] + ends_mps[1]), 0.5 * (ends_mps[1] - ends_mps[0]));
        let around = self.surroundings.around(origin);
        for near in around.boxes() {
            if !self.surroundings.may_be_nearer(near, enough) {
                break;
            }
            let contact = self.counting.contact;
            if let Some(ends) = self.surroundings.meets(near, &sweep, contact) {
                let [low_mps, high_mps] = ends.map(|end| middle_mps + half_mps * end);
                for index in speeds.clone() {
                    let v_mps = self.all_mps[index];
                    touching[index] |= v_mps >= low_mps && v_mps <= high_mps;
                }
            }
        }
    }
}
