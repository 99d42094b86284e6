//! Who watches a search.

use crate::map::Cell;

/// The side of a bidirectional search; a one-sided one is all forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// From the start.
    Forward,
    /// From the goal.
    Backward,
}

/// What a picture, a log or a test sees of a search. Every method does nothing by default; `()` is
/// the silent observer, which costs nothing.
pub trait Observer {
    /// A node was taken from the open list; `g_cells` is its path cost.
    fn expanded(&mut self, side: Side, at: Cell, g_cells: f64) {
        let _ = (side, at, g_cells);
    }

    /// A node was put into the open list, or improved there.
    fn generated(&mut self, side: Side, at: Cell, g_cells: f64) {
        let _ = (side, at, g_cells);
    }

    /// False when nobody watches: the search then skips whatever only serves the observer.
    fn is_watching(&self) -> bool {
        true
    }
}

impl Observer for () {
    fn is_watching(&self) -> bool {
        false
    }
}

impl Observer for &mut dyn Observer {
    fn expanded(&mut self, side: Side, at: Cell, g_cells: f64) {
        (**self).expanded(side, at, g_cells);
    }

    fn generated(&mut self, side: Side, at: Cell, g_cells: f64) {
        (**self).generated(side, at, g_cells);
    }

    fn is_watching(&self) -> bool {
        (**self).is_watching()
    }
}
