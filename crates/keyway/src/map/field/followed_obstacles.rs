//! Distances along one row: each obstacle is followed to both sides as far as it is the nearest
//! one.
//!
//! The lower envelope processes its parabolas one by one, with divisions and branches that no
//! processor can predict. Here squares are numbers of 16 bits, and a parabola lowers eight cells
//! per instruction, until they are as low already. Distances too large for 16 bits are left to
//! the envelope.

use super::DistanceTo;
use super::envelope::{Envelope, Parabola};
use super::squares_16_bit::{FAR, NEAR_ROWS, RUN, lower};
use std::ops::Range;

/// Number of columns that are processed together.
const BLOCK: usize = 64;
/// Largest number of columns from a cell beside a far one to its nearest obstacle.
const NEAR_COLUMNS: usize = NEAR_ROWS as usize + 1;
/// Largest number of blocks between a column and its near obstacles.
const NEAR_BLOCKS: usize = (NEAR_ROWS as usize).div_ceil(BLOCK);
/// Number of rows after a row for which its bounds hold.
const ROWS_KNOWN: i16 = 4;
/// Number of steps in a block from which on its columns are compared directly.
const MANY_STEPS: u32 = 16;

/// Scratch memory for rows, and the bounds known from the row before.
#[derive(Default)]
pub(super) struct RowScratch {
    hull: Vec<Parabola>,
    /// Squared distance across the row to each column's own obstacle \[quarters\]: whole blocks,
    /// and a run at both ends.
    across: Vec<i16>,
    /// Squared distance to the nearest obstacle \[quarters\]; 0 beside the row, where nothing can
    /// be lowered.
    nearest: Vec<i16>,
    /// Bit mask of each block: columns that are nearer to their obstacle than the next ones.
    rises: Vec<u64>,
    /// Bit mask of each block: columns that are farther from their obstacle than the next ones.
    falls: Vec<u64>,
    /// Per block of columns, an upper bound of the distance from a cell of the next rows to its
    /// nearest obstacle, in rows; 0 for blocks whose cells are not needed; empty if unknown.
    most_rows: Vec<i16>,
    /// Per block of columns, the number of rows beyond which an obstacle of theirs is not the
    /// nearest one to any cell of the next rows; empty if unknown.
    near_rows: Vec<i16>,
    /// Most cells of a row were far: the next rows are left to the envelope.
    is_far: bool,
    /// Number of the next rows, minus one.
    rows_left: i16,
}

impl RowScratch {
    /// Forgets the previous row.
    pub(super) fn start(&mut self) {
        self.most_rows.clear();
        self.near_rows.clear();
        self.rows_left = 0;
    }
}

impl Envelope {
    /// Squared distances of the columns `own` of a row, from the rows to each column's nearest
    /// obstacle. Two calls without [`RowScratch::start`] in between must be for adjacent rows.
    pub(super) fn row(
        &self,
        rows: &[i16],
        own: Range<usize>,
        out: &mut [i32],
        scratch: &mut RowScratch,
    ) {
        if scratch.is_far && scratch.rows_left > 0 {
            scratch.rows_left -= 1;
            self.part(rows, 0..rows.len(), own.start, out, &mut scratch.hull);
            return;
        }
        let most = scratch.most_rows.iter().max().copied().unwrap_or(NEAR_ROWS) as usize;
        let first = own.start.saturating_sub(most) / BLOCK;
        let last = rows.len().min(own.end + most);
        scratch.look_across(&rows[BLOCK * first..last], first, self.to);
        scratch.compare(first, self.to);
        scratch.follow(self.to);
        let found = &scratch.nearest[RUN + own.start - BLOCK * first..][..own.len()];
        for (out, &quarter) in out.iter_mut().zip(found) {
            *out = self.to.half_cells_sq_of_quarter(quarter);
        }
        let far = if self.limit_sq <= self.to.half_cells_sq_of_quarter(FAR) {
            for value in out.iter_mut() {
                *value = self.limit_sq.min(*value);
            }
            0
        } else {
            found.iter().filter(|&&quarter| quarter == FAR).count()
        };
        if scratch.rows_left > 0 {
            scratch.rows_left -= 1;
        } else {
            scratch.is_far = 2 * far > own.len();
            scratch.remember(first, &own, rows.len(), self);
        }
        if far > 0 {
            self.far(rows, own, out, &mut scratch.hull);
        }
    }

    /// Distances of the cells that are far from all obstacles, by the lower envelope.
    fn far(&self, rows: &[i16], own: Range<usize>, out: &mut [i32], hull: &mut Vec<Parabola>) {
        let far_sq = self.to.half_cells_sq_of_quarter(FAR);
        let mut start = 0;
        while let Some(from) = out[start..].iter().position(|&value| value >= far_sq) {
            let from = start + from;
            let to = out[from..].iter().position(|&value| value < far_sq);
            let to = to.map_or(out.len(), |to| from + to);
            // The nearest obstacle of a cell in the run lies no farther beyond the run than that
            // of the cell at its end.
            let (mut left, mut right) = (0, rows.len());
            if from > 0 {
                left = (own.start + from).saturating_sub(NEAR_COLUMNS);
            }
            if to < out.len() {
                right = right.min(own.start + to + NEAR_COLUMNS);
            }
            self.part(rows, left..right, own.start + from, &mut out[from..to], hull);
            start = to;
        }
    }

    /// Distances of some columns of a row, beginning at `first`, to the obstacles of the columns
    /// `sources`, by the lower envelope.
    fn part(
        &self,
        rows: &[i16],
        sources: Range<usize>,
        first: usize,
        out: &mut [i32],
        hull: &mut Vec<Parabola>,
    ) {
        for (value, &rows) in out.iter_mut().zip(&rows[first..]) {
            *value = self.to.half_cells_sq(rows).min(self.limit_sq);
        }
        let offset = sources.start as i64 - first as i64;
        self.lower_beside(&rows[sources], offset, out, hull);
    }
}

impl RowScratch {
    /// Computes each column's distance to its own obstacle, if that is near enough to matter.
    fn look_across(&mut self, rows: &[i16], first: usize, to: DistanceTo) {
        let nearer = i16::from(to == DistanceTo::Squares);
        let blocks = rows.len().div_ceil(BLOCK);
        let end = RUN + rows.len();
        self.across.resize(RUN + blocks * BLOCK + RUN, FAR);
        self.across[..RUN].fill(FAR);
        self.across[end..].fill(FAR);
        for (block, rows) in rows.chunks(BLOCK).enumerate() {
            let most = self.near_rows.get(first + block).copied().unwrap_or(NEAR_ROWS);
            let across = &mut self.across[RUN + BLOCK * block..];
            for (across, &rows) in across.iter_mut().zip(rows) {
                let near = rows.min(NEAR_ROWS);
                let quarter = near * (near - nearer) + nearer.min(near);
                *across = if rows > most { FAR } else { quarter };
            }
        }
        self.nearest.clone_from(&self.across);
        self.nearest[..RUN].fill(0);
        self.nearest[RUN + rows.len()..].fill(0);
        self.rises.clear();
        self.falls.clear();
        let (left, _) = self.across[RUN..].as_chunks::<BLOCK>();
        let (right, _) = self.across[RUN + 1..].as_chunks::<BLOCK>();
        for (left, right) in left.iter().zip(right) {
            self.rises.push(ones(left, right));
            self.falls.push(ones(right, left));
        }
    }

    /// Stores bounds of the distances in each block for the next rows.
    fn remember(&mut self, first: usize, own: &Range<usize>, columns: usize, envelope: &Envelope) {
        self.rows_left = ROWS_KNOWN - 1;
        let blocks = columns.div_ceil(BLOCK);
        self.most_rows.clear();
        self.most_rows.resize(blocks, 0);
        for block in own.start / BLOCK..own.end.div_ceil(BLOCK) {
            let from = own.start.max(BLOCK * block) - BLOCK * first;
            let to = own.end.min(BLOCK * (block + 1)) - BLOCK * first;
            let largest = largest(&self.nearest[RUN + from..RUN + to]);
            let sq = envelope.to.half_cells_sq_of_quarter(largest).min(envelope.limit_sq);
            // One row further, all distances grow by at most one cell; plus rounding.
            let cells = f64::from(sq).sqrt() as i16 / 2 + 1;
            self.most_rows[block] = (cells + ROWS_KNOWN).min(NEAR_ROWS);
        }
        self.near_rows.clear();
        for block in 0..blocks {
            let others = block.saturating_sub(NEAR_BLOCKS)..blocks.min(block + NEAR_BLOCKS + 1);
            let reaching = others.map(|other| {
                let between = block.abs_diff(other).saturating_sub(1) * BLOCK;
                let most = self.most_rows[other];
                if between < most as usize { most } else { 0 }
            });
            self.near_rows.push(reaching.max().unwrap_or(0));
        }
    }

    /// Finishes blocks with many steps near obstacles by comparing each column with those beside
    /// it.
    ///
    /// Beyond such a block only the obstacles near its ends can matter: the nearest obstacle of a
    /// cell there is not farther than that of the block's last cell plus the distance from it.
    fn compare(&mut self, first: usize, to: DistanceTo) {
        let Self { across, nearest, rises, falls, most_rows, .. } = self;
        let (nearest, _) = nearest[RUN..].as_chunks_mut::<BLOCK>();
        let mut was_finished = false;
        for (block, nearest) in nearest.iter_mut().enumerate() {
            let steps = rises[block] | falls[block];
            let most = most_rows.get(first + block).copied().unwrap_or(0) as usize;
            let across = &across[BLOCK * block..BLOCK * (block + 1) + 2 * RUN];
            let is_near =
                steps.count_ones() >= MANY_STEPS && 0 < most && most <= RUN + ROWS_KNOWN as usize;
            let found = if is_near { compared(across, to) } else { None };
            let is_finished = found.is_some();
            if let Some((found, away)) = found {
                *nearest = found;
                rises[block] &= !(u64::MAX >> away);
                falls[block] &= !(u64::MAX << away);
                if was_finished {
                    rises[block - 1] = 0;
                    falls[block] = 0;
                }
            }
            was_finished = is_finished;
        }
    }

    /// Follows the obstacles along the row.
    ///
    /// An obstacle lowers distances along the row only beyond a step to a column whose own
    /// obstacle is farther: an equally near one is nearer to every cell on its side. From there
    /// it is followed until a cell is as near to an obstacle further on, which is then at least
    /// as near to all cells that follow. All obstacles further on are therefore processed first,
    /// and none of those on the other side.
    fn follow(&mut self, to: DistanceTo) {
        let Self { across, nearest, rises, falls, .. } = self;
        let along = to.along();
        for (block, &steps) in rises.iter().enumerate().rev() {
            let mut steps = steps;
            while steps != 0 {
                let step = BLOCK - 1 - steps.leading_zeros() as usize;
                steps ^= 1 << step;
                let column = RUN + BLOCK * block + step;
                let (runs, _) = nearest[column + 1..].as_chunks_mut();
                lower(runs.iter_mut().zip(&along.right), RUN - 1, across[column]);
            }
        }
        for (block, &steps) in falls.iter().enumerate() {
            let mut steps = steps;
            while steps != 0 {
                let step = steps.trailing_zeros() as usize;
                steps &= steps - 1;
                let column = RUN + BLOCK * block + step + 1;
                let (_, runs) = nearest[..column].as_rchunks_mut();
                lower(runs.iter_mut().rev().zip(&along.left), 0, across[column]);
            }
        }
    }
}

/// Nearest distances of a block's columns, from their own obstacles and those of a run at both
/// ends, and the largest number of columns to a nearest obstacle; `None` if farther columns might
/// matter.
fn compared(across: &[i16], to: DistanceTo) -> Option<([i16; BLOCK], usize)> {
    let mut nearest = [0; BLOCK];
    nearest.copy_from_slice(&across[RUN..RUN + BLOCK]);
    for away in 1..=RUN {
        let along = to.quarter(away as i32);
        let largest = largest(&nearest);
        if largest <= along {
            return Some((nearest, away));
        }
        let left = &across[RUN - away..][..BLOCK];
        let right = &across[RUN + away..][..BLOCK];
        for (nearest, (&left, &right)) in nearest.iter_mut().zip(left.iter().zip(right)) {
            *nearest = (*nearest).min(left.min(right).saturating_add(along));
        }
    }
    None
}

fn largest(quarters: &[i16]) -> i16 {
    quarters.iter().fold(0, |largest, &quarter| largest.max(quarter))
}

/// Bit mask of the columns that are nearer than the next ones.
fn ones(left: &[i16; BLOCK], right: &[i16; BLOCK]) -> u64 {
    let mut flags = [0; BLOCK];
    for (flag, (left, right)) in flags.iter_mut().zip(left.iter().zip(right)) {
        *flag = u8::from(left < right);
    }
    let (eights, _) = flags.as_chunks();
    let bits = |&eight: &[u8; 8]| {
        // Eight bytes become eight bits.
        u64::from_le_bytes(eight).wrapping_mul(0x0102_0408_1020_4080) >> 56
    };
    eights.iter().rev().fold(0, |ones, eight| ones << 8 | bits(eight))
}

#[cfg(test)]
mod tests {
    use super::super::DistanceTo;
    use super::super::envelope::FAR_ROWS;
    use super::super::tests::Random;
    use super::*;
    use proptest::prelude::*;

    /// Compares each column with every other.
    fn brute_force(rows: &[i16], own: Range<usize>, envelope: &Envelope) -> Vec<i32> {
        let nearest = |at: usize| {
            let values = rows.iter().enumerate().map(|(x, &rows)| {
                let along = envelope.to.half_cells_sq(x.abs_diff(at) as i16);
                along + envelope.to.half_cells_sq(rows)
            });
            values.min().unwrap_or(i32::MAX).min(envelope.limit_sq)
        };
        own.map(nearest).collect()
    }

    proptest! {
        #[test]
        fn rows_agree_with_brute_force(
            seed: u64, parts in prop::collection::vec((1i16..500, 0.0..1.0f64, 1usize..200), 1..6),
            centres: bool, limit in prop_oneof![Just(32_766), 1..800], from in 0.0..1.0f64, to in 0.0..1.0f64,
        ) {
            // Stretches that differ in the distances of obstacles and in the frequency of
            // changes.
            let mut random = Random(seed | 1);
            let mut rows = Vec::new();
            for (most, change, columns) in parts {
                let mut across = FAR_ROWS;
                for _ in 0..columns {
                    if random.fraction() < change {
                        across = (random.fraction() * f64::from(most)) as i16;
                    }
                    rows.push(across);
                }
            }
            let to_what = if centres { DistanceTo::Centres } else { DistanceTo::Squares };
            let envelope = Envelope { to: to_what, limit_sq: limit * limit };
            let start = (from * (rows.len() - 1) as f64) as usize;
            let own = start..start + 1 + (to * (rows.len() - 1 - start) as f64) as usize;
            let (mut scratch, mut out) = (RowScratch::default(), vec![0; own.len()]);
            // Moves every column's obstacle one row away: distances grow by at most a cell.
            for _ in 0..10 {
                envelope.row(&rows, own.clone(), &mut out, &mut scratch);
                prop_assert_eq!(&out, &brute_force(&rows, own.clone(), &envelope));
                for across in &mut rows {
                    let nearer = random.fraction() < 0.02;
                    *across = if nearer { *across / 2 } else { (*across + 1).min(FAR_ROWS) };
                }
            }
        }
    }
}
