//! The clearance that a smoother's connections must keep from obstacles and from the map's border.

use crate::geometry::{Path, PathPiece, Point, Segment, Square};
use crate::map::{Clearance, Obstruction};

/// Distances that fall short of a safe distance by less than this \[m\] still keep it: beside a
/// wall of 1 m cells a path lies at exactly 0.5 m.
const SAFE_TOLERANCE_M: f64 = 1e-9;

/// The obstacles, the required clearance, and the smoother's own safe distance.
///
/// The clearance is also kept from the map's border; the safe distance only from obstacles.
#[derive(Clone, Copy, Debug)]
pub(super) struct RequiredClearance<'a> {
    clearance: &'a Clearance<'a>,
    clearance_m: f64,
    safe_m: f64,
}

impl<'a> RequiredClearance<'a> {
    /// A safe distance below the clearance counts as the clearance.
    pub(super) fn new(clearance: &'a Clearance<'a>, clearance_m: f64, safe_m: f64) -> Self {
        Self { clearance, clearance_m, safe_m: safe_m.max(clearance_m) }
    }

    /// The larger of safe distance and clearance \[m\].
    pub(super) const fn safe_m(&self) -> f64 {
        self.safe_m
    }

    /// A connection that comes closer to an obstacle than this is not safe \[m\].
    pub(super) const fn unsafe_within_m(&self) -> f64 {
        (self.safe_m - SAFE_TOLERANCE_M).max(self.clearance_m)
    }

    /// True if a connection is free: it keeps the clearance.
    pub(super) fn is_free(&self, connection: Segment) -> bool {
        self.clearance.is_clear(connection, self.clearance_m)
    }

    /// True if all connections within a triangle are certainly free. False does not mean that one
    /// of them is not.
    pub(super) fn is_free_triangle(&self, corners: [Point; 3]) -> bool {
        self.clearance.is_clear_triangle(corners, self.clearance_m)
    }

    /// True if a connection keeps the safe distance from obstacles, whatever the clearance.
    pub(super) fn keeps_safe_distance(&self, connection: Segment) -> bool {
        self.too_near(connection).is_none()
    }

    /// True if a connection is free and keeps the safe distance.
    pub(super) fn is_safe(&self, connection: Segment) -> bool {
        self.obstruction(connection).is_none()
    }

    /// The obstacle or border that keeps a connection from being safe.
    pub(super) fn obstruction(&self, connection: Segment) -> Option<Obstruction> {
        if self.unsafe_within_m() <= self.clearance_m {
            return self.clearance.obstruction(connection, self.clearance_m);
        }
        // A connection that keeps the larger distance from obstacles also keeps the smaller one.
        if !self.clearance.is_on_map(connection, self.clearance_m) {
            return Some(Obstruction::Border);
        }
        self.too_near(connection).map(Obstruction::Obstacle)
    }

    /// The distance that the pieces of a path certainly keep if a required distance is not kept:
    /// the smaller of the two. The clearance of curves is known to `tolerance_m`, and a shortfall
    /// of less than `slack_m` is ignored.
    pub(super) fn kept_clearance_m<'p>(
        &self,
        pieces: impl IntoIterator<Item = &'p PathPiece>,
        tolerance_m: f64,
        slack_m: f64,
    ) -> Option<f64> {
        let not_clear = self.not_clear(pieces.into_iter());
        let from_obstacles = self.obstacle_shortfall_of(&not_clear, tolerance_m, slack_m);
        let from_border = self.border_shortfall_of(&not_clear, tolerance_m, slack_m);
        from_obstacles.into_iter().chain(from_border).reduce(f64::min)
    }

    /// The same for the distance from obstacles alone.
    pub(super) fn obstacle_shortfall_m(&self, path: &Path, tolerance_m: f64) -> Option<f64> {
        self.obstacle_shortfall_of(&self.not_clear(path.pieces().iter()), tolerance_m, 0.0)
    }

    /// The pieces that may violate the required distance.
    fn not_clear<'p>(&self, pieces: impl Iterator<Item = &'p PathPiece>) -> Vec<&'p PathPiece> {
        // An obstacle that is too close to the end of one piece is also too close to the next
        // piece.
        let (mut was_clear, mut near) = (true, None);
        let mut is_clear = |piece: &PathPiece| {
            if near.is_some_and(|square| self.is_too_near(square, piece.start(), piece.end())) {
                return false;
            }
            let is_clear = was_clear && self.clearance.is_clear_curve(piece, self.safe_m);
            if is_clear {
                return true;
            }
            let end =
                self.clearance.obstruction(Segment::new(piece.end(), piece.end()), self.safe_m);
            near = match end {
                Some(Obstruction::Obstacle(square)) => Some(square),
                Some(Obstruction::Border) | None => None,
            };
            was_clear =
                !was_clear && end.is_none() && self.clearance.is_clear_curve(piece, self.safe_m);
            was_clear
        };
        pieces.filter(|piece| !is_clear(piece)).collect()
    }

    /// True if a square is certainly closer to one of two points than the required distance.
    fn is_too_near(&self, square: Square, one: Point, other: Point) -> bool {
        let cells = |at| self.clearance.frame().grid_from_world(at);
        let too_near_sq = self.clearance.margin(self.safe_m).powi(2);
        [one, other].iter().any(|&at| square.distance_sq_to_point(cells(at)) < too_near_sq)
    }

    fn obstacle_shortfall_of(
        &self,
        pieces: &[&PathPiece],
        tolerance_m: f64,
        slack_m: f64,
    ) -> Option<f64> {
        let (mut at_least_m, mut reach_m) = (self.safe_m, self.safe_m);
        for piece in pieces {
            // Most pieces are not nearer than the nearest so far.
            if self.clearance.certainly_keeps(piece, reach_m) {
                continue;
            }
            let bounds = self.clearance.of_curve(piece, reach_m, tolerance_m);
            at_least_m = at_least_m.min(bounds.at_least_m);
            reach_m = bounds.at_most_m;
        }
        self.is_short(at_least_m, self.safe_m, slack_m).then_some(at_least_m)
    }

    /// The safe distance does not apply at the border, so only the clearance is required there.
    fn border_shortfall_of(
        &self,
        pieces: &[&PathPiece],
        tolerance_m: f64,
        slack_m: f64,
    ) -> Option<f64> {
        let to_border = |piece: &&PathPiece| self.clearance.curve_to_border(piece, tolerance_m);
        // As in an obstacle, nothing is kept outside the map.
        let kept_m = pieces.iter().map(to_border).fold(f64::INFINITY, f64::min).max(0.0);
        self.is_short(kept_m, self.clearance_m, slack_m).then_some(kept_m)
    }

    /// True if a distance falls short by more than the rounding that [`Clearance::is_clear`]
    /// allows for.
    fn is_short(&self, kept_m: f64, asked_m: f64, slack_m: f64) -> bool {
        let scale_m = asked_m + self.clearance.frame().resolution_m();
        kept_m < asked_m - slack_m.max(SAFE_TOLERANCE_M * scale_m.max(1.0))
    }

    fn too_near(&self, connection: Segment) -> Option<Square> {
        self.clearance.obstacle_within(connection, self.safe_m - SAFE_TOLERANCE_M)
    }

    /// True if a safe connection can begin or end at a point.
    pub(super) fn is_safe_point(&self, point: Point) -> bool {
        self.is_safe(Segment::new(point, point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::OccupancyGrid;

    #[test]
    fn the_safe_distance_does_not_hold_at_the_border() {
        let grid = OccupancyGrid::from_ascii(&["...#", "....", "...."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let along = |y: f64| Segment::new(Point::new(0.5, y), Point::new(3.5, y));
        // 1.5 m below the obstacle and 0.5 m from the border; 0.5 m below it.
        let required =
            |clearance_m, safe_m| RequiredClearance::new(&clearance, clearance_m, safe_m);
        assert!(required(0.5, 1.5).is_safe(along(0.5)) && !required(0.6, 1.5).is_safe(along(0.5)));
        assert!(required(0.0, 0.5).is_safe(along(1.5)) && !required(0.0, 0.51).is_safe(along(1.5)));
        assert!(required(0.5, 0.51).is_free(along(1.5)));
        assert_eq!(required(0.5, 0.2).safe_m(), 0.5);
        assert!(!required(0.0, 0.5).is_safe_point(Point::new(3.0, 1.6)));
    }
}
