//! Lazy Theta* \[Nash2010\]: a map and two cells -> a short path in any direction, with few
//! line-of-sight checks.
//!
//! Theta* (see [`super::ThetaStar`]) checks for every generated cell whether it sees the parent of
//! the node that it was generated from. Lazy Theta* assumes the line of sight, and checks it only
//! when the cell is expanded: once for each expanded node. If the line is blocked, the best of the
//! expanded neighbours becomes the parent. In exchange, values in the open list may be too small.
//!
//! # Source
//! \[Nash2010\]: figure 5.
//!
//! | paper | here |
//! |---|---|
//! | g(s) | a value in the open list, a [`crate::search::Cost::key`] |
//! | h(s), c(s, s') | [`crate::search::Euclidean`], the straight line |
//! | `ComputeCost`, path 2 | `way` below |
//! | `SetVertex`, path 1 | `corrected` below |
//! | `nghbr_vis(s)` | the cells from which there is a step to s |
//!
//! # Where this differs from the paper
//! - Nodes are the centres of cells, not their corners, as for [`super::ThetaStar`].
//! - `SetVertex` takes the neighbour of smallest g(s') + c(s', s); the paper leaves ties open,
//!   here they go to the lower cell index.
//! - The goal's line of sight to its parent is checked, too, when the goal is taken from the open
//!   list.
//! - Collinear waypoints are dropped from the result.
//! - Ties of the open list: f, then larger g, then lower cell index.
//!
//! Unlike that of Theta*, its path may be longer than a shortest one with 8 neighbours: a node may
//! be expanded too early, because of a value that then proves too small.
//!
//! # Errors / cost
//! See [`PlanError`]; maps with penalised cells are refused, as the cost of a line is not defined
//! there. O(n log n) in the number n of reached cells, and a line-of-sight check for each expanded
//! one; 16 bytes per cell of the padded map, of which only the pages of reached cells are touched.

use super::any_angle::{self, Lines, Ways};
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanError};
use crate::map::{CellIndex, Connectivity, SearchMap};
use crate::search::{CornerRule, Expanded, Frontier, GridStep, Observer, Query, Workspace};
use serde::{Deserialize, Serialize};

/// Parameters of [`LazyThetaStar`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LazyThetaStarConfig {
    /// Lines that pass between two cells touching at a corner, one of which is blocked: `forbid`
    /// or `allow`.
    pub corners: CornerRule,
}

/// Lazy Theta*: paths in any direction, a little longer than the shortest ones.
#[derive(Clone, Debug, Default)]
pub struct LazyThetaStar {
    config: LazyThetaStarConfig,
}

impl LazyThetaStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "lazy-theta-star";

    /// Creates a planner with these parameters.
    pub const fn new(config: LazyThetaStarConfig) -> Self {
        Self { config }
    }
}

/// The line of sight to the parent is checked when a cell is expanded.
struct SeenWhenExpanded;

impl Ways for SeenWhenExpanded {
    fn way(
        &self,
        lines: &Lines<'_>,
        parent: Expanded,
        _: Expanded,
        step: GridStep,
        _: Option<u64>,
    ) -> Option<(Expanded, GridStep)> {
        Some((parent, lines.line(parent.at, step.to)))
    }

    fn corrected(
        &self,
        lines: &Lines<'_>,
        frontier: &Frontier,
        node: Expanded,
    ) -> Option<(CellIndex, u64)> {
        if lines.is_free(frontier.parent(node.at), node.at) {
            return None;
        }
        let mut best: Option<(u64, CellIndex)> = None;
        lines.for_each_step(node.at, |GridStep { to: neighbour, cost }| {
            if !frontier.is_closed(neighbour) {
                return;
            }
            let way = frontier.value(neighbour).map(|g| (g + cost, neighbour));
            best = best.into_iter().chain(way).min();
        });
        best.map(|(g, neighbour)| (neighbour, g))
    }
}

impl PlannerParameters for LazyThetaStarConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(LazyThetaStar::new(self.clone())))
    }
}

impl GlobalPlanner for LazyThetaStar {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        self.config.corners.connectivity()
    }

    fn is_any_angle(&self) -> bool {
        true
    }

    fn needs_uniform_cost(&self) -> bool {
        true
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        any_angle::plan(&SeenWhenExpanded, map, query, self.config.corners, workspace, seen, plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::any_angle::watched::{reported, rounded, waypoints};

    /// Over the obstacle, whose corners are not cut. All cells take the parent of the node that
    /// they are generated from; (1, 1) and (2, 0) then prove not to see it.
    #[test]
    fn corrections_by_hand() {
        let (plan, reported) = reported(&LazyThetaStar::default(), &["...", ".#."], (0, 0), (2, 0));
        let expected = [
            ("expanded", (0, 0), (0, 0), 0.0),
            ("generated", (0, 1), (0, 0), 1.0),
            ("expanded", (0, 1), (0, 1), 1.0),
            ("generated", (1, 1), (0, 0), rounded(2f64.sqrt())),
            ("expanded", (1, 1), (1, 1), 2.0),
            ("reparented", (1, 1), (0, 1), 2.0),
            ("generated", (2, 1), (0, 1), 3.0),
            ("expanded", (2, 1), (2, 1), 3.0),
            ("generated", (2, 0), (0, 1), rounded(1.0 + 5f64.sqrt())),
            ("expanded", (2, 0), (2, 0), 4.0),
            ("reparented", (2, 0), (2, 1), 4.0),
        ];
        assert_eq!(reported.0, expected);
        assert_eq!(waypoints(&plan), [(0, 0), (0, 1), (2, 1), (2, 0)]);
        assert_eq!(plan.cost, crate::plan::PlanCost::Length(4.0));
        assert_eq!((plan.statistics.expanded(), plan.statistics.generated()), (5, 5));
    }
}
