//! The evaluation of nodes, and the choice between paths to a node.

use super::GridStep;
use super::metric::{DistanceTo, Euclidean, Metric};
use crate::map::CellIndex;

/// The rule of a best-first search: the value g that is recorded for a node, the key by which
/// nodes are expanded, and the choice between two paths to an open node.
///
/// Closed nodes are not reopened, unless [`Self::reopens`]. So every search terminates, and as a
/// parent is always closed before its children, parents never form a cycle.
pub(crate) trait Rule {
    /// True if an open node accepts another path of equal value, and not only of a smaller one.
    const TAKES_EQUAL: bool = false;
    /// True if the search ends when the goal is inserted into the open list, and not only when it
    /// is taken out.
    const ENDS_AT_GENERATION: bool = false;

    /// True if a closed node is reopened when a path of smaller value to it is found. Only for
    /// rules whose values grow along every step: each node is then reopened finitely often.
    fn reopens(&self) -> bool {
        false
    }

    /// The value of a node reached by `step` from a node with value `g`.
    fn value(&self, g: u64, step: GridStep) -> u64;

    /// The key of a node with value `g`.
    fn key(&self, at: CellIndex, g: u64) -> u64;
}

/// f = g + h with g the cost of the path: A* \[Hart1968\], Dijkstra's algorithm with h = 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accumulated<M>(pub(crate) DistanceTo<M>);

impl<M: Metric> Rule for Accumulated<M> {
    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        g + self.0.from(at)
    }
}

/// f = g + h with g the straight line from the start \[Wang2019, eq. (3) and (4)\].
///
/// A node's value does not depend on the path to it. An open node accepts a value that is "smaller
/// or equal" (step 5 there); the effect is that its parent is the neighbour that was expanded
/// last. The search ends when the goal appears in the open list (step 3).
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightLine<M> {
    /// The distance from the start.
    pub(crate) from_start: DistanceTo<Euclidean>,
    /// The distance to the goal.
    pub(crate) to_goal: DistanceTo<M>,
}

impl<M: Metric> Rule for StraightLine<M> {
    const TAKES_EQUAL: bool = true;
    const ENDS_AT_GENERATION: bool = true;

    fn value(&self, _: u64, step: GridStep) -> u64 {
        self.from_start.from(step.to)
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        g + self.to_goal.from(at)
    }
}

/// A rule whose search ends when the goal appears in the open list \[Wang2019, step 3\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtGeneration<R>(pub(crate) R);

impl<R: Rule> Rule for AtGeneration<R> {
    const TAKES_EQUAL: bool = R::TAKES_EQUAL;
    const ENDS_AT_GENERATION: bool = true;

    fn reopens(&self) -> bool {
        self.0.reopens()
    }

    fn value(&self, g: u64, step: GridStep) -> u64 {
        self.0.value(g, step)
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        self.0.key(at, g)
    }
}

/// f = h: greedy best-first search. g is the cost of the path, which decides between two paths to
/// an open node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Greedy<M>(pub(crate) DistanceTo<M>);

impl<M: Metric> Rule for Greedy<M> {
    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    fn key(&self, at: CellIndex, _: u64) -> u64 {
        self.0.from(at)
    }
}
