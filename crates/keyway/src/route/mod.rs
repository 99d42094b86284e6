//! The pipeline: two positions -> a plan -> a line -> a smoothed route.
//!
//! [`plan_route`] runs all of it. Its steps are also available one by one, for example to smooth
//! one plan in several ways or to use a plan from elsewhere: [`RouteQuery::search`],
//! [`RouteQuery::line`], [`smooth_line`] and [`Route::of_plan`]. Nothing here reads a clock: a
//! [`StageObserver`] is told when a search or a smoothing begins and ends.
//!
//! ```
//! use keyway::geometry::Point;
//! use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
//! use keyway::plan::AStar;
//! use keyway::route::{RouteQuery, plan_route};
//! use keyway::search::Workspace;
//! use keyway::smooth::Taut;
//!
//! let grid = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
//! let map = SearchMap::new(&grid, LayerConfig::default())?;
//! let query = RouteQuery::new(Point::new(0.2, 1.5), Point::new(4.8, 1.5));
//! let mut workspace = Workspace::default();
//! let route = plan_route(&map, &AStar::default(), &Taut, &query, &mut workspace, &mut ())?;
//! // Around the square of the obstacle, instead of from centre to centre of the cells.
//! assert!(route.smoothed.length_m() < route.line.polyline().length_m());
//! assert_eq!(route.smoothed.points().last(), Some(&query.goal));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod between_cells;
mod ends;
mod no_path;
mod no_room;

pub use between_cells::{BetweenCells, looser_clearance_m, plan_between_cells};
pub use ends::EndRule;
pub use no_path::{NoPath, why_no_path};
pub use no_room::why_no_room;

use crate::geometry::{PlannedLine, Point, Polyline};
use crate::map::SearchMap;
use crate::plan::{GlobalPlanner, PathEnd, Plan, PlanError};
use crate::search::{IfUnreachable, Query, Workspace};
use crate::smooth::{Smoothed, Smoother};
use serde::{Deserialize, Serialize};

/// Largest distance between the line of a route and the curve that it approximates \[cells\].
pub const CHORD_CELLS: f64 = 0.05;

/// A planned route from one position to another.
///
/// Serialised without the planner's path.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Route {
    /// The planner's path.
    #[serde(skip)]
    pub plan: Plan,
    /// The path as a line from position to position \[m\].
    pub line: PlannedLine,
    /// The smoothed path, and the statistics of the smoothing.
    pub smoothing: Smoothed,
    /// The smoothed path as a line; a curve is approximated by chords.
    pub smoothed: Polyline,
    /// Clearance that the smoothed line keeps wherever the path did \[m\].
    pub clearance_m: f64,
}

/// A route request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteQuery {
    /// Start position \[m\].
    pub start: Point,
    /// Goal position \[m\].
    pub goal: Point,
    /// Rule that joins start and goal to the cells of the path.
    pub ends: EndRule,
    /// Give up after this many expanded nodes.
    pub budget: Option<u64>,
    /// Behaviour if no path leads to the goal.
    pub if_unreachable: IfUnreachable,
}

/// A step of the pipeline that is worth timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// The planner's query.
    Search,
    /// Smoothing the line.
    Smoothing,
}

/// Observes when the stages of a route begin and end, to measure them; `()` does nothing.
pub trait StageObserver {
    /// A stage begins.
    fn begin(&mut self, _stage: Stage) {}

    /// The stage that began last has ended.
    fn end(&mut self, _stage: Stage) {}
}

impl StageObserver for () {}

/// Plans a path, draws it as a line between the two positions, and smooths the line. The smoothed
/// line keeps the clearance of the map's layers, or the radius of [`EndRule::NearestFree`] if
/// that is larger.
///
/// # Errors
/// As for [`GlobalPlanner::plan_into`]; also if a blocked start or goal cannot be joined to a
/// free cell.
pub fn plan_route(
    map: &SearchMap,
    planner: &dyn GlobalPlanner,
    smoother: &dyn Smoother,
    query: &RouteQuery,
    workspace: &mut Workspace,
    stages: &mut dyn StageObserver,
) -> Result<Route, PlanError> {
    let mut plan = Plan::default();
    query.search(map, planner, workspace, &mut plan, stages)?;
    Ok(Route::of_plan(map, smoother, query, plan, stages))
}

impl RouteQuery {
    /// A query from `start` to exactly `goal`, both of which must lie in free cells; no budget.
    pub const fn new(start: Point, goal: Point) -> Self {
        Self {
            start,
            goal,
            ends: EndRule::OwnCell,
            budget: None,
            if_unreachable: IfUnreachable::Fail,
        }
    }

    /// The same query between the cells of start and goal.
    ///
    /// # Errors
    /// Returns [`PlanError`] if a blocked start or goal cannot be joined to a free cell.
    pub fn on_cells(&self, map: &SearchMap) -> Result<Query, PlanError> {
        let start = self.ends.cell(map, PathEnd::Start, self.start)?;
        let goal = self.ends.cell(map, PathEnd::Goal, self.goal)?;
        let &Self { budget, if_unreachable, .. } = self;
        Ok(Query { start, goal, budget, if_unreachable })
    }

    /// Plans the path into `plan`, which is overwritten.
    ///
    /// # Errors
    /// As for [`plan_route`].
    pub fn search(
        &self,
        map: &SearchMap,
        planner: &dyn GlobalPlanner,
        workspace: &mut Workspace,
        plan: &mut Plan,
        stages: &mut dyn StageObserver,
    ) -> Result<(), PlanError> {
        let query = self.on_cells(map)?;
        stages.begin(Stage::Search);
        let result = planner.plan_into(map, &query, workspace, None, plan);
        stages.end(Stage::Search);
        result
    }

    /// A plan for this query as a line from position to position. If the goal was not reached,
    /// the line ends at the centre of the cell that was reached instead.
    pub fn line(&self, map: &SearchMap, plan: &Plan) -> PlannedLine {
        let goal = self.ends.cell(map, PathEnd::Goal, self.goal).ok();
        let in_its_place = plan.reached().filter(|&cell| Some(cell) != goal);
        let end = in_its_place.map_or(self.goal, |cell| map.frame().world_from_cell(cell));
        plan.line(map, self.start, end)
    }
}

impl Route {
    /// The route along a plan for this query.
    pub fn of_plan(
        map: &SearchMap,
        smoother: &dyn Smoother,
        query: &RouteQuery,
        plan: Plan,
        stages: &mut dyn StageObserver,
    ) -> Self {
        let line = query.line(map, &plan);
        let clearance_m = query.ends.clearance_m(map);
        let smoothing = smooth_line(map, smoother, &line, clearance_m, stages);
        let smoothed = smoothing.path.flattened(CHORD_CELLS * map.frame().resolution_m());
        Self { plan, line, smoothing, smoothed, clearance_m }
    }

    /// The end of the route; `None` for a route without points.
    pub fn end(&self) -> Option<Point> {
        self.line.polyline().points().last().copied()
    }
}

/// Smooths a line so that it keeps `clearance_m` wherever it did before.
pub fn smooth_line(
    map: &SearchMap,
    smoother: &dyn Smoother,
    line: &PlannedLine,
    clearance_m: f64,
    stages: &mut dyn StageObserver,
) -> Smoothed {
    stages.begin(Stage::Smoothing);
    let smoothing = smoother.smooth(line, &map.clearance(), clearance_m);
    stages.end(Stage::Smoothing);
    smoothing
}
