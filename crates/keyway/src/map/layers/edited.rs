//! The edited parts of a map, in a few windows.

use crate::map::{Cell, CellWindow};
use arrayvec::ArrayVec;

/// The windows that contain all edited cells. There are few of them, so that data derived from
/// the cells of each are computed once and not for every edit, and they are kept small.
#[derive(Debug, Default)]
pub(super) struct EditedWindows {
    windows: ArrayVec<EditedWindow, { Self::MOST }>,
}

/// A window around edited cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EditedWindow {
    pub(super) window: CellWindow,
    /// True if an obstacle was removed from it.
    pub(super) is_cleared: bool,
}

impl EditedWindows {
    const MOST: usize = 24;

    /// Number of cells by which a window may grow to avoid another one.
    const CELLS: i64 = 64 * 64;

    /// Records a cell that has changed.
    pub(super) fn note(&mut self, cell: Cell, is_cleared: bool) {
        let own = EditedWindow { window: CellWindow { low: cell, high: cell }, is_cleared };
        let grown =
            |known: &EditedWindow| cells(&known.window.union(&own.window)) - cells(&known.window);
        let is_full = self.windows.is_full();
        let least = self.windows.iter_mut().min_by_key(|known| grown(known));
        match least.filter(|known| is_full || grown(known) <= Self::CELLS) {
            Some(known) => {
                known.window = known.window.union(&own.window);
                known.is_cleared |= is_cleared;
            }
            None => self.windows.push(own),
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = EditedWindow> + '_ {
        self.windows.iter().copied()
    }
}

/// The number of cells of a window.
fn cells(window: &CellWindow) -> i64 {
    let along = |low: i32, high: i32| i64::from(high) - i64::from(low) + 1;
    along(window.low.x, window.high.x) * along(window.low.y, window.high.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_in_a_window_and_what_is_far_apart_is_in_two() {
        let mut edited = EditedWindows::default();
        let places: Vec<Cell> = (0..500).map(|i| Cell::new(i * i % 997, i * 31 % 613)).collect();
        for (index, &cell) in places.iter().enumerate() {
            edited.note(cell, index % 2 == 0);
        }
        assert!(places.iter().all(|&cell| edited.iter().any(|it| it.window.contains(cell))));
        assert!(edited.iter().count() <= EditedWindows::MOST);
        let mut edited = EditedWindows::default();
        for (x, y, is_cleared) in [(0, 3, false), (9, 3, true), (500, 300, false)] {
            edited.note(Cell::new(x, y), is_cleared);
        }
        let window = |low: [i32; 2], high: [i32; 2]| CellWindow {
            low: Cell::new(low[0], low[1]),
            high: Cell::new(high[0], high[1]),
        };
        let found: Vec<_> = edited.iter().map(|it| (it.window, it.is_cleared)).collect();
        assert_eq!(
            found,
            [(window([0, 3], [9, 3]), true), (window([500, 300], [500, 300]), false)]
        );
    }
}
