//! Pose of a grid in the world; all conversions between metres and cells.

use super::Cell;
use crate::geometry::{Point, Pose};
use crate::given::Given;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use thiserror::Error;

/// Largest number of cells of a grid (2^31: padded cell indices fit 32 bits).
pub const MAX_CELLS: u64 = 1 << 31;

/// True if a grid may have this many columns and rows.
pub(super) fn is_size(width: u64, height: u64) -> bool {
    // Counts the padding, so that a thin map cannot overflow the padded index either.
    let padded = (u128::from(width) + 130) * (u128::from(height) + 2);
    let cells = u128::from(width) * u128::from(height);
    (1..=u128::from(MAX_CELLS)).contains(&cells) && padded <= 1 << 32
}

/// Geometry of a grid: size, resolution and origin.
///
/// Three coordinate systems are used: *world* (metres), *grid* (continuous, in cells: cell (i, j)
/// is the square from (i, j) to (i + 1, j + 1)), and *cells* (integers).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "FrameParts")]
pub struct GridFrame {
    width: u32,
    height: u32,
    resolution_m: f64,
    /// World pose of the lower-left corner of cell (0, 0).
    origin: Pose,
    #[serde(skip)]
    sin: f64,
    #[serde(skip)]
    cos: f64,
}

/// A frame that is not yet validated.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameParts {
    width: u64,
    height: u64,
    resolution_m: f64,
    origin: Pose,
}

impl TryFrom<FrameParts> for GridFrame {
    type Error = FrameError;

    fn try_from(parts: FrameParts) -> Result<Self, FrameError> {
        let FrameParts { width, height, resolution_m, origin } = parts;
        Self::new(width, height, resolution_m, origin)
    }
}

/// Reason why a frame is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FrameError {
    /// No cells at all.
    #[error("a map needs at least one cell, got {width} x {height}")]
    Empty {
        /// Requested columns.
        width: u64,
        /// Requested rows.
        height: u64,
    },
    /// More than [`MAX_CELLS`].
    #[error("a map of {width} x {height} cells is larger than the limit of {MAX_CELLS} cells")]
    TooLarge {
        /// Requested columns.
        width: u64,
        /// Requested rows.
        height: u64,
    },
    /// Not a positive length, or one at which coordinates cannot be distinguished.
    #[error("resolution must be a number of metres per cell from 1e-6 to 1e6, got {}", Given(*.0))]
    Resolution(f64),
    /// NaN, infinite, or so far away that cells cannot be distinguished.
    #[error("origin must be within 1e9 m, got x = {x:e}, y = {y:e}, yaw = {yaw_rad} rad")]
    Origin {
        /// Requested x \[m\].
        x: f64,
        /// Requested y \[m\].
        y: f64,
        /// Requested yaw \[rad\].
        yaw_rad: f64,
    },
}

/// True if cells at this distance can be distinguished.
pub(super) fn is_origin(origin: Pose) -> bool {
    [origin.x, origin.y, origin.theta].iter().all(|n| n.abs() <= 1e9)
}

impl GridFrame {
    /// Allowed range of the side of a cell \[m\].
    pub const RESOLUTIONS_M: RangeInclusive<f64> = 1e-6..=1e6;

    /// A grid of `width` x `height` cells of `resolution_m`, whose lower-left corner has the world
    /// pose `origin`.
    ///
    /// # Errors
    /// Returns [`FrameError`] if there are no cells or too many, or a number is not usable.
    pub fn new(
        width: u64,
        height: u64,
        resolution_m: f64,
        origin: Pose,
    ) -> Result<Self, FrameError> {
        if width == 0 || height == 0 {
            return Err(FrameError::Empty { width, height });
        }
        if !is_size(width, height) {
            return Err(FrameError::TooLarge { width, height });
        }
        if !Self::RESOLUTIONS_M.contains(&resolution_m) {
            return Err(FrameError::Resolution(resolution_m));
        }
        if !is_origin(origin) {
            return Err(FrameError::Origin { x: origin.x, y: origin.y, yaw_rad: origin.theta });
        }
        let (sin, cos) = libm::sincos(origin.theta);
        Ok(Self { width: width as u32, height: height as u32, resolution_m, origin, sin, cos })
    }

    /// Columns.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Side of a cell \[m\].
    pub const fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// World pose of the lower-left corner of cell (0, 0).
    pub const fn origin(&self) -> Pose {
        self.origin
    }

    /// Number of cells.
    pub const fn cell_count(&self) -> u64 {
        self.width as u64 * self.height as u64
    }

    /// True for a cell of this grid.
    pub const fn contains(&self, cell: Cell) -> bool {
        cell.x >= 0 && cell.y >= 0 && (cell.x as u32) < self.width && (cell.y as u32) < self.height
    }

    /// All cells, row by row from the bottom.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let (width, height) = (self.width as i32, self.height as i32);
        (0..height).flat_map(move |y| (0..width).map(move |x| Cell::new(x, y)))
    }

    /// Grid coordinates \[cells\] of a world point.
    pub fn grid_from_world(&self, world: Point) -> Point {
        let d = world - self.origin.point();
        let along = Point::new(self.cos * d.x + self.sin * d.y, self.cos * d.y - self.sin * d.x);
        Point::new(along.x / self.resolution_m, along.y / self.resolution_m)
    }

    /// World point of grid coordinates \[cells\].
    pub fn world_from_grid(&self, grid: Point) -> Point {
        let d = grid * self.resolution_m;
        Point::new(
            self.origin.x + self.cos * d.x - self.sin * d.y,
            self.origin.y + self.sin * d.x + self.cos * d.y,
        )
    }

    /// World point of a cell's centre.
    pub fn world_from_cell(&self, cell: Cell) -> Point {
        self.world_from_grid(Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5))
    }

    /// The cell that contains a world point; `None` outside the grid. A point on a shared edge
    /// belongs to the cell right of or above it, on the outer right or upper edge to the last
    /// cell.
    pub fn cell_from_world(&self, world: Point) -> Option<Cell> {
        self.cell_from_grid(self.grid_from_world(world))
    }

    /// Like [`Self::cell_from_world`], but also for points outside the grid: returns the cell
    /// that would contain the point if the grid continued.
    pub fn cell_near(&self, world: Point) -> Cell {
        let grid = self.grid_from_world(world);
        self.cell_from_grid(grid)
            .unwrap_or_else(|| Cell::new(grid.x.floor() as i32, grid.y.floor() as i32))
    }

    /// The cell that contains a point in grid coordinates, as for [`Self::cell_from_world`].
    pub fn cell_from_grid(&self, grid: Point) -> Option<Cell> {
        let index = |value: f64, count: u32| -> Option<i32> {
            if !(value >= 0.0 && value <= f64::from(count)) {
                return None;
            }
            Some((value as i32).min(count as i32 - 1))
        };
        Some(Cell::new(index(grid.x, self.width)?, index(grid.y, self.height)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn frame(width: u64, height: u64, origin: Pose) -> GridFrame {
        GridFrame::new(width, height, 0.05, origin).unwrap()
    }

    #[test]
    fn centres_and_corners() {
        let frame = frame(4, 3, Pose::new(-10.0, 2.0, 0.0));
        let centre = frame.world_from_cell(Cell::new(0, 0));
        assert!((centre.x + 9.975).abs() < 1e-12 && (centre.y - 2.025).abs() < 1e-12);
        assert_eq!(frame.cell_from_world(Point::new(-10.0, 2.0)), Some(Cell::new(0, 0)));
        assert_eq!(frame.cell_from_world(Point::new(-9.8, 2.15)), Some(Cell::new(3, 2)));
        assert_eq!(frame.cell_from_world(Point::new(-10.001, 2.0)), None);
        assert_eq!(frame.cell_from_world(Point::new(f64::NAN, 2.0)), None);
        let near = |x, y| frame.cell_near(Point::new(x, y));
        assert_eq!((near(-9.8, 2.15), near(-10.001, 2.17)), (Cell::new(3, 2), Cell::new(-1, 3)));
    }

    #[test]
    fn rotated_origin() {
        let frame = frame(4, 3, Pose::new(1.0, 1.0, FRAC_PI_2));
        // The grid's x axis points up in the world, its y axis left.
        let centre = frame.world_from_cell(Cell::new(3, 0));
        assert!((centre.x - 0.975).abs() < 1e-12 && (centre.y - 1.175).abs() < 1e-12);
        for cell in frame.cells() {
            assert_eq!(frame.cell_from_world(frame.world_from_cell(cell)), Some(cell));
        }
    }

    #[test]
    fn refuses_what_cannot_be() {
        let make = |w, h, r| GridFrame::new(w, h, r, Pose::default());
        assert!(matches!(make(0, 3, 1.0), Err(FrameError::Empty { .. })));
        assert!(matches!(make(1 << 40, 1 << 40, 1.0), Err(FrameError::TooLarge { .. })));
        assert!(matches!(make(u64::MAX, 1, 1.0), Err(FrameError::TooLarge { .. })));
        assert!(matches!(make(1, 1 << 31, 1.0), Err(FrameError::TooLarge { .. })));
        for resolution in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            assert!(matches!(make(2, 2, resolution), Err(FrameError::Resolution(_))));
        }
        let far = Pose { x: f64::NAN, ..Pose::default() };
        assert!(matches!(GridFrame::new(2, 2, 1.0, far), Err(FrameError::Origin { .. })));
        assert!(make(1, 1, 1.0).is_ok());
    }
}
