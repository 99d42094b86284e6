//! How unseen ground spreads into seen ground.

use crate::map::{BitGrid, CellWindow};

/// Steps of unseen ground, a cell each.
///
/// Memory: three rows of a window.
#[derive(Clone, Debug, Default)]
pub(super) struct Spread {
    /// Of the row that is looked at and those below and above it: which cells are open and unseen.
    rows: [Vec<u64>; 3],
}

impl Spread {
    /// Makes the seen cells of a window unseen that share a side or a corner with an unseen cell which is no obstacle. Outside the
    /// window no cell is seen. Costs a few instructions for every 64 cells.
    pub(super) fn step(&mut self, seen: &mut BitGrid, obstacles: &BitGrid, window: &CellWindow) {
        if window.is_empty() {
            return;
        }
        let word = |x: i32| (x + 1) as usize / 64;
        let (first, last) = (word(window.low.x), word(window.high.x));
        let fill = |row: &mut Vec<u64>, seen: &BitGrid, y: i32| {
            let pairs = seen.row(y)[first..=last].iter().zip(&obstacles.row(y)[first..=last]);
            row.clear();
            row.extend(pairs.map(|(seen, obstacle)| !(seen | obstacle)));
        };
        fill(&mut self.rows[1], seen, window.low.y - 1);
        fill(&mut self.rows[2], seen, window.low.y);
        for y in window.low.y..=window.high.y {
            self.rows.rotate_left(1);
            fill(&mut self.rows[2], seen, y + 1);
            for word in first..=last {
                let left = seen.row(y)[word] & !self.reached(word - first);
                seen.set_word(y, word, left);
            }
        }
    }

    /// The cells of a word which a step reaches; those beside the window are unseen.
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
