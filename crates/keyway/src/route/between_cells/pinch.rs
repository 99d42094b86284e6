//! A place that is too narrow.

use crate::geometry::Point;
use crate::map::Cell;

/// Points on a line between two obstacles are looked at so often \[cells\].
const LOOK_CELLS: f64 = 0.125;

/// A place at which a way has no room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pinch {
    /// The way's point, on the grid \[cells\].
    pub(super) at: Point,
    /// The two sides of a gap that is too narrow, if there is one \[cells\].
    pub(super) gap: Option<[Point; 2]>,
}

impl Pinch {
    /// The cells without which no path leads through it: those across the gap. The one of the way's
    /// point, too, so that no path leads there again.
    pub(super) fn cells(&self) -> Vec<Cell> {
        let mut cells = vec![cell_of(self.at)];
        let Some([one, other]) = self.gap else { return cells };
        let looks = (one.distance(other) / LOOK_CELLS).ceil().max(1.0);
        let mut last: Option<Cell> = None;
        for look in 0..=looks as u32 {
            let cell = cell_of(one.lerp(other, f64::from(look) / looks));
            // A path leads between two cells that meet at a corner.
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
