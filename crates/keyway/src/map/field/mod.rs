//! Exact Euclidean distance from every cell's centre to the nearest obstacle.
//!
//! The squared distance to a cell splits into a part along the column and a part along the row.
//! The first pass finds the nearest obstacle of each cell's own column, 8 to 16 cells per
//! instruction. The second pass takes, along each row, the lowest of the parabolas with an apex
//! at each change of the first pass's result. Each parabola is followed to its side as long as it
//! is the lowest; in clutter the few relevant columns are compared; far from all obstacles the
//! lower envelope is built. Both passes run band by band, in cache, on several cores. All numbers
//! are integers, so any number of threads gives the same bytes.
//!
//! # Source
//! Two passes: \[Meijster2000\]. Lower envelope: \[Felzenszwalb2012\].
//!
//! # Differences from the papers
//! - Distances are measured to the obstacle cells' squares (or to their centres, by choice). The
//!   distance to a square is the distance to the nearer of its edges: parabolas have their apexes
//!   on edges.
//! - Between two columns whose nearest obstacles are equally far, no parabola is needed: walls
//!   along the axes cost nothing.
//! - Up to 181 cells from an obstacle no envelope is built. A parabola is followed, 16 cells at a
//!   time, until a cell is as low already because of one further on; these are processed first.
//! - A changed window is followed outwards only as far as a changed cell can matter
//!   ([`DistanceField::update`]).
//!
//! # Errors / cost
//! Linear time; 4 bytes and one bit per cell. No errors: in a map without obstacles all distances
//! are infinite.

mod bands;
mod columns;
mod envelope;
mod followed_obstacles;
mod lookup;
mod squares_16_bit;
#[cfg(test)]
mod tests;
mod touched;
mod update;
mod window;

use super::{BitGrid, GridFrame};
pub use envelope::DistanceTo;
use envelope::{Envelope, FAR_ROWS};
use std::num::NonZeroUsize;
pub use window::CellWindow;

/// Configuration of a [`DistanceField`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldConfig {
    /// Definition of the distance to an obstacle cell.
    pub to: DistanceTo,
    /// Reach \[m\]: larger distances are not distinguished; infinity for no limit. A smaller one
    /// makes updates in open areas faster.
    pub reach_m: f64,
    /// Number of threads that compute a whole field; `None` for one per core. A window is updated
    /// on one.
    pub threads: Option<NonZeroUsize>,
}

impl Default for FieldConfig {
    fn default() -> Self {
        Self { to: DistanceTo::Squares, reach_m: f64::INFINITY, threads: None }
    }
}

/// Distance field: for every cell of a map, the exact distance from its centre to the nearest
/// obstacle.
///
/// A cell stores the squared distance in half cells, a whole number: no rounding, and one
/// comparison decides whether a radius fits. Memory: 4 bytes and one bit per cell.
#[derive(Clone, Debug)]
pub struct DistanceField {
    frame: GridFrame,
    to: DistanceTo,
    obstacles: BitGrid,
    /// Squared distance in half cells, at most `limit_sq` and never negative; row by row from the
    /// bottom, with rows `stride` apart.
    half_cells_sq: Vec<i32>,
    stride: usize,
    limit_sq: i32,
    /// Largest number of threads that compute a whole field.
    threads: usize,
}

/// Compares the distances and the obstacles, but not the number of threads.
impl PartialEq for DistanceField {
    fn eq(&self, other: &Self) -> bool {
        (self.frame, self.to, self.limit_sq) == (other.frame, other.to, other.limit_sq)
            && self.obstacles == other.obstacles
            && self.half_cells_sq == other.half_cells_sq
    }
}

impl DistanceField {
    /// Number of cells from which on distances are not distinguished (819 m in cells of 0.05 m).
    pub const MAX_REACH_CELLS: f64 = (FAR_ROWS - 1) as f64;

    /// Computes the distances to the set bits of `obstacles`, a grid of `frame`'s size.
    ///
    /// # Panics
    /// Panics if the sizes differ.
    pub fn new(frame: &GridFrame, obstacles: &BitGrid, config: &FieldConfig) -> Self {
        let stride = stride(frame.width() as usize);
        let mut field = Self {
            frame: *frame,
            to: config.to,
            obstacles: BitGrid::new(frame.width(), frame.height(), false),
            half_cells_sq: vec![0; stride * frame.height() as usize],
            stride,
            limit_sq: limit_sq(config.reach_m / frame.resolution_m()),
            threads: config.threads.map_or_else(bands::available_threads, NonZeroUsize::get),
        };
        field.recompute(obstacles);
        field
    }

    /// Recomputes all distances in the same memory.
    ///
    /// # Panics
    /// Panics if the grids differ in size.
    pub fn recompute(&mut self, obstacles: &BitGrid) {
        self.assert_same_size(obstacles);
        self.obstacles.clone_from(obstacles);
        let work = bands::Work {
            obstacles,
            envelope: Envelope { to: self.to, limit_sq: self.limit_sq },
            stride: self.stride,
            threads: self.threads,
        };
        work.run(&mut self.half_cells_sq);
    }

    /// Geometry of the field: size, resolution and origin.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Definition of the distances.
    pub const fn to(&self) -> DistanceTo {
        self.to
    }

    /// The obstacles of the field.
    pub const fn obstacles(&self) -> &BitGrid {
        &self.obstacles
    }

    /// Memory on the heap \[bytes\].
    pub const fn memory_bytes(&self) -> usize {
        size_of::<i32>() * self.half_cells_sq.capacity() + self.obstacles.memory_bytes()
    }

    fn assert_same_size(&self, obstacles: &BitGrid) {
        let own = (self.frame.width(), self.frame.height());
        assert_eq!((obstacles.width(), obstacles.height()), own, "grids differ in size");
    }

    /// Index range of row `y` in the vector.
    const fn row(&self, y: i32) -> std::ops::Range<usize> {
        let start = y as usize * self.stride;
        start..start + self.frame.width() as usize
    }
}

/// Distance between rows in the vector: in a wide field an odd number of cache lines, so that the
/// cells of a column do not compete for the same cache sets.
fn stride(width: usize) -> usize {
    const LINE: usize = 16;
    if width < 32 * LINE { width } else { (width.div_ceil(LINE) | 1) * LINE }
}

/// Squared reach in half cells: at least one cell, and no more than fits.
fn limit_sq(reach_cells: f64) -> i32 {
    let half_cells = (2.0 * reach_cells.clamp(0.5, DistanceField::MAX_REACH_CELLS)).ceil() as i32;
    half_cells * half_cells
}
