//! Discs.

use super::Point;
use serde::{Deserialize, Serialize};

/// A disc, such as a round obstacle, or the area that a moving obstacle may cover.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre of the disc \[m\].
    pub centre: Point,
    /// Radius of the disc \[m\].
    pub radius_m: f64,
}

impl Disc {
    /// The disc with this centre and radius \[m\].
    pub const fn new(centre: Point, radius_m: f64) -> Self {
        Self { centre, radius_m }
    }

    /// Distance from a point to the disc \[m\]; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        (self.centre.distance(point) - self.radius_m).max(0.0)
    }

    /// True if all numbers are finite and the radius is not negative.
    pub fn is_valid(&self) -> bool {
        self.radius_m >= 0.0 && self.radius_m.is_finite() && self.centre.is_finite()
    }

    /// The smallest disc that contains the intersection of two discs; the smaller of the two if
    /// they do not intersect.
    pub(crate) fn shared_with(&self, other: &Self) -> Self {
        let (small, large) =
            if self.radius_m <= other.radius_m { (self, other) } else { (other, self) };
        let apart = large.centre - small.centre;
        let apart_m = apart.norm();
        // The circles intersect in a chord at this distance from the smaller one's centre.
        let to_chord_m = 0.5
            * (apart_m
                - (large.radius_m - small.radius_m) * (large.radius_m + small.radius_m) / apart_m);
        let half_chord_sq = (small.radius_m - to_chord_m) * (small.radius_m + to_chord_m);
        // Also for concentric discs, for which the distance to the chord is not a number.
        if !(to_chord_m > 0.0 && half_chord_sq > 0.0) {
            return *small;
        }
        // Each part beyond the chord is less than half of its disc, so the chord is its widest
        // extent.
        let middle = small.centre + apart * (to_chord_m / apart_m);
        Self { centre: middle, radius_m: half_chord_sq.sqrt() }
    }
}
