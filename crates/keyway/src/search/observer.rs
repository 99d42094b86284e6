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

    /// A node was put into the open list, or improved there; `parent` is the node that the way to
    /// it comes from.
    fn generated(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        let _ = (side, at, parent, g_cells);
    }

    /// The way to a node that is just expanded was found to come from another parent.
    fn reparented(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        let _ = (side, at, parent, g_cells);
    }

    /// A jump point search looked along a straight or diagonal line, up to the last free cell or to
    /// where it found something. `jps`, which skips what leads nowhere 64 cells at a time, reports
    /// only the lines that led to a jump point.
    fn scanned(&mut self, side: Side, from: Cell, to: Cell) {
        let _ = (side, from, to);
    }

    /// A node was linked to another one, far from it, by a straight line: an edge of a tree.
    /// Reported in addition to [`Self::generated`].
    fn linked(&mut self, side: Side, at: Cell, parent: Cell) {
        let _ = (side, at, parent);
    }

    /// The two sides of a search met in a cell: the last one reported is that of the path.
    fn met(&mut self, at: Cell) {
        let _ = at;
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
