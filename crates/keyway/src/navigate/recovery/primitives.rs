//! The motions of which the search for a manoeuvre is made, and their times: straight drives, and
//! rotations on the spot or, for a robot that cannot do those, arcs.

use super::manoeuvre::{STEP_RAD, TightPlace};
use super::motion::{Motion, SPEED_SHARE};
use arrayvec::ArrayVec;

/// Length of one straight drive, in sides of the squares in which positions count as equal: it
/// ends in another square at any heading.
const STEP_SQUARES: f64 = 1.5;

/// Radius of an arc, in smallest turning radii: the rest is for steering.
const ARC_RADIUS: f64 = 1.05;

impl TightPlace<'_> {
    /// The motions from a pose of the search, each with the number of headings that it turns by.
    pub(super) fn motions(&self) -> impl Iterator<Item = (Motion, i32)> + use<> {
        let limits = &self.robot.limits;
        let step_m = STEP_SQUARES * self.square_m();
        let ways: ArrayVec<f64, 2> =
            [step_m].into_iter().chain((limits.v_min_mps < 0.0).then_some(-step_m)).collect();
        let arc_m = (STEP_RAD * ARC_RADIUS * limits.min_turning_radius_m).max(step_m);
        let sides = [1, -1].map(|side| (STEP_RAD * f64::from(side), side));
        let turns: ArrayVec<(Motion, i32), 4> = if limits.turns_in_place() {
            sides.into_iter().map(|(turn_rad, side)| (Motion::Turn(turn_rad), side)).collect()
        } else {
            let arcs = ways.iter().flat_map(|way_m| {
                let length_m = arc_m.copysign(*way_m);
                sides.map(|(turn_rad, side)| (Motion::Arc(length_m, turn_rad), side))
            });
            arcs.collect()
        };
        let mut drives = ways.into_iter().map(|way_m| (Motion::Drive(way_m), 0));
        drives.next().into_iter().chain(turns).chain(drives)
    }

    pub(super) fn time_s(&self, motion: Motion) -> f64 {
        let limits = &self.robot.limits;
        match motion {
            Motion::Turn(turn_rad) => turn_rad.abs() / (SPEED_SHARE * limits.omega_max_radps),
            Motion::Drive(length_m) | Motion::Arc(length_m, _) => {
                length_m.abs() / (SPEED_SHARE * limits.v_max_mps)
            }
            Motion::Wait(time_s) => time_s,
        }
    }
}
