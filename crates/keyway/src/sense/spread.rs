//! Spread of unobserved space into observed free space.

use crate::map::{BitGrid, CellWindow};

/// Cells that pedestrians do not walk through: obstacles, except unknown cells.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Walls<'a> {
    /// All obstacle cells.
    pub obstacles: &'a BitGrid,
    /// All unknown cells, obstacles or not.
    pub unknown: &'a BitGrid,
}

impl Walls<'_> {
    fn word(&self, y: i32, word: usize) -> u64 {
        self.obstacles.row(y)[word] & !self.unknown.row(y)[word]
    }
}

/// Spreads unobserved space by one cell per step.
///
/// Memory: three rows of a window.
#[derive(Clone, Debug, Default)]
pub(super) struct Spread {
    /// Open and unobserved cells of the current row and of the rows below and above it.
    rows: [Vec<u64>; 3],
}

impl Spread {
    /// Marks as unobserved every observed cell of a window that shares a side or a corner with an
    /// unobserved cell that is not a wall. All cells outside the window count as unobserved.
    /// Returns true if any cell changed. Costs a few instructions for every 64 cells.
    pub(super) fn step(
        &mut self,
        seen: &mut BitGrid,
        walls: Walls<'_>,
        window: &CellWindow,
    ) -> bool {
        if window.is_empty() {
            return false;
        }
        let word = |x: i32| (x + 1) as usize / 64;
        let (first, last) = (word(window.low.x), word(window.high.x));
        let fill = |row: &mut Vec<u64>, seen: &BitGrid, y: i32| {
            row.clear();
            // Enough for every later window.
            row.reserve(seen.row(y).len());
            row.extend((first..=last).map(|word| !(seen.row(y)[word] | walls.word(y, word))));
        };
        fill(&mut self.rows[1], seen, window.low.y - 1);
        fill(&mut self.rows[2], seen, window.low.y);
        let mut changed = false;
        for y in window.low.y..=window.high.y {
            self.rows.rotate_left(1);
            fill(&mut self.rows[2], seen, y + 1);
            for word in first..=last {
                let before = seen.row(y)[word];
                let left = before & !self.reached(word - first);
                changed |= left != before;
                seen.set_word(y, word, left);
            }
        }
        changed
    }

    /// The cells of a word that a step reaches; cells beside the window count as unobserved.
    fn reached(&self, word: usize) -> u64 {
        let open = |word: Option<usize>| {
            let word = word.filter(|&word| word < self.rows[1].len());
            word.map_or(u64::MAX, |word| self.rows.iter().fold(0, |all, row| all | row[word]))
        };
        let here = open(Some(word));
        let (before, after) = (open(word.checked_sub(1)), open(Some(word + 1)));
        here | here << 1 | before >> 63 | here >> 1 | after << 63
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Cell;
    use proptest::prelude::*;

    const HEIGHT: u32 = 4;

    proptest! {
        /// Compared with the definition, cell by cell; windows reach the borders and the ends of
        /// words.
        #[test]
        fn a_step_reaches_the_neighbours_of_open_unseen_cells(
            width in 60u32..135, from in (0i32..70, 0i32..4), size in (0i32..134, 0i32..4),
            kinds in prop::collection::vec(prop_oneof![6 => Just(3), 2 => 0..3], 135 * 4),
        ) {
            let empty = || BitGrid::new(width, HEIGHT, false);
            let (mut seen, mut obstacles, mut unknown) = (empty(), empty(), empty());
            let high = Cell::new((from.0 + size.0).min(width as i32 - 1), (from.1 + size.1).min(HEIGHT as i32 - 1));
            let window = CellWindow { low: Cell::new(from.0.min(high.x), from.1), high };
            let cells = (0..HEIGHT as i32).flat_map(|y| (0..width as i32).map(move |x| Cell::new(x, y)));
            for (cell, &kind) in cells.clone().zip(&kinds).filter(|(cell, _)| window.contains(*cell)) {
                seen.set(cell, kind == 3);
                obstacles.set(cell, kind == 1 || kind == 2);
                unknown.set(cell, kind == 2);
            }
            let is_open = |cell: Cell| !seen.get(cell) && (!obstacles.get(cell) || unknown.get(cell));
            let around = |cell: Cell| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| Cell::new(cell.x + x, cell.y + y)));
            let mut expected = empty();
            for cell in cells.filter(|&cell| seen.get(cell) && !around(cell).any(is_open)) {
                expected.set(cell, true);
            }
            let mut after = seen.clone();
            let walls = Walls { obstacles: &obstacles, unknown: &unknown };
            let has_changed = Spread::default().step(&mut after, walls, &window);
            prop_assert_eq!(&after, &expected);
            prop_assert_eq!(has_changed, after != seen);
        }
    }
}
