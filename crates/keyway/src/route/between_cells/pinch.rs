//! A point of a path with too little clearance.

use crate::geometry::Point;
use crate::map::Cell;

/// Spacing of the samples on a line between two obstacles \[cells\].
const LOOK_CELLS: f64 = 0.125;

/// A point at which a path cannot keep its clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pinch {
    /// Point of the path, in grid coordinates \[cells\].
    pub(super) at: Point,
    /// Both sides of the gap that is too narrow, if there is one \[cells\].
    pub(super) gap: Option<[Point; 2]>,
}

impl Pinch {
    /// The cells to close so that no path leads through: those across the gap, and the cell of
    /// the path's point.
    pub(super) fn cells(&self) -> Vec<Cell> {
        let mut cells = vec![cell_of(self.at)];
        let Some([one, other]) = self.gap else { return cells };
        let looks = (one.distance(other) / LOOK_CELLS).ceil().max(1.0);
        let mut last: Option<Cell> = None;
        for look in 0..=looks as u32 {
            let cell = cell_of(one.lerp(other, f64::from(look) / looks));
            // A path may lead between two cells that meet at a corner.
            let beside = last.filter(|last| last.x != cell.x && last.y != cell.y);
            cells.extend(beside.map(|last| Cell::new(last.x, cell.y)));
            cells.push(cell);
            last = Some(cell);
        }
        cells
    }
}

fn cell_of(at: Point) -> Cell {
    Cell::new(at.x.floor() as i32, at.y.floor() as i32)
}
