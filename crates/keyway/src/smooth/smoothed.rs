//! What a smoother returns.

use super::required_clearance::RequiredClearance;
use crate::geometry::{Path, Point, Polyline};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// A path to drive, and what was done to the line that it comes from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Smoothed {
    /// The path: begins and ends where the line does.
    pub path: Path,
    /// Points of the line, repeated and collinear ones left out, over which the path does not lead.
    pub removed_points: usize,
    /// Corners and control points of the path that are not points of the line.
    pub inserted_points: usize,
    /// Corners that were to be rounded and were not.
    pub sharp_corners: Vec<SharpCorner>,
    /// The distance that the path certainly keeps \[m\], where that is less than was asked for;
    /// `None` where it is kept. The clearance is to be kept from obstacles and from the map's
    /// border, a smoother's own safe distance from obstacles only; where neither is kept it is the
    /// smaller distance, 0 in an obstacle and outside the map.
    pub shortfall_m: Option<f64>,
}

/// A corner that stayed as it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SharpCorner {
    /// Where \[m\].
    pub at: Point,
    /// Why.
    pub why: WhySharp,
}

/// Why a corner was not rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WhySharp {
    /// Every rounder way comes too near to an obstacle.
    Clearance,
    /// The path turns back on itself.
    Reversal,
    /// There is only room for a curve that is sharper than the turning limit, or for none at all
    /// because the edges are too short. A smoother without a turning limit of its own bends at most
    /// 5 degrees within a centimetre.
    TurningRadius,
}

impl Smoothed {
    /// How finely the distances of a curve are measured \[m\].
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

    /// The same with its shortfall measured.
    pub(super) fn judged(self, required: &RequiredClearance<'_>) -> Self {
        let shortfall_m =
            required.shortfall_m(self.path.pieces(), Self::CLEARANCE_TOLERANCE_M, 0.0);
        Self { shortfall_m, ..self }
    }
}

/// How many of some points are not among some others.
pub(super) fn count_others(points: &[Point], others: &[Point]) -> usize {
    let others: HashSet<[u64; 2]> = others.iter().map(bits).collect();
    points.iter().filter(|point| !others.contains(&bits(point))).count()
}

/// The same for equal points: 0 and -0 are one number.
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
        // (1.5, 0.5) lies on the way to (2.5, 0.5) and is not a point of its own.
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
        assert_eq!(done.shortfall_m, None, "0.2907 m below the obstacle");
        assert_eq!(done.path.length_m(), after.length_m());
        let closer = straight(0.5);
        // The corner (3, 1) is nearest: the line is at 0.5 + 2.5 / 12 there.
        let expected = (1.0 - (0.5 + 2.5 / 12.0)) * 3.0 / 3f64.hypot(0.25);
        assert!((closer.shortfall_m.unwrap() - expected).abs() < 1e-9, "{closer:?}");
    }
}
