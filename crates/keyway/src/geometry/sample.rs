//! Samples of a path, and their form as a table.

use super::Point;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// A path at one arc length. The fields' names are the columns of [`csv_of_samples`] and the keys of
/// the JSON form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

    /// The same place, at another arc length.
    pub(super) const fn moved_to(self, s_m: f64) -> Self {
        Self { s_m, ..self }
    }

    /// Position \[m, world frame\].
    pub const fn position(&self) -> Point {
        Point::new(self.x_m, self.y_m)
    }
}

/// The samples as comma-separated values: a header with units, then one line per sample. Every number
/// reads back as the same number.
///
/// ```
/// use keyway::geometry::{Path, Point, Polyline, csv_of_samples};
/// let line = Polyline::new(vec![Point::new(0.0, 1.0), Point::new(0.25, 1.0)]);
/// assert_eq!(
///     csv_of_samples(&Path::from(&line).samples(0.25)),
///     "s_m,x_m,y_m,heading_rad,curvature_per_m\n0,0,1,0,0\n0.25,0.25,1,0,0\n",
/// );
/// ```
pub fn csv_of_samples(samples: &[PathSample]) -> String {
    let mut text = String::from("s_m,x_m,y_m,heading_rad,curvature_per_m\n");
    for PathSample { s_m, x_m, y_m, heading_rad, curvature_per_m } in samples {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{s_m},{x_m},{y_m},{heading_rad},{curvature_per_m}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        fn sample()(n in prop::array::uniform5(prop::num::f64::NORMAL | prop::num::f64::ZERO)) -> PathSample {
            PathSample { s_m: n[0], x_m: n[1], y_m: n[2], heading_rad: n[3], curvature_per_m: n[4] }
        }
    }

    proptest! {
        #[test]
        fn tables_read_back_the_same(samples in prop::collection::vec(sample(), 0..5)) {
            let csv = csv_of_samples(&samples);
            let read: Vec<PathSample> = csv.lines().skip(1).map(|line| {
                let n: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
                PathSample { s_m: n[0], x_m: n[1], y_m: n[2], heading_rad: n[3], curvature_per_m: n[4] }
            }).collect();
            prop_assert_eq!(&read, &samples);
            // The JSON keys are the columns, in the same order.
            let json = serde_json::to_string(&samples).unwrap();
            let keys: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
            if let Some(first) = json.split('}').next().filter(|_| !samples.is_empty()) {
                let in_json: Vec<&str> = first.split('"').skip(1).step_by(2).collect();
                prop_assert_eq!(in_json, keys);
            }
        }
    }

    #[test]
    fn json_reads_back_the_same() {
        let sample = PathSample::new(0.1 + 0.2, Point::new(-1.0 / 3.0, 2e-9), 3.1, -0.7);
        let json = serde_json::to_string(&sample).unwrap();
        assert_eq!(serde_json::from_str::<PathSample>(&json).unwrap(), sample);
    }
}
