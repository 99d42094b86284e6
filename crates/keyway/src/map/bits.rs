//! One bit per cell, in padded rows of 64-bit words.

use super::Cell;
use super::frame::is_size;
use serde::{Deserialize, Serialize};

/// A bit for every cell of a `width` x `height` grid, and a border of one padding cell around it.
///
/// Rows are runs of whole words, so that a scan reads 64 cells at a time. Cell (x, y) is bit
/// `(y + 1) * stride + x + 1`: neighbours of every real cell can be read without bounds checks of
/// their own. All padding bits have one value, given when the grid is made. Memory: one bit per
/// padded cell.
///
/// Serialised as run lengths, row by row from the bottom, alternating between clear and set bits;
/// the first run is of clear ones.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "BitRuns", into = "BitRuns")]
pub struct BitGrid {
    width: u32,
    height: u32,
    words_per_row: usize,
    padding: bool,
    words: Vec<u64>,
}

/// Run-length encoding of a grid of bits.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BitRuns {
    width: u32,
    height: u32,
    padding: bool,
    /// Lengths of runs, alternating: of 0, of 1, of 0 and so on.
    runs: Vec<u64>,
}

impl From<BitGrid> for BitRuns {
    fn from(grid: BitGrid) -> Self {
        let (mut runs, mut value) = (vec![0], false);
        for y in 0..grid.height as i32 {
            for x in 0..grid.width as i32 {
                if grid.get(Cell::new(x, y)) != value {
                    runs.push(0);
                    value = !value;
                }
                if let Some(last) = runs.last_mut() {
                    *last += 1;
                }
            }
        }
        Self { width: grid.width, height: grid.height, padding: grid.padding, runs }
    }
}

impl TryFrom<BitRuns> for BitGrid {
    type Error = String;

    fn try_from(given: BitRuns) -> Result<Self, String> {
        let BitRuns { width, height, padding, runs } = given;
        let (columns, rows) = (u64::from(width), u64::from(height));
        let sum = runs.iter().try_fold(0u64, |sum, &run| sum.checked_add(run));
        if !is_size(columns, rows) || sum != Some(columns * rows) {
            return Err(format!("the runs of a grid of {width} x {height} cells do not fill it"));
        }
        let mut grid = Self::new(width, height, padding);
        let mut at = 0u64;
        for (index, run) in runs.into_iter().enumerate() {
            if index % 2 == 1 {
                grid.fill_run(at, run);
            }
            at += run;
        }
        Ok(grid)
    }
}

/// A range of columns in a grid: up to two words, and a mask for each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns {
    first: usize,
    last: usize,
    masks: [u64; 2],
}

impl BitGrid {
    /// Creates a grid with all cells `false` and the given padding.
    pub fn new(width: u32, height: u32, padding: bool) -> Self {
        let words_per_row = (width as usize + 2).div_ceil(64);
        let fill = if padding { u64::MAX } else { 0 };
        // One word more than the rows need, so that an unaligned read never leaves the vector.
        let mut words = vec![fill; words_per_row * (height as usize + 2) + 1];
        if padding {
            for y in 0..height as usize {
                let row = &mut words[(y + 1) * words_per_row..(y + 2) * words_per_row];
                clear_range(row, 1, 1 + width as usize);
            }
        }
        Self { width, height, words_per_row, padding, words }
    }

    /// Sets `count` cells from index `from` on, row by row from the bottom.
    fn fill_run(&mut self, from: u64, count: u64) {
        let width = u64::from(self.width);
        let (mut at, end) = (from, from + count);
        while at < end {
            let (y, x) = (at / width, at % width);
            let last = (x + end - at).min(width) - 1;
            self.fill_span(y as i32, x as i32, last as i32);
            at += last + 1 - x;
        }
    }

    /// Columns, without padding.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows, without padding.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The value of all padding bits.
    pub const fn padding(&self) -> bool {
        self.padding
    }

    /// Memory on the heap \[bytes\].
    pub const fn memory_bytes(&self) -> usize {
        size_of::<u64>() * self.words.capacity()
    }

    /// Bits from one row to the next in [`Self::words`].
    pub(crate) const fn stride(&self) -> usize {
        self.words_per_row * 64
    }

    /// All words, padding rows included, and one word more at the end.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// The words of row `y` (-1 and `height` are the padding rows); column x is bit x + 1.
    pub fn row(&self, y: i32) -> &[u64] {
        let start = (y + 1) as usize * self.words_per_row;
        &self.words[start..start + self.words_per_row]
    }

    fn row_mut(&mut self, y: i32) -> &mut [u64] {
        let start = (y + 1) as usize * self.words_per_row;
        &mut self.words[start..start + self.words_per_row]
    }

    /// True for a cell of the grid.
    pub fn contains(&self, cell: Cell) -> bool {
        cell.x >= 0 && cell.y >= 0 && (cell.x as u32) < self.width && (cell.y as u32) < self.height
    }

    /// The bit of a cell; outside the grid the value of the padding.
    pub fn get(&self, cell: Cell) -> bool {
        if self.contains(cell) {
            let bit = (cell.x + 1) as usize;
            self.row(cell.y)[bit / 64] >> (bit % 64) & 1 == 1
        } else {
            self.padding
        }
    }

    /// Sets the bit of a cell; returns true if it changed. Ignores cells outside the grid.
    pub fn set(&mut self, cell: Cell, value: bool) -> bool {
        if !self.contains(cell) {
            return false;
        }
        let bit = (cell.x + 1) as usize;
        let word = &mut self.row_mut(cell.y)[bit / 64];
        let before = *word;
        let mask = 1 << (bit % 64);
        *word = if value { before | mask } else { before & !mask };
        *word != before
    }

    /// Sets the bits of columns `from..=to` in row `y`, clipped to the grid.
    pub fn fill_span(&mut self, y: i32, from: i32, to: i32) {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        if y < 0 || y >= self.height as i32 || from > to {
            return;
        }
        set_range(self.row_mut(y), (from + 1) as usize, (to + 2) as usize);
    }

    /// Clears the bits of row `y` outside columns `from..=to`; clears the whole row if that range
    /// is empty.
    pub(crate) fn keep_span(&mut self, y: i32, from: i32, to: i32) {
        let width = self.width as i32;
        if y < 0 || y >= self.height as i32 {
            return;
        }
        let row = self.row_mut(y);
        let (from, to) = (from.clamp(0, width), to.saturating_add(1).clamp(0, width));
        for (from, to) in [(0, from), (to, width)] {
            if from < to {
                clear_range(row, (from + 1) as usize, (to + 1) as usize);
            }
        }
    }

    /// Sets the bits of row `y` to those of another grid of the same size and padding.
    pub(crate) fn copy_row(&mut self, y: i32, other: &Self) {
        self.row_mut(y).copy_from_slice(other.row(y));
    }

    /// Overwrites one word of row `y`, padding included.
    pub(crate) fn set_word(&mut self, y: i32, word: usize, value: u64) {
        self.row_mut(y)[word] = value;
    }

    /// Sets the bits of row `y` that are set in `words`, laid out like [`Self::row`]. Bits in the
    /// padding must have its value, or be 0 where it is 1.
    pub(crate) fn merge_row(&mut self, y: i32, words: &[u64]) {
        for (own, new) in self.row_mut(y).iter_mut().zip(words) {
            *own |= new;
        }
    }

    /// Sets every bit that is set in `other`, a grid of the same size and padding.
    ///
    /// # Panics
    /// Panics if the sizes differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!((self.width, self.height), (other.width, other.height), "grids differ in size");
        for (own, new) in self.words.iter_mut().zip(&other.words) {
            *own |= new;
        }
    }

    /// True if a bit is set among columns `from..=to` of row `y`, clipped to the grid.
    pub fn any_in_span(&self, y: i32, from: i32, to: i32) -> bool {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        if y < 0 || y >= self.height as i32 || from > to {
            return false;
        }
        let row = self.row(y);
        let (first, last) = ((from + 1) as usize, (to + 1) as usize);
        (first / 64..=last / 64).any(|word| {
            let low = if word == first / 64 { u64::MAX << (first % 64) } else { u64::MAX };
            let high = if word == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
            row[word] & low & high != 0
        })
    }

    /// Columns `from..=to`, clipped to the grid, for queries on many rows. `None` if they span
    /// more than two words, or the range is empty.
    pub(crate) fn columns(&self, from: i32, to: i32) -> Option<Columns> {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        // The requested column may be the largest number of its type.
        if from > to {
            return None;
        }
        let (first, last) = ((from + 1) as usize, (to + 1) as usize);
        let word = first / 64;
        if last / 64 > word + 1 {
            return None;
        }
        let (low, high) = (u64::MAX << (first % 64), u64::MAX >> (63 - last % 64));
        let masks = if last / 64 == word { [low & high, 0] } else { [low, high] };
        Some(Columns { first: word, last: last / 64, masks })
    }

    /// True if a bit is set in one of these columns of row `y` of the grid.
    pub(crate) fn any_in_columns(&self, y: i32, columns: &Columns) -> bool {
        let start = (y + 1) as usize * self.words_per_row;
        let word = |number: usize| self.words[start + number];
        word(columns.first) & columns.masks[0] | word(columns.last) & columns.masks[1] != 0
    }

    /// Cells whose bits are set, row by row from the bottom.
    pub fn ones(&self) -> impl Iterator<Item = Cell> + '_ {
        let last = self.width as i32 - 1;
        (0..self.height as i32)
            .flat_map(move |y| self.ones_in_span(y, 0, last).map(move |x| Cell::new(x, y)))
    }

    /// Columns of the set bits among columns `from..=to` of row `y` (clipped to the grid), in
    /// order. Empty words cost one test per 64 cells.
    pub fn ones_in_span(&self, y: i32, from: i32, to: i32) -> impl Iterator<Item = i32> + '_ {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        let words: &[u64] = if y < 0 || y >= self.height as i32 || from > to {
            &[]
        } else {
            let row = self.row(y);
            &row[(from + 1) as usize / 64..=(to + 1) as usize / 64]
        };
        // The requested column may be the largest number of its type.
        let first = from.saturating_add(1) / 64;
        words.iter().enumerate().flat_map(move |(i, &word)| {
            let base = (first + i as i32) * 64 - 1;
            let mut rest = word;
            if base < from {
                rest &= u64::MAX << (from - base);
            }
            if base + 63 > to {
                rest &= u64::MAX >> (base + 63 - to);
            }
            std::iter::from_fn(move || {
                (rest != 0).then(|| {
                    let bit = rest.trailing_zeros() as i32;
                    rest &= rest - 1;
                    base + bit
                })
            })
        })
    }

    /// Visits the columns of [`Self::ones_in_span`] until `visit` returns false; returns true if
    /// it never did.
    pub(crate) fn all_ones_in_span(
        &self,
        y: i32,
        from: i32,
        to: i32,
        mut visit: impl FnMut(i32) -> bool,
    ) -> bool {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        if y < 0 || y >= self.height as i32 || from > to {
            return true;
        }
        let (first, last) = ((from + 1) as usize, (to + 1) as usize);
        let start = (y + 1) as usize * self.words_per_row;
        let mut low = u64::MAX << (first % 64);
        for word in first / 64..=last / 64 {
            let high = if word == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
            let mut rest = self.words[start + word] & low & high;
            while rest != 0 {
                if !visit((word * 64) as i32 + rest.trailing_zeros() as i32 - 1) {
                    return false;
                }
                rest &= rest - 1;
            }
            low = u64::MAX;
        }
        true
    }

    /// Numbers of consecutive set cells directly to the left and to the right of a cell of the
    /// grid.
    pub(crate) fn ones_beside(&self, cell: Cell) -> (i32, i32) {
        let row = self.row(cell.y);
        let (at, width) = ((cell.x + 1) as usize, self.width as usize);
        // The nearest clear bits on both sides, excluding the cell's own.
        let (low, high) = ((1 << (at % 64)) - 1, !1 << (at % 64));
        let last = |word: usize, zeros: u64| word * 64 + 63 - zeros.leading_zeros() as usize;
        let first = |word: usize, zeros: u64| word * 64 + zeros.trailing_zeros() as usize;
        let zeros = |word: usize, mask: u64| Some(!row[word] & mask).filter(|&zeros| zeros != 0);
        let own = at / 64;
        let left = zeros(own, low).map(|bits| last(own, bits)).or_else(|| {
            (0..own).rev().find_map(|word| zeros(word, u64::MAX).map(|bits| last(word, bits)))
        });
        let right = zeros(own, high).map(|bits| first(own, bits)).or_else(|| {
            (own + 1..row.len())
                .find_map(|word| zeros(word, u64::MAX).map(|bits| first(word, bits)))
        });
        let (left, right) = (left.unwrap_or(0), right.unwrap_or(width + 1).min(width + 1));
        ((at - 1 - left) as i32, (right - 1 - at) as i32)
    }

    /// Number of set bits among columns `from..=to` of row `y`, clipped to the grid.
    pub(crate) fn count_in_span(&self, y: i32, from: i32, to: i32) -> u32 {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        if y < 0 || y >= self.height as i32 || from > to {
            return 0;
        }
        let (row, mut count) = (self.row(y), 0);
        for_each_word((from + 1) as usize, (to + 2) as usize, |word, mask| {
            count += (row[word] & mask).count_ones();
        });
        count
    }

    /// The first set column among columns `from..=to` of row `y`, clipped to the grid.
    pub(crate) fn first_one_in_span(&self, y: i32, from: i32, to: i32) -> Option<i32> {
        self.ones_in_span(y, from, to).next()
    }

    /// The last set column among columns `from..=to` of row `y`, clipped to the grid.
    pub(crate) fn last_one_in_span(&self, y: i32, from: i32, to: i32) -> Option<i32> {
        let (from, to) = (from.max(0), to.min(self.width as i32 - 1));
        if y < 0 || y >= self.height as i32 || from > to {
            return None;
        }
        let row = self.row(y);
        let (first, last) = ((from + 1) as usize, (to + 1) as usize);
        for word in (first / 64..=last / 64).rev() {
            let mut bits = row[word];
            if word == first / 64 {
                bits &= u64::MAX << (first % 64);
            }
            if word == last / 64 {
                bits &= u64::MAX >> (63 - last % 64);
            }
            if bits != 0 {
                return Some((word * 64 + 63 - bits.leading_zeros() as usize) as i32 - 1);
            }
        }
        None
    }

    /// Number of set cells (padding not counted).
    pub fn count_ones(&self) -> u64 {
        let ones = |y| self.row(y).iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        let padding = if self.padding { self.stride() as u64 - u64::from(self.width) } else { 0 };
        (0..self.height as i32).map(|y| ones(y) - padding).sum()
    }

    /// The same bits with columns and rows exchanged: block by block of 64 x 64 bits, each with
    /// some 400 word operations.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut turned = Self::new(self.height, self.width, self.padding);
        let (columns, rows) = (turned.words.len() - 1, self.words.len() - 1);
        for down in 0..turned.words_per_row {
            for along in 0..self.words_per_row {
                // Rows beyond the grid have the padding's value in every bit.
                let mut block = [if self.padding { u64::MAX } else { 0 }; 64];
                let first = down * 64 * self.words_per_row + along;
                let from = (first..rows).step_by(self.words_per_row);
                for (word, i) in block.iter_mut().zip(from) {
                    *word = self.words[i];
                }
                transpose_block(&mut block);
                let first = along * 64 * turned.words_per_row + down;
                let to = (first..columns).step_by(turned.words_per_row);
                for (word, i) in block.iter().zip(to) {
                    turned.words[i] = *word;
                }
            }
        }
        turned
    }
}

/// Exchanges rows and columns of 64 x 64 bits: halves are exchanged across the diagonal, then
/// quarters within them, down to single bits (H. Warren, "Hacker's Delight", 2nd edition, section
/// 7-3).
fn transpose_block(block: &mut [u64; 64]) {
    let (mut half, mut low) = (32, u64::from(u32::MAX));
    while half != 0 {
        let mut row = 0;
        while row < 64 {
            let swapped = (block[row] >> half ^ block[row + half]) & low;
            block[row] ^= swapped << half;
            block[row + half] ^= swapped;
            // The next row in the upper part of a pair.
            row = (row + half + 1) & !half;
        }
        half /= 2;
        low ^= low << half;
    }
}

fn set_range(row: &mut [u64], from: usize, to: usize) {
    for_each_word(from, to, |word, mask| row[word] |= mask);
}

fn clear_range(row: &mut [u64], from: usize, to: usize) {
    for_each_word(from, to, |word, mask| row[word] &= !mask);
}

/// Calls `apply(word, mask)` for the words that hold the bits `from..to` (not empty).
fn for_each_word(from: usize, to: usize, mut apply: impl FnMut(usize, u64)) {
    let (first, last) = (from / 64, (to - 1) / 64);
    for word in first..=last {
        let low = if word == first { u64::MAX << (from % 64) } else { u64::MAX };
        let high = if word == last { u64::MAX >> (63 - (to - 1) % 64) } else { u64::MAX };
        apply(word, low & high);
    }
}

#[cfg(test)]
#[path = "bits_tests.rs"]
mod tests;
