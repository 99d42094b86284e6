//! Bidirectional A* that is provably optimal, NBA* \[Pijls2009\]: a map and two cells -> a shortest
//! 8-connected path.
//!
//! One A* from the start and one from the goal share the cells: a cell that either side has closed
//! is excluded for the other, so no cell is expanded twice. Any cell that both sides have reached
//! gives a path; the shortest so far has length L. Cells that cannot lie on a shorter one are
//! *rejected*: closed, but not expanded.
//!
//! # Source
//! \[Pijls2009\]: the algorithm and its theorem.
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | M | cells that neither side has closed | the middle |
//! | g1, g2 | the sides' values, a [`Cost::key`](crate::search::Cost::key) | cost from the start, to the goal |
//! | h1, h2 | `to_target`, octile | estimated cost to the goal, from the start |
//! | f1 = g1 + h1, f2 = g2 + h2 | the key of [`Accumulated`] | |
//! | F1, F2 | `lowest_key` | smallest f1, f2 of the cells in M, never decreasing |
//! | L | [`Meeting::cost`] | cost of the best path so far |
//!
//! # Why it is optimal
//! Let h1 and h2 be consistent and d the cost of a shortest path. *While L > d, neither open list
//! is empty, and F1 <= d and F2 <= d.* So when a side has no open cell left, or none with f < L,
//! then L = d.
//!
//! Proof. As long as L > d, some shortest path v0 .. vk can be cut in three: cells before vi,
//! which the forward side has expanded, with their true g1; cells after vj, which the backward
//! side has expanded, with their true g2; and between them, i < j, cells of M. Then vi and vj are
//! open with their true values, and f1(vi) <= d and f2(vj) <= d by consistency. Initially i = 0
//! and j = k, and the invariant is kept:
//! - Let the forward side close a cell vm of the middle (the other side is its mirror image). It
//!   had the smallest f1, so g1(vm) + h1(vm) <= f1(vi), which with consistency makes g1(vm) true.
//!   The path by which it was reached, followed by vm .. vk, is a shortest path as well, and
//!   replaces v0 .. vk.
//! - vm is not rejected: g1(vm) + h1(vm) <= d < L; and g1(vm) + F2 - h2(vm) < L, too, because F2
//!   <= f2(vj) = g2(vj) + h2(vj) and h2(vj) <= h2(vm) + c(vm, vj), so F2 - h2(vm) is at most the
//!   cost from vm to the goal. (vj itself has both true values only when L = d.)
//! - So vm is expanded, and the next cell, which is in M, gets its true g1: i becomes m + 1. If
//!   that is j, both values of vj are true, and L = d.
//!
//! The octile distance is consistent in both directions, even with penalties, which only raise
//! costs.
//!
//! # Where this differs from the paper
//! - The side with the shorter open list moves, in a tie the forward one. The paper leaves the
//!   choice free.
//! - The search ends as soon as F1 >= L or F2 >= L: the remaining cells would be rejected one by
//!   one.
//! - F2 is the value after the backward side's last move, and F1 likewise; cells that the other
//!   side has closed since may have raised the true value. A lower value only rejects less.
//! - Costs are directed where unknown cells are penalised: the cost of a step is that of the cell
//!   which the robot *enters*. The backward side prices its step from a to b as the robot's step
//!   from b to a.
//! - Order within a side: f, then larger g, then lower cell index.
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 32 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched. Rejected cells count as expanded:
//! they were taken from an open list.

use super::best_first::{check_budget, with_costs};
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanError, Stop, two_sided};
use crate::map::{CellIndex, Connectivity, SearchMap};
use crate::search::{
    Accumulated, CornerRule, DistanceTo, Frontier, GridStep, Moves, Neighbours, Observer, Octile,
    Query, Reversed, Side, Sides, StepCost, Successors, Workspace, cells,
};
use serde::{Deserialize, Serialize};

/// Parameters of [`BidirectionalOptimal`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct BidirectionalOptimalConfig {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
}

/// Bidirectional A* with 8 neighbours; optimal.
#[derive(Clone, Debug, Default)]
pub struct BidirectionalOptimal {
    config: BidirectionalOptimalConfig,
}

impl BidirectionalOptimal {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-optimal";

    /// Creates a planner with these parameters.
    pub const fn new(config: BidirectionalOptimalConfig) -> Self {
        Self { config }
    }

    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        cost: impl StepCost + Copy,
        sides: &mut Sides,
        seen: &mut impl Observer,
    ) -> Result<Meeting, PlanError> {
        let moves = Moves::Eight(self.config.corners);
        let to_start = DistanceTo::new(map, Octile, query.start);
        let to_goal = DistanceTo::new(map, Octile, query.goal);
        let (start, goal) = (map.index(query.start), map.index(query.goal));
        let forward = Half {
            frontier: &mut sides.forward,
            steps: Neighbours::new(map, moves, cost),
            to_root: to_start,
            to_target: to_goal,
            lowest_key: to_goal.from(start),
            side: Side::Forward,
        };
        let backward = Half {
            frontier: &mut sides.backward,
            steps: Neighbours::new(map, moves, Reversed(cost)),
            to_root: to_goal,
            to_target: to_start,
            lowest_key: to_start.from(goal),
            side: Side::Backward,
        };
        run(map, query, forward, backward, seen)
    }
}

impl PlannerParameters for BidirectionalOptimalConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(BidirectionalOptimal::new(self.clone())))
    }

    fn is_optimal(&self) -> bool {
        self.corners == CornerRule::Forbid
    }
}

impl GlobalPlanner for BidirectionalOptimal {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        self.config.corners.connectivity()
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let sides = workspace.part::<Sides>();
        let meeting = with_costs!(map, seen, cost, seen => {
            self.search(map, query, cost, sides, seen)
        })?;
        let Sides { forward, backward } = sides;
        two_sided::finish(map, (forward, backward), meeting.at, Stop::NothingBetter, plan);
        Ok(())
    }
}

/// The cell at which the best path so far passes from one side's tree into the other's.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    at: CellIndex,
    /// L, the cost of that path.
    cost: u64,
}

/// One side of the search.
struct Half<'a, N> {
    frontier: &'a mut Frontier,
    steps: N,
    to_root: DistanceTo<Octile>,
    to_target: DistanceTo<Octile>,
    lowest_key: u64,
    side: Side,
}

fn run(
    map: &SearchMap,
    query: &Query,
    mut forward: Half<'_, impl Successors>,
    mut backward: Half<'_, impl Successors>,
    seen: &mut impl Observer,
) -> Result<Meeting, PlanError> {
    let (start, goal) = (map.index(query.start), map.index(query.goal));
    forward.frontier.start(map, start, forward.lowest_key);
    backward.frontier.start(map, goal, backward.lowest_key);
    let cost = if start == goal { 0 } else { u64::MAX };
    let mut best = Meeting { at: start, cost };
    loop {
        let statistics = two_sided::statistics(forward.frontier, backward.frontier);
        let is_forward = forward.frontier.open_len() <= backward.frontier.open_len();
        let may_improve = if is_forward {
            forward.find_lowest_key(backward.frontier, best)
        } else {
            backward.find_lowest_key(forward.frontier, best)
        };
        if !may_improve && best.cost == u64::MAX {
            return Err(PlanError::NoPath { statistics });
        }
        if !may_improve {
            return Ok(best);
        }
        check_budget(query, statistics)?;
        if is_forward {
            forward.step(map, backward.frontier, backward.lowest_key, &mut best, seen);
        } else {
            backward.step(map, forward.frontier, forward.lowest_key, &mut best, seen);
        }
    }
}

impl<N: Successors> Half<'_, N> {
    /// Updates F. False if no open cell of this side can lie on a path better than `best`.
    fn find_lowest_key(&mut self, other: &Frontier, best: Meeting) -> bool {
        match self.frontier.best_key(|at| other.is_closed(at)) {
            Some(key) if key < best.cost => {
                self.lowest_key = key;
                true
            }
            _ => false,
        }
    }

    /// Closes the best cell, and expands it unless no shorter path can lead over it.
    fn step(
        &mut self,
        map: &SearchMap,
        other: &Frontier,
        other_lowest_key: u64,
        best: &mut Meeting,
        seen: &mut impl Observer,
    ) {
        let Some(node) = self.frontier.take_best() else { return };
        if seen.is_watching() {
            seen.expanded(self.side, map.cell(node.at), cells(node.g));
        }
        // g1(u) + F2 - h2(u) >= L.
        if node.g - self.to_root.from(node.at) + other_lowest_key >= best.cost {
            return;
        }
        let rule = Accumulated(self.to_target);
        self.steps.for_each(node.at, |step: GridStep| {
            if other.is_closed(step.to) {
                return;
            }
            let Some(g) = self.frontier.offer(node, step, &rule) else { return };
            if seen.is_watching() {
                let (at, parent) = (map.cell(step.to), map.cell(node.at));
                seen.generated(self.side, at, parent, cells(g));
            }
            // L = min(L, g1(v) + g2(v)).
            if let Some(cost) = other.value(step.to).map(|rest| g + rest)
                && cost < best.cost
            {
                *best = Meeting { at: step.to, cost };
                seen.met(map.cell(step.to));
            }
        });
    }
}
