//! Greedy best-first search \[Doran1966\]: a map and two cells -> some 8-connected path, quickly.
//!
//! Expands the node with the smallest estimated distance to the goal next, regardless of its path
//! cost: in \[Wang2019\], where it is called BFS, it is A* whose g has weight 0. Paths are not
//! shortest ones.
//!
//! # Source
//! \[Doran1966\]. \[Wang2019\]: section 1.2.
//!
//! | paper | here |
//! |---|---|
//! | h(n) | [`GreedyConfig::heuristic`]; the papers' straight line is `euclidean` |
//!
//! # Where this differs from the papers
//! - Of two paths to an open node the shorter one is kept, as h does not tell them apart.
//! - Ties go to the node with the longer path, then to the lower cell index.
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 16 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched.

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, best_first};
use crate::map::{Connectivity, SearchMap};
use crate::search::{CornerRule, DistanceTo, Greedy, Moves, Observer, Query, Workspace};
use serde::{Deserialize, Serialize};

/// Parameters of [`GreedyBestFirst`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct GreedyConfig {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
    /// The estimate that orders the nodes: `octile`, `euclidean`, `manhattan` or `mean`.
    pub heuristic: Heuristic,
}

/// Greedy best-first search with 8 neighbours; not optimal.
#[derive(Clone, Debug, Default)]
pub struct GreedyBestFirst {
    config: GreedyConfig,
}

impl GreedyBestFirst {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "greedy";

    /// Creates a planner with these parameters.
    pub const fn new(config: GreedyConfig) -> Self {
        Self { config }
    }
}

impl PlannerParameters for GreedyConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(GreedyBestFirst::new(self.clone())))
    }
}

impl GlobalPlanner for GreedyBestFirst {
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
        let moves = Moves::Eight(self.config.corners);
        with_metric!(self.config.heuristic, metric => {
            let rule = Greedy(DistanceTo::new(map, metric, query.goal));
            best_first::plan(map, query, moves, &rule, workspace, seen, plan)
        })
    }
}
