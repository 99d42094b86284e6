//! Along one row of a whole field: where obstacles are dense, columns nearby are simply compared.
//!
//! The lower envelope takes its steps one by one, with branches that nobody can foretell in clutter.
//! Where every obstacle that matters is a few columns away, comparing each cell with each of those
//! columns, eight cells an instruction, needs a tenth of the time.

use super::envelope::{Envelope, FAR_ROWS, Parabola};
use std::ops::Range;

/// Cells that are taken together: as many columns are compared as the worst of them needs.
const BLOCK: usize = 64;
/// Columns to each side that are compared at most; measured.
const NEAR_COLUMNS: usize = 16;
/// Squares of more rows than this do not fit 16 bits; they are too large to matter here.
const NEAR_ROWS: i16 = 90;
/// With fewer steps than this in a block its envelope is cheaper.
const MANY_STEPS: i16 = 12;
/// A row in which one block in so many has many steps is left to the envelope as a whole.
const FEW_BLOCKS: usize = 8;

/// Stands for the largest value of a block that is left to the envelope.
const NOT_NEAR: i32 = -1;

/// Scratch memory for rows, and what is known from the row before.
pub(super) struct RowScratch {
    hull: Vec<Parabola>,
    /// Squares of the rows to each column's obstacle, with [`NEAR_COLUMNS`] more at both ends.
    squares: Vec<i16>,
    /// The rows, without those that are too many to matter.
    rows: Vec<i16>,
    /// No cell of the next row is farther than this from its nearest obstacle.
    most_rows: i16,
    /// The largest value of each block in the row before; 0 when it is not known.
    largest: Vec<i32>,
}

impl Default for RowScratch {
    fn default() -> Self {
        Self {
            hull: Vec::new(),
            squares: Vec::new(),
            rows: Vec::new(),
            most_rows: FAR_ROWS,
            largest: Vec::new(),
        }
    }
}

impl RowScratch {
    /// Forgets the row before.
    pub(super) fn start(&mut self) {
        self.most_rows = FAR_ROWS;
        self.largest.clear();
    }
}

/// True when the values change in many places.
fn is_dense(rows: &[i16]) -> bool {
    let pairs = rows[..rows.len() - 1].iter().zip(&rows[1..]);
    pairs.map(|(left, right)| i16::from(left != right)).sum::<i16>() >= MANY_STEPS
}

impl Envelope {
    /// Squared distances of the columns `own` of a row, from the rows to each column's nearest
    /// obstacle. Between two calls without [`RowScratch::start`] lies one row.
    pub(super) fn row(
        &self,
        rows: &[i16],
        own: Range<usize>,
        out: &mut [i32],
        scratch: &mut RowScratch,
    ) {
        let pairs = &rows[own.start..rows.len().min(own.end + 1)];
        let blocks = pairs.windows(BLOCK + 1).step_by(BLOCK).filter(|block| is_dense(block));
        if BLOCK * FEW_BLOCKS * blocks.count() <= own.len() {
            self.part(rows, own, out, &mut scratch.hull);
            scratch.start();
            return;
        }
        // A column whose obstacle is farther away than any cell's nearest one is nobody's nearest;
        // between two such columns is then no step.
        let most = scratch.most_rows;
        let near = |&rows: &i16| if rows > most { FAR_ROWS } else { rows };
        scratch.rows.clear();
        scratch.rows.extend(rows.iter().map(near));
        self.square(scratch);
        self.blocks(own, out, scratch);
        let largest = scratch.largest.iter().copied().max().unwrap_or(0);
        // A row further all distances are at most a cell larger.
        let half_cells = f64::from(largest).sqrt().ceil() as i32 + 2;
        scratch.most_rows = ((half_cells + 1) / 2).min(i32::from(FAR_ROWS)) as i16;
    }

    /// Compares columns in dense blocks; the runs of other blocks between are left to the envelope.
    fn blocks(&self, own: Range<usize>, out: &mut [i32], scratch: &mut RowScratch) {
        let RowScratch { hull, squares, rows, largest, .. } = scratch;
        let (first, last) = (own.start, own.end - BLOCK);
        largest.resize(own.len().div_ceil(BLOCK), 0);
        // From one row to the next no distance changes by more than a cell.
        let hopeless = self.to.half_cells_sq(NEAR_COLUMNS as i16 + 1);
        let mut rest = first..first;
        for (start, largest) in (first..).step_by(BLOCK).zip(largest.iter_mut()) {
            // The last block overlaps the one before.
            let start = start.min(last);
            let end = start + BLOCK;
            let is_near = *largest <= hopeless && is_dense(&rows[start..rows.len().min(end + 1)]);
            let columns = &squares[start..end + 2 * NEAR_COLUMNS];
            let out_of_block = start - first..end - first;
            let found = is_near.then(|| self.compare(columns, &mut out[out_of_block]));
            if let Some(found) = found.flatten() {
                *largest = found;
                self.rest(rows, rest, first, out, hull);
                rest = end..end;
            } else {
                *largest = NOT_NEAR;
                rest.end = end;
            }
        }
        self.rest(rows, rest, first, out, hull);
        for (start, largest) in (0..).step_by(BLOCK).zip(largest) {
            if *largest == NOT_NEAR {
                let block = &out[start.min(last - first)..][..BLOCK];
                *largest = block.iter().fold(0, |largest, &value| value.max(largest));
            }
        }
    }

    /// The envelope of a run of blocks, if there is one; `out` starts with column `first`.
    fn rest(
        &self,
        rows: &[i16],
        run: Range<usize>,
        first: usize,
        out: &mut [i32],
        hull: &mut Vec<Parabola>,
    ) {
        if !run.is_empty() {
            let out = &mut out[run.start - first..run.end - first];
            self.part(rows, run, out, hull);
        }
    }

    fn square(&self, scratch: &mut RowScratch) {
        let edge = i16::from(self.to == super::DistanceTo::Squares);
        scratch.squares.clear();
        scratch.squares.resize(scratch.rows.len() + 2 * NEAR_COLUMNS, i16::MAX);
        for (square, &rows) in scratch.squares[NEAR_COLUMNS..].iter_mut().zip(&scratch.rows) {
            let half_cells = (2 * rows.min(NEAR_ROWS) - edge).max(0);
            *square = half_cells * half_cells;
        }
    }

    /// The distances of a block, from the squares of its columns and of [`NEAR_COLUMNS`] to both
    /// sides, and the largest of them; `None` when farther columns might matter.
    fn compare(&self, squares: &[i16], out: &mut [i32]) -> Option<i32> {
        let mut best = [0_i16; BLOCK];
        best.copy_from_slice(&squares[NEAR_COLUMNS..NEAR_COLUMNS + BLOCK]);
        for away in 1..=NEAR_COLUMNS {
            let along = self.to.half_cells_sq(away as i16) as i16;
            let largest = best.iter().fold(0, |largest: i16, &value| largest.max(value));
            if largest <= along {
                for (out, &best) in out.iter_mut().zip(&best) {
                    *out = i32::from(best).min(self.limit_sq);
                }
                return Some(i32::from(largest));
            }
            let left = &squares[NEAR_COLUMNS - away..][..BLOCK];
            let right = &squares[NEAR_COLUMNS + away..][..BLOCK];
            for (best, (&left, &right)) in best.iter_mut().zip(left.iter().zip(right)) {
                *best = (*best).min(left.min(right).saturating_add(along));
            }
        }
        None
    }

    /// The distances of some columns of a row by the lower envelope.
    fn part(&self, rows: &[i16], own: Range<usize>, out: &mut [i32], hull: &mut Vec<Parabola>) {
        for (value, &rows) in out.iter_mut().zip(&rows[own.clone()]) {
            *value = self.to.half_cells_sq(rows).min(self.limit_sq);
        }
        let (from, to) = self.sources(rows, own.clone());
        self.lower_beside(&rows[from..to], from as i64 - own.start as i64, out, hull);
    }

    /// The columns whose obstacles may be the nearest ones to `own`: one beyond an end must be nearer
    /// to the end than any before it.
    fn sources(&self, rows: &[i16], own: Range<usize>) -> (usize, usize) {
        let count = |end: i16, beyond: &mut dyn Iterator<Item = &i16>| {
            let mut best = self.to.half_cells_sq(end);
            let nearer = |(away, &rows): (i16, &i16)| {
                let along = self.to.half_cells_sq(away);
                let is_nearer = along < best;
                best = best.min(along + self.to.half_cells_sq(rows));
                is_nearer.then_some(())
            };
            (1..FAR_ROWS).zip(beyond).map_while(nearer).count()
        };
        let left = count(rows[own.start], &mut rows[..own.start].iter().rev());
        let right = count(rows[own.end - 1], &mut rows[own.end..].iter());
        (own.start - left, own.end + right)
    }
}
