//! The cells around an obstacle cell that it blocks.

use crate::ConfigError;
use crate::map::{BitGrid, Cell};

/// Relative tolerance for comparing a clearance with a distance: both are sums and products of
/// decimal fractions, and 0.225 m must equal 4.5 cells of 0.05 m.
pub(crate) const CLEARANCE_TOLERANCE: f64 = 1e-9;

/// Largest allowed reach of a neighbourhood around an obstacle \[cells\].
const MAX_REACH_CELLS: f64 = 100_000.0;

/// Rejects a field's value if its neighbourhood exceeds the largest allowed reach.
pub(in crate::map) fn check_reach(
    field: &str,
    reach_cells: f64,
    value: f64,
) -> Result<(), ConfigError> {
    if (0.0..=MAX_REACH_CELLS).contains(&reach_cells) {
        return Ok(());
    }
    let expected = "a length of at least 0 and at most 100000 cells";
    Err(ConfigError::must_be(field, expected, value))
}

/// The neighbourhood of cells that an obstacle cell blocks: symmetric in both axes and under
/// their exchange, and without gaps in a row.
///
/// `half_widths[k]` is the largest |dx| that is blocked in the rows k above and k below.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BlockedNeighbourhood {
    half_widths: Vec<i32>,
}

impl BlockedNeighbourhood {
    /// Cells whose offset (dx, dy >= 0) satisfies `blocked`, which must shrink monotonically in
    /// |dx| and |dy|, and the obstacle cell itself; at most `side` columns and rows away.
    fn new(side: i32, blocked: impl Fn(i32, i32) -> bool) -> Self {
        let mut half_widths = Vec::new();
        let mut half_width = side;
        for dy in (0..=side).take_while(|&dy| dy == 0 || blocked(0, dy)) {
            // No row is wider than the one before it.
            while half_width > 0 && !blocked(half_width, dy) {
                half_width -= 1;
            }
            half_widths.push(half_width);
        }
        Self { half_widths }
    }

    /// Cells whose centre is nearer than `clearance_cells` to the obstacle's square, on a map whose
    /// longer side has `side` cells.
    pub(crate) fn disc(clearance_cells: f64, side: i32) -> Self {
        let limit = clearance_cells * (1.0 - CLEARANCE_TOLERANCE);
        let beyond = |offset: i32| (f64::from(offset) - 0.5).max(0.0);
        Self::new(side, |dx, dy| {
            let (x, y) = (beyond(dx), beyond(dy));
            x * x + y * y < limit * limit
        })
    }

    /// The square of cells at most `cells` columns and rows away (1: the 8 neighbours), on a map
    /// whose longer side has `side` cells.
    pub(crate) fn square(cells: u32, side: i32) -> Self {
        let cells = cells.min(side as u32) as i32;
        Self { half_widths: vec![cells; cells as usize + 1] }
    }

    /// Cells whose centre is nearer than `distance_cells` to the obstacle's centre in the L1 norm,
    /// on a map whose longer side has `side` cells.
    pub(crate) fn diamond(distance_cells: f64, side: i32) -> Self {
        let limit = distance_cells * (1.0 - CLEARANCE_TOLERANCE);
        Self::new(side, |dx, dy| f64::from(dx + dy) < limit)
    }

    /// Cells that either neighbourhood blocks.
    #[must_use]
    pub(crate) fn union(mut self, other: &Self) -> Self {
        for (i, &width) in other.half_widths.iter().enumerate() {
            match self.half_widths.get_mut(i) {
                Some(own) => *own = (*own).max(width),
                None => self.half_widths.push(width),
            }
        }
        self
    }

    /// Number of rows (and columns) that it reaches to either side.
    pub(crate) fn reach(&self) -> i32 {
        self.half_widths.len() as i32 - 1
    }

    /// Row offsets, each with its half width.
    fn rows(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        let reach = self.reach();
        (-reach..=reach).map(|dy| (dy, self.half_widths[dy.unsigned_abs() as usize]))
    }

    /// Sets every bit of `target` (whose padding is set) that some obstacle blocks, 64 cells at a
    /// time.
    pub(crate) fn stamp_all(&self, obstacles: &BitGrid, target: &mut BitGrid) {
        let (height, reach) = (obstacles.height() as i32, self.reach());
        let mut wide = vec![0; obstacles.row(0).len()];
        let mut scratch = wide.clone();
        // Rows of the target without a free cell, in which nothing changes.
        let mut is_full = vec![false; height as usize];
        for y in 0..height {
            wide.copy_from_slice(obstacles.row(y));
            let rows = &is_full[(y - reach).max(0) as usize..=(y + reach).min(height - 1) as usize];
            if wide.iter().all(|&word| word == 0) || rows.iter().all(|&is_full| is_full) {
                continue;
            }
            // Farthest rows first: their spans are the narrowest, and each is widened to the
            // next.
            let mut width = 0;
            for dy in (0..=reach).rev() {
                let half = self.half_widths[dy as usize];
                widen(&mut wide, half - width, &mut scratch);
                width = half;
                for row in [y - dy, y + dy] {
                    if row >= 0 && row < height && !is_full[row as usize] {
                        target.merge_row(row, &wide);
                        is_full[row as usize] = reach >= WIDE_REACH && is_all_set(target.row(row));
                    }
                }
            }
        }
    }

    /// Sets every bit of `target` that an obstacle in `cell` blocks.
    pub(crate) fn stamp(&self, cell: Cell, target: &mut BitGrid) {
        for (dy, half) in self.rows() {
            target.fill_span(cell.y + dy, cell.x - half, cell.x + half);
        }
    }

    /// Largest reach for which [`Self::word`] reads all obstacles that block.
    pub(crate) const MOST_WORD_REACH: i32 = 63;

    /// The bits of a word of row `y` that some obstacle blocks: column x is bit x + 1 of the row.
    /// Rows near `y` are widened to each other's widths, the nearest ones first: theirs are the
    /// widest. For a reach of at most [`Self::MOST_WORD_REACH`].
    pub(crate) fn word(&self, obstacles: &BitGrid, y: i32, word: usize) -> u64 {
        // The word itself and one to each side, as nothing reaches farther.
        let mut wide = [0_u64; 3];
        let places = [word.checked_sub(1), Some(word), Some(word + 1)];
        let merge = |y: i32, wide: &mut [u64; 3]| {
            if y < 0 || y >= obstacles.height() as i32 {
                return;
            }
            let row = obstacles.row(y);
            for (place, wide) in places.into_iter().zip(wide) {
                *wide |= place.and_then(|place| row.get(place)).copied().unwrap_or_default();
            }
        };
        for (dy, &half) in self.half_widths.iter().enumerate() {
            for row in [y - dy as i32, y + dy as i32] {
                merge(row, &mut wide);
            }
            let next = self.half_widths.get(dy + 1).copied().unwrap_or_default();
            for _ in next..half {
                let [low, own, high] = wide;
                wide = [
                    low | low << 1 | low >> 1 | own << 63,
                    own | own << 1 | own >> 1 | low >> 63 | high << 63,
                    high | high << 1 | high >> 1 | own >> 63,
                ];
            }
        }
        wide[1]
    }

    /// True if some obstacle blocks `cell`.
    pub(crate) fn is_blocked(&self, cell: Cell, obstacles: &BitGrid) -> bool {
        self.rows()
            .any(|(dy, half)| obstacles.any_in_span(cell.y + dy, cell.x - half, cell.x + half))
    }
}

/// Reach from which on rows often become full, so that a check pays off \[cells\].
const WIDE_REACH: i32 = 64;

fn is_all_set(words: &[u64]) -> bool {
    words.iter().all(|&word| word == u64::MAX)
}

/// Sets every bit at most `by` places from a set one.
fn widen(words: &mut [u64], by: i32, scratch: &mut [u64]) {
    let mut reached = 0;
    while reached < by {
        // Copies shifted by up to 2 reached + 1 leave no gap.
        let shift = (by - reached).min(2 * reached + 1);
        scratch.copy_from_slice(words);
        or_shifted(words, scratch, shift as usize);
        reached += shift;
    }
}

/// ORs `source` into `target`, shifted by `shift` places both ways.
fn or_shifted(target: &mut [u64], source: &[u64], shift: usize) {
    let (whole, bits) = (shift / 64, shift % 64);
    // The upper part of a word moves on to the next one; two shifts, as one by 64 is undefined.
    let carried = |word: u64| word >> 1 >> (63 - bits);
    let carried_down = |word: u64| word << 1 << (63 - bits);
    for (i, &word) in source.iter().enumerate() {
        for (to, part) in [(i + whole, word << bits), (i + whole + 1, carried(word))] {
            if let Some(slot) = target.get_mut(to) {
                *slot |= part;
            }
        }
        if let Some(to) = i.checked_sub(whole) {
            target[to] |= word >> bits;
            if let Some(before) = to.checked_sub(1) {
                target[before] |= carried_down(word);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disc_is_measured_to_the_square() {
        // The centre of the neighbour is half a cell from the square, of the diagonal one 0.707.
        assert_eq!(BlockedNeighbourhood::disc(0.0, 99).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::disc(0.5, 99).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::disc(0.6, 99).half_widths, [1, 0]);
        assert_eq!(BlockedNeighbourhood::disc(0.8, 99).half_widths, [1, 1]);
        // 0.225 m on 0.05 m cells: exactly 4.5 cells, so the fifth neighbour is free.
        assert_eq!(BlockedNeighbourhood::disc(0.225 / 0.05, 99).half_widths[0], 4);
    }

    #[test]
    fn square_diamond_and_union() {
        assert_eq!(BlockedNeighbourhood::square(1, 99).half_widths, [1, 1]);
        assert_eq!(BlockedNeighbourhood::square(0, 99).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::diamond(2.0, 99).half_widths, [1, 0]);
        assert_eq!(BlockedNeighbourhood::diamond(0.0, 99).half_widths, [0]);
        let both =
            BlockedNeighbourhood::square(1, 99).union(&BlockedNeighbourhood::diamond(4.0, 99));
        assert_eq!(both.half_widths, [3, 2, 1, 0]);
    }

    /// A neighbourhood contains no cells farther away than the map is wide.
    #[test]
    fn no_larger_than_the_map() {
        let whole = BlockedNeighbourhood { half_widths: vec![32; 33] };
        assert_eq!(BlockedNeighbourhood::disc(1e5, 32), whole);
        assert_eq!(BlockedNeighbourhood::disc(f64::INFINITY, 32), whole);
        assert_eq!(BlockedNeighbourhood::square(u32::MAX, 32), whole);
        assert_eq!(BlockedNeighbourhood::diamond(1e5, 32), whole);
        assert_eq!(BlockedNeighbourhood::diamond(4.0, 2).half_widths, [2, 2, 1]);
    }

    #[test]
    fn stamping_all_is_stamping_each() {
        for (width, clearance) in [(300, 0.0), (300, 3.3), (200, 70.0), (64, 9.0), (1, 2.0)] {
            let mut obstacles = BitGrid::new(width, 9, false);
            for i in 0..40_i32 {
                obstacles.set(Cell::new((i * i * 7 + i) % width as i32, i % 5), i % 3 == 0);
            }
            let neighbourhood = BlockedNeighbourhood::disc(clearance, width.max(9) as i32);
            let mut all = BitGrid::new(width, 9, true);
            let mut each = all.clone();
            neighbourhood.stamp_all(&obstacles, &mut all);
            for y in 0..9 {
                for x in obstacles.ones_in_span(y, 0, width as i32) {
                    neighbourhood.stamp(Cell::new(x, y), &mut each);
                }
            }
            assert_eq!(all, each, "{width} columns, clearance {clearance}");
        }
    }
}
