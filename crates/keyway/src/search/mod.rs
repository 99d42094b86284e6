//! The engine under every planner: exact costs, neighbour rules, frontiers and their memory,
//! observers.
//!
//! A one-sided search is a loop over one [`Frontier`]; a bidirectional one is a loop over two. The
//! policies (neighbour rule, step cost, observer) are type parameters, so that a search compiles
//! to one loop without indirect calls; they are chosen by name at the edge, in
//! [`crate::plan`].

mod bucket_queue;
mod cost;
mod frontier;
mod hubs;
mod jump_nodes;
mod jump_points;
mod neighbours;
mod node_pages;
mod observer;
mod pattern;

pub use cost::Cost;
pub use frontier::{Expanded, Frontier, SearchStatistics};
pub(crate) use hubs::{Access, HubMemory};
pub(crate) use jump_nodes::JumpNode;
pub use jump_nodes::JumpNodes;
pub(crate) use jump_points::{Arrival, JumpPoints, JumpVisitor, Place};
pub use neighbours::{
    CornerRule, EightConnected, Step, StepCost, Successors, Uniform, UnknownCost,
};
pub use observer::{Observer, Side};

use crate::map::Cell;

/// What is asked of a planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Query {
    /// Where the path begins.
    pub start: Cell,
    /// Where it ends.
    pub goal: Cell,
    /// Give up after so many expanded nodes.
    pub budget: Option<u64>,
}

impl Query {
    /// From `start` to `goal`, without a budget.
    pub const fn new(start: Cell, goal: Cell) -> Self {
        Self { start, goal, budget: None }
    }
}

/// Reusable memory for searches. It holds no result and has no meaning between calls: a second
/// query on the same map allocates nothing and clears nothing.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) forward: Frontier,
    pub(crate) jumps: JumpNodes,
    pub(crate) hubs: HubMemory,
}

impl Workspace {
    /// Memory on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        self.forward.memory_bytes() + self.jumps.memory_bytes() + self.hubs.memory_bytes()
    }
}
