//! A summed-area table of occupied cells: the count in any box, in four look-ups \[Crow1984\].

use crate::map::{Cell, CellState, SearchMap};
use crate::search::SearchMemory;

/// For every cell, the number of occupied cells with no larger column and row.
///
/// Memory: 4 bytes for each cell of the map, kept from query to query. Built in one pass over all
/// cells.
#[derive(Clone, Debug, Default)]
pub(super) struct SummedArea {
    /// Row by row, preceded by a row and a column of zeros.
    sums: Vec<u32>,
    stride: usize,
}

impl SummedArea {
    /// Counts the occupied cells of a map; unknown ones do not count, even if they are treated as
    /// obstacles.
    pub(super) fn build(&mut self, map: &SearchMap) {
        let (width, height) = (map.frame().width() as usize, map.frame().height() as usize);
        self.stride = width + 1;
        self.sums.clear();
        self.sums.resize(self.stride * (height + 1), 0);
        for y in 0..height {
            let mut in_row = 0;
            for x in 0..width {
                let is_occupied = map.state(Cell::new(x as i32, y as i32)) == CellState::Occupied;
                in_row += u32::from(is_occupied);
                let below = self.sums[y * self.stride + x + 1];
                self.sums[(y + 1) * self.stride + x + 1] = below + in_row;
            }
        }
    }

    /// The number of occupied cells from `low` to `high`, both included and on the map.
    pub(super) fn between(&self, low: Cell, high: Cell) -> u64 {
        let (left, right) = (low.x as usize, high.x as usize + 1);
        let (bottom, top) = (low.y as usize, high.y as usize + 1);
        let until = |x: usize, y: usize| u64::from(self.sums[y * self.stride + x]);
        until(right, top) + until(left, bottom) - until(left, top) - until(right, bottom)
    }
}

impl SearchMemory for SummedArea {
    fn memory_bytes(&self) -> usize {
        size_of::<u32>() * self.sums.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    /// Sums from the lower left: the row below holds 1 at x = 1, the row above 1 at x = 0 and 2.
    #[test]
    fn by_hand() {
        let grid = OccupancyGrid::from_ascii(&["#?#", ".#."]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let mut table = SummedArea::default();
        table.build(&map);
        assert_eq!(table.sums, [0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 2, 3]);
        assert_eq!(table.between(Cell::new(0, 0), Cell::new(2, 1)), 3);
        assert_eq!(table.between(Cell::new(1, 0), Cell::new(1, 1)), 1);
        assert_eq!(table.between(Cell::new(1, 1), Cell::new(2, 1)), 1);
        assert_eq!(table.memory_bytes(), 4 * table.sums.capacity());
    }
}
