//! Nearest-neighbour search among numbered cells.

use crate::map::Cell;

/// Numbered cells of a map in a quadtree: level l has a mark for every square of 2^l x 2^l cells
/// that holds one.
///
/// The search for the nearest cell descends from the largest square, nearer quadrants first, and
/// skips squares farther away than the best find. Memory: 4 bytes and a third per cell of the map,
/// of which only the surroundings of numbered cells are touched.
#[derive(Clone, Debug, Default)]
pub(super) struct NearestNode {
    width: u32,
    height: u32,
    /// For each cell, its number plus one; 0 if it has none.
    numbers: Vec<u32>,
    /// Levels 1, 2, ... up to the one whose only square is the map.
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    columns: u32,
    rows: u32,
    holds_some: Vec<bool>,
}

/// The square of a distance, and the number of the cell at that distance: nearer first, then older.
type Found = (u64, u32);

impl NearestNode {
    /// Resizes to a map of another size, without any numbered cells. False if the size is the
    /// same: then nothing changes.
    pub(super) fn resize(&mut self, width: u32, height: u32) -> bool {
        if (self.width, self.height) == (width, height) {
            return false;
        }
        let levels = (1..=u32::BITS).map(|level| {
            let squares = |cells: u32| (u64::from(cells)).div_ceil(1 << level) as u32;
            let (columns, rows) = (squares(width), squares(height));
            Level { columns, rows, holds_some: vec![false; columns as usize * rows as usize] }
        });
        let mut is_whole = false;
        let up_to_whole = levels.take_while(|level| {
            !std::mem::replace(&mut is_whole, level.columns <= 1 && level.rows <= 1)
        });
        self.levels = up_to_whole.collect();
        self.numbers = vec![0; width as usize * height as usize];
        (self.width, self.height) = (width, height);
        true
    }

    /// Memory on the heap \[bytes\].
    pub(super) fn memory_bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(|level| level.holds_some.capacity()).sum();
        size_of::<u32>() * self.numbers.capacity() + levels
    }

    /// Numbers a cell of the map.
    pub(super) fn insert(&mut self, cell: Cell, number: u32) {
        let index = self.index(cell);
        self.numbers[index] = number + 1;
        self.mark(cell, true);
    }

    /// Removes a cell, and the marks of all squares around it; only valid if all cells are
    /// removed.
    pub(super) fn forget(&mut self, cell: Cell) {
        let index = self.index(cell);
        self.numbers[index] = 0;
        self.mark(cell, false);
    }

    /// True if a cell of the map has a number.
    pub(super) fn contains(&self, cell: Cell) -> bool {
        self.numbers[self.index(cell)] != 0
    }

    /// The number of the nearest cell, in a tie the smallest number; `None` without numbered
    /// cells.
    pub(super) fn nearest(&self, to: Cell) -> Option<u32> {
        let mut found = (u64::MAX, u32::MAX);
        self.look(self.levels.len(), (0, 0), to, &mut found);
        (found.1 != u32::MAX).then_some(found.1)
    }

    /// Searches a square for a nearer cell.
    fn look(&self, level: usize, square: (i64, i64), to: Cell, found: &mut Found) {
        let distance_sq = distance_sq(level, square, to);
        if distance_sq > found.0 {
            return;
        }
        let (x, y) = square;
        let Some(below) = level.checked_sub(1) else {
            if let Some(number) = self.number(square) {
                *found = (distance_sq, number).min(*found);
            }
            return;
        };
        if !self.levels[below].holds_some(square) {
            return;
        }
        // The quadrant on the target's side first.
        let is_beyond =
            |at: i32, square: i64| i64::from(i64::from(at) >= (2 * square + 1) << below);
        let (near_x, near_y) = (is_beyond(to.x, x), is_beyond(to.y, y));
        for (other_x, other_y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let quarter = (2 * x + (near_x ^ other_x), 2 * y + (near_y ^ other_y));
            self.look(below, quarter, to, found);
        }
    }

    fn number(&self, (x, y): (i64, i64)) -> Option<u32> {
        if x >= i64::from(self.width) || y >= i64::from(self.height) {
            return None;
        }
        self.numbers[y as usize * self.width as usize + x as usize].checked_sub(1)
    }

    fn index(&self, cell: Cell) -> usize {
        cell.y as usize * self.width as usize + cell.x as usize
    }

    fn mark(&mut self, cell: Cell, holds_some: bool) {
        for (level, shift) in self.levels.iter_mut().zip(1u32..) {
            let square = (i64::from(cell.x) >> shift, i64::from(cell.y) >> shift);
            let index = level.index(square);
            level.holds_some[index] = holds_some;
        }
    }
}

impl Level {
    fn index(&self, (x, y): (i64, i64)) -> usize {
        y as usize * self.columns as usize + x as usize
    }

    fn holds_some(&self, square: (i64, i64)) -> bool {
        let (x, y) = square;
        x < i64::from(self.columns)
            && y < i64::from(self.rows)
            && self.holds_some[self.index(square)]
    }
}

/// The square of the distance from a cell to the nearest cell of a square of 2^level x 2^level
/// cells.
fn distance_sq(level: usize, (x, y): (i64, i64), to: Cell) -> u64 {
    let along = |at: i32, square: i64| {
        let (at, first) = (i64::from(at), square << level);
        let last = first + (1 << level) - 1;
        (first - at).max(at - last).max(0).unsigned_abs()
    };
    along(to.x, x).pow(2) + along(to.y, y).pow(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nearer_first_then_smaller_number() {
        let mut nodes = NearestNode::default();
        assert!(nodes.resize(5, 3));
        assert_eq!(nodes.nearest(Cell::new(2, 1)), None);
        nodes.insert(Cell::new(4, 1), 3);
        nodes.insert(Cell::new(0, 1), 7);
        assert_eq!(nodes.nearest(Cell::new(2, 1)), Some(3));
        assert_eq!(nodes.nearest(Cell::new(1, 2)), Some(7));
        nodes.insert(Cell::new(2, 2), 9);
        assert_eq!(nodes.nearest(Cell::new(2, 1)), Some(9));
        assert!(nodes.contains(Cell::new(2, 2)) && !nodes.contains(Cell::new(2, 1)));
    }

    #[test]
    fn distances_to_squares_by_hand() {
        // Columns 4 to 7, rows 0 to 3.
        let distance = |x, y| distance_sq(2, (1, 0), Cell::new(x, y));
        assert_eq!([distance(5, 2), distance(1, 1), distance(9, 6)], [0, 9, 4 + 9]);
    }

    proptest! {
        #[test]
        fn as_by_looking_at_all(width in 1u32..80, height in 1u32..80, seed: u64,
                                cells in prop::collection::vec((0i32..80, 0i32..80), 0..60),
                                targets in prop::collection::vec((0i32..80, 0i32..80), 20)) {
            let on_map = |(x, y): (i32, i32)| Cell::new(x % width as i32, y % height as i32);
            let mut nodes = NearestNode::default();
            // Filled, emptied and filled again.
            for round in 0..2 {
                prop_assert_eq!(nodes.resize(width, height), round == 0);
                let mut all: Vec<Cell> = Vec::new();
                let skipped = (seed >> (8 * round)) as usize % 5;
                for &cell in cells.iter().skip(skipped) {
                    let cell = on_map(cell);
                    prop_assert_eq!(nodes.contains(cell), all.contains(&cell));
                    if !all.contains(&cell) {
                        nodes.insert(cell, all.len() as u32);
                        all.push(cell);
                    }
                }
                for &target in &targets {
                    let to = on_map(target);
                    let distance_sq = |c: &Cell| (c.x - to.x).pow(2) + (c.y - to.y).pow(2);
                    let expected = (0..all.len()).min_by_key(|&i| (distance_sq(&all[i]), i));
                    prop_assert_eq!(nodes.nearest(to).map(|number| number as usize), expected);
                }
                for &cell in &all {
                    nodes.forget(cell);
                }
            }
        }
    }
}
