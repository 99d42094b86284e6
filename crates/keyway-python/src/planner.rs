//! Planning.

use crate::errors::bad_value;
use crate::given_map::GivenMap;
use crate::parameters::{Parameters, RobotName};
use crate::plan::Plan;
use crate::ready::{ChoiceRef, Ready};
use crate::values::{Numbers, Positions};
use crate::watched::{Progress, Watch, watched};
use keyway::geometry::Point;
use keyway::navigate::Stack;
use keyway::route::{Route, RouteQuery};
use keyway::search::IfUnreachable;
use keyway_sim::parallel::{in_parallel, processors};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::Arc;

/// Plans many paths on one map. Its layers, planner and smoother are built once.
///
/// The arguments are those of `keyway.plan`. `progress(done, expected)` is called during the
/// construction. The planner `prepared` counts twice the number of cells at which paths may turn;
/// for the other planners, which build only the layers, `expected` is `None`.
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
    #[pyo3(signature = (grid, radius=None, planner="jps", smoother="none", robot=None, parameters=None, as_published=false, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        grid: GivenMap,
        radius: Option<f64>,
        planner: &str,
        smoother: &str,
        robot: Option<RobotName>,
        parameters: Option<Parameters>,
        as_published: bool,
        progress: Option<Progress>,
    ) -> PyResult<Self> {
        let parameters = parameters.as_ref();
        let (radius_m, robot) = (radius, robot.as_ref().map(|RobotName(name)| &**name));
        let choice = ChoiceRef { planner, smoother, radius_m, robot, parameters, as_published };
        Ok(Self { ready: grid.planners().get(grid.parts(), &choice, py, progress.as_ref())? })
    }

    /// Plans a path between two positions [m]; see `keyway.plan`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
    /// >>> planner.plan((0.5, 0.5), (8.5, 4.5)).cost == 4 + 4 * 2 ** 0.5
    /// True
    #[pyo3(signature = (start, goal, budget=None, nearest_reachable=false, progress=None))]
    fn plan(
        &self,
        py: Python<'_>,
        start: Numbers,
        goal: Numbers,
        budget: Option<u64>,
        nearest_reachable: bool,
        progress: Option<Progress>,
    ) -> PyResult<Plan> {
        let query = query((&start, &goal), budget, nearest_reachable)?;
        planned(py, &self.ready, query, progress.as_ref())
    }

    /// Plans many paths on all cores; see `keyway.plan_many`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
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

    /// Plans a path to the nearest of several goals, by path cost. `goals` are an array of shape
    /// (n, 2) [m]. Returns the index of that goal, and the plan. Raises the exceptions of
    /// `keyway.plan` if no goal has a path.
    ///
    /// >>> import keyway, numpy as np
    /// >>> planner = keyway.Planner(keyway.Map.from_array(np.zeros((9, 9), dtype=bool), resolution=1.0))
    /// >>> index, plan = planner.plan_nearest((0.5, 0.5), [(8.5, 8.5), (0.5, 3.5), (5.5, 0.5)])
    /// >>> index, plan.cost
    /// (1, 3.0)
    #[pyo3(signature = (start, goals, budget=None, progress=None))]
    fn plan_nearest(
        &self,
        py: Python<'_>,
        start: Numbers,
        goals: Positions,
        budget: Option<u64>,
        progress: Option<Progress>,
    ) -> PyResult<(usize, Plan)> {
        let (start, goals) = (start.position("start")?, goals.points("goals")?);
        if goals.is_empty() {
            return Err(bad_value("goals: expected at least one"));
        }
        let ready = Arc::clone(&self.ready);
        let (ready, (index, route)) = watched(py, progress.as_ref(), move |watch| {
            let ends: Vec<Point> = std::iter::once(start).chain(goals.iter().copied()).collect();
            let ready = ready.around(&ends, watch)?;
            let found = ready.nearest_route(start, &goals, budget)?;
            Ok::<_, PyErr>((ready, found))
        })??;
        Ok((index, Plan::new(ready, route)))
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

fn planned(
    py: Python<'_>,
    ready: &Arc<Ready>,
    query: RouteQuery,
    progress: Option<&Progress>,
) -> PyResult<Plan> {
    let work = move |ready: &Arc<Ready>, watch: &Watch| {
        let ready = ready.around(&[query.start, query.goal], watch)?;
        let route = ready.route(&query).map_err(|error| ready.why(&error, &query))?;
        Ok::<_, PyErr>((ready, route))
    };
    if progress.is_none() {
        if ready.is_quick() {
            let (ready, route) = py.detach(|| work(ready, &Watch::default()))?;
            return Ok(Plan::new(ready, route));
        }
        if let Some(route) = py.detach(|| ready.quick_route(&query)) {
            return Ok(Plan::new(Arc::clone(ready), route));
        }
    }
    let ready = Arc::clone(ready);
    let (ready, route) = watched(py, progress, move |watch| work(&ready, watch))??;
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
    let ready = Arc::clone(ready);
    let results = watched(py, progress, move |watch| all_routes(&ready, &queries, jobs, watch))?;
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

/// A plan for each query, or the exception of a failed one.
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

/// Plans all queries, in their order. If it is stopped, the remaining ones are missing.
fn all_routes(
    ready: &Arc<Ready>,
    queries: &[RouteQuery],
    jobs: Option<usize>,
    watch: &Watch,
) -> Vec<PlannedRoute> {
    let jobs = jobs.unwrap_or_else(processors).min(1024);
    let plan = |query: &RouteQuery| {
        if watch.is_stopped() {
            return None;
        }
        let around = ready.around(&[query.start, query.goal], watch);
        let route = around.and_then(|ready| {
            let route = ready.route(query).map_err(|error| ready.plain_why(&error, query))?;
            Ok((ready, route))
        });
        watch.advance(queries.len() as u64);
        Some(route)
    };
    in_parallel(queries, jobs, plan).into_iter().flatten().collect()
}

/// Plans a path on a map from one position to another [m], and smooths it.
///
/// `grid` is a map, or the path of its file, which is then read at every call.
///
/// `planner` and `smoother` are names of `keyway.names`. `radius` is the clearance of the path to
/// every obstacle [m]; with `robot` it is the robot's inscribed radius instead. `parameters` are
/// those of the TOML files, as a dictionary:
/// `{"planner": {"corners": "allow"}, "map": {"unknown": "free"}}`. With `as_published`, planner
/// and smoother use the parameters of their papers, for maps with cells of 1 m, whatever the
/// robot. `budget` limits the expanded nodes. With `nearest_reachable` the path ends in the
/// reachable cell nearest to the goal.
///
/// The layers for a choice of parameters are cached with the map, so a second call is fast.
///
/// `progress(done, expected)` is called meanwhile. The preparation of a `keyway.Planner` is
/// counted. A search is not, as its length is unknown: (0, None).
///
/// Raises `NoPath` if no path connects the two, with the reason; `NoRoom` if one of them is
/// blocked or outside the map; `Missed` if the planner finds no path although there is one;
/// `BudgetExhausted`; and `ValueError` for an invalid parameter.
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
#[pyo3(signature = (grid, start, goal, radius=None, planner="jps", smoother="none", robot=None, parameters=None, as_published=false, budget=None, nearest_reachable=false, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn plan(
    py: Python<'_>,
    grid: GivenMap,
    start: Numbers,
    goal: Numbers,
    radius: Option<f64>,
    planner: &str,
    smoother: &str,
    robot: Option<RobotName>,
    parameters: Option<Parameters>,
    as_published: bool,
    budget: Option<u64>,
    nearest_reachable: bool,
    progress: Option<Progress>,
) -> PyResult<Plan> {
    let query = query((&start, &goal), budget, nearest_reachable)?;
    let (radius_m, parameters) = (radius, parameters.as_ref());
    let robot = robot.as_ref().map(|RobotName(name)| &**name);
    let choice = ChoiceRef { planner, smoother, radius_m, robot, parameters, as_published };
    let ready = grid.planners().get(grid.parts(), &choice, py, progress.as_ref())?;
    planned(py, &ready, query, progress.as_ref())
}

/// Plans many paths on all cores: from `starts` to `goals`, arrays of shape (n, 2) [m].
///
/// The other arguments are those of `keyway.plan`; `jobs` is the number of threads. Returns a
/// list with a plan for each query, in their order; for a query without one, the list contains
/// the exception. `progress(done, expected)` is called meanwhile.
///
/// >>> import keyway, numpy as np
/// >>> occupied = np.zeros((5, 5), dtype=bool)
/// >>> occupied[4, 4] = True
/// >>> grid = keyway.Map.from_array(occupied, resolution=1.0)
/// >>> first, second = keyway.plan_many(grid, [(0.5, 0.5), (0.5, 0.5)], [(3.5, 0.5), (4.5, 4.5)])
/// >>> first.cost, type(second).__name__
/// (3.0, 'NoRoom')
#[pyfunction]
#[pyo3(signature = (grid, starts, goals, radius=None, planner="jps", smoother="none", robot=None, parameters=None, as_published=false, jobs=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn plan_many(
    py: Python<'_>,
    grid: GivenMap,
    starts: Positions,
    goals: Positions,
    radius: Option<f64>,
    planner: &str,
    smoother: &str,
    robot: Option<RobotName>,
    parameters: Option<Parameters>,
    as_published: bool,
    jobs: Option<usize>,
    progress: Option<Progress>,
) -> PyResult<Plans> {
    let (radius_m, parameters) = (radius, parameters.as_ref());
    let robot = robot.as_ref().map(|RobotName(name)| &**name);
    let choice = ChoiceRef { planner, smoother, radius_m, robot, parameters, as_published };
    let ready = grid.planners().get(grid.parts(), &choice, py, progress.as_ref())?;
    planned_many(py, &ready, (&starts, &goals), jobs, progress.as_ref())
}
