//! Why a map cannot be prepared.

use crate::search::Cost;
use thiserror::Error;

/// Why a map cannot be prepared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The map has penalised cells.
    #[error(
        "a prepared map needs one cost for all cells; treat unknown cells as blocked or free, or use astar"
    )]
    NeedsUniformCost,
    /// Whoever watched it wanted it to stop.
    #[error("the preparation was stopped")]
    Stopped,
    /// Too many corner cells.
    #[error(
        "the map has {corner_cells} cells at which paths may turn, expected at most {limit}; use jps"
    )]
    TooManyCorners {
        /// Their number.
        corner_cells: u64,
        /// The largest number that there may be.
        limit: u64,
    },
    /// Too many label entries.
    #[error("the labels would have more than {limit} entries; use jps")]
    TooManyEntries {
        /// The largest number that there may be.
        limit: u64,
    },
    /// Too long a path.
    #[error(
        "there is a shortest path of {} straight and {} diagonal steps, expected less than 2^20 of each; use jps",
        cost.straight, cost.diagonal
    )]
    TooLong {
        /// Its cost.
        cost: Cost,
    },
}
