//! A* \[Hart1968\]: a map and two cells -> a shortest 8-connected path.
//!
//! Nodes are expanded in the order of f = g + h, the cost so far plus the octile distance to the
//! goal. The heuristic is consistent, so the first time the goal is expanded its path is a
//! shortest one. Ties go to the larger g (nearer to the goal), then to the lower cell index.
//!
//! # Source
//! \[Hart1968\] P. Hart, N. Nilsson, B. Raphael, "A formal basis for the heuristic determination of
//! minimum cost paths", IEEE Transactions on Systems Science and Cybernetics 4(2), 1968.
//!
//! | paper | here |
//! |---|---|
//! | g(n) | the frontier's path cost, a [`Cost::key`] |
//! | h(n) | [`Cost::octile`] to the goal |
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 16 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched.

use super::{GlobalPlanner, Plan, PlanError, path_cost};
use crate::map::{Cell, CellIndex, Connectivity, SearchMap};
use crate::search::{
    CornerRule, Cost, EightConnected, Frontier, Observer, Query, StepCost, Successors, Uniform,
    UnknownCost, Workspace,
};
use serde::{Deserialize, Serialize};

/// Parameters of [`AStar`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct AStarConfig {
    /// May a diagonal step pass blocked side neighbours? `forbid` or `allow`.
    pub corners: CornerRule,
}

/// A* with 8 neighbours; optimal.
#[derive(Clone, Debug, Default)]
pub struct AStar {
    config: AStarConfig,
}

impl AStar {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "astar";

    /// A planner with these parameters.
    pub const fn new(config: AStarConfig) -> Self {
        Self { config }
    }

    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        cost: impl StepCost,
        frontier: &mut Frontier,
        seen: &mut impl Observer,
    ) -> Result<(), PlanError> {
        let successors = EightConnected::new(map, self.config.corners, cost);
        run(map, query, &successors, frontier, seen)
    }
}

impl GlobalPlanner for AStar {
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
        let frontier = &mut workspace.forward;
        match (UnknownCost::of(map), seen) {
            (None, None) => self.search(map, query, Uniform, frontier, &mut ()),
            (None, Some(mut seen)) => self.search(map, query, Uniform, frontier, &mut seen),
            (Some(cost), None) => self.search(map, query, cost, frontier, &mut ()),
            (Some(cost), Some(mut seen)) => self.search(map, query, cost, frontier, &mut seen),
        }?;
        frontier.path_into(map, map.index(query.goal), &mut plan.cells);
        plan.cost = path_cost(map, &plan.cells);
        plan.statistics = frontier.statistics();
        Ok(())
    }
}

/// Expands nodes until the goal is expanded.
fn run(
    map: &SearchMap,
    query: &Query,
    successors: &impl Successors,
    frontier: &mut Frontier,
    seen: &mut impl Observer,
) -> Result<(), PlanError> {
    let goal = map.index(query.goal);
    let key = |at: CellIndex, g: u64| g + octile(map.cell(at), query.goal);
    frontier.start(map, map.index(query.start));
    loop {
        match query.budget {
            Some(budget) if frontier.statistics().expanded >= budget => {
                return Err(PlanError::BudgetExhausted {
                    budget,
                    statistics: frontier.statistics(),
                });
            }
            _ => {}
        }
        match frontier.expand_best(map, successors, key, seen) {
            Some(expanded) if expanded.at == goal => return Ok(()),
            Some(_) => {}
            None => return Err(PlanError::NoPath { statistics: frontier.statistics() }),
        }
    }
}

fn octile(from: Cell, to: Cell) -> u64 {
    Cost::octile(from.x.abs_diff(to.x), from.y.abs_diff(to.y)).key()
}
