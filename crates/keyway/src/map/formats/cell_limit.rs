//! Limit of the number of cells of a map that is read.

use crate::geometry::Pose;
use crate::map::{FrameError, GridFrame};
use thiserror::Error;

/// Default limit of the number of cells of a map that is read: 16384 x 32768.
pub const DEFAULT_MAX_CELLS: u64 = 1 << 29;

/// Error of a map with more cells than the limit. A small file can hold one that takes all
/// memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "a map of {width} x {height} cells is larger than the limit of {max_cells} cells; if this size \
     is intended, raise the limit"
)]
#[non_exhaustive]
pub struct TooManyCells {
    /// Columns of the map.
    pub width: u64,
    /// Rows of the map.
    pub height: u64,
    /// The limit.
    pub max_cells: u64,
}

impl TooManyCells {
    /// The smallest limit with which the map is read.
    pub const fn needed(&self) -> u64 {
        self.width * self.height
    }
}

/// Rejects a size that no grid can have, or that exceeds the limit.
pub(super) fn check_size<E: From<FrameError> + From<TooManyCells>>(
    (width, height): (u64, u64),
    max_cells: u64,
) -> Result<(), E> {
    let frame = GridFrame::new(width, height, 1.0, Pose::default())?;
    if frame.cell_count() > max_cells {
        return Err(TooManyCells { width, height, max_cells }.into());
    }
    Ok(())
}
