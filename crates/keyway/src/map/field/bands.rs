//! Computation of a whole field, in bands of rows that fit the cache and are shared among
//! threads.

use super::columns::{nearest_in_rows, step};
use super::envelope::{Envelope, FAR_ROWS};
use super::followed_obstacles::RowScratch;
use crate::map::BitGrid;
use std::num::NonZeroUsize;
use std::sync::Mutex;

/// Number of cells of a band: both passes' results then stay in the cache of one core.
const BAND_CELLS: usize = 1 << 17;

/// Number of threads that this machine can run at once.
pub(super) fn available_threads() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Inputs of the computation of a whole field.
pub(super) struct Work<'a> {
    pub(super) obstacles: &'a BitGrid,
    pub(super) envelope: Envelope,
    /// Distance between rows of the field in the vector.
    pub(super) stride: usize,
    pub(super) threads: usize,
}

/// A band of rows of the field, with the distances of the obstacles in the rows below and above
/// it.
struct Band<'a> {
    first_row: i32,
    /// Per column, rows from the row below the band to the nearest obstacle at or below that.
    below: Vec<i16>,
    /// Per column, rows from the row above the band to the nearest obstacle at or above that.
    above: Vec<i16>,
    half_cells_sq: &'a mut [i32],
}

/// Scratch memory of a thread.
#[derive(Default)]
struct Scratch {
    /// Rows to the nearest obstacle of the same column, for the cells of a band.
    column_rows: Vec<i16>,
    row: RowScratch,
}

impl Work<'_> {
    /// Fills the field, row by row from the bottom.
    pub(super) fn run(&self, half_cells_sq: &mut [i32]) {
        let width = self.obstacles.width() as usize;
        let band_rows = (BAND_CELLS / width).max(16);
        let mut bands: Vec<Band<'_>> = half_cells_sq
            .chunks_mut(band_rows * self.stride)
            .enumerate()
            .map(|(i, half_cells_sq)| Band {
                first_row: (i * band_rows) as i32,
                below: Vec::new(),
                above: Vec::new(),
                half_cells_sq,
            })
            .collect();
        self.look_beyond(&mut bands);
        let threads = self.threads.clamp(1, bands.len());
        // A free thread takes the next band: no band depends on another one.
        let bands = Mutex::new(bands.into_iter());
        let next = || bands.lock().ok().and_then(|mut bands| bands.next());
        let work = || {
            let mut scratch = Scratch::default();
            while let Some(band) = next() {
                self.fill(band, &mut scratch);
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(work);
            }
            work();
        });
    }

    /// Sets the distances to the obstacles below and above every band.
    fn look_beyond(&self, bands: &mut [Band<'_>]) {
        let far = vec![FAR_ROWS; self.obstacles.width() as usize];
        let mut below = far.clone();
        for band in bands.iter_mut() {
            band.below.clone_from(&below);
            let rows = self.rows_of(band);
            self.carry(&mut below, rows.rev());
        }
        let mut above = far;
        for band in bands.iter_mut().rev() {
            band.above.clone_from(&above);
            let rows = self.rows_of(band);
            self.carry(&mut above, rows);
        }
    }

    fn rows_of(&self, band: &Band<'_>) -> std::ops::Range<i32> {
        let rows = band.half_cells_sq.len() / self.stride;
        band.first_row..band.first_row + rows as i32
    }

    /// Converts row distances to the nearest obstacle, counted from the row before a band, to
    /// those from the band's last row; `rows` come in the order from that last row back.
    fn carry(&self, nearest: &mut [i16], rows: impl ExactSizeIterator<Item = i32>) {
        let height = rows.len().min(FAR_ROWS as usize) as i16;
        for distance in nearest.iter_mut() {
            *distance = (*distance + height).min(FAR_ROWS);
        }
        nearest_in_rows(self.obstacles, rows, 0, nearest);
    }

    /// Runs both passes for one band.
    fn fill(&self, band: Band<'_>, scratch: &mut Scratch) {
        let width = self.obstacles.width() as usize;
        let Band { first_row, mut below, mut above, half_cells_sq } = band;
        let Scratch { column_rows, row: row_scratch } = scratch;
        row_scratch.start();
        column_rows.resize(width * (half_cells_sq.len() / self.stride), 0);
        for (y, row) in (first_row..).zip(column_rows.chunks_mut(width)) {
            step(&mut below);
            for x in self.obstacles.ones_in_span(y, 0, i32::MAX) {
                below[x as usize] = 0;
            }
            row.copy_from_slice(&below);
        }
        let rows = column_rows.chunks_mut(width).zip(half_cells_sq.chunks_mut(self.stride));
        for (row, out) in rows.rev() {
            step(&mut above);
            for (rows, above) in row.iter_mut().zip(&mut above) {
                // An obstacle is 0 rows away, in either direction.
                *above = if *rows == 0 { 0 } else { *above };
                *rows = (*rows).min(*above);
            }
            self.envelope.row(row, 0..width, &mut out[..width], row_scratch);
        }
    }
}
