//! A* \[Hart1968\]: a map and two cells -> a shortest 8-connected path.
//!
//! Nodes are expanded in the order of f = g + h, the cost so far plus an estimate of the rest. With
//! a consistent estimate (octile, the default, or Euclidean) the first time the goal is expanded
//! its path is a shortest one. Ties go to the larger g (nearer to the goal), then to the lower cell
//! index.
//!
//! # Source
//! \[Hart1968\]. \[Wang2019\]: equations (3) to (5), steps 1 to 8. \[You2021\]: equation (3), see
//! [`Heuristic::Mean`].
//!
//! | paper | here |
//! |---|---|
//! | g(n) \[Hart1968\] | [`PathCost::Accumulated`], a [`crate::search::Cost::key`] |
//! | g(n) \[Wang2019, eq. (4)\] | [`PathCost::StraightLine`] |
//! | h(n) | [`AStarConfig::heuristic`]; \[Wang2019, eq. (5)\] is `euclidean` |
//! | Open, Closed | the open list; a bit of each node |
//!
//! # The traditional A* of \[Wang2019\]
//! There g(n) is the straight line from the start to n, not the cost of a path. The parameters
//! `g = "straight-line"`, `heuristic = "euclidean"` and `corners = "allow"` give exactly that
//! search. An open cell that is generated again has the same f, which is "smaller or equal" (step
//! 5), so its parent becomes the cell expanded last. Closed cells are skipped. The search ends
//! when the goal appears in the open list (step 3), inserted by the cell expanded last. A cell is
//! closed once and after its parent, so the search terminates, and the parents of the goal lead
//! back to the start over legal steps. That path need not be a shortest one.
//!
//! # Where this differs from the papers
//! Tie-breaking, on which the papers are silent. In the traditional A* a larger straight-line g
//! goes first.
//!
//! # Errors / cost
//! See [`PlanError`]. O(n log n) in the number n of reached cells; 16 bytes per cell of the padded
//! map, of which only the pages of reached cells are touched.

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, best_first};
use crate::map::{Connectivity, SearchMap};
use crate::search::{
    Accumulated, CornerRule, DistanceTo, Euclidean, Moves, Observer, Query, StraightLine, Workspace,
};
use serde::{Deserialize, Serialize};

/// The meaning of g.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PathCost {
    /// The cost of the path from the start.
    #[default]
    Accumulated,
    /// The straight line from the start \[Wang2019, eq. (4)\]; the search then ends when the goal
    /// appears in the open list.
    StraightLine,
}

/// Parameters of [`AStar`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct AStarConfig {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
    /// The estimate of the remaining cost: `octile`, `euclidean`, `manhattan` or `mean`. Paths are
    /// shortest ones with the first two.
    pub heuristic: Heuristic,
    /// The cost of a node: `accumulated` along its path, or the `straight-line` from the start,
    /// which does not give shortest paths.
    pub g: PathCost,
}

impl AStarConfig {
    /// True if paths are shortest ones under the config's corner rule.
    pub fn is_exact(&self) -> bool {
        self.heuristic.is_consistent() && self.g == PathCost::Accumulated
    }
}

/// A* with 8 neighbours; optimal with the default config.
#[derive(Clone, Debug, Default)]
pub struct AStar {
    config: AStarConfig,
}

impl AStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "astar";

    /// Creates a planner with these parameters.
    pub const fn new(config: AStarConfig) -> Self {
        Self { config }
    }
}

impl PlannerParameters for AStarConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(AStar::new(self.clone())))
    }

    fn is_optimal(&self) -> bool {
        self.corners == CornerRule::Forbid && self.is_exact()
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
        let AStarConfig { corners, heuristic, g } = self.config;
        let moves = Moves::Eight(corners);
        with_metric!(heuristic, metric => {
            let to_goal = DistanceTo::new(map, metric, query.goal);
            match g {
                PathCost::Accumulated => {
                    let rule = Accumulated(to_goal);
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
                PathCost::StraightLine => {
                    let from_start = DistanceTo::new(map, Euclidean, query.start);
                    let rule = StraightLine { from_start, to_goal };
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
            }
        })
    }
}
