//! Routes of a robot: on the widest of its map layers, or on a narrower one that is shorter.

use super::headings::fits_within;
use super::layers::Layers;
use super::start::{StartTooNear, nearest_fitting, touches_at_every_heading};
use super::{FittedStack, Goal, HeadingRange, NavigateError};
use crate::geometry::{Disc, Point, Polyline, Pose};
use crate::map::{
    Cell, CellState, CellWindow, DistanceField, FieldConfig, LayerConfig, OccupancyGrid, SearchMap,
};
use crate::plan::{GlobalPlanner, PathEnd, Plan, PlanError};
use crate::robot::{Footprint, Robot};
use crate::route::{BetweenCells, EndRule, Route, RouteQuery, plan_between_cells, plan_route};
use crate::search::{IfUnreachable, Query, Workspace};
use crate::smooth::Smoother;
use std::sync::Arc;

/// Plans the routes of one robot, on layers that include the sensed obstacles.
pub(super) struct Router {
    pub(super) layers: Layers,
    planner: Arc<dyn GlobalPlanner + Send + Sync>,
    smoother: Arc<dyn Smoother + Send + Sync>,
    workspace: Workspace,
    radius_m: f64,
}

impl Clone for Router {
    /// Clones the router with its own scratch memory.
    fn clone(&self) -> Self {
        let Self { layers, planner, smoother, radius_m, .. } = self;
        Self {
            layers: layers.clone(),
            planner: Arc::clone(planner),
            smoother: Arc::clone(smoother),
            workspace: Workspace::default(),
            radius_m: *radius_m,
        }
    }
}

impl Router {
    /// # Errors
    /// Returns [`NavigateError`] if the stack cannot be used.
    pub(super) fn new(known: &OccupancyGrid, fitted: &FittedStack) -> Result<Self, NavigateError> {
        let FittedStack { stack, robot, smoother, planner, .. } = fitted;
        let layers = Layers::new(known, stack, robot)?;
        let planner = match planner {
            Some(planner) => Arc::clone(planner),
            None => stack.planner.build(layers.obstacles())?.into(),
        };
        let mut workspace = Workspace::default();
        planner.warm_up(layers.obstacles(), &mut workspace);
        Ok(Self {
            planner,
            smoother: Arc::clone(smoother),
            layers,
            workspace,
            radius_m: robot.footprint.inscribed_radius_m(),
        })
    }

    /// Distances to the obstacles of its maps, up to the horizon of the robot's decisions.
    pub(super) fn distances(&self, robot: &Robot) -> DistanceField {
        let config = FieldConfig { reach_m: robot.decision_reach_m(), ..FieldConfig::default() };
        let map = self.layers.obstacles();
        DistanceField::new(map.frame(), map.obstacles(), &config)
    }

    /// The smallest distance of a path from the obstacles of its maps \[m\], up to the widest
    /// clearance of its routes.
    pub(super) fn clearance_along(&self, path: &Polyline) -> f64 {
        let map = self.layers.obstacles();
        let (clearance, most_m) = (map.clearance(), map.config().clearance_m);
        let along = path.segments().map(|segment| clearance.of_segment(segment, most_m));
        along.fold(most_m, f64::min)
    }

    /// Rejects a start with too little clearance or in contact with an obstacle, by more than a
    /// localisation error explains. Reports one that is too close by less.
    pub(super) fn check_start(
        &self,
        start: Point,
        footprint: &Footprint,
        error_m: f64,
    ) -> Result<Option<StartTooNear>, NavigateError> {
        let refused = match self.refuse_start(start, footprint) {
            Ok(()) => return Ok(None),
            Err(refused @ NavigateError::NotFinite { .. }) => return Err(refused),
            Err(refused) => refused,
        };
        let map = self.layers.obstacles();
        let nearest =
            nearest_fitting(footprint, start, error_m, &map.clearance()).ok_or(refused)?;
        let (why, off_m) = (map.hindrance(start), nearest.distance(start));
        Ok(Some(StartTooNear { why, nearest, off_m }))
    }

    fn refuse_start(&self, start: Point, footprint: &Footprint) -> Result<(), NavigateError> {
        check_room(&self.layers, PathEnd::Start, start, self.radius_m)?;
        let map = self.layers.obstacles();
        if !touches_at_every_heading(footprint, start, &map.clearance()) {
            return Ok(());
        }
        let (position, why) = (start, map.hindrance(start));
        let footprint = footprint.clone();
        Err(NavigateError::StartTouches { position, heading_rad: None, footprint, why })
    }

    /// A route on the known map, or the reason why none exists.
    pub(super) fn first(
        &mut self,
        known: &OccupancyGrid,
        start: Point,
        goal: Point,
    ) -> Result<Route, NavigateError> {
        check_room(&self.layers, PathEnd::Start, start, self.radius_m)?;
        check_room(&self.layers, PathEnd::Goal, goal, self.radius_m)?;
        let query = footprint_query(start, goal, self.radius_m);
        match self.first_of(self.layers.fitting, &query) {
            Ok(route) => Ok(self.wider(known, &query, &route).unwrap_or(route)),
            Err(error) => {
                let route = self.between_cells(&query, Self::FIRST_ATTEMPTS);
                self.layers.is_between_cells |= route.is_some();
                route.ok_or_else(|| explain(&self.layers, &*self.planner, &query, error))
            }
        }
    }

    /// Maximum number of attempts for a first route between the centres of cells; finding out why
    /// none exists costs more.
    const FIRST_ATTEMPTS: u32 = 16;

    /// The same while the robot waits for the route.
    const LATER_ATTEMPTS: u32 = 4;

    /// A route that keeps the required clearance although no path of cells does.
    fn between_cells(&mut self, query: &RouteQuery, attempts: u32) -> Option<Route> {
        let Self { layers, planner, smoother, workspace, radius_m } = self;
        let (looser, needed_m) = layers.looser()?;
        let wanted = BetweenCells { clearance_m: needed_m.max(*radius_m), attempts };
        plan_between_cells(looser, wanted, &**planner, &**smoother, query, workspace, &mut ())
    }

    /// A route with more than the least clearance, for a given one on which the robot cannot turn
    /// everywhere: along the middle of the narrowest passage instead of along its side. The
    /// clearance is found by bisection; its layer is kept for later routes.
    fn wider(&mut self, known: &OccupancyGrid, query: &RouteQuery, route: &Route) -> Option<Route> {
        let mut fitting = self.layers.fitting().iter().rev();
        let (least, above) = (fitting.next()?.config().clone(), fitting.next()?.config());
        if least.clearance_m + 0.5 * known.frame().resolution_m() > above.clearance_m {
            return None;
        }
        let is_least = route.clearance_m <= least.clearance_m.max(self.radius_m);
        if !is_least {
            return None;
        }
        let (mut low_m, mut high_m, mut best) = (least.clearance_m, above.clearance_m, None);
        let (planner, smoother) = (&*self.planner, &*self.smoother);
        for _ in 0..Self::HALVINGS {
            let clearance_m = 0.5 * (low_m + high_m);
            let map = SearchMap::new(known, LayerConfig { clearance_m, ..least.clone() }).ok()?;
            match plan_route(&map, planner, smoother, query, &mut self.workspace, &mut ()) {
                Ok(route) => {
                    low_m = clearance_m;
                    best = Some((map, route));
                }
                Err(_) => high_m = clearance_m,
            }
        }
        let (map, route) = best?;
        self.layers.insert(map);
        Some(route)
    }

    /// Bisection steps of the range of clearances.
    const HALVINGS: u32 = 3;

    /// A route with the known and the sensed obstacles, within a budget of expanded nodes; also
    /// between the centres of cells if a route on the known map had to lead there.
    pub(super) fn again(
        &mut self,
        position: Point,
        goal: Point,
        budget: u64,
    ) -> Result<Route, NavigateError> {
        let query =
            RouteQuery { budget: Some(budget), ..footprint_query(position, goal, self.radius_m) };
        let fitting = self.first_of(self.layers.fitting, &query);
        let is_final =
            matches!(fitting, Ok(_) | Err(NavigateError::Plan(PlanError::BudgetExhausted { .. })));
        if is_final {
            return fitting;
        }
        let between = self.layers.is_between_cells;
        let between = between.then(|| self.between_cells(&query, Self::LATER_ATTEMPTS)).flatten();
        // Searches that have failed so far fail at once, since start and goal are not connected.
        let any = self.layers.maps.len();
        between.map_or_else(|| self.first_of(any, &query), Ok)
    }

    /// [`Self::again`], with less clearance, but enough, if that saves more than a detour \[m\].
    pub(super) fn again_within(
        &mut self,
        (position, goal): (Point, Point),
        budget: u64,
        detour_m: f64,
    ) -> Result<Route, NavigateError> {
        let route = self.again(position, goal, budget)?;
        let query =
            RouteQuery { budget: Some(budget), ..footprint_query(position, goal, self.radius_m) };
        Ok(self.shorter(&query, &route, detour_m).unwrap_or(route))
    }

    /// A route with less clearance, but enough, if a given one is longer by more than a detour.
    fn shorter(&mut self, query: &RouteQuery, route: &Route, detour_m: f64) -> Option<Route> {
        let Self { layers, planner, smoother, workspace, .. } = self;
        let length_m = |route: &Route| route.smoothed.length_m();
        if length_m(route) <= query.start.distance(query.goal) + detour_m {
            return None;
        }
        let is_narrower = |map: &SearchMap| map.config().clearance_m < route.clearance_m;
        let mut on = |map| plan_route(map, &**planner, &**smoother, query, workspace, &mut ()).ok();
        let fitting = layers.fitting();
        let (narrowest, wider) = fitting.split_last().filter(|(last, _)| is_narrower(last))?;
        let shortest = on(narrowest)?;
        let most_m = length_m(&shortest) + detour_m;
        if length_m(route) <= most_m {
            return None;
        }
        let mut between = wider.iter().filter(|map| is_narrower(map)).filter_map(on);
        between.find(|route| length_m(route) <= most_m).or(Some(shortest))
    }

    /// The route on the first of the widest maps that has one.
    fn first_of(&mut self, maps: usize, query: &RouteQuery) -> Result<Route, NavigateError> {
        let Self { layers, planner, smoother, workspace, .. } = self;
        first_route(&layers.maps[..maps], &**planner, &**smoother, query, workspace)
    }

    /// The nearest position with enough clearance for the robot, with the known and the sensed
    /// obstacles.
    fn nearest_with_room(&self, position: Point) -> Option<Point> {
        let map = self.layers.fitting().last()?;
        let cell = map.nearest_free(map.frame().cell_near(position))?;
        Some(map.frame().world_from_cell(cell))
    }

    /// The position nearest to a goal to which a path exists, with the known and the sensed
    /// obstacles; `None` if none exists from the start.
    pub(super) fn nearest_reachable(&mut self, start: Point, goal: Point) -> Option<Point> {
        let to = self.nearest_with_room(goal)?;
        let map = self.layers.fitting().last()?;
        let query = RouteQuery {
            if_unreachable: IfUnreachable::NearestReachable,
            ..footprint_query(start, to, self.radius_m)
        };
        let mut plan = Plan::default();
        query.search(map, &*self.planner, &mut self.workspace, &mut plan, &mut ()).ok()?;
        plan.cells.last().map(|&cell| map.frame().world_from_cell(cell))
    }

    /// A route between two positions around some areas; `None` if there is none, or no area.
    pub(super) fn around(
        &mut self,
        known: &OccupancyGrid,
        (position, goal): (Point, Point),
        budget: u64,
        ground: &[Disc],
    ) -> Option<Route> {
        let cells = free_cells(ground, self.layers.obstacles());
        if cells.is_empty() {
            return None;
        }
        let query =
            RouteQuery { budget: Some(budget), ..footprint_query(position, goal, self.radius_m) };
        self.layers.mark(&cells, |_| CellState::Occupied);
        let (planner, smoother) = (&*self.planner, &*self.smoother);
        let fitting = self.layers.fitting();
        let route = first_route(fitting, planner, smoother, &query, &mut self.workspace);
        self.layers.unmark(&cells, known);
        route.ok()
    }
}

/// The free cells of some discs, each once.
fn free_cells(discs: &[Disc], map: &SearchMap) -> Vec<Cell> {
    let (frame, obstacles) = (map.frame(), map.obstacles());
    let mut cells = Vec::new();
    for disc in discs {
        let centre = frame.grid_from_world(disc.centre);
        let reach = disc.radius_m / frame.resolution_m();
        let within = CellWindow::around(frame, disc.centre, disc.radius_m).cells();
        cells.extend(within.filter(|&cell| {
            let middle = Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
            middle.distance(centre) <= reach && !obstacles.get(cell)
        }));
    }
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// The route on the first of the maps that has one.
fn first_route(
    maps: &[SearchMap],
    planner: &dyn GlobalPlanner,
    smoother: &dyn Smoother,
    query: &RouteQuery,
    workspace: &mut Workspace,
) -> Result<Route, NavigateError> {
    let (mut failure, mut no_room) = (None, None);
    for map in maps {
        match plan_route(map, planner, smoother, query, workspace, &mut ()) {
            Ok(route) => return Ok(route),
            // If the budget is too small for one layer, the next one would only cost as much
            // again.
            Err(error @ PlanError::BudgetExhausted { .. }) => return Err(error.into()),
            Err(error) if query.on_cells(map).is_err() => {
                no_room = Some(no_way_on(maps, query, error));
            }
            Err(error) => failure = Some(error.into()),
        }
    }
    let statistics = crate::search::SearchStatistics::default();
    // The result of a search is more informative than an end from which none could start.
    Err(failure.or(no_room).unwrap_or(PlanError::NoPath { statistics }.into()))
}

/// A query from one position to another; at a blocked cell, straight as far as a footprint of
/// this radius fits.
const fn footprint_query(start: Point, goal: Point, radius_m: f64) -> RouteQuery {
    RouteQuery { ends: EndRule::NearestFree { radius_m }, ..RouteQuery::new(start, goal) }
}

/// Rejects a goal heading at which the footprint does not fit at the goal.
pub(super) fn check_goal_heading(
    goal: &Goal,
    footprint: &Footprint,
    tolerance_rad: f64,
    obstacles: &DistanceField,
) -> Result<(), NavigateError> {
    let position = goal.position;
    let Some(heading_rad) = goal.heading_rad else { return Ok(()) };
    let pose = Pose::new(position.x, position.y, heading_rad);
    if fits_within(footprint, pose, tolerance_rad, obstacles) {
        return Ok(());
    }
    let fits = HeadingRange::all_free(footprint, position, obstacles);
    let footprint = footprint.clone();
    Err(NavigateError::GoalHeading { position, heading_rad, footprint, fits })
}

/// Rejects an end at which the footprint touches an obstacle, or would leave the map.
fn check_room(
    layers: &Layers,
    end: PathEnd,
    position: Point,
    radius_m: f64,
) -> Result<(), NavigateError> {
    if !position.is_finite() {
        return Err(NavigateError::NotFinite { end, position });
    }
    let map = layers.obstacles();
    if map.clearance().is_clear_point(position, radius_m) {
        return Ok(());
    }
    // The narrowest layer has the cells with enough clearance.
    let least = layers.fitting().last().unwrap_or(map);
    Err(no_room(least, end, position, radius_m))
}

/// The error for an end with too little clearance, given a `map` of sufficient clearance.
fn no_room(map: &SearchMap, end: PathEnd, position: Point, radius_m: f64) -> NavigateError {
    let nearest = map
        .nearest_free(map.frame().cell_near(position))
        .map(|cell| map.frame().world_from_cell(cell));
    let why = map.hindrance(position);
    NavigateError::NoRoom { end, position, radius_m, why, nearest }
}

/// The reason why no route can start (or end) at a position: too little clearance for the
/// footprint is more informative than the blocked cell of the last layer.
fn no_way_on(maps: &[SearchMap], query: &RouteQuery, why: PlanError) -> NavigateError {
    let (PlanError::Blocked { end, .. } | PlanError::OutsideMap { end, .. }) = why else {
        return why.into();
    };
    let EndRule::NearestFree { radius_m } = query.ends else { return why.into() };
    let position = match end {
        PathEnd::Start => query.start,
        PathEnd::Goal => query.goal,
    };
    let fits = |map: &&SearchMap| map.config().clearance_m >= radius_m;
    match maps.iter().rfind(fits) {
        Some(map) if !map.clearance().is_clear_point(position, radius_m) => {
            no_room(map, end, position, radius_m)
        }
        _ => why.into(),
    }
}

/// Explains why a route does not exist, for the smallest clearance that the robot needs.
fn explain(
    layers: &Layers,
    planner: &dyn GlobalPlanner,
    query: &RouteQuery,
    error: NavigateError,
) -> NavigateError {
    let NavigateError::Plan(PlanError::NoPath { .. }) = error else { return error };
    let Some(map) = layers.fitting().last() else { return error };
    let Ok(Query { start, goal, .. }) = query.on_cells(map) else { return error };
    let why = map.separation(start, goal, planner.connectivity());
    why.map_or(error, |why| NavigateError::NoWay { why })
}
