//! The result of a smoother.

use super::required_clearance::RequiredClearance;
use crate::geometry::{Path, Point, Polyline};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// A drivable path, and the changes from the line that it was made from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Smoothed {
    /// The path. It has the same start and goal as the line.
    pub path: Path,
    /// Number of points of the line, without repeated and collinear ones, that the path does not
    /// pass through.
    pub removed_points: usize,
    /// Number of corners and control points of the path that are not points of the line.
    pub inserted_points: usize,
    /// Corners that could not be rounded.
    pub sharp_corners: Vec<SharpCorner>,
    /// The certified clearance of the path \[m\] if it is less than required; `None` if the
    /// requirement is met. The clearance is required from obstacles and from the map's border, a
    /// smoother's own safe distance from obstacles only. If neither is kept, this is the smaller
    /// distance; it is 0 in an obstacle and outside the map.
    pub kept_clearance_m: Option<f64>,
}

/// A corner that was not rounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SharpCorner {
    /// Position of the corner \[m\].
    pub at: Point,
    /// Reason why it was not rounded.
    pub why: WhySharp,
}

/// Reason why a corner was not rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WhySharp {
    /// Every curve around the corner comes too close to an obstacle.
    Clearance,
    /// The path turns back on itself.
    Reversal,
    /// Only a curve sharper than the turning limit fits, or none at all because the edges are too
    /// short. A smoother without a configurable turning limit bends by at most 5 degrees within a
    /// centimetre.
    TurningRadius,
}

impl Smoothed {
    /// Tolerance for the clearance of curves \[m\].
    pub(super) const CLEARANCE_TOLERANCE_M: f64 = 1e-4;

    /// A path of straight segments over the points of `smooth`.
    pub(super) fn straight(
        line: &Polyline,
        smooth: &Polyline,
        required: &RequiredClearance<'_>,
    ) -> Self {
        let (before, after) = (line.merged(), smooth.merged());
        let done = Self {
            path: Path::from(&after),
            removed_points: count_others(before.points(), after.points()),
            inserted_points: count_others(after.points(), before.points()),
            ..Self::default()
        };
        done.judged(required)
    }

    /// Returns `self` with its shortfall measured.
    pub(super) fn judged(self, required: &RequiredClearance<'_>) -> Self {
        let kept_clearance_m =
            required.kept_clearance_m(self.path.pieces(), Self::CLEARANCE_TOLERANCE_M, 0.0);
        Self { kept_clearance_m, ..self }
    }
}

/// The number of points that are not among `others`.
pub(super) fn count_others(points: &[Point], others: &[Point]) -> usize {
    let others: HashSet<[u64; 2]> = others.iter().map(bits).collect();
    points.iter().filter(|point| !others.contains(&bits(point))).count()
}

/// Bit patterns that are the same for equal points: 0 and -0 are one number.
fn bits(point: &Point) -> [u64; 2] {
    [point.x, point.y].map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Clearance, OccupancyGrid};

    #[test]
    fn points_are_counted_and_the_shortfall_is_reported() {
        let grid = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let line = |points: &[[f64; 2]]| Polyline::new(points.iter().map(|&p| p.into()).collect());
        // (1.5, 0.5) lies on the segment to (2.5, 0.5), so it does not count as a point of its
        // own.
        let before = line(&[[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [3.5, 1.5], [4.5, 1.5]]);
        let after = line(&[[0.5, 0.5], [3.5, 0.75], [4.5, 1.5]]);
        let zeros = [[0.0, -0.0], [-0.0, 0.0], [0.0, 1.0]].map(Point::from);
        assert_eq!(count_others(&zeros, &[Point::default()]), 1, "0 and -0 are the same place");
        let straight = |clearance_m| {
            Smoothed::straight(
                &before,
                &after,
                &RequiredClearance::new(&clearance, clearance_m, 0.0),
            )
        };
        let done = straight(0.29);
        assert_eq!((done.removed_points, done.inserted_points), (2, 1));
        assert_eq!(done.kept_clearance_m, None, "0.2907 m below the obstacle");
        assert_eq!(done.path.length_m(), after.length_m());
        let closer = straight(0.5);
        // The corner (3, 1) is nearest: the line is at 0.5 + 2.5 / 12 there.
        let expected = (1.0 - (0.5 + 2.5 / 12.0)) * 3.0 / 3f64.hypot(0.25);
        assert!((closer.kept_clearance_m.unwrap() - expected).abs() < 1e-9, "{closer:?}");
    }
}
