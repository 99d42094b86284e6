//! Distances along the columns: rows to the nearest obstacle of the same column.

use super::CellWindow;
use super::envelope::FAR_ROWS;
use crate::map::{BitGrid, Cell};

/// Moves one row further from every column's nearest obstacle.
pub(super) fn step(rows: &mut [i16]) {
    for rows in rows {
        *rows = (*rows + 1).min(FAR_ROWS);
    }
}

/// Sets, for every column from `first` on with an obstacle in one of the rows, the number of the
/// first such row, counted from 0; other columns keep their number. Processes 64 columns
/// together.
pub(super) fn nearest_in_rows(
    obstacles: &BitGrid,
    rows: impl Iterator<Item = i32>,
    first: i32,
    nearest: &mut [i16],
) {
    // Column x is bit x + 1.
    let from = first as usize + 1;
    let to = from + nearest.len();
    let words = from / 64..(to - 1) / 64 + 1;
    let mut seen = vec![0_u64; words.len()];
    seen[0] = !(u64::MAX << (from % 64));
    if !to.is_multiple_of(64) {
        seen[words.len() - 1] |= u64::MAX << (to % 64);
    }
    for (distance, y) in rows.take(FAR_ROWS as usize).enumerate() {
        let mut all = u64::MAX;
        let row = &obstacles.row(y)[words.clone()];
        for (i, (seen, &word)) in seen.iter_mut().zip(row).enumerate() {
            let mut new = word & !*seen;
            *seen |= word;
            all &= *seen;
            while new != 0 {
                let bit = 64 * (words.start + i) + new.trailing_zeros() as usize;
                nearest[bit - from] = distance as i16;
                new &= new - 1;
            }
        }
        if all == u64::MAX {
            break;
        }
    }
}

/// Rows to the nearest obstacle of its column, for every cell of a rectangle; at most
/// [`FAR_ROWS`].
#[derive(Default)]
pub(super) struct ColumnRows {
    /// Lowest row.
    low_y: i32,
    width: usize,
    rows: Vec<i16>,
}

impl ColumnRows {
    /// Computes the rows to the obstacles of a map for the cells of a window; obstacles below row
    /// `low_y` and above row `high_y` do not count.
    pub(super) fn fill(
        &mut self,
        obstacles: &BitGrid,
        window: CellWindow,
        low_y: i32,
        high_y: i32,
    ) {
        let CellWindow { low, high } = window;
        let mut below = vec![FAR_ROWS; (high.x - low.x + 1) as usize];
        let mut above = below.clone();
        nearest_in_rows(obstacles, (low_y..low.y).rev(), low.x, &mut below);
        nearest_in_rows(obstacles, (high.y + 1)..=high_y, low.x, &mut above);
        self.between(obstacles, window, below, above);
    }

    /// Computes the rows from the cells of a window to the obstacles of a grid whose cell (0, 0)
    /// is at `origin`; there are no others.
    pub(super) fn of_grid(grid: &BitGrid, origin: Cell, window: CellWindow) -> Self {
        let CellWindow { low, high } = window;
        let far = vec![FAR_ROWS; (high.x - low.x + 1) as usize];
        let within = CellWindow {
            low: Cell::new(low.x - origin.x, low.y - origin.y),
            high: Cell::new(high.x - origin.x, high.y - origin.y),
        };
        let mut columns = Self::default();
        columns.between(grid, within, far.clone(), far);
        Self { low_y: low.y, ..columns }
    }

    /// Computes the rows to the obstacles within a window and to those outside, given their rows
    /// from the row below the window and from the row above it.
    fn between(
        &mut self,
        grid: &BitGrid,
        window: CellWindow,
        mut below: Vec<i16>,
        mut above: Vec<i16>,
    ) {
        let CellWindow { low, high } = window;
        self.low_y = low.y;
        self.width = below.len();
        self.rows.resize(self.width * (high.y - low.y + 1) as usize, 0);
        for (y, row) in (low.y..).zip(self.rows.chunks_mut(self.width)) {
            step(&mut below);
            for x in grid.ones_in_span(y, low.x, high.x) {
                below[(x - low.x) as usize] = 0;
            }
            row.copy_from_slice(&below);
        }
        for row in self.rows.chunks_mut(self.width).rev() {
            step(&mut above);
            for (rows, above) in row.iter_mut().zip(&mut above) {
                // An obstacle is 0 rows away, in either direction.
                *above = (*above).min(*rows);
                *rows = *above;
            }
        }
    }

    /// Row `y` of the window.
    pub(super) fn row(&self, y: i32) -> &[i16] {
        let start = (y - self.low_y) as usize * self.width;
        &self.rows[start..start + self.width]
    }
}
