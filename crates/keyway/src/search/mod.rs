//! The engine under every planner: exact costs, neighbour rules, frontiers and their memory,
//! observers.
//!
//! A one-sided search is a loop over one [`Frontier`]; a bidirectional one is a loop over two. The
//! policies (neighbour rule, step cost, observer) are type parameters, so that a search compiles
//! to one loop without indirect calls; they are chosen by name at the edge, in
//! [`crate::plan`].

pub(crate) mod bit_scan;
mod bucket_queue;
mod buckets;
mod cell_tree;
mod cost;
mod frontier;
mod hubs;
mod jump_nodes;
mod jump_points;
mod marks;
mod metric;
mod nearest_node;
mod neighbours;
mod neighbours_24;
mod node_pages;
mod observer;
mod open_list;
mod pattern;
mod random;
mod random_queries;
mod recording;
mod rule;
mod sight;
mod statistics;
mod summed_area;

pub(crate) use cell_tree::{CellTree, TreeNode};
pub use cost::Cost;
pub(crate) use frontier::cells;
pub use frontier::{Expanded, Frontier};
pub(crate) use hubs::{Access, HubMemory};
pub(crate) use jump_nodes::JumpNode;
pub use jump_nodes::JumpNodes;
pub(crate) use jump_points::{Arrival, JumpPoints, JumpVisitor, Place};
pub(crate) use marks::Marks;
pub use metric::{DistanceTo, Euclidean, Manhattan, Mean, Metric, Octile, Zero};
pub use neighbours::{
    CornerRule, Moves, Neighbours, Reversed, Step, StepCost, Successors, Uniform, UnknownCost,
};
pub use neighbours_24::Neighbours24;
pub use observer::{Observer, Side};
pub use open_list::{Entry, OpenList};
pub(crate) use random::Random;
pub use random_queries::random_queries;
pub use recording::{Recording, SearchEvent};
pub use rule::{Accumulated, AtGeneration, Greedy, Rule, StraightLine};
pub use sight::Sight;
pub use statistics::{SearchStatistics, SideStatistics};
pub(crate) use summed_area::SummedArea;

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

/// Reusable memory for searches. It holds no result and has no meaning between calls: a second
/// query on the same map allocates nothing and clears nothing.
///
/// Memory: 16 bytes per cell of the padded map for each side of a search, reserved by its first query,
/// and its open list: 266 kB and 17 to 300 bytes for each node that it held at once; a quarter of a
/// byte more for each side of a bidirectional jump point search. A one-sided jump point
/// search has 1/8 byte per cell, 1 kB for each page of 64 cells that its largest query touched, and an
/// open list for which 1 byte per cell is reserved. A density of the remaining box takes 4 bytes per
/// cell. A random tree has 4.4 bytes per cell, and 32 bytes for each sample that it may draw. What is
/// reserved and not touched uses no memory.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) forward: Frontier,
    pub(crate) backward: Frontier,
    pub(crate) forward_marks: Marks,
    pub(crate) backward_marks: Marks,
    pub(crate) jumps: JumpNodes,
    pub(crate) hubs: HubMemory,
    pub(crate) summed_area: SummedArea,
    pub(crate) tree: CellTree,
}

impl Workspace {
    /// Memory on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        let Self { forward, backward, forward_marks, backward_marks, jumps, hubs, .. } = self;
        let frontiers = forward.memory_bytes() + backward.memory_bytes();
        let marks = forward_marks.memory_bytes() + backward_marks.memory_bytes();
        let jumps = jumps.memory_bytes() + hubs.memory_bytes();
        frontiers + marks + jumps + self.summed_area.memory_bytes() + self.tree.memory_bytes()
    }
}
