//! The state of a cell.

use serde::{Deserialize, Serialize};

/// The state of a cell according to the observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CellState {
    /// No obstacle.
    Free,
    /// An obstacle.
    Occupied,
    /// Never observed.
    Unknown,
}
