//! Report of a query to one goal or to several: `keyway.plan/3`.

use super::{Clock, Inputs, MapSource, Parameters, PlanOutcome, PlanPart, SmoothedPart};
use keyway::geometry::Point;
use keyway::map::{Cell, Connectivity, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{
    AStar, AStarConfig, GlobalPlanner, GoalPlan, NearestFirst, PathEnd, Plan, PlanError,
};
use keyway::robot::Robot;
use keyway::route::{NoPath, Route, RouteQuery, Stage, StageObserver, plan_route, why_no_path};
use keyway::search::{CornerRule, IfUnreachable, Query, SearchStatistics, Workspace};
use keyway::smooth::{Smoother, Unsmoothed};
use serde::Serialize;

/// Request for routes from one start, with the map and the planner.
#[derive(Clone, Copy)]
pub struct RouteRequest<'a> {
    /// The map.
    pub grid: &'a OccupancyGrid,
    /// Layers of the map.
    pub map: &'a SearchMap,
    /// The planner.
    pub planner: &'a dyn GlobalPlanner,
    /// The smoother; `None` keeps the planned line, and the report has no smoothing part.
    pub smoother: Option<&'a dyn Smoother>,
    /// Start of the routes \[m\].
    pub start: Point,
    /// Goals \[m\]: one, or several of which the nearest by path cost is wanted.
    pub goals: &'a [Point],
    /// Limit of expanded nodes for each search.
    pub budget: Option<u64>,
    /// Behaviour if no path leads to the goal. It does not apply to several goals.
    pub if_unreachable: IfUnreachable,
    /// True if the path is compared with the cheapest path of straight and diagonal steps.
    pub with_optimum: bool,
}

/// Report of a route without its inputs, and the route itself.
#[derive(Clone, Debug)]
pub struct RouteAnswer {
    /// Index of the route's goal in the list; without a route, of the goal that [`Self::plan`]
    /// describes.
    pub goal: usize,
    /// Route to this goal.
    pub route: Option<Route>,
    /// Reason why there is no route, if known from a search.
    pub failure: Option<RouteFailure>,
    /// Report of the plan.
    pub plan: PlanPart,
    /// Goal that the route reaches.
    pub reached: Option<ReachedGoal>,
    /// All goals, nearest first, if there are several.
    pub goals: Option<Vec<GoalPart>>,
    /// The smoothed path, if it was smoothed.
    pub smoothed: Option<SmoothedPart>,
}

/// Reason why a route does not exist.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RouteFailure {
    /// The planner found no path.
    Plan(PlanError),
    /// No path joins start and goal.
    Separated(NoPath),
}

/// `keyway.plan/3`: the answer to a request, and all its inputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RouteReport {
    /// Name and version of this format.
    pub schema: &'static str,
    /// The path, or the reason why there is none.
    #[serde(flatten)]
    pub plan: PlanPart,
    /// Goal that the path reaches; `None` without a path.
    pub goal: Option<ReachedGoal>,
    /// All goals, nearest first, if there are several.
    pub goals: Option<Vec<GoalPart>>,
    /// The smoothed path, if it was smoothed.
    pub smoothed: Option<SmoothedPart>,
    /// All inputs of the result.
    pub inputs: Inputs,
}

/// Goal that a path reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReachedGoal {
    /// Index in the list, from 0.
    pub index: usize,
    /// The last cell of the path.
    pub cell: Cell,
    /// Distance from the requested position to the end of the path \[m\]; 0 when it was reached.
    pub gap_m: f64,
}

/// One of several goals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GoalPart {
    /// Index in the list, from 0.
    pub index: usize,
    /// Position of the goal \[m\].
    pub goal: Point,
    /// Outcome of the search.
    pub outcome: PlanOutcome,
    /// Length of the line \[m\].
    pub length_m: Option<f64>,
    /// Cost of the grid path \[cells\].
    pub cost_cells: Option<f64>,
    /// Nodes taken from the open list.
    pub expanded: u64,
    /// Nodes added to the open list, or improved there.
    pub generated: u64,
    /// Wall-clock time until this goal's rank was known, including the searches for other goals
    /// \[s\].
    pub time_s: Option<f64>,
}

impl RouteRequest<'_> {
    /// Plans the routes, and measures the one to the nearest goal.
    ///
    /// ```
    /// use keyway::geometry::Point;
    /// use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
    /// use keyway::plan::AStar;
    /// use keyway_sim::report::{PlanOutcome, RouteRequest};
    /// use keyway::search::{IfUnreachable, Workspace};
    /// use keyway::smooth::Taut;
    ///
    /// let grid = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
    /// let map = SearchMap::new(&grid, LayerConfig::default())?;
    /// let request = RouteRequest {
    ///     grid: &grid,
    ///     map: &map,
    ///     planner: &AStar::default(),
    ///     smoother: Some(&Taut),
    ///     start: Point::new(0.5, 1.5),
    ///     goals: &[Point::new(4.5, 1.5)],
    ///     budget: None,
    ///     if_unreachable: IfUnreachable::Fail,
    ///     with_optimum: true,
    /// };
    /// let answer = request.answer(None, &mut Workspace::default())?;
    /// assert_eq!((answer.plan.outcome, answer.plan.excess), (PlanOutcome::Found, Some(0.0)));
    /// assert!(answer.smoothed.unwrap().length_m < answer.plan.length_m.unwrap());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if no search can begin: a start or a goal in an obstacle or outside the
    /// map (of several goals, only the start counts), a planner that does not support the map, or
    /// an empty list of goals. A search without a path is an answer.
    pub fn answer(
        &self,
        clock: Clock<'_>,
        workspace: &mut Workspace,
    ) -> Result<RouteAnswer, PlanError> {
        // The components are a layer of the map.
        self.map.components(self.planner.connectivity());
        let answer = match self.goals {
            [] => return Err(PlanError::NoPath { statistics: SearchStatistics::default() }),
            &[goal] => self.for_one(goal, clock, workspace),
            _ => self.for_nearest(clock, workspace),
        }?;
        let answer = self.explained(answer);
        let optimum = answer.route.as_ref().filter(|_| self.with_optimum);
        Ok(match optimum.and_then(|route| self.optimum_cells(&route.plan.cells)) {
            Some(optimum) => RouteAnswer { plan: answer.plan.beside_optimum(optimum), ..answer },
            None => answer,
        })
    }

    /// Returns all inputs of the answer, for its report. `stack` holds the parameters of the
    /// layers, the planner and the smoother.
    pub fn inputs(&self, source: MapSource, robot: Option<Robot>, stack: &Stack) -> Inputs {
        let is_nearest = self.if_unreachable == IfUnreachable::NearestReachable;
        Inputs {
            version: Inputs::VERSION,
            map: source.name,
            map_digest: source.digest,
            placement: source.placement,
            robot,
            stack: None,
            config: Parameters::Route {
                map: stack.map.clone(),
                planner: stack.planner.clone(),
                smoother: stack.smoother.clone(),
            },
            start: vec![self.start.x, self.start.y],
            goal: self.goals.first().map(|goal| vec![goal.x, goal.y]).unwrap_or_default(),
            goals: (self.goals.len() > 1).then(|| self.goals.to_vec()),
            via: None,
            nearest_reachable: Some(is_nearest),
            obstacles: Vec::new(),
            polygons: Vec::new(),
            hidden_cells: Vec::new(),
            absent_cells: Vec::new(),
            elusive: Vec::new(),
            moving: Vec::new(),
            random: None,
            disturbances: None,
            goal_tolerance_m: None,
            arrival: None,
            reached_by: None,
            time_limit_s: None,
            stuck_window_s: None,
            budget: self.budget,
        }
    }

    /// Returns the query to one of the goals.
    pub fn query(&self, goal: Point) -> RouteQuery {
        let &Self { budget, if_unreachable, .. } = self;
        RouteQuery { budget, if_unreachable, ..RouteQuery::new(self.start, goal) }
    }

    fn smoother(&self) -> &dyn Smoother {
        self.smoother.unwrap_or(&Unsmoothed)
    }

    fn for_one(
        &self,
        goal: Point,
        clock: Clock<'_>,
        workspace: &mut Workspace,
    ) -> Result<RouteAnswer, PlanError> {
        let (mut times, query) = (StageTimes::new(clock), self.query(goal));
        let &Self { map, planner, .. } = self;
        match plan_route(map, planner, self.smoother(), &query, workspace, &mut times) {
            Ok(route) => Ok(self.found(0, route, times.search_s, &times)),
            Err(error) => match PlanPart::failed(planner.name(), &error, times.search_s) {
                Some(plan) => Ok(RouteAnswer::without_route(0, plan, Some(error))),
                None => Err(error),
            },
        }
    }

    /// Plans paths to all goals, nearest first; the route leads to the first of them.
    fn for_nearest(
        &self,
        clock: Clock<'_>,
        workspace: &mut Workspace,
    ) -> Result<RouteAnswer, PlanError> {
        let cell = |point: &Point| self.map.frame().cell_near(*point);
        let goals: Vec<Cell> = self.goals.iter().map(cell).collect();
        let query = Query { budget: self.budget, ..Query::new(cell(&self.start), goals[0]) };
        let begin_s = clock.map(|now_s| now_s());
        let elapsed_s = || clock.zip(begin_s).map(|(now_s, begin_s)| now_s() - begin_s);
        let found = NearestFirst::new(self.planner, self.map, &query, &goals, workspace);
        let found: Vec<(GoalPlan, Option<f64>)> = found.map(|goal| (goal, elapsed_s())).collect();
        let (first, time_s) = &found[0];
        let nearest = match &first.result {
            Ok(plan) => {
                let (mut times, query) =
                    (StageTimes::new(clock), self.query(self.goals[first.index]));
                let route =
                    Route::of_plan(self.map, self.smoother(), &query, plan.clone(), &mut times);
                self.found(first.index, route, *time_s, &times)
            }
            Err(error) if concerns_all_goals(error) => return Err(error.clone()),
            Err(error) => {
                let name = self.planner.name();
                // A goal without clearance for the robot counts as a goal without a path.
                let without = || PlanPart::without_path(name, PlanOutcome::NoPath, *time_s);
                let failed = PlanPart::failed(name, error, *time_s);
                let failure = failed.as_ref().map(|_| error.clone());
                RouteAnswer::without_route(first.index, failed.unwrap_or_else(without), failure)
            }
        };
        let part = |(goal, time_s): &(GoalPlan, Option<f64>)| self.goal_part(goal, *time_s);
        Ok(RouteAnswer { goals: Some(found.iter().map(part).collect()), ..nearest })
    }

    fn found(
        &self,
        goal: usize,
        route: Route,
        time_s: Option<f64>,
        times: &StageTimes<'_>,
    ) -> RouteAnswer {
        let gap_m = route.end().map_or(0.0, |end| self.goals[goal].distance(end));
        RouteAnswer {
            goal,
            failure: None,
            plan: PlanPart::found(self.planner.name(), &route.plan, &route.line, self.map, time_s),
            reached: route.plan.reached().map(|cell| ReachedGoal { index: goal, cell, gap_m }),
            goals: None,
            smoothed: (self.smoother)
                .map(|_| SmoothedPart::of(&route, self.map, times.smoothing_s)),
            route: Some(route),
        }
    }

    fn goal_part(&self, found: &GoalPlan, time_s: Option<f64>) -> GoalPart {
        let goal = self.goals[found.index];
        let plan = found.result.as_ref().ok();
        let (outcome, statistics) = match &found.result {
            Ok(plan) => (PlanOutcome::Found, plan.statistics),
            Err(error) => PlanOutcome::of(error),
        };
        let length_m = |plan: &Plan| self.query(goal).line(self.map, plan).polyline().length_m();
        GoalPart {
            index: found.index,
            goal,
            outcome,
            length_m: plan.map(length_m),
            cost_cells: plan.map(|plan| plan.cost.cells()),
            expanded: statistics.expanded(),
            generated: statistics.generated(),
            time_s,
        }
    }

    /// Adds the reason why no path connects start and goal.
    fn explained(&self, answer: RouteAnswer) -> RouteAnswer {
        if answer.plan.outcome != PlanOutcome::NoPath {
            return answer;
        }
        let ends = [self.start, self.goals[answer.goal]].map(|end| self.map.frame().cell_near(end));
        let connectivity = self.planner.connectivity();
        let Some(why) = why_no_path(self.map, self.grid, ends, connectivity) else { return answer };
        let plan = answer.plan.separated_by(&why.separation, why.to_string());
        RouteAnswer { plan, failure: Some(RouteFailure::Separated(why)), ..answer }
    }

    /// Cost of the cheapest path of straight and diagonal steps between the first and last cell
    /// of a found path \[cells\], by A* under the corner rule of the planner.
    fn optimum_cells(&self, path: &[Cell]) -> Option<f64> {
        let corners = match self.planner.connectivity() {
            Connectivity::Four => CornerRule::Forbid,
            Connectivity::Eight => CornerRule::Allow,
        };
        let astar = AStar::new(AStarConfig { corners, ..AStarConfig::default() });
        let query = Query::new(*path.first()?, *path.last()?);
        let mut plan = Plan::default();
        astar.plan_into(self.map, &query, &mut Workspace::default(), None, &mut plan).ok()?;
        Some(plan.cost.cells())
    }
}

/// True if an error concerns all goals, not a single one of several.
fn concerns_all_goals(error: &PlanError) -> bool {
    match *error {
        PlanError::Blocked { end, .. } | PlanError::OutsideMap { end, .. } => end == PathEnd::Start,
        ref error => PlanOutcome::of(error).0 == PlanOutcome::Refused,
    }
}

impl RouteAnswer {
    fn without_route(goal: usize, plan: PlanPart, failure: Option<PlanError>) -> Self {
        let failure = failure.map(RouteFailure::Plan);
        Self { goal, route: None, failure, plan, reached: None, goals: None, smoothed: None }
    }

    /// Returns the report of the answer.
    pub fn report(&self, inputs: Inputs) -> RouteReport {
        let Self { plan, reached, goals, smoothed, .. } = self;
        RouteReport {
            schema: RouteReport::SCHEMA,
            plan: plan.clone(),
            goal: *reached,
            goals: goals.clone(),
            smoothed: smoothed.clone(),
            inputs,
        }
    }
}

impl RouteReport {
    /// Name and version of this format.
    pub const SCHEMA: &'static str = "keyway.plan/3";
}

/// Wall-clock times of the stages of a route, by the caller's clock.
struct StageTimes<'a> {
    clock: Clock<'a>,
    begin_s: Option<f64>,
    search_s: Option<f64>,
    smoothing_s: Option<f64>,
}

impl<'a> StageTimes<'a> {
    const fn new(clock: Clock<'a>) -> Self {
        Self { clock, begin_s: None, search_s: None, smoothing_s: None }
    }
}

impl StageObserver for StageTimes<'_> {
    fn begin(&mut self, _stage: Stage) {
        self.begin_s = self.clock.map(|now_s| now_s());
    }

    fn end(&mut self, stage: Stage) {
        let time_s = self.clock.zip(self.begin_s).map(|(now_s, begin_s)| now_s() - begin_s);
        match stage {
            Stage::Search => self.search_s = time_s,
            Stage::Smoothing => self.smoothing_s = time_s,
            _ => {}
        }
    }
}
