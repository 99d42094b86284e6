//! The beams of a scan on a grid.

use super::Scan;
use crate::geometry::{Point, Pose};
use crate::map::{Cell, GridFrame};

/// What a beam reports: from where, in which direction (a unit vector) and how far nothing stands,
/// all in grid coordinates \[cells\].
pub(super) struct Beam {
    /// Its number in the scan.
    pub(super) number: usize,
    pub(super) start: Point,
    pub(super) direction: Point,
    pub(super) free: f64,
    /// Whether something stands at the end of it.
    pub(super) hit: bool,
}

impl Beam {
    /// Length along the beam by which a hit is advanced before its cell is looked up \[cells\]. A
    /// hit exactly on a square's face then marks the square behind the face, rounded or not, and
    /// not the free cell before it. A square that the beam crosses for less than this, or at a
    /// flatter angle than rounding allows, may still be mistaken for its neighbour.
    pub(super) const HIT_ADVANCE_CELLS: f64 = 1e-6;

    /// Where the beam ends.
    pub(super) fn end(&self) -> Point {
        self.start + self.direction * self.free
    }

    /// The cell of what it hit; none outside the map.
    pub(super) fn hit_cell(&self, frame: &GridFrame) -> Option<Cell> {
        let advanced = self.free + Self::HIT_ADVANCE_CELLS;
        frame.cell_from_grid(self.start + self.direction * advanced)
    }
}

/// The usable beams of a scan.
pub(super) fn beams<'a>(
    frame: &'a GridFrame,
    pose: Pose,
    scan: &'a Scan,
) -> impl Iterator<Item = Beam> + use<'a> {
    let start = frame.grid_from_world(pose.point());
    let ahead = pose.theta - frame.origin().theta;
    scan.ranges_m.iter().enumerate().filter_map(move |(number, &range)| {
        let hit = range.is_finite() && range <= scan.range_max_m;
        let free_m = if hit { range } else { scan.range_max_m };
        let (sin, cos) = libm::sincos(ahead + scan.bearing_rad(number));
        let direction = Point::new(cos, sin);
        // Also false for NaN.
        let is_usable = range > 0.0 && free_m > 0.0 && start.is_finite() && direction.is_finite();
        let free = free_m / frame.resolution_m();
        is_usable.then_some(Beam { number, start, direction, free, hit })
    })
}
