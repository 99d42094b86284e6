//! Bounds on the motion of a core between two predicted poses.

use super::motion::Timing;
use crate::geometry::Velocity;

/// Bounds on the motion between two predicted poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// Upper bound of the motion of any part of the core \[m\].
    pub(super) moves_m: f64,
    /// Upper bound of the distance of any vertex of the core (or the centre, if it is alone) from
    /// the straight line between its two ends \[m\]. Half of the motion deviates at most a
    /// quarter as far.
    pub(super) deviation_m: f64,
}

impl Stretch {
    /// The stretch of this number with a candidate of at most this speed, for a core that reaches
    /// `swing_m` from the centre of rotation.
    ///
    /// In the time T a curve is nowhere farther from its chord than T² / 8 times the largest
    /// second derivative across the chord. That of a vertex is at most
    /// `|dv/dt| + swing |d omega/dt| + (|v| + swing |omega|) |omega|`. The centre alone moves
    /// along its chord except for the angle turned, unless it reverses, so of dv/dt only that part
    /// counts.
    pub(super) fn new(timing: &Timing, number: usize, candidate: Velocity, swing_m: f64) -> Self {
        if !(number == 0 && timing.has_ramp()) {
            let driven_m = candidate.v.abs() * timing.step_s;
            let turned_rad = candidate.omega.abs() * timing.step_s;
            let moves_m = driven_m + swing_m * turned_rad;
            return Self { moves_m, deviation_m: 0.125 * moves_m * turned_rad };
        }
        let (from, duration_s) = (timing.from, timing.ramp_s);
        // Larger than the mean of both, which is only correct if the robot does not reverse.
        let driven_m = from.v.abs().max(candidate.v.abs()) * duration_s;
        let turned_rad = from.omega.abs().max(candidate.omega.abs()) * duration_s;
        let moves_m = driven_m + swing_m * turned_rad;
        let to = timing.after_ramp(candidate);
        let faster_m = (to.v - from.v).abs() * duration_s;
        let is_point_ahead = swing_m == 0.0 && from.v * to.v >= 0.0;
        let along_m = if is_point_ahead { faster_m * turned_rad.min(1.0) } else { faster_m };
        let swung_m = swing_m * (to.omega - from.omega).abs() * duration_s;
        Self { moves_m, deviation_m: 0.125 * (along_m + swung_m + moves_m * turned_rad) }
    }
}
