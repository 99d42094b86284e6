//! Marked cells that stop scans.

use crate::map::{BitGrid, Cell, SearchMap};

/// A set of cells of one map that grows during a query: one bit per cell, by rows and by columns,
/// so that scans in either direction read 64 cells at a time.
///
/// The cost of clearing it is proportional to the cells in it. Memory: two bits per cell of the
/// map, of which only the pages of marked cells are touched.
#[derive(Clone, Debug)]
pub(super) struct Marks {
    rows: BitGrid,
    /// The same with columns and rows exchanged.
    columns: BitGrid,
    marked: Vec<Cell>,
}

impl Default for Marks {
    fn default() -> Self {
        Self::sized(0, 0)
    }
}

impl Marks {
    fn sized(width: u32, height: u32) -> Self {
        let (rows, columns) =
            (BitGrid::new(width, height, false), BitGrid::new(height, width, false));
        Self { rows, columns, marked: Vec::new() }
    }

    /// Clears all marks, and resizes the set to a map.
    pub(super) fn start(&mut self, map: &SearchMap) {
        let (width, height) = (map.frame().width(), map.frame().height());
        if (self.rows.width(), self.rows.height()) == (width, height) {
            self.clear();
        } else {
            *self = Self::sized(width, height);
        }
    }

    /// Clears all marks.
    pub(super) fn clear(&mut self) {
        while let Some(cell) = self.marked.pop() {
            self.set(cell, false);
        }
    }

    /// Marks a cell of the map.
    pub(super) fn mark(&mut self, cell: Cell) {
        if self.set(cell, true) {
            self.marked.push(cell);
        }
    }

    /// True if a cell is marked.
    pub(super) fn contains(&self, cell: Cell) -> bool {
        self.rows.get(cell)
    }

    /// Bits by rows; (x, y) is at (x, y).
    pub(super) const fn rows(&self) -> &BitGrid {
        &self.rows
    }

    /// Bits by columns; (x, y) is at (y, x).
    pub(super) const fn columns(&self) -> &BitGrid {
        &self.columns
    }

    /// Memory on the heap \[bytes\].
    pub(super) fn memory_bytes(&self) -> usize {
        let Self { rows, columns, marked } = self;
        rows.memory_bytes() + columns.memory_bytes() + size_of::<Cell>() * marked.capacity()
    }

    fn set(&mut self, cell: Cell, value: bool) -> bool {
        self.columns.set(Cell::new(cell.y, cell.x), value);
        self.rows.set(cell, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn marks_last_for_one_query() {
        let map = |rows: &[&str]| {
            SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
        };
        let mut marks = Marks::default();
        marks.start(&map(&["...", "..."]));
        marks.mark(Cell::new(2, 1));
        marks.mark(Cell::new(2, 1));
        marks.mark(Cell::new(0, 0));
        assert!(marks.contains(Cell::new(2, 1)) && !marks.contains(Cell::new(1, 1)));
        assert!(marks.columns().get(Cell::new(1, 2)) && marks.rows().get(Cell::new(0, 0)));
        for rows in [["...", "..."].as_slice(), &["....."]] {
            marks.start(&map(rows));
            let none = (marks.rows().count_ones(), marks.columns().count_ones());
            assert_eq!(none, (0, 0));
        }
    }
}
