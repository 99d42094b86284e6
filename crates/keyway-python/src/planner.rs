//! Planning.

use crate::errors::{NoPath, bad_value, plan_error};
use crate::map::Map;
use crate::parameters::{Parameters, robot};
use crate::plan::Plan;
use crate::values::{Numbers, Positions};
use crate::watched::{Progress, Watch, watched};
use keyway::files::StackBase;
use keyway::geometry::Point;
use keyway::map::{OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, PlanError};
use keyway::robot::Robot;
use keyway::route::{Route, RouteQuery, plan_route, why_no_path};
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::Smoother;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// What planners are made of, beside their parameters.
pub(crate) struct PlannerParts {
    pub(crate) grid: Arc<OccupancyGrid>,
}

/// The layers of a map, a planner and a smoother, ready for queries; and the memory of searches, one for each thread.
pub(crate) struct Ready {
    pub(crate) grid: Arc<OccupancyGrid>,
    pub(crate) map: SearchMap,
    pub(crate) stack: Stack,
    pub(crate) robot: Robot,
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    smoother: Box<dyn Smoother + Send + Sync>,
    workspaces: Mutex<Vec<Workspace>>,
}

/// What a planner follows from, besides its map.
#[derive(Clone, PartialEq)]
struct Choice {
    planner: String,
    smoother: String,
    radius_m: Option<f64>,
    robot: Option<String>,
    parameters: toml::Table,
}

/// Planners that were used on a map last: whoever calls `plan` again does not wait for the layers again.
#[derive(Default)]
pub(crate) struct PlannerCache(Mutex<Vec<(Choice, Arc<Ready>)>>);

impl PlannerCache {
    const SIZE: usize = 8;

    fn get(
        &self,
        parts: PlannerParts,
        choice: &ChoiceRef<'_>,
        py: Python<'_>,
    ) -> PyResult<Arc<Ready>> {
        let find = |all: &[(Choice, Arc<Ready>)]| {
            all.iter().find(|(known, _)| choice.is(known)).map(|(_, ready)| Arc::clone(ready))
        };
        if let Some(ready) = find(&self.lock()) {
            return Ok(ready);
        }
        let owned = choice.owned();
        let ready = Arc::new(py.detach(|| Ready::new(parts, &owned))?);
        let mut all = self.lock();
        all.insert(0, (owned, Arc::clone(&ready)));
        all.truncate(Self::SIZE);
        Ok(ready)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<(Choice, Arc<Ready>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The same without copies.
struct ChoiceRef<'a> {
    planner: &'a str,
    smoother: &'a str,
    radius_m: Option<f64>,
    robot: Option<&'a str>,
    parameters: Option<&'a Parameters>,
}

impl ChoiceRef<'_> {
    fn is(&self, known: &Choice) -> bool {
        (self.planner, self.smoother) == (&known.planner, &known.smoother)
            && (self.radius_m, self.robot) == (known.radius_m, known.robot.as_deref())
            && self.parameters.map_or(known.parameters.is_empty(), |it| it.0 == known.parameters)
    }

    fn owned(&self) -> Choice {
        Choice {
            planner: self.planner.to_owned(),
            smoother: self.smoother.to_owned(),
            radius_m: self.radius_m,
            robot: self.robot.map(str::to_owned),
            parameters: self.parameters.map(|it| it.0.clone()).unwrap_or_default(),
        }
    }
}

impl Ready {
    fn new(PlannerParts { grid }: PlannerParts, choice: &Choice) -> PyResult<Self> {
        let named = choice.robot.as_deref().map(|name| robot(name, choice.radius_m)).transpose()?;
        let radius_m = named.as_ref().map(|robot| robot.footprint.inscribed_radius_m());
        let robot = named.unwrap_or_else(Robot::small);
        let stack = stack(&robot, radius_m.or(choice.radius_m), choice)?;
        Self::of_stack(grid, stack, robot)
    }

    fn of_stack(grid: Arc<OccupancyGrid>, stack: Stack, robot: Robot) -> PyResult<Self> {
        let map = SearchMap::new(&grid, stack.map.clone());
        let map = map.map_err(|error| bad_value(error.within("map")))?;
        let planner = stack.planner.build(&map).map_err(|error| match error {
            PlanError::Config(error) => bad_value(error.within("planner")),
            error => plan_error(&error),
        })?;
        let smoother =
            stack.smoother.build().map_err(|error| bad_value(error.within("smoother")))?;
        Ok(Self { grid, map, stack, robot, planner, smoother, workspaces: Mutex::default() })
    }

    /// The same with the clearance lifted around the ends of a query, where that is asked for.
    fn around(self: &Arc<Self>, ends: [Point; 2]) -> PyResult<Arc<Self>> {
        if self.stack.map.free_ends_m == 0.0 {
            return Ok(Arc::clone(self));
        }
        let (stack, robot) = (self.stack.clone(), self.robot.clone());
        let mut own = Self::of_stack(Arc::clone(&self.grid), stack, robot)?;
        let cells = ends.map(|end| own.map.frame().cell_near(end));
        own.map.free_ends(&cells);
        Ok(Arc::new(own))
    }

    fn route(&self, query: &RouteQuery) -> Result<Route, PlanError> {
        let workspaces = || self.workspaces.lock().unwrap_or_else(PoisonError::into_inner);
        let known = workspaces().pop();
        let mut workspace = known.unwrap_or_default();
        let route =
            plan_route(&self.map, &*self.planner, &*self.smoother, query, &mut workspace, &mut ());
        workspaces().push(workspace);
        route
    }

    /// Why there is no route; what parts start and goal where no path joins them, which takes as long as several searches.
    fn why(&self, error: &PlanError, query: &RouteQuery) -> PyErr {
        if !matches!(error, PlanError::NoPath { .. }) {
            return plan_error(error);
        }
        let ends = [query.start, query.goal].map(|end| self.map.frame().cell_near(end));
        let why = why_no_path(&self.map, &self.grid, ends, self.planner.connectivity());
        why.map_or_else(|| plan_error(error), |why| NoPath::new_err(why.to_string()))
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
    let named = Parameters(names).over(StackBase::for_robot(&base, robot))?;
    Parameters(choice.parameters.clone()).over(StackBase::for_robot(&named, robot))
}

/// Plans many paths on one map: its layers, its planner and its smoother are made once.
///
/// The arguments are those of `keyway.plan`.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((50, 50), dtype=bool), resolution=0.1)
/// >>> planner = keyway.Planner(grid, radius=0.2, planner="theta-star")
/// >>> planner.plan((0.55, 0.55), (4.55, 0.55)).length
/// 4.0
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Planner {
    ready: Arc<Ready>,
}

#[pymethods]
impl Planner {
    #[new]
    #[pyo3(signature = (grid, radius=None, planner="jps", smoother="none", robot=None, parameters=None))]
    fn new(
        py: Python<'_>,
        grid: &Map,
        radius: Option<f64>,
        planner: &str,
        smoother: &str,
        robot: Option<&str>,
        parameters: Option<Parameters>,
    ) -> PyResult<Self> {
        let parameters = parameters.as_ref();
        let choice = ChoiceRef { planner, smoother, radius_m: radius, robot, parameters };
        Ok(Self { ready: grid.planners().get(grid.parts(), &choice, py)? })
    }

    /// Plans a path between two positions [m]; see `keyway.plan`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool)))
    /// >>> planner.plan((0.5, 0.5), (8.5, 4.5)).cost == 4 + 4 * 2 ** 0.5
    /// True
    #[pyo3(signature = (start, goal, budget=None, nearest_reachable=false))]
    fn plan(
        &self,
        py: Python<'_>,
        start: Numbers,
        goal: Numbers,
        budget: Option<u64>,
        nearest_reachable: bool,
    ) -> PyResult<Plan> {
        let query = query((&start, &goal), budget, nearest_reachable)?;
        planned(py, &self.ready, &query)
    }

    /// Plans many paths on all cores; see `keyway.plan_many`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool)))
    /// >>> [plan.cost for plan in planner.plan_many([(0.5, 0.5), (1.5, 1.5)], [(8.5, 0.5), (1.5, 4.5)])]
    /// [8.0, 3.0]
    #[pyo3(signature = (starts, goals, jobs=None, progress=None))]
    fn plan_many(
        &self,
        py: Python<'_>,
        starts: Positions,
        goals: Positions,
        jobs: Option<usize>,
        progress: Option<Progress>,
    ) -> PyResult<Plans> {
        planned_many(py, &self.ready, (&starts, &goals), jobs, progress.as_ref())
    }

    fn __repr__(&self) -> String {
        let Stack { map, planner, smoother, .. } = &self.ready.stack;
        let (planner, smoother, clearance_m) = (planner.name(), smoother.name(), map.clearance_m);
        format!("<keyway.Planner {planner} with {smoother}, {clearance_m} m from obstacles>")
    }
}

fn query(
    (start, goal): (&Numbers, &Numbers),
    budget: Option<u64>,
    nearest_reachable: bool,
) -> PyResult<RouteQuery> {
    let query = RouteQuery::new(start.position("start")?, goal.position("goal")?);
    let if_unreachable =
        if nearest_reachable { IfUnreachable::NearestReachable } else { IfUnreachable::Fail };
    Ok(RouteQuery { budget, if_unreachable, ..query })
}

fn planned(py: Python<'_>, ready: &Arc<Ready>, query: &RouteQuery) -> PyResult<Plan> {
    let (ready, route) = py.detach(|| {
        let ready = ready.around([query.start, query.goal])?;
        let route = ready.route(query).map_err(|error| ready.why(&error, query))?;
        Ok::<_, PyErr>((ready, route))
    })?;
    Ok(Plan::new(ready, route))
}

fn planned_many(
    py: Python<'_>,
    ready: &Arc<Ready>,
    (starts, goals): (&Positions, &Positions),
    jobs: Option<usize>,
    progress: Option<&Progress>,
) -> PyResult<Plans> {
    let (starts, goals) = (starts.points("starts")?, goals.points("goals")?);
    if starts.len() != goals.len() {
        let text =
            format!("expected as many goals as starts, got {} and {}", starts.len(), goals.len());
        return Err(bad_value(text));
    }
    if jobs == Some(0) {
        return Err(bad_value("jobs: expected at least 1, got 0"));
    }
    let queries: Vec<RouteQuery> =
        starts.iter().zip(&goals).map(|(&start, &goal)| RouteQuery::new(start, goal)).collect();
    let results = watched(py, progress, |watch| all_routes(ready, &queries, jobs, watch))?;
    let plan = |result| match result {
        Ok((ready, route)) => Ok(Bound::new(py, Plan::new(ready, route))?.into_any()),
        Err(error) => {
            let error: PyErr = error;
            Ok(error.into_value(py).into_bound(py).into_any())
        }
    };
    let plans = results.into_iter().map(plan).collect::<PyResult<Vec<_>>>()?;
    Ok(Plans(PyList::new(py, plans)?.unbind()))
}

/// A plan for each query, or why there is none.
pub(crate) struct Plans(Py<PyList>);

impl<'py> IntoPyObject<'py> for Plans {
    type Target = PyList;
    type Output = Bound<'py, PyList>;
    type Error = std::convert::Infallible;

    #[cfg(feature = "stubs")]
    const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr =
        pyo3::type_hint_identifier!("keyway.typing", "Plans");

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(self.0.into_bound(py))
    }
}

type PlannedRoute = PyResult<(Arc<Ready>, Route)>;

/// In the order of the queries; not all of them where somebody stops it.
fn all_routes(
    ready: &Arc<Ready>,
    queries: &[RouteQuery],
    jobs: Option<usize>,
    watch: &Watch,
) -> Vec<PlannedRoute> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.unwrap_or(cores).min(queries.len()).min(1024);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((index, query)) = {
            let index = next.fetch_add(1, Ordering::Relaxed);
            queries.get(index).map(|query| (index, query)).filter(|_| !watch.is_stopped())
        } {
            let around = ready.around([query.start, query.goal]);
            let route = around.and_then(|ready| {
                let route = ready.route(query).map_err(|error| plan_error(&error))?;
                Ok((ready, route))
            });
            done.push((index, route));
            watch.advance(queries.len() as u64);
        }
        done
    };
    let mut all: Vec<(usize, PlannedRoute)> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap_or_default()).collect()
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, route)| route).collect()
}

/// Plans a path on a map, from one position to another [m], and smooths it.
///
/// `planner` and `smoother` are names of `keyway.names`; `radius` is what the path keeps from every obstacle [m], `robot` a
/// robot whose inscribed radius it keeps instead. `parameters` are those of the TOML files, as a dictionary:
/// `{"planner": {"corners": "allow"}, "map": {"unknown": "free"}}`. `budget` limits the expanded nodes; with
/// `nearest_reachable` the path ends in the cell nearest to the goal that can be reached.
///
/// What a map needs for a choice of parameters is kept with the map, so a second call is fast.
///
/// Raises `NoPath` where no path joins the two and says what parts them, `NoRoom` where one of them is blocked or outside the
/// map, `Missed` where the planner finds none although there is one, `BudgetExhausted`, and `ValueError` for a parameter that
/// cannot be used.
///
/// >>> import keyway, numpy as np
/// >>> occupied = np.zeros((60, 100), dtype=bool)
/// >>> occupied[:50, 50] = True
/// >>> grid = keyway.Map.from_array(occupied, resolution=0.1)
/// >>> plan = keyway.plan(grid, start=(1, 1), goal=(9, 4), radius=0.2, smoother="taut")
/// >>> plan.xy[0].tolist(), plan.xy[-1].tolist()
/// ([1.0, 1.0], [9.0, 4.0])
/// >>> round(plan.length, 2)
/// 10.0
#[pyfunction]
#[pyo3(signature = (grid, start, goal, radius=None, planner="jps", smoother="none", robot=None, parameters=None, budget=None, nearest_reachable=false))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn plan(
    py: Python<'_>,
    grid: &Map,
    start: Numbers,
    goal: Numbers,
    radius: Option<f64>,
    planner: &str,
    smoother: &str,
    robot: Option<&str>,
    parameters: Option<Parameters>,
    budget: Option<u64>,
    nearest_reachable: bool,
) -> PyResult<Plan> {
    let query = query((&start, &goal), budget, nearest_reachable)?;
    let choice =
        ChoiceRef { planner, smoother, radius_m: radius, robot, parameters: parameters.as_ref() };
    let ready = grid.planners().get(grid.parts(), &choice, py)?;
    planned(py, &ready, &query)
}

/// Plans many paths on all cores: from `starts` to `goals`, arrays of shape (n, 2) [m].
///
/// The other arguments are those of `keyway.plan`; `jobs` is the number of threads. Gives a list with a plan for each query, in
/// their order; where there is none, the exception that says why is in its place. `progress(done, expected)` is called meanwhile.
///
/// >>> import keyway, numpy as np
/// >>> occupied = np.zeros((5, 5), dtype=bool)
/// >>> occupied[4, 4] = True
/// >>> grid = keyway.Map.from_array(occupied)
/// >>> first, second = keyway.plan_many(grid, [(0.5, 0.5), (0.5, 0.5)], [(3.5, 0.5), (4.5, 4.5)])
/// >>> first.cost, type(second).__name__
/// (3.0, 'NoRoom')
#[pyfunction]
#[pyo3(signature = (grid, starts, goals, radius=None, planner="jps", smoother="none", robot=None, parameters=None, jobs=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn plan_many(
    py: Python<'_>,
    grid: &Map,
    starts: Positions,
    goals: Positions,
    radius: Option<f64>,
    planner: &str,
    smoother: &str,
    robot: Option<&str>,
    parameters: Option<Parameters>,
    jobs: Option<usize>,
    progress: Option<Progress>,
) -> PyResult<Plans> {
    let choice =
        ChoiceRef { planner, smoother, radius_m: radius, robot, parameters: parameters.as_ref() };
    let ready = grid.planners().get(grid.parts(), &choice, py)?;
    planned_many(py, &ready, (&starts, &goals), jobs, progress.as_ref())
}
