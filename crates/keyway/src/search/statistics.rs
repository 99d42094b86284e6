//! Counters of a search.

use super::Side;
use serde::{Deserialize, Serialize};

/// Counters of one side of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SideStatistics {
    /// Nodes taken from the open list.
    pub expanded: u64,
    /// Nodes inserted into the open list, or improved there.
    pub generated: u64,
}

/// Counters of both sides of a search; a one-sided search uses the forward side only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchStatistics {
    /// The side from the start.
    pub forward: SideStatistics,
    /// The side from the goal.
    pub backward: SideStatistics,
}

impl SearchStatistics {
    /// The counters of a one-sided search.
    pub const fn one_sided(forward: SideStatistics) -> Self {
        Self { forward, backward: SideStatistics { expanded: 0, generated: 0 } }
    }

    /// The counters of one side.
    pub const fn side_mut(&mut self, side: Side) -> &mut SideStatistics {
        match side {
            Side::Forward => &mut self.forward,
            Side::Backward => &mut self.backward,
        }
    }

    /// Nodes taken from the open lists of both sides.
    pub const fn expanded(&self) -> u64 {
        self.forward.expanded + self.backward.expanded
    }

    /// Nodes inserted into the open lists of both sides, or improved there.
    pub const fn generated(&self) -> u64 {
        self.forward.generated + self.backward.generated
    }
}
