//! The state of a cell.

use serde::{Deserialize, Serialize};

/// The state of a cell, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CellState {
    /// Nothing stands there.
    Free,
    /// Something stands there.
    Occupied,
    /// Never observed.
    Unknown,
}
