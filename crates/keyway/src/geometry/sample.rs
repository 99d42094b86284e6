//! Samples of a path.

use super::Point;
use serde::{Deserialize, Serialize};

/// A sample of a path at one arc length. The fields' names are the keys of the JSON form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PathSample {
    /// Arc length from the beginning of the path \[m\].
    pub s_m: f64,
    /// Position: right \[m, world frame\].
    pub x_m: f64,
    /// Position: up \[m, world frame\].
    pub y_m: f64,
    /// Direction of travel, in (-pi, pi] \[rad\].
    pub heading_rad: f64,
    /// Curvature, positive to the left \[1/m\].
    pub curvature_per_m: f64,
}

impl PathSample {
    pub(super) const fn new(s_m: f64, at: Point, heading_rad: f64, curvature_per_m: f64) -> Self {
        Self { s_m, x_m: at.x, y_m: at.y, heading_rad, curvature_per_m }
    }

    /// The same position at another arc length.
    pub(super) const fn moved_to(self, s_m: f64) -> Self {
        Self { s_m, ..self }
    }

    /// Position \[m, world frame\].
    pub const fn position(&self) -> Point {
        Point::new(self.x_m, self.y_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_reads_back_the_same() {
        let sample = PathSample::new(0.1 + 0.2, Point::new(-1.0 / 3.0, 2e-9), 3.1, -0.7);
        let json = serde_json::to_string(&sample).unwrap();
        assert_eq!(serde_json::from_str::<PathSample>(&json).unwrap(), sample);
    }
}
