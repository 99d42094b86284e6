//! Bidirectional A* with the 24 neighbours of the 5 x 5 block \[Gao2019\]: a map and two cells ->
//! some path whose steps take 16 directions.
//!
//! Like [`super::BidirectionalAStar`], but each side steps to every cell of the 5 x 5 block around
//! a node that a straight line reaches over free cells. Paths turn less and are shorter than with
//! 8 neighbours, at a higher search effort.
//!
//! # Source
//! \[Gao2019\], known here only through \[Wang2019\], where it is reference 18: it searches from
//! both start and goal, in more directions.
//!
//! | there | here |
//! |---|---|
//! | more search directions | [`Neighbours24`]: 24 offsets, of which 8 are collinear repeats |
//! | h | [`Bidirectional24Config::heuristic`], to the other side's root |
//!
//! # Where this differs from the paper
//! The original paper was not available, so all of this is an interpretation:
//! - The 24 offsets of the 5 x 5 block, with every swept cell checked.
//! - Turn, meeting and order are those of [`super::BidirectionalAStar`]. The sides can only meet
//!   at nodes: cells in the middle of a long step are not nodes.
//! - The straight line is the default estimate; the octile distance exceeds the length of a
//!   knight's step.
//!
//! # Errors / cost
//! See [`PlanError`]. The planner is complete, as every single step is among the 24. Maps with
//! penalised cells are refused: the cost of a long step would depend on every cell that it sweeps.
//! O(n log n) in the number n of reached cells, with 24 look-ups per expansion; 32 bytes per cell
//! of the padded map, of which only the pages of reached cells are touched.

use super::any_angle::length;
use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::two_sided::{self, Half, Meeting, OpenKeys};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, Stop};
use crate::map::{CellIndex, Connectivity, SearchMap};
use crate::search::{
    Accumulated, CornerRule, DistanceTo, Neighbours24, Observer, Query, Side, Sides, Workspace,
};
use serde::{Deserialize, Serialize};

/// Parameters of [`Bidirectional24`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Bidirectional24Config {
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`.
    pub corners: CornerRule,
    /// The estimate of the cost to the other side's root: `octile`, `euclidean`, `manhattan` or
    /// `mean`.
    pub heuristic: Heuristic,
}

impl Default for Bidirectional24Config {
    fn default() -> Self {
        Self { corners: CornerRule::Forbid, heuristic: Heuristic::Euclidean }
    }
}

/// Bidirectional A* with 24 neighbours that stops at the first meeting of its sides; not optimal.
#[derive(Clone, Debug, Default)]
pub struct Bidirectional24 {
    config: Bidirectional24Config,
}

impl Bidirectional24 {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-24";

    /// Creates a planner with these parameters.
    pub const fn new(config: Bidirectional24Config) -> Self {
        Self { config }
    }

    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        sides: &mut Sides,
        seen: &mut impl Observer,
    ) -> Result<CellIndex, PlanError> {
        let steps = Neighbours24::new(map, self.config.corners);
        let forward = Half::new(Side::Forward, &mut sides.forward, steps, |_| true);
        let backward = Half::new(Side::Backward, &mut sides.backward, steps, |_| true);
        with_metric!(self.config.heuristic, metric => {
            let to_goal = Accumulated(DistanceTo::new(map, metric, query.goal));
            let to_start = Accumulated(DistanceTo::new(map, metric, query.start));
            let rule = |side, _| if side == Side::Forward { to_goal } else { to_start };
            let how = (OpenKeys::Kept, Meeting::Generated);
            two_sided::take_turns(map, query, forward, backward, rule, how, seen)
        })
    }
}

impl PlannerParameters for Bidirectional24Config {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Bidirectional24::new(self.clone())))
    }
}

impl GlobalPlanner for Bidirectional24 {
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
        let sides = workspace.part::<Sides>();
        let meeting = match seen {
            None => self.search(map, query, sides, &mut ()),
            Some(mut seen) => self.search(map, query, sides, &mut seen),
        }?;
        let Sides { forward, backward } = sides;
        two_sided::join(map, (forward, backward), meeting, plan);
        plan.cost = length(&plan.cells);
        plan.stop = Some(Stop::SidesMet);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, LayerConfig, OccupancyGrid, UnknownPolicy};
    use crate::plan::two_sided::drawn;

    /// S = (0, 2), G = (5, 0). The best node of S is the knight's step to (2, 1): f = 2.236 +
    /// 3.162 = 5.398; (1, 1) has 1.414 + 4.123 = 5.537, (2, 0) 2.828 + 3 = 5.828. The best node of
    /// G is (4, 0) with 1 + 4.472 = 5.472; the knight's step to (4, 2) has 2.236 + 4 = 6.236, and
    /// the one to (3, 1) is blocked. From (2, 1) the wall hides everything to the right, and no
    /// known value improves. From (4, 0) a double step reaches (2, 0).
    #[test]
    fn an_expansion_sequence_by_hand() {
        let rows = ["S.....", "...#..", ".....G"];
        let (plan, [forward, backward]) = drawn::plan(&Bidirectional24::default(), &rows).unwrap();
        assert_eq!((forward, backward), (vec![(0, 2), (2, 1)], vec![(5, 0), (4, 0)]));
        let path: Vec<(i32, i32)> = plan.cells.iter().map(|cell| (cell.x, cell.y)).collect();
        assert_eq!(path, [(0, 2), (2, 0), (4, 0), (5, 0)]);
        assert_eq!((plan.meeting, plan.stop), (Some(Cell::new(2, 0)), Some(Stop::SidesMet)));
        // 2 sqrt(2) + 2 + 1.
        assert!((plan.cost.cells() - 5.828_427).abs() < 1e-6);
    }

    #[test]
    fn penalised_cells_are_refused() {
        let grid = OccupancyGrid::from_ascii(&[".?."]);
        let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let query = Query::new(Cell::new(0, 0), Cell::new(2, 0));
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let result =
            Bidirectional24::default().plan_into(&map, &query, &mut workspace, None, &mut plan);
        assert_eq!(result, Err(PlanError::NeedsUniformCost { planner: "bidirectional-24" }));
    }
}
