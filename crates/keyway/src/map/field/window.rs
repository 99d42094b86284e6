//! Rectangles of cells.

use crate::map::Cell;

/// A rectangle of cells, both corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellWindow {
    /// Lower-left cell.
    pub low: Cell,
    /// Upper-right cell.
    pub high: Cell,
}

impl CellWindow {
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

    /// The smallest window that holds both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: Cell::new(self.low.x.min(other.low.x), self.low.y.min(other.low.y)),
            high: Cell::new(self.high.x.max(other.high.x), self.high.y.max(other.high.y)),
        }
    }

    /// The part inside another window that it overlaps.
    pub(super) fn clipped(&self, other: &Self) -> Self {
        Self {
            low: Cell::new(self.low.x.max(other.low.x), self.low.y.max(other.low.y)),
            high: Cell::new(self.high.x.min(other.high.x), self.high.y.min(other.high.y)),
        }
    }
}
