//! Rectangles of cells.

use crate::geometry::Point;
use crate::map::{Cell, GridFrame};
use serde::{Deserialize, Serialize};

/// A rectangle of cells, both corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellWindow {
    /// Lower-left cell.
    pub low: Cell,
    /// Upper-right cell.
    pub high: Cell,
}

impl CellWindow {
    /// The cells of a grid within a distance of a position along the grid's axes; some cells at
    /// the border if the position is not finite.
    pub fn around(frame: &GridFrame, place: Point, reach_m: f64) -> Self {
        let centre = frame.grid_from_world(place);
        let reach = reach_m / frame.resolution_m();
        let low = |at: f64| (at - reach).floor().max(0.0) as i32;
        let high = |at: f64, count: u32| ((at + reach).floor() as i32).min(count as i32 - 1);
        Self {
            low: Cell::new(low(centre.x), low(centre.y)),
            high: Cell::new(high(centre.x, frame.width()), high(centre.y, frame.height())),
        }
    }

    /// All cells, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let Self { low, high } = *self;
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| Cell::new(x, y)))
    }

    /// True for a cell of the window.
    pub const fn contains(&self, cell: Cell) -> bool {
        self.low.x <= cell.x
            && self.low.y <= cell.y
            && cell.x <= self.high.x
            && cell.y <= self.high.y
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.low.x > self.high.x || self.low.y > self.high.y
    }

    /// The smallest window that contains both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: Cell::new(self.low.x.min(other.low.x), self.low.y.min(other.low.y)),
            high: Cell::new(self.high.x.max(other.high.x), self.high.y.max(other.high.y)),
        }
    }

    /// The intersection with another window, which must overlap.
    pub(super) fn clipped(&self, other: &Self) -> Self {
        Self {
            low: Cell::new(self.low.x.max(other.low.x), self.low.y.max(other.low.y)),
            high: Cell::new(self.high.x.min(other.high.x), self.high.y.min(other.high.y)),
        }
    }
}
