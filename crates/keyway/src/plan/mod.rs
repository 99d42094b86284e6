//! Global planners: from a map and a query to a path, one file per method.
//!
//! ```
//! use keyway::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
//! use keyway::plan::{Plan, PlannerConfig};
//! use keyway::search::{Query, Workspace};
//!
//! let grid = OccupancyGrid::from_ascii(&["......", ".####.", "......"]);
//! let map = SearchMap::new(&grid, LayerConfig::default())?;
//! let planner = PlannerConfig::by_name("jps").expect("a name").build(&map)?;
//! // Both are kept from query to query, which then allocates nothing.
//! let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
//! let query = Query::new(Cell::new(0, 0), Cell::new(5, 2));
//! planner.plan_into(&map, &query, &mut workspace, None, &mut plan)?;
//! assert_eq!((plan.cost.cells(), plan.cells.len()), (7.0, 8));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A planner of your own implements [`GlobalPlanner`]; the example `own_planner` does so outside
//! the crate.

mod any_angle;
mod astar;
mod astar4;
mod best_first;
mod bidirectional_24;
mod bidirectional_astar;
mod bidirectional_jps;
mod bidirectional_optimal;
mod config;
mod cost;
mod density_astar;
mod dijkstra;
mod ends;
mod error;
mod greedy;
mod heuristic;
mod hsta;
mod jps;
mod jump_points;
mod lazy_theta_star;
mod nearest_first;
mod parameters;
mod prepare_progress;
mod prepared;
mod ratio_astar;
mod rrt;
mod shortest;
mod theta_star;
mod two_sided;

pub use astar::{AStar, AStarConfig, PathCost};
pub use astar4::{AStar4, AStar4Config};
pub use bidirectional_24::{Bidirectional24, Bidirectional24Config};
pub use bidirectional_astar::{BidirectionalAStar, BidirectionalAStarConfig};
pub use bidirectional_jps::{
    BidirectionalJps, BidirectionalJpsConfig, BidirectionalJpsFixed, BidirectionalJpsFixedConfig,
    JumpMeeting,
};
pub use bidirectional_optimal::{BidirectionalOptimal, BidirectionalOptimalConfig};
pub use config::PlannerConfig;
pub use cost::PlanCost;
pub use density_astar::{Closed, Density, DensityAStar, DensityAStarConfig, EstimateWeight};
pub use dijkstra::{Dijkstra, DijkstraConfig};
pub use error::{Advice, Miss, PathEnd, PlanError};
pub use greedy::{GreedyBestFirst, GreedyConfig};
pub use heuristic::Heuristic;
pub use hsta::{Correction, DistanceUnit, Hsta, HstaConfig, IfNoPath, Weight, WeightAt};
pub use jps::{Jps, JpsConfig};
pub use lazy_theta_star::{LazyThetaStar, LazyThetaStarConfig};
pub use nearest_first::{GoalPlan, NearestFirst};
pub use prepare_progress::PrepareProgress;
#[cfg(feature = "files")]
pub use prepared::PreparedFileError;
#[cfg(feature = "formats")]
pub use prepared::PreparedFormatError;
pub use prepared::{Preparation, PreparationEstimate, PrepareError, Prepared, PreparedConfig};
pub use ratio_astar::{RatioAStar, RatioAStarConfig, SearchEnd};
pub use rrt::{Rrt, RrtConfig};
pub use shortest::shortest_line;
pub use theta_star::{ThetaStar, ThetaStarConfig};
pub use two_sided::OpenKeys;

pub(crate) use ends::check_end;
use ends::settle_ends;
use std::fmt::Debug;

use crate::geometry::{PlannedLine, Point};
use crate::map::{Cell, Connectivity, SearchMap};
use crate::search::{Cost, Observer, Query, SearchStatistics, Workspace};
use serde::Serialize;

/// A path on the grid, and what it took to find it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The path's waypoints, start and goal included; it goes straight from the centre of one to
    /// that of the next. They are neighbours, unless the planner [is
    /// any-angle](GlobalPlanner::is_any_angle).
    pub cells: Vec<Cell>,
    /// Which of the cells are jump points, as ascending indices; the first cell, the last one and
    /// every cell in which the path turns are among them. A planner that searches jump points has
    /// more: the nodes of its search that lie on the path, even where it goes straight on.
    pub jump_points: Vec<usize>,
    /// Its cost, penalties of unknown cells included.
    pub cost: PlanCost,
    /// The work of the search.
    pub statistics: SearchStatistics,
    /// The cell in which the two sides of a bidirectional search met.
    pub meeting: Option<Cell>,
    /// The reason why the search stopped; `None` without a path.
    pub stop: Option<Stop>,
    /// Something that only its planner knows of it; mostly `None`.
    pub note: Option<PlanNote>,
}

/// A planner's note on its plan, for whoever reads the plan: searches and smoothers do without it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanNote {
    /// A constraint of the planner left no path and was lowered.
    Relaxed(Relaxed),
}

/// A constraint that was lowered as little as was needed to leave a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Relaxed {
    /// The constraint that was asked for \[m\].
    pub asked_m: f64,
    /// The one that was searched with \[m\].
    pub used_m: f64,
}

/// The reason why a search that found a path stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Stop {
    /// The goal was taken from the open list.
    GoalExpanded,
    /// The goal was put into the open list.
    GoalGenerated,
    /// The two sides met.
    SidesMet,
    /// Nothing in the open lists can lead to a shorter path.
    NothingBetter,
    /// The goal was joined to the tree.
    GoalJoined,
    /// The path was looked up, not searched for.
    LookedUp,
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::GoalExpanded => "the goal was expanded",
            Self::GoalGenerated => "the goal was generated",
            Self::SidesMet => "the two sides met",
            Self::NothingBetter => "nothing open could lead to a shorter path",
            Self::GoalJoined => "the goal was joined to the tree",
            Self::LookedUp => "the path was looked up",
        })
    }
}

/// The boundary at which a planner is chosen by name.
///
/// A planner is an immutable config; the map, the query, the memory and the observer are arguments.
/// No call allocates once workspace and plan are warm and the map's components are known. Time is
/// measured by the caller.
pub trait GlobalPlanner: Debug {
    /// Its name on the command line and in reports.
    fn name(&self) -> &'static str;

    /// Which neighbouring cells its steps join.
    fn connectivity(&self) -> Connectivity;

    /// True if its paths leave the 8 directions of the grid: its waypoints are then not neighbours,
    /// and its cost is a length.
    fn is_any_angle(&self) -> bool {
        false
    }

    /// True if it plans only where all cells cost the same: on maps with [penalised
    /// cells](SearchMap::penalised) it is refused.
    fn needs_uniform_cost(&self) -> bool {
        false
    }

    /// Memory on the heap that the planner itself holds \[bytes\]: what it has prepared.
    fn memory_bytes(&self) -> usize {
        0
    }

    /// The search itself, for [`Self::plan_into`]: start and goal are on the map, free and
    /// connected, all cells cost the same if [it needs that](Self::needs_uniform_cost), and the
    /// plan is empty. Without jump points of its own it leaves [`Plan::jump_points`] empty.
    ///
    /// # Errors
    /// When the planner cannot plan on such a map, or the budget is used up. The plan stays empty.
    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError>;

    /// Plans into `plan`, which is overwritten; after an error it is empty. Ends that are blocked
    /// or not connected are reported without a search.
    ///
    /// # Errors
    /// Says why there is no plan; a search that failed carries its statistics.
    fn plan_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        plan.clear();
        let query = settle_ends(map, query, self.connectivity())?;
        if self.needs_uniform_cost() && map.penalised().is_some() {
            return Err(PlanError::NeedsUniformCost { planner: self.name() });
        }
        self.search_into(map, &query, workspace, seen, plan)?;
        if plan.jump_points.is_empty() {
            plan.mark_turns();
        }
        Ok(())
    }
}

impl Plan {
    /// The cell in which the path ends: the goal, or the one that was reached in its place (see
    /// [`crate::search::IfUnreachable`]); `None` without a path.
    pub fn reached(&self) -> Option<Cell> {
        self.cells.last().copied()
    }

    /// The path in the world: the given start position, the centres of all cells, the given goal
    /// position. Positions at the centre of their cell are not repeated. Between two positions in
    /// one cell it is the straight line, from a position to itself a single point.
    pub fn line(&self, map: &SearchMap, start: Point, goal: Point) -> PlannedLine {
        let frame = map.frame();
        let is_in = |point| Some(frame.cell_near(point)) == self.reached();
        let cells = match &self.cells[..] {
            [_] if is_in(start) && is_in(goal) => &[],
            cells => cells,
        };
        let mut jump_points = self.jump_points.iter().peekable();
        let mut is_jump_point = |i: usize| jump_points.next_if(|&&at| at == i).is_some();
        let centres = cells.iter().map(|&cell| frame.world_from_cell(cell));
        let mut waypoints = vec![(start, true)];
        waypoints.extend(centres.enumerate().map(|(i, centre)| (centre, is_jump_point(i))));
        waypoints.push((goal, true));
        waypoints.dedup_by(|(point, is_jump_point), (kept, keeps)| {
            let is_same = point.distance(*kept) < SAME_POINT_M;
            *keeps |= is_same && *is_jump_point;
            is_same
        });
        if let Some((last, _)) = waypoints.last_mut() {
            *last = goal;
        }
        waypoints.into_iter().collect()
    }

    /// Empties the plan, keeping its memory.
    pub(crate) fn clear(&mut self) {
        let Self { mut cells, mut jump_points, .. } = std::mem::take(self);
        cells.clear();
        jump_points.clear();
        *self = Self { cells, jump_points, ..Self::default() };
    }
}

/// Positions nearer than this are the same point: a cell's centre and a decimal fraction that
/// stands for it.
const SAME_POINT_M: f64 = 1e-9;

/// The exact cost of a path of neighbouring cells on a map, penalties included.
fn path_cost(map: &SearchMap, cells: &[Cell]) -> PlanCost {
    let penalty = u64::from(map.config().unknown_penalty);
    PlanCost::Steps(cells.windows(2).fold(Cost::default(), |cost, pair| {
        let penalised = map.penalised().is_some_and(|cells| cells.get(pair[1]));
        let factor = if penalised { penalty } else { 1 };
        let step = Cost::octile(pair[0].x.abs_diff(pair[1].x), pair[0].y.abs_diff(pair[1].y));
        cost + Cost::new(step.straight * factor, step.diagonal * factor)
    }))
}
