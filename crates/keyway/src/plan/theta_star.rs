//! Theta* \[Nash2007\]: a map and two cells -> a short path in any direction.
//!
//! A* whose nodes may have any node as a parent, not only a neighbour: a cell that is generated
//! from a node adopts that node's parent if the two see each other. So only the search follows the
//! edges of the grid, not the path, which turns only at obstacles. Paths are not shortest
//! any-angle paths, but hardly longer. [`super::LazyThetaStar`] checks lines of sight less often.
//!
//! # Source
//! \[Nash2007\], and \[Daniel2010\]: the basic Theta*, figure 4.
//!
//! | paper | here |
//! |---|---|
//! | g(s) | a value in the open list, a [`crate::search::Cost::key`] |
//! | h(s), c(s, s') | [`crate::search::Euclidean`], the straight line |
//! | parent(s) | [`crate::search::Frontier::parent`] |
//! | lineofsight(s, s') | [`crate::search::Sight`] |
//! | path 1, path 2 | over s, over parent(s): the two results of `way` below |
//!
//! # Never longer than a shortest path with 8 neighbours
//! Let o(v) be the cost of a shortest path with 8 neighbours from the start to v. *A node v that is
//! expanded has g(v) <= o(v).*
//!
//! Proof. Let v be the first node for which it fails, and u the first node of a shortest path with
//! 8 neighbours to v that was not expanded before v; its predecessor w was, with g(w) <= o(w). Path
//! 2 is no longer than path 1 (triangle inequality), so w gave u a value of at most g(w) + c(w, u)
//! <= o(u). If u is v, this is g(v) <= o(v). Otherwise u is open, and as h is consistent, f(u) <=
//! o(u) + h(u) <= o(v) + h(v) < g(v) + h(v) = f(v): u comes before v.
//!
//! It holds for the rounded numbers as well: steps cost their length rounded up, lines theirs
//! rounded down, so the triangle inequality of c(p, s') <= c(p, s) + (step from s to s') survives,
//! and so does the consistency of h.
//!
//! # Where this differs from the paper
//! - Nodes are the centres of cells, not their corners: paths of this crate lead from centre to
//!   centre. A line is free under the same corner rule as a diagonal step.
//! - The line of sight is checked only if path 2 is shorter than the known path. Otherwise path 1,
//!   which is never shorter, would not be taken either: the same search, with fewer checks.
//! - Expanded nodes are not reopened, as in the paper's figure. As f may decrease along a path,
//!   the path to a node need not be the best one that could be found.
//! - Collinear waypoints are dropped from the result.
//! - Ties: f, then larger g, then lower cell index.
//!
//! # Errors / cost
//! See [`PlanError`]; maps with penalised cells are refused, as the cost of a line is not defined
//! there. O(n log n) in the number n of reached cells, and at most 8 n line-of-sight checks; 16
//! bytes per cell of the padded map, of which only the pages of reached cells are touched.

use super::any_angle::{self, Lines, Ways};
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanError};
use crate::map::{Connectivity, SearchMap};
use crate::search::{CornerRule, Expanded, GridStep, Observer, Query, Workspace};
use serde::{Deserialize, Serialize};

/// Parameters of [`ThetaStar`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ThetaStarConfig {
    /// Lines that pass between two cells touching at a corner, one of which is blocked: `forbid`
    /// or `allow`.
    pub corners: CornerRule,
}

/// Theta*: paths in any direction, a little longer than the shortest ones.
#[derive(Clone, Debug, Default)]
pub struct ThetaStar {
    config: ThetaStarConfig,
}

impl ThetaStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "theta-star";

    /// Creates a planner with these parameters.
    pub const fn new(config: ThetaStarConfig) -> Self {
        Self { config }
    }
}

/// The line of sight to the parent is checked when a cell is generated.
struct SeenWhenGenerated;

impl Ways for SeenWhenGenerated {
    fn way(
        &self,
        lines: &Lines<'_>,
        parent: Expanded,
        node: Expanded,
        step: GridStep,
        known: Option<u64>,
    ) -> Option<(Expanded, GridStep)> {
        let line = lines.line(parent.at, step.to);
        if known.is_some_and(|known| known <= parent.g + line.cost) {
            return None;
        }
        Some(if lines.is_free(parent.at, step.to) { (parent, line) } else { (node, step) })
    }
}

impl PlannerParameters for ThetaStarConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(ThetaStar::new(self.clone())))
    }
}

impl GlobalPlanner for ThetaStar {
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
        any_angle::plan(&SeenWhenGenerated, map, query, self.config.corners, workspace, seen, plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::any_angle::watched::{reported, waypoints};

    /// Over the obstacle, whose corners are not cut.
    ///
    /// (0, 1) is reached from the start, in a straight line. (1, 1) does not see the start: path 1.
    /// (2, 1) sees the parent of (1, 1), which is (0, 1): path 2. (2, 0) does not: path 1.
    #[test]
    fn path_1_and_path_2_by_hand() {
        let (plan, reported) = reported(&ThetaStar::default(), &["...", ".#."], (0, 0), (2, 0));
        let expected = [
            ("expanded", (0, 0), (0, 0), 0.0),
            ("generated", (0, 1), (0, 0), 1.0),
            ("expanded", (0, 1), (0, 1), 1.0),
            ("generated", (1, 1), (0, 1), 2.0),
            ("expanded", (1, 1), (1, 1), 2.0),
            ("generated", (2, 1), (0, 1), 3.0),
            ("expanded", (2, 1), (2, 1), 3.0),
            ("generated", (2, 0), (2, 1), 4.0),
            ("expanded", (2, 0), (2, 0), 4.0),
        ];
        assert_eq!(reported.0, expected);
        assert_eq!(waypoints(&plan), [(0, 0), (0, 1), (2, 1), (2, 0)]);
        assert_eq!(plan.cost, crate::plan::PlanCost::Length(4.0));
        assert_eq!((plan.statistics.expanded(), plan.statistics.generated()), (5, 5));
    }

    #[test]
    fn straight_to_what_the_start_sees() {
        let (plan, _) =
            reported(&ThetaStar::default(), &["......", ".#....", "......"], (0, 0), (5, 1));
        assert_eq!(waypoints(&plan), [(0, 0), (5, 1)]);
        assert_eq!(plan.cost, crate::plan::PlanCost::Length(26f64.sqrt()));
    }
}
