//! The pipeline: two positions -> a plan -> a line -> a smoothed route.
//!
//! [`plan_route`] is all of it. Where single steps are wanted (to plan once and to smooth in
//! several ways, or to take a plan from elsewhere), they are [`RouteQuery::search`],
//! [`RouteQuery::line`], [`smooth_line`] and [`Route::of_plan`]; `plan_route` consists of them.
//! Nothing here reads a clock: a [`StageObserver`] learns when a search or a smoothing begins and
//! ends.
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

/// How far the line of a route may be from the curve that it stands for \[cells\].
pub const CHORD_CELLS: f64 = 0.05;

/// A planned way from one position to another.
///
/// Serialised without the planner's path.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Route {
    /// The planner's path.
    #[serde(skip)]
    pub plan: Plan,
    /// The same as a line from position to position \[m\].
    pub line: PlannedLine,
    /// The smoothed path, and what was done to the line.
    pub smoothing: Smoothed,
    /// The smoothed path as a line; of a curve, chords along it.
    pub smoothed: Polyline,
    /// What the smoothed line keeps from obstacles wherever the path did \[m\].
    pub clearance_m: f64,
}

/// Which route is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteQuery {
    /// Where it begins \[m\].
    pub start: Point,
    /// Where it ends \[m\].
    pub goal: Point,
    /// How start and goal are joined to the cells of the path.
    pub ends: EndRule,
    /// Give up after this many expanded nodes.
    pub budget: Option<u64>,
    /// What to do when no path leads to the goal.
    pub if_unreachable: IfUnreachable,
}

/// A step of the pipeline whose time is worth knowing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// The planner's query.
    Search,
    /// Smoothing the line.
    Smoothing,
}

/// Learns when the stages of a route begin and end, to measure them; `()` is the silent one.
pub trait StageObserver {
    /// A stage begins.
    fn begin(&mut self, _stage: Stage) {}

    /// The stage that began last has ended.
    fn end(&mut self, _stage: Stage) {}
}

impl StageObserver for () {}

/// Plans a path, draws it as a line between the two positions, and smooths that. The smoothed line
/// keeps the clearance of the map's layers, and the radius of [`EndRule::NearestFree`] where that
/// is larger.
///
/// # Errors
/// As for [`GlobalPlanner::plan_into`]; and when a blocked end cannot be joined to a free cell.
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
    /// From `start` to `goal` and nowhere else, each of which lies in a free cell; without a
    /// budget.
    pub const fn new(start: Point, goal: Point) -> Self {
        Self {
            start,
            goal,
            ends: EndRule::OwnCell,
            budget: None,
            if_unreachable: IfUnreachable::Fail,
        }
    }

    /// The same between the cells of the path's ends.
    ///
    /// # Errors
    /// When a blocked end cannot be joined to a free cell.
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

    /// A plan for this query as a line from position to position. Where the goal was not reached,
    /// it ends at the centre of the cell that was reached in its place.
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

    /// Where the route ends; `None` for a route without points.
    pub fn end(&self) -> Option<Point> {
        self.line.polyline().points().last().copied()
    }
}

/// Smooths a line so that it keeps `clearance_m` wherever it did.
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
