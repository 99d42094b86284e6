//! Bidirectional A* as it is usually published \[You2021, Wang2019\]: a map and two cells -> some
//! 8-connected path through the first meeting of a search from the start and one from the goal.
//!
//! Two A* searches, each aiming at the other's root, take turns and expand one node at a time. The
//! first node that both have reached joins their two halves into the path. The method is fast but
//! not optimal: a cheaper path may lead over another node. [`super::BidirectionalOptimal`]
//! continues until no cheaper path is possible.
//!
//! # Source
//! A baseline of three papers, none of which gives more than the name and the idea. \[You2021\]:
//! section 1.3.1 and figure 2. \[Wang2019\]: reference 17, "synchronous bidirectional A*".
//! \[ZhuYin2024\]: table 1.
//!
//! | papers | here |
//! |---|---|
//! | openlist1, openlist2 | the open lists of the two sides |
//! | g | cost from the side's own root, a [`Cost::key`](crate::search::Cost::key) |
//! | h | [`BidirectionalAStarConfig::heuristic`], to the other side's root |
//! | the same node in both open lists | a node that both sides have generated |
//!
//! # Where this differs from the papers
//! The papers leave open:
//! - The turns: one expansion each, the forward side first.
//! - The meeting: a side inserts into its open list a node that the other side has in its list or
//!   has expanded. (Until then no node was reached by both, so the meeting is found at once.) If
//!   one expansion finds several such nodes, the one with the cheapest path counts; among equal
//!   ones, the first counter-clockwise from east.
//! - The order within a side: f, then larger g, then lower cell index.
//! - The corner rule. The papers' own comparisons with this method forbid corner cutting
//!   \[You2021\] or allow it \[Wang2019, ZhuYin2024\].
//! - Costs are directed where unknown cells are penalised: the cost of a step is that of the cell
//!   which the robot *enters*. The backward side prices its step from a to b as the robot's step
//!   from b to a.
//!
//! # Errors / cost
//! See [`PlanError`]; the planner is complete. O(n log n) in the number n of reached cells; 32
//! bytes per cell of the padded map, of which only the pages of reached cells are touched.

use super::best_first::with_costs;
use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::two_sided::{self, Half, Meeting, OpenKeys};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, Stop};
use crate::map::{CellIndex, Connectivity, SearchMap};
use crate::search::{
    Accumulated, CornerRule, DistanceTo, Moves, Neighbours, Observer, Query, Reversed, Side, Sides,
    StepCost, Workspace,
};
use serde::{Deserialize, Serialize};

/// Parameters of [`BidirectionalAStar`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct BidirectionalAStarConfig {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
    /// The estimate of the cost to the other side's root: `octile`, `euclidean`, `manhattan` or
    /// `mean`.
    pub heuristic: Heuristic,
}

/// Bidirectional A* with 8 neighbours that stops at the first meeting of its sides; not optimal.
#[derive(Clone, Debug, Default)]
pub struct BidirectionalAStar {
    config: BidirectionalAStarConfig,
}

impl BidirectionalAStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-astar";

    /// Creates a planner with these parameters.
    pub const fn new(config: BidirectionalAStarConfig) -> Self {
        Self { config }
    }

    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        cost: impl StepCost + Copy,
        sides: &mut Sides,
        seen: &mut impl Observer,
    ) -> Result<CellIndex, PlanError> {
        let moves = Moves::Eight(self.config.corners);
        let there = Neighbours::new(map, moves, cost);
        let back = Neighbours::new(map, moves, Reversed(cost));
        let forward = Half::new(Side::Forward, &mut sides.forward, there, |_| true);
        let backward = Half::new(Side::Backward, &mut sides.backward, back, |_| true);
        with_metric!(self.config.heuristic, metric => {
            let to_goal = Accumulated(DistanceTo::new(map, metric, query.goal));
            let to_start = Accumulated(DistanceTo::new(map, metric, query.start));
            let rule = |side, _| if side == Side::Forward { to_goal } else { to_start };
            let how = (OpenKeys::Kept, Meeting::Generated);
            two_sided::take_turns(map, query, forward, backward, rule, how, seen)
        })
    }
}

impl PlannerParameters for BidirectionalAStarConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(BidirectionalAStar::new(self.clone())))
    }
}

impl GlobalPlanner for BidirectionalAStar {
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
        two_sided::finish(map, (forward, backward), meeting, Stop::SidesMet, plan);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Cell;
    use crate::plan::two_sided::drawn;
    use crate::search::Cost;

    /// f of the forward side, octile. S = (1, 2) inserts (1, 3) with 1 + 3.83, (0, 3) with 1.41 +
    /// 4.83, (0, 2) with 1 + 4.41, (0, 1) with 1.41 + 4 and (1, 1) with 1 + 3 = 4, the best; no
    /// diagonal passes the wall. G = (4, 1) inserts (3, 1) with 1 + 2.41 = 3.41, the best. Then
    /// (1, 1) inserts (2, 1), and (3, 1) as well: the sides have met, with one more step from
    /// (2, 1) to either.
    #[test]
    fn an_expansion_sequence_by_hand() {
        let rows = ["......", ".S##..", "....G.", "......"];
        let (plan, [forward, backward]) =
            drawn::plan(&BidirectionalAStar::default(), &rows).unwrap();
        assert_eq!((forward, backward), (vec![(1, 2), (1, 1)], vec![(4, 1), (3, 1)]));
        let path: Vec<(i32, i32)> = plan.cells.iter().map(|cell| (cell.x, cell.y)).collect();
        assert_eq!(path, [(1, 2), (1, 1), (2, 1), (3, 1), (4, 1)]);
        assert_eq!(plan.cost.steps(), Some(Cost::new(4, 0)));
        assert_eq!((plan.meeting, plan.stop), (Some(Cell::new(2, 1)), Some(Stop::SidesMet)));
    }

    /// In the first turn S inserts (1, 0), which the other side has not reached. Then G inserts
    /// (1, 0): the sides have met before any cell is expanded twice.
    #[test]
    fn generating_is_meeting() {
        let (plan, sides) = drawn::plan(&BidirectionalAStar::default(), &["S.G"]).unwrap();
        assert_eq!(sides, [vec![(0, 0)], vec![(2, 0)]]);
        assert_eq!(plan.meeting, Some(Cell::new(1, 0)));
        // Neighbours: S inserts the other root.
        let (plan, sides) = drawn::plan(&BidirectionalAStar::default(), &["SG"]).unwrap();
        assert_eq!((sides, plan.meeting), ([vec![(0, 0)], vec![]], Some(Cell::new(1, 0))));
    }
}
