//! Free cells at corners of obstacles.

use crate::map::{BitGrid, Cell, SearchMap};

/// The corner cells of a map \[Uras2013, "subgoals"\]: free cells with a blocked diagonal
/// neighbour, while the two cells between are free.
///
/// They are numbered row by row.
#[derive(Clone, Debug)]
pub(super) struct Corners {
    cells: BitGrid,
    /// Number of corner cells before each word of `cells`.
    before: Vec<u32>,
}

impl Corners {
    pub(super) fn new(map: &SearchMap) -> Self {
        let cells = corner_cells(map.blocked());
        let mut count = 0;
        let counted = cells.words().iter().map(|word| {
            let before = count;
            count += word.count_ones();
            before
        });
        Self { before: counted.collect(), cells }
    }

    /// One bit per cell.
    pub(super) const fn cells(&self) -> &BitGrid {
        &self.cells
    }

    /// The number of corner cells.
    pub(super) fn count(&self) -> usize {
        self.cells.count_ones() as usize
    }

    /// All corner cells, in the order of their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells.ones()
    }

    /// True if a cell of the map is a corner cell.
    pub(super) fn contains(&self, cell: Cell) -> bool {
        let bit = self.bit(cell);
        self.cells.words()[bit / 64] >> (bit % 64) & 1 == 1
    }

    /// The number of a corner cell.
    pub(super) fn number(&self, corner: Cell) -> usize {
        let bit = self.bit(corner);
        let lower = self.cells.words()[bit / 64] & !(u64::MAX << (bit % 64));
        (self.before[bit / 64] + lower.count_ones()) as usize
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.cells.memory_bytes() + self.before.capacity() * size_of::<u32>()
    }

    fn bit(&self, cell: Cell) -> usize {
        (cell.y + 1) as usize * self.cells.stride() + (cell.x + 1) as usize
    }
}

/// Free cells with a blocked diagonal neighbour and free cells between, 64 at a time.
fn corner_cells(blocked: &BitGrid) -> BitGrid {
    let mut corners = BitGrid::new(blocked.width(), blocked.height(), false);
    for y in 0..blocked.height() as i32 {
        let rows = [blocked.row(y - 1), blocked.row(y), blocked.row(y + 1)];
        for word in 0..rows[1].len() {
            let [below, own, above] = rows.map(|row| Beside::of(row, word));
            // The own row is free here and at the side; the adjacent row is free here and blocked
            // at the side.
            let turns =
                |next: &Beside| !next.here & ((!own.right & next.right) | (!own.left & next.left));
            let found = !own.here & (turns(&above) | turns(&below));
            corners.set_word(y, word, found);
        }
    }
    corners
}

/// For each bit of a word, its own value and those of its neighbours; beyond the row all cells are
/// blocked.
struct Beside {
    left: u64,
    here: u64,
    right: u64,
}

impl Beside {
    fn of(row: &[u64], word: usize) -> Self {
        let here = row[word];
        let before = if word > 0 { row[word - 1] } else { u64::MAX };
        let after = row.get(word + 1).copied().unwrap_or(u64::MAX);
        Self { left: here << 1 | before >> 63, here, right: here >> 1 | after << 63 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    fn corners(rows: &[&str]) -> Vec<(i32, i32)> {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap();
        let corners = Corners::new(&map);
        for (number, cell) in corners.iter().enumerate() {
            assert!(corners.contains(cell));
            assert_eq!(corners.number(cell), number);
        }
        assert_eq!(corners.iter().count(), corners.count());
        corners.iter().map(|cell| (cell.x, cell.y)).collect()
    }

    #[test]
    fn beside_the_corners_of_obstacles_only() {
        assert_eq!(corners(&["...", ".#.", "..."]), [(0, 0), (2, 0), (0, 2), (2, 2)]);
        // The cells between obstacle and border are not at a corner, and neither are those in a
        // concave corner.
        assert_eq!(corners(&["#..", "..."]), [(1, 0)]);
        assert_eq!(corners(&["##.", "#..", "..."]), [(1, 0), (2, 1)]);
    }

    #[test]
    fn across_words() {
        for x in 1..130 {
            let row: String = (0..132).map(|at| if at == x { '#' } else { '.' }).collect();
            let free = ".".repeat(132);
            assert_eq!(corners(&[&free, &row]), [(x - 1, 1), (x + 1, 1)], "column {x}");
        }
    }
}
