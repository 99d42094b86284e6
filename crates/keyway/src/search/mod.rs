//! The search engine of all planners: exact costs, steps between cells, memory, observers.
//!
//! A one-sided search is a loop over one frontier; a bidirectional one is a loop over two. The
//! policies (neighbour rule, step cost, observer) are type parameters, so that a search compiles
//! to one loop without indirect calls. They are chosen by name in [`crate::plan`].
//!
//! The public items are those for callers of planners ([`Query`], [`Workspace`], [`Observer`]),
//! and those for writing your own planner: [`Neighbours`], [`Sight`], [`Cost`], and memory of its
//! own ([`SearchMemory`]). The example `own_planner` is one.

pub(crate) mod bit_scan;
mod buckets;
mod cost;
mod frontier;
mod metric;
mod neighbours;
mod neighbours_24;
mod observer;
mod open_list;
pub(crate) mod pattern;
mod random_queries;
mod recording;
mod rule;
mod sight;
mod statistics;
mod workspace;

pub use cost::Cost;
pub(crate) use frontier::cells;
pub(crate) use frontier::{Expanded, Frontier};
pub(crate) use metric::{DistanceTo, Euclidean, Manhattan, Mean, Metric, Octile, Zero};
pub(crate) use neighbours::Reversed;
pub use neighbours::{
    CornerRule, GridStep, Moves, Neighbours, StepCost, Successors, Uniform, UnknownCost,
};
pub(crate) use neighbours_24::Neighbours24;
pub use observer::{Observer, Side};
pub use random_queries::random_queries;
pub use recording::{Recording, SearchEvent};
pub(crate) use rule::{Accumulated, AtGeneration, Greedy, Rule, StraightLine};
pub use sight::Sight;
pub use statistics::{SearchStatistics, SideStatistics};
pub(crate) use workspace::Sides;
pub use workspace::{SearchMemory, Workspace};

use crate::map::Cell;

/// A planning query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Query {
    /// The start of the path.
    pub start: Cell,
    /// The goal of the path.
    pub goal: Cell,
    /// The maximum number of expanded nodes; the search gives up beyond it.
    pub budget: Option<u64>,
    /// The behaviour if the goal is blocked or no path leads there.
    pub if_unreachable: IfUnreachable,
}

/// The behaviour for an unreachable goal on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IfUnreachable {
    /// Report the reason why there is no path.
    #[default]
    Fail,
    /// Plan to the reachable cell whose centre is nearest to the goal's centre (ties: lower row,
    /// then lower column). It is the last cell of the plan.
    NearestReachable,
}

impl Query {
    /// A query from `start` to exactly `goal`, without a budget.
    pub const fn new(start: Cell, goal: Cell) -> Self {
        Self { start, goal, budget: None, if_unreachable: IfUnreachable::Fail }
    }
}
