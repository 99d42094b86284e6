//! Errors of the preparation of a map.

use crate::search::Cost;
use thiserror::Error;

/// The reason why a map cannot be prepared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The map has penalised cells.
    #[error(
        "a prepared map needs one cost for all cells; treat unknown cells as blocked or free, or use astar"
    )]
    NeedsUniformCost,
    /// The progress callback stopped the preparation.
    #[error("the preparation was stopped")]
    Stopped,
    /// The map has too many corner cells.
    #[error(
        "the map has {corner_cells} cells at which paths may turn, expected at most {limit}; use jps"
    )]
    TooManyCorners {
        /// The number of corner cells.
        corner_cells: u64,
        /// The largest number allowed.
        limit: u64,
    },
    /// The labels have too many entries.
    #[error("the labels would have more than {limit} entries; use jps")]
    TooManyEntries {
        /// The largest number allowed.
        limit: u64,
    },
    /// A shortest path is too long.
    #[error(
        "a shortest path has {} straight and {} diagonal steps, expected fewer than 2^20 of each; use jps",
        cost.straight, cost.diagonal
    )]
    TooLong {
        /// The cost of the path.
        cost: Cost,
    },
}
