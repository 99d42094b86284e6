//! Global planners: from a map and a query to a path, one file per method.

mod astar;
mod astar4;
mod best_first;
mod bidirectional;
mod dijkstra;
mod ends;
mod greedy;
mod heuristic;
mod jps;
mod nearest_first;

pub use astar::{AStar, AStarConfig, PathCost};
pub use astar4::{AStar4, AStar4Config};
pub use bidirectional::{BidirectionalOptimal, BidirectionalOptimalConfig};
pub use dijkstra::{Dijkstra, DijkstraConfig};
pub use greedy::{GreedyBestFirst, GreedyConfig};
pub use heuristic::Heuristic;
pub use jps::{Jps, JpsConfig};
pub use nearest_first::{GoalPlan, NearestFirst};

use ends::settle_ends;

use crate::geometry::{Point, Polyline};
use crate::map::{Cell, Connectivity, SearchMap};
use crate::search::{CornerRule, Cost, Observer, Query, SearchStatistics, Workspace};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A path on the grid, and what it took to find it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Every cell of the path, start and goal included.
    pub cells: Vec<Cell>,
    /// Its cost, penalties of unknown cells included.
    pub cost: Cost,
    /// What the search did.
    pub statistics: SearchStatistics,
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The start or goal is not on the map.
    #[error("{end} {cell} is outside the map of {width} x {height} cells")]
    OutsideMap {
        /// Which of the two.
        end: PathEnd,
        /// The cell asked for.
        cell: Cell,
        /// Columns of the map.
        width: u32,
        /// Rows of the map.
        height: u32,
    },
    /// The start or goal is blocked.
    #[error("{end} {cell} is inside an obstacle{}", nearest_text(.nearest.as_ref()))]
    Blocked {
        /// Which of the two.
        end: PathEnd,
        /// The cell asked for.
        cell: Cell,
        /// The nearest free cell, unless all are blocked.
        nearest: Option<Cell>,
    },
    /// Start and goal are in different connected components. Told without a search: the statistics
    /// are zero, unless every cell that can be reached was searched.
    #[error("there is no path from the start to the goal")]
    NoPath {
        /// What the search did.
        statistics: SearchStatistics,
    },
    /// The planner cannot weigh penalised cells.
    #[error(
        "{planner} needs one cost for all cells; treat unknown cells as blocked or free, or use astar"
    )]
    NeedsUniformCost {
        /// The planner.
        planner: &'static str,
    },
    /// The budget was used up before a path was found.
    #[error("no path was found within the budget of {budget} expanded nodes")]
    BudgetExhausted {
        /// The budget.
        budget: u64,
        /// What the search did.
        statistics: SearchStatistics,
    },
}

/// One end of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The beginning.
    Start,
    /// The end.
    Goal,
}

impl std::fmt::Display for PathEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

fn nearest_text(nearest: Option<&Cell>) -> String {
    nearest.map_or_else(
        || " (as is every cell, for this clearance)".to_owned(),
        |cell| format!("; nearest free cell is {cell}"),
    )
}

/// The boundary at which a planner is chosen by name.
///
/// A planner is an immutable config; the map, the query, the memory and the observer are
/// arguments. No call allocates once workspace and plan are warm and the map's components are known.
/// Time is measured by the caller.
pub trait GlobalPlanner {
    /// Its name on the command line and in reports.
    fn name(&self) -> &'static str;

    /// Which neighbouring cells its steps join.
    fn connectivity(&self) -> Connectivity;

    /// The search itself, for [`Self::plan_into`]: start and goal are on the map, free and connected,
    /// the plan is empty.
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

    /// Plans into `plan`, which is overwritten; after an error it is empty. Ends that are blocked or
    /// not connected are told without a search.
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
        self.search_into(map, &query, workspace, seen, plan)
    }
}

/// A planner and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case")]
pub enum PlannerConfig {
    /// Dijkstra's algorithm: shortest paths, without any estimate of the rest.
    Dijkstra(DijkstraConfig),
    /// Greedy best-first search: some path quickly, not a shortest one.
    Greedy(GreedyConfig),
    /// A*: shortest paths under either corner rule, unless other parameters are changed.
    #[serde(rename = "astar")]
    AStar(AStarConfig),
    /// A* with 4 neighbours: shortest paths without diagonal steps.
    #[serde(rename = "astar4")]
    AStar4(AStar4Config),
    /// Bidirectional A*: shortest paths, searched for from both ends.
    BidirectionalOptimal(BidirectionalOptimalConfig),
    /// Jump point search: shortest paths without corner cutting, found much faster.
    Jps(JpsConfig),
}

impl PlannerConfig {
    /// Names of all planners, for [`Self::by_name`].
    pub const NAMES: [&'static str; 6] = [
        Dijkstra::NAME,
        GreedyBestFirst::NAME,
        AStar::NAME,
        AStar4::NAME,
        BidirectionalOptimal::NAME,
        Jps::NAME,
    ];

    /// A planner with its default parameters.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            Dijkstra::NAME => Some(Self::Dijkstra(DijkstraConfig::default())),
            GreedyBestFirst::NAME => Some(Self::Greedy(GreedyConfig::default())),
            AStar::NAME => Some(Self::AStar(AStarConfig::default())),
            AStar4::NAME => Some(Self::AStar4(AStar4Config::default())),
            BidirectionalOptimal::NAME => {
                Some(Self::BidirectionalOptimal(BidirectionalOptimalConfig::default()))
            }
            Jps::NAME => Some(Self::Jps(JpsConfig::default())),
            _ => None,
        }
    }

    /// The planner's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Dijkstra(_) => Dijkstra::NAME,
            Self::Greedy(_) => GreedyBestFirst::NAME,
            Self::AStar(_) => AStar::NAME,
            Self::AStar4(_) => AStar4::NAME,
            Self::BidirectionalOptimal(_) => BidirectionalOptimal::NAME,
            Self::Jps(_) => Jps::NAME,
        }
    }

    /// Whether its paths are shortest among those without corner cutting.
    pub fn is_optimal(&self) -> bool {
        match self {
            Self::Dijkstra(config) => config.corners == CornerRule::Forbid,
            Self::AStar(config) => config.corners == CornerRule::Forbid && config.is_exact(),
            Self::BidirectionalOptimal(config) => config.corners == CornerRule::Forbid,
            Self::Jps(_) => true,
            // Without diagonal steps, or without regard to the cost so far.
            Self::AStar4(_) | Self::Greedy(_) => false,
        }
    }

    /// The planner.
    pub fn build(&self) -> Box<dyn GlobalPlanner + Send + Sync> {
        match self {
            Self::Dijkstra(config) => Box::new(Dijkstra::new(config.clone())),
            Self::Greedy(config) => Box::new(GreedyBestFirst::new(config.clone())),
            Self::AStar(config) => Box::new(AStar::new(config.clone())),
            Self::AStar4(config) => Box::new(AStar4::new(config.clone())),
            Self::BidirectionalOptimal(config) => {
                Box::new(BidirectionalOptimal::new(config.clone()))
            }
            Self::Jps(JpsConfig {}) => Box::new(Jps),
        }
    }
}

impl Plan {
    /// The cell in which the path ends: the goal, or the one that was reached in its place (see
    /// [`crate::search::IfUnreachable`]); `None` without a path.
    pub fn reached(&self) -> Option<Cell> {
        self.cells.last().copied()
    }

    /// The path in the world: the given start position, the centres of all cells, the given goal
    /// position. Positions at the centre of their cell are not repeated.
    pub fn line(&self, map: &SearchMap, start: Point, goal: Point) -> Polyline {
        let centres = self.cells.iter().map(|&cell| map.frame().world_from_cell(cell));
        let mut points: Vec<Point> =
            std::iter::once(start).chain(centres).chain(std::iter::once(goal)).collect();
        points.dedup_by(|a, b| a.distance(*b) < SAME_POINT_M);
        if let Some(last) = points.last_mut() {
            *last = goal;
        }
        Polyline::new(points)
    }

    /// Empties the plan, keeping its memory.
    pub(crate) fn clear(&mut self) {
        self.cells.clear();
        self.cost = Cost::default();
        self.statistics = SearchStatistics::default();
    }
}

/// Positions nearer than this are the same point: a cell's centre and a decimal fraction that
/// means it.
const SAME_POINT_M: f64 = 1e-9;

/// The exact cost of a path of neighbouring cells on a map, penalties included.
fn path_cost(map: &SearchMap, cells: &[Cell]) -> Cost {
    let penalty = u64::from(map.config().unknown_penalty);
    cells.windows(2).fold(Cost::default(), |cost, pair| {
        let penalised = map.penalised().is_some_and(|cells| cells.get(pair[1]));
        let factor = if penalised { penalty } else { 1 };
        let step = Cost::octile(pair[0].x.abs_diff(pair[1].x), pair[0].y.abs_diff(pair[1].y));
        cost + Cost::new(step.straight * factor, step.diagonal * factor)
    })
}
