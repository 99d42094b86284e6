//! Round stationary obstacles.

use keyway::geometry::Point;
use serde::{Deserialize, Serialize};

/// A round stationary obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Centre in the world frame \[m\].
    pub centre: Point,
    /// Radius \[m\].
    pub radius_m: f64,
}

impl Circle {
    /// A stationary circle.
    pub const fn standing(centre: Point, radius_m: f64) -> Self {
        Self { centre, radius_m }
    }

    /// Distance from a point to the circle \[m\]; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        (self.centre.distance(point) - self.radius_m).max(0.0)
    }

    pub(super) fn is_usable(&self) -> bool {
        self.radius_m >= 0.0 && self.radius_m.is_finite() && self.centre.is_finite()
    }
}
