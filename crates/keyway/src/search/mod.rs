//! The engine under every planner: exact costs, steps between cells, memory, observers.
//!
//! A one-sided search is a loop over one frontier; a bidirectional one is a loop over two. The
//! policies (neighbour rule, step cost, observer) are type parameters, so that a search compiles
//! to one loop without indirect calls; they are chosen by name at the edge, in
//! [`crate::plan`].
//!
//! What is public is what a caller of a planner needs ([`Query`], [`Workspace`], [`Observer`]), and
//! what a planner of your own is written with: [`Neighbours`], [`Sight`], [`Cost`], and its own
//! memory ([`SearchMemory`]). The example `own_planner` is one.

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

/// What is asked of a planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Query {
    /// Where the path begins.
    pub start: Cell,
    /// Where it ends.
    pub goal: Cell,
    /// Give up after this many expanded nodes.
    pub budget: Option<u64>,
    /// What to do when the goal is blocked, or no path leads there.
    pub if_unreachable: IfUnreachable,
}

/// What to do about a goal on the map that cannot be reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IfUnreachable {
    /// Report why there is no path.
    #[default]
    Fail,
    /// Go to the cell that can be reached whose centre is nearest to the goal's centre (ties: lower
    /// row, then lower column). The plan's last cell says where that is.
    NearestReachable,
}

impl Query {
    /// From `start` to `goal` and nowhere else, without a budget.
    pub const fn new(start: Cell, goal: Cell) -> Self {
        Self { start, goal, budget: None, if_unreachable: IfUnreachable::Fail }
    }
}
