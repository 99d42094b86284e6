//! A* with 4 neighbours \[Hart1968\]: a map and two cells -> a shortest 4-connected path.
//!
//! The same search as [`super::AStar`] without diagonal steps. All estimates are consistent among 4
//! neighbours, so its path is a shortest one *of those without diagonal steps*; the Manhattan
//! distance is the largest of them, hence the default.
//!
//! # Source
//! \[Hart1968\].
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 16 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched.

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, best_first};
use crate::map::{Connectivity, SearchMap};
use crate::search::{Accumulated, DistanceTo, Moves, Observer, Query, Workspace};
use serde::{Deserialize, Serialize};

/// Parameters of [`AStar4`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct AStar4Config {
    /// The estimate of the remaining cost: `octile`, `euclidean`, `manhattan` or `mean`.
    pub heuristic: Heuristic,
}

impl Default for AStar4Config {
    fn default() -> Self {
        Self { heuristic: Heuristic::Manhattan }
    }
}

/// A* with 4 neighbours; optimal among paths without diagonal steps.
#[derive(Clone, Debug, Default)]
pub struct AStar4 {
    config: AStar4Config,
}

impl AStar4 {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "astar4";

    /// Creates a planner with these parameters.
    pub const fn new(config: AStar4Config) -> Self {
        Self { config }
    }
}

impl PlannerParameters for AStar4Config {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(AStar4::new(self.clone())))
    }
}

impl GlobalPlanner for AStar4 {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        with_metric!(self.config.heuristic, metric => {
            let rule = Accumulated(DistanceTo::new(map, metric, query.goal));
            best_first::plan(map, query, Moves::Four, &rule, workspace, seen, plan)
        })
    }
}
