//! Observers of a search.

use crate::map::Cell;

/// The side of a bidirectional search; a one-sided search has the forward side only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The side from the start.
    Forward,
    /// The side from the goal.
    Backward,
}

/// Receives the events of a search, for visualisation, logs or tests. Every method does nothing by
/// default; `()` is the null observer, which has no cost.
pub trait Observer {
    /// A node was taken from the open list; `g_cells` is its path cost.
    fn expanded(&mut self, side: Side, at: Cell, g_cells: f64) {
        let _ = (side, at, g_cells);
    }

    /// A node was inserted into the open list, or improved there; `parent` is its parent.
    fn generated(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        let _ = (side, at, parent, g_cells);
    }

    /// A node that is being expanded got another parent.
    fn reparented(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        let _ = (side, at, parent, g_cells);
    }

    /// A jump point search scanned a straight or diagonal line, up to the last free cell or to a
    /// find. `jps`, which skips lines without a jump point 64 cells at a time, reports only the
    /// lines that led to one.
    fn scanned(&mut self, side: Side, from: Cell, to: Cell) {
        let _ = (side, from, to);
    }

    /// A node was linked to a distant one by a straight line: an edge of a tree. Reported in
    /// addition to [`Self::generated`].
    fn linked(&mut self, side: Side, at: Cell, parent: Cell) {
        let _ = (side, at, parent);
    }

    /// The two sides of a search met in a cell; the last one reported is that of the path.
    fn met(&mut self, at: Cell) {
        let _ = at;
    }

    /// False if no observer is attached: the search then skips work that only serves the observer.
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

    fn generated(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        (**self).generated(side, at, parent, g_cells);
    }

    fn reparented(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        (**self).reparented(side, at, parent, g_cells);
    }

    fn scanned(&mut self, side: Side, from: Cell, to: Cell) {
        (**self).scanned(side, from, to);
    }

    fn linked(&mut self, side: Side, at: Cell, parent: Cell) {
        (**self).linked(side, at, parent);
    }

    fn met(&mut self, at: Cell) {
        (**self).met(at);
    }

    fn is_watching(&self) -> bool {
        (**self).is_watching()
    }
}
