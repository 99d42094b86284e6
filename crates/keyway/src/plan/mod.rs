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
//! Your own planner implements [`GlobalPlanner`]; the example `own_planner` does so outside the
//! crate.

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
mod leg;
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

/// A path on the grid, and the statistics of its search.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Waypoints of the path, start and goal included; the path goes straight from centre to
    /// centre. Consecutive waypoints are neighbours, unless the planner [is
    /// any-angle](GlobalPlanner::is_any_angle).
    pub cells: Vec<Cell>,
    /// Indices of the cells that are jump points, ascending. They include the first cell, the last
    /// one and every cell in which the path turns. A planner that searches jump points adds the
    /// nodes of its search on the path, even if the path goes straight on there.
    pub jump_points: Vec<usize>,
    /// Cost of the path, penalties of unknown cells included.
    pub cost: PlanCost,
    /// Counters of the search.
    pub statistics: SearchStatistics,
    /// The cell in which the two sides of a bidirectional search met.
    pub meeting: Option<Cell>,
    /// The reason why the search stopped; `None` if there is no path.
    pub stop: Option<Stop>,
    /// A remark that is specific to the planner; usually `None`.
    pub note: Option<PlanNote>,
}

/// A planner's remark on its plan, for reports: searches and smoothers ignore it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanNote {
    /// A constraint of the planner left no path and was relaxed.
    Relaxed(Relaxed),
}

/// A constraint that was relaxed as little as necessary to leave a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Relaxed {
    /// The requested constraint \[m\].
    pub asked_m: f64,
    /// The constraint that the search used \[m\].
    pub used_m: f64,
}

/// The reason why a successful search stopped.
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
    /// No node in the open lists can lead to a shorter path.
    NothingBetter,
    /// The goal was joined to the tree.
    GoalJoined,
    /// The path was looked up without a search.
    LookedUp,
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::GoalExpanded => "the goal was expanded",
            Self::GoalGenerated => "the goal was generated",
            Self::SidesMet => "the two sides met",
            Self::NothingBetter => "no open node could lead to a shorter path",
            Self::GoalJoined => "the goal was joined to the tree",
            Self::LookedUp => "the path was looked up",
        })
    }
}

/// The interface of all global planners.
///
/// A planner is an immutable config; the map, the query, the memory and the observer are
/// arguments. No call allocates once workspace and plan are warm and the map's components are
/// known. Time is measured by the caller.
pub trait GlobalPlanner: Debug {
    /// Name on the command line and in reports.
    fn name(&self) -> &'static str;

    /// Connectivity of the planner's steps.
    fn connectivity(&self) -> Connectivity;

    /// True if paths leave the 8 directions of the grid: waypoints are then not neighbours, and
    /// the cost is a length.
    fn is_any_angle(&self) -> bool {
        false
    }

    /// True if the planner requires one cost for all cells. It refuses maps with [penalised
    /// cells](SearchMap::penalised).
    fn needs_uniform_cost(&self) -> bool {
        false
    }

    /// Memory on the heap of the planner itself \[bytes\]: its preparation.
    fn memory_bytes(&self) -> usize {
        0
    }

    /// Does beforehand what the first query on a map would do, so that it is as quick as later
    /// ones; the results are the same. Labels the components of the map, expands a few nodes, and
    /// plans a short path. A one-sided jump point search also touches memory, since the first touch
    /// of a page costs the kernel microseconds: 1/8 byte per cell, and up to 0.5 MB for nodes.
    fn warm_up(&self, map: &SearchMap, workspace: &mut Workspace) {
        expand_a_few(self, map, workspace);
    }

    /// The search itself, for [`Self::plan_into`]. Start and goal are on the map, free and
    /// connected; all cells cost the same if [the planner needs that](Self::needs_uniform_cost);
    /// the plan is empty. A planner without jump points of its own leaves [`Plan::jump_points`]
    /// empty.
    ///
    /// # Errors
    /// Returns an error if the planner cannot plan on such a map or the budget is used up. The
    /// plan stays empty.
    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError>;

    /// Plans into `plan`, which is overwritten; after an error it is empty. A blocked start or
    /// goal, or a start and goal that are not connected, are reported without a search.
    ///
    /// # Errors
    /// Returns the reason why there is no plan; if a search failed, the error carries its
    /// statistics.
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
    /// The cell in which the path ends: the goal or its replacement (see
    /// [`crate::search::IfUnreachable`]); `None` without a path.
    pub fn reached(&self) -> Option<Cell> {
        self.cells.last().copied()
    }

    /// The path in the world: the given start position, the centres of all cells, the given goal
    /// position. Positions at the centre of their cell are not repeated. Between two positions in
    /// one cell the path is the straight line; from a position to itself it is a single point.
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

/// Positions nearer than this count as the same point \[m\]: a cell's centre and its rounded
/// decimal fraction.
const SAME_POINT_M: f64 = 1e-9;

/// Begins a search from the middle of a map to its corner, and plans a path to a neighbour.
fn expand_a_few(
    planner: &(impl GlobalPlanner + ?Sized),
    map: &SearchMap,
    workspace: &mut Workspace,
) {
    let Some(query) = far_query(map, planner.connectivity()) else { return };
    // The budget is enough for short queries only, and some planners refuse some maps.
    _ = planner.plan_into(map, &query, workspace, None, &mut Plan::default());
    plan_a_step(planner, map, (query.start, workspace));
}

/// Plans a path to a neighbour, so that the code that writes paths is in memory.
fn plan_a_step(
    planner: &(impl GlobalPlanner + ?Sized),
    map: &SearchMap,
    (start, workspace): (Cell, &mut Workspace),
) {
    let beside = Cell::new(start.x + 1, start.y);
    let end = map.nearest_connected(start, beside, planner.connectivity()).unwrap_or(start);
    let query = Query { budget: Some(64), ..Query::new(start, end) };
    _ = planner.plan_into(map, &query, workspace, None, &mut Plan::default());
}

/// From the middle of a map to its corner, with a budget of 64 nodes; `None` without a free cell.
fn far_query(map: &SearchMap, connectivity: Connectivity) -> Option<Query> {
    let centre = Cell::new(map.frame().width() as i32 / 2, map.frame().height() as i32 / 2);
    let start = map.nearest_free(centre)?;
    let corner = map.nearest_connected(start, Cell::new(0, 0), connectivity);
    Some(Query { budget: Some(64), ..Query::new(start, corner.unwrap_or(start)) })
}

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
