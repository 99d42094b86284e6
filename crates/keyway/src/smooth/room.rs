//! What the connections that a smoother makes keep from obstacles.

use crate::geometry::{Point, Segment, Square};
use crate::map::{Clearance, Obstruction};

/// Distances that fall short of a safe distance by less than this \[m\] keep it: beside a wall of 1 m
/// cells a path lies at exactly 0.5 m.
const SAFE_TOLERANCE_M: f64 = 1e-9;

/// The obstacles, the clearance that was asked for, and the smoother's own safe distance.
///
/// The clearance is also kept from the map's border; the safe distance only from obstacles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room<'a> {
    clearance: &'a Clearance<'a>,
    clearance_m: f64,
    safe_m: f64,
}

impl<'a> Room<'a> {
    /// A safe distance below the clearance counts as the clearance.
    pub(super) fn new(clearance: &'a Clearance<'a>, clearance_m: f64, safe_m: f64) -> Self {
        Self { clearance, clearance_m, safe_m: safe_m.max(clearance_m) }
    }

    /// The larger of safe distance and clearance \[m\].
    pub(super) const fn safe_m(&self) -> f64 {
        self.safe_m
    }

    /// What comes nearer to an obstacle than this is not safe \[m\].
    pub(super) const fn unsafe_within_m(&self) -> f64 {
        (self.safe_m - SAFE_TOLERANCE_M).max(self.clearance_m)
    }

    /// Whether a connection is free: it keeps the clearance.
    pub(super) fn is_free(&self, connection: Segment) -> bool {
        self.clearance.is_clear(connection, self.clearance_m)
    }

    /// Whether all connections within a triangle are certainly free; they can be when this is false.
    pub(super) fn is_free_triangle(&self, corners: [Point; 3]) -> bool {
        self.clearance.is_clear_triangle(corners, self.clearance_m)
    }

    /// Whether the safe distance to obstacles is kept, whatever the clearance.
    pub(super) fn keeps_safe_distance(&self, connection: Segment) -> bool {
        self.too_near(connection).is_none()
    }

    /// Whether a connection is free and keeps the safe distance.
    pub(super) fn is_safe(&self, connection: Segment) -> bool {
        self.obstruction(connection).is_none()
    }

    /// What keeps a connection from being safe.
    pub(super) fn obstruction(&self, connection: Segment) -> Option<Obstruction> {
        if self.unsafe_within_m() <= self.clearance_m {
            return self.clearance.obstruction(connection, self.clearance_m);
        }
        // What keeps the larger distance from obstacles keeps the smaller one.
        if !self.clearance.is_on_map(connection, self.clearance_m) {
            return Some(Obstruction::Border);
        }
        self.too_near(connection).map(Obstruction::Obstacle)
    }

    fn too_near(&self, connection: Segment) -> Option<Square> {
        self.clearance.obstacle_within(connection, self.safe_m - SAFE_TOLERANCE_M)
    }

    /// Whether a safe connection can begin or end at a point.
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
        let room = |clearance_m, safe_m| Room::new(&clearance, clearance_m, safe_m);
        assert!(room(0.5, 1.5).is_safe(along(0.5)) && !room(0.6, 1.5).is_safe(along(0.5)));
        assert!(room(0.0, 0.5).is_safe(along(1.5)) && !room(0.0, 0.51).is_safe(along(1.5)));
        assert!(room(0.5, 0.51).is_free(along(1.5)));
        assert_eq!(room(0.5, 0.2).safe_m(), 0.5);
        assert!(!room(0.0, 0.5).is_safe_point(Point::new(3.0, 1.6)));
    }
}
