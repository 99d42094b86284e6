//! Dijkstra's algorithm \[Dijkstra1959\]: a map and two cells -> a shortest 8-connected path.
//!
//! Nodes are expanded in the order of their path cost, uniformly in all directions, until the goal
//! is expanded. It is A* ([`super::AStar`]) with the estimate 0: the uninformed baseline.
//!
//! # Source
//! \[Dijkstra1959\]: problem 2.
//!
//! | paper | here |
//! |---|---|
//! | set A | closed nodes |
//! | set B | the open list |
//! | set C | nodes that were not reached |
//!
//! # Where this differs from the paper
//! A node of set B is reinserted when a shorter path to it is found, and its older entry is
//! skipped.
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 16 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched.

use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanError, best_first};
use crate::map::{Connectivity, SearchMap};
use crate::search::{Accumulated, CornerRule, DistanceTo, Moves, Observer, Query, Workspace, Zero};
use serde::{Deserialize, Serialize};

/// Parameters of [`Dijkstra`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct DijkstraConfig {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
}

/// Dijkstra's algorithm with 8 neighbours; optimal.
#[derive(Clone, Debug, Default)]
pub struct Dijkstra {
    config: DijkstraConfig,
}

impl Dijkstra {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "dijkstra";

    /// Creates a planner with these parameters.
    pub const fn new(config: DijkstraConfig) -> Self {
        Self { config }
    }
}

impl PlannerParameters for DijkstraConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Dijkstra::new(self.clone())))
    }

    fn is_optimal(&self) -> bool {
        self.corners == CornerRule::Forbid
    }
}

impl GlobalPlanner for Dijkstra {
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
        let rule = Accumulated(DistanceTo::new(map, Zero, query.goal));
        let moves = Moves::Eight(self.config.corners);
        best_first::plan(map, query, moves, &rule, workspace, seen, plan)
    }
}
