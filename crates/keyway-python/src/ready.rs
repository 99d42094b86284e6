//! The layers and planners of a map, and queries on them.

use crate::errors::{NoPath, bad_value, check_memory, no_path_error, no_room_error, plan_error};
use crate::parameters::{Parameters, robot};
use crate::watched::{Progress, Watch, watched};
use keyway::files::StackBase;
use keyway::geometry::Point;
use keyway::map::{OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, PlanError, PlannerConfig, PrepareProgress};
use keyway::robot::Robot;
use keyway::route::{Route, RouteQuery, plan_route, why_no_path, why_no_room};
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::Smoother;
use keyway_sim::report::{RouteFailure, RouteRequest};
use pyo3::prelude::*;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::{Arc, Mutex, PoisonError};

/// Everything a planner is built from, besides its parameters.
pub(crate) struct PlannerParts {
    pub(crate) grid: Arc<OccupancyGrid>,
}

/// The layers of a map, a planner and a smoother, ready for queries; and the search memory, one
/// for each thread.
pub(crate) struct Ready {
    pub(crate) grid: Arc<OccupancyGrid>,
    pub(crate) map: SearchMap,
    pub(crate) stack: Stack,
    pub(crate) robot: Robot,
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    smoother: Box<dyn Smoother + Send + Sync>,
    workspaces: Mutex<Vec<Workspace>>,
}

/// Arguments that determine a planner, besides its map.
#[derive(Clone, PartialEq)]
struct Choice {
    planner: String,
    smoother: String,
    radius_m: Option<f64>,
    robot: Option<String>,
    parameters: toml::Table,
    as_published: bool,
}

/// Cache of the last planners of a map, so that repeated calls of `plan` do not rebuild the
/// layers.
#[derive(Default)]
pub(crate) struct PlannerCache(Mutex<Vec<(Choice, Arc<Ready>)>>);

impl PlannerCache {
    const SIZE: usize = 8;

    pub(crate) fn get(
        &self,
        parts: PlannerParts,
        choice: &ChoiceRef<'_>,
        py: Python<'_>,
        progress: Option<&Progress>,
    ) -> PyResult<Arc<Ready>> {
        let find = |all: &[(Choice, Arc<Ready>)]| {
            all.iter().find(|(known, _)| choice.is(known)).map(|(_, ready)| Arc::clone(ready))
        };
        if let Some(ready) = find(&self.lock()) {
            return Ok(ready);
        }
        let owned = choice.owned();
        let choice = owned.clone();
        let ready =
            Arc::new(watched(py, progress, move |watch| Ready::new(parts, &choice, watch))??);
        let mut all = self.lock();
        all.insert(0, (owned, Arc::clone(&ready)));
        all.truncate(Self::SIZE);
        Ok(ready)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<(Choice, Arc<Ready>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The same as `Choice`, borrowed.
pub(crate) struct ChoiceRef<'a> {
    pub(crate) planner: &'a str,
    pub(crate) smoother: &'a str,
    pub(crate) radius_m: Option<f64>,
    pub(crate) robot: Option<&'a str>,
    pub(crate) parameters: Option<&'a Parameters>,
    pub(crate) as_published: bool,
}

impl ChoiceRef<'_> {
    fn is(&self, known: &Choice) -> bool {
        (self.planner, self.smoother) == (&known.planner, &known.smoother)
            && (self.radius_m, self.robot) == (known.radius_m, known.robot.as_deref())
            && self.as_published == known.as_published
            && self.parameters.map_or(known.parameters.is_empty(), |it| it.0 == known.parameters)
    }

    fn owned(&self) -> Choice {
        Choice {
            planner: self.planner.to_owned(),
            smoother: self.smoother.to_owned(),
            radius_m: self.radius_m,
            robot: self.robot.map(str::to_owned),
            parameters: self.parameters.map(|it| it.0.clone()).unwrap_or_default(),
            as_published: self.as_published,
        }
    }
}

impl Ready {
    /// Number of cells up to which a search takes a few tenths of a second at most.
    const QUICK_CELLS: u64 = 1 << 20;

    /// Number of nodes of a search that takes about as long as starting a thread.
    const QUICK_NODES: u64 = 1 << 11;

    fn new(PlannerParts { grid }: PlannerParts, choice: &Choice, watch: &Watch) -> PyResult<Self> {
        let named = choice.robot.as_deref().map(|name| robot(name, choice.radius_m)).transpose()?;
        let radius_m = named.as_ref().map(|robot| robot.footprint.inscribed_radius_m());
        let robot = named.unwrap_or_else(Robot::small);
        let stack = stack(&robot, radius_m.or(choice.radius_m), choice)?;
        Self::of_stack(grid, stack, robot, &mut |PrepareProgress { done, total, .. }| {
            if watch.is_stopped_at(done, total) { Break(()) } else { Continue(()) }
        })
    }

    fn of_stack(
        grid: Arc<OccupancyGrid>,
        stack: Stack,
        robot: Robot,
        prepares: &mut dyn FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> PyResult<Self> {
        // Memory of the layers without a search.
        check_memory(grid.frame().cell_count() * 3 / 2)?;
        let map = SearchMap::new(&grid, stack.map.clone());
        let map = map.map_err(|error| bad_value(error.within("map")))?;
        let planner = stack.planner.build_with_progress(&map, prepares);
        let planner = planner.map_err(|error| match error {
            PlanError::Config(error) => bad_value(error.within("planner")),
            error => plan_error(&error),
        })?;
        let smoother =
            stack.smoother.build().map_err(|error| bad_value(error.within("smoother")))?;
        Ok(Self { grid, map, stack, robot, planner, smoother, workspaces: Mutex::default() })
    }

    /// True if a query is too short to be interrupted. It then runs without a thread, as starting
    /// one takes longer than most queries.
    pub(crate) fn is_quick(&self) -> bool {
        self.map.frame().cell_count() <= Self::QUICK_CELLS && self.is_bounded_by_nodes()
    }

    /// Returns the route if its search ends after a few nodes, whatever the size of the map.
    pub(crate) fn quick_route(&self, query: &RouteQuery) -> Option<Route> {
        let budget = query.budget.unwrap_or(Self::QUICK_NODES).min(Self::QUICK_NODES);
        let query = RouteQuery { budget: Some(budget), ..*query };
        self.is_bounded_by_nodes().then(|| self.route(&query).ok()).flatten()
    }

    /// True if the number of nodes determines the duration of a query.
    fn is_bounded_by_nodes(&self) -> bool {
        let is_random_tree = matches!(self.stack.planner, PlannerConfig::Rrt(_));
        let makes_layers = self.stack.map.free_ends_m > 0.0;
        !is_random_tree && !makes_layers
    }

    /// The same with the clearance lifted around start and goal, if that is requested.
    pub(crate) fn around(self: &Arc<Self>, ends: &[Point], watch: &Watch) -> PyResult<Arc<Self>> {
        if self.stack.map.free_ends_m == 0.0 {
            return Ok(Arc::clone(self));
        }
        let (stack, robot) = (self.stack.clone(), self.robot.clone());
        let mut own = Self::of_stack(Arc::clone(&self.grid), stack, robot, &mut |_| {
            if watch.is_stopped() { Break(()) } else { Continue(()) }
        })?;
        let cells: Vec<_> = ends.iter().map(|&end| own.map.frame().cell_near(end)).collect();
        own.map.free_ends(&cells);
        Ok(Arc::new(own))
    }

    pub(crate) fn route(&self, query: &RouteQuery) -> Result<Route, PlanError> {
        let workspaces = || self.workspaces.lock().unwrap_or_else(PoisonError::into_inner);
        let known = workspaces().pop();
        let mut workspace = known.unwrap_or_default();
        let route =
            plan_route(&self.map, &*self.planner, &*self.smoother, query, &mut workspace, &mut ());
        workspaces().push(workspace);
        route
    }

    /// Returns the index of the nearest of several goals, and the route to it.
    pub(crate) fn nearest_route(
        &self,
        start: Point,
        goals: &[Point],
        budget: Option<u64>,
    ) -> PyResult<(usize, Route)> {
        let request = RouteRequest {
            grid: &self.grid,
            map: &self.map,
            planner: &*self.planner,
            smoother: Some(&*self.smoother),
            start,
            goals,
            budget,
            if_unreachable: IfUnreachable::Fail,
            with_optimum: false,
        };
        let first = goals.first().copied().unwrap_or(start);
        let answer = request
            .answer(None, &mut Workspace::default())
            .map_err(|error| self.plain_why(&error, &request.query(first)))?;
        if let Some(route) = answer.route {
            return Ok((answer.goal, route));
        }
        let goal = goals.get(answer.goal).copied().unwrap_or(start);
        Err(match answer.failure {
            Some(RouteFailure::Plan(error)) => self.plain_why(&error, &request.query(goal)),
            Some(RouteFailure::Separated(why)) => no_path_error(&why, &self.stack.planner),
            _ => NoPath::new_err("no path leads to any of the goals"),
        })
    }

    /// Exception of a query without a route. If no path exists, it says what separates start and
    /// goal, which takes as long as several searches.
    pub(crate) fn why(&self, error: &PlanError, query: &RouteQuery) -> PyErr {
        if !matches!(error, PlanError::NoPath { .. }) {
            return self.plain_why(error, query);
        }
        let ends = [query.start, query.goal].map(|end| self.map.frame().cell_near(end));
        let why = why_no_path(&self.map, &self.grid, ends, self.planner.connectivity());
        why.map_or_else(|| plan_error(error), |why| no_path_error(&why, &self.stack.planner))
    }

    /// The same without additional searches.
    pub(crate) fn plain_why(&self, error: &PlanError, query: &RouteQuery) -> PyErr {
        why_no_room(&self.map, [query.start, query.goal], error)
            .map_or_else(|| plan_error(error), |text| no_room_error(&text, error))
    }
}

/// Base of the parameters. Parts selected by name use distances derived from the robot if there
/// is one, otherwise from the radius; with `as_published`, the parameters of their papers.
fn plan_base<'a>(stack: &'a Stack, robot: &'a Robot, choice: &Choice) -> StackBase<'a> {
    match choice.robot {
        _ if choice.as_published => StackBase::as_published(stack, robot),
        Some(_) => StackBase::for_robot(stack, robot),
        None => StackBase::for_radius(stack, robot, choice.radius_m),
    }
}

/// The parameters of a plan.
fn stack(robot: &Robot, radius_m: Option<f64>, choice: &Choice) -> PyResult<Stack> {
    let named = |name: &str| toml::Table::from_iter([("name".to_owned(), name.into())]);
    let mut names = toml::Table::new();
    names.insert("planner".to_owned(), named(&choice.planner).into());
    names.insert("smoother".to_owned(), named(&choice.smoother).into());
    if let Some(radius_m) = radius_m {
        let clearance = [("clearance_m".to_owned(), radius_m.into())];
        names.insert("map".to_owned(), toml::Table::from_iter(clearance).into());
    }
    let base = Stack::for_plans(robot);
    let named = Parameters(names).over(plan_base(&base, robot, choice))?;
    Parameters(choice.parameters.clone()).over(plan_base(&named, robot, choice))
}
