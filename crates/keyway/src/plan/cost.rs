//! The cost of a path.

use crate::search::Cost;
use std::cmp::Ordering;

/// The cost of a path, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanCost {
    /// Numbers of straight and diagonal steps, penalties included: exact.
    Steps(Cost),
    /// The length of a path in any direction \[cells\].
    Length(f64),
}

impl PlanCost {
    /// The cost \[cells\].
    pub fn cells(self) -> f64 {
        match self {
            Self::Steps(cost) => cost.cells(),
            Self::Length(cells) => cells,
        }
    }

    /// The exact cost of a path of straight and diagonal steps; `None` for a path in any
    /// direction.
    pub const fn steps(self) -> Option<Cost> {
        match self {
            Self::Steps(cost) => Some(cost),
            Self::Length(_) => None,
        }
    }
}

impl Default for PlanCost {
    fn default() -> Self {
        Self::Steps(Cost::default())
    }
}

impl Eq for PlanCost {}

impl PartialOrd for PlanCost {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Exact between costs of steps; otherwise by the floating-point lengths.
impl Ord for PlanCost {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Steps(a), Self::Steps(b)) => a.cmp(b),
            _ => self.cells().total_cmp(&other.cells()),
        }
    }
}
