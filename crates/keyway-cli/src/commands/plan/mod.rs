//! `keyway plan`: a map and two positions -> a path.

mod curve;
mod outputs;
mod table;

use super::optimum::optimum_cells;
use super::{Done, THROUGH_UNKNOWN, build_planner, end_flag, remedy, why};
use crate::args::{Format, PlanArgs, PositionArg};
use crate::config::{FieldOption, resolve, size_option};
use crate::error::{CliError, Kind};
use crate::inputs::{layers, load_map, position, sized_robot};
use crate::measure::{StageTimer, Times};
use crate::output::print_files;
use crate::pictures::{PlanGoals, PlanPicture};
use crate::report::{
    GoalPart, Inputs, PlanOutcome, PlanPart, PlanReport, ReachedGoal, SmoothedPart,
};
use curve::Curve;
use keyway::geometry::{Path, Point};
use keyway::map::formats::LoadedMap;
use keyway::map::{Cell, Connectivity, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, GoalPlan, NearestFirst, PathEnd, Plan, PlanError, Prepared};
use keyway::robot::Robot;
use keyway::route::{NoPath, Route, RouteQuery, plan_route, why_no_path};
use keyway::search::{IfUnreachable, Query, Recording, Workspace};
use keyway::smooth::SmootherConfig;
use std::time::Instant;
use table::table;

pub(crate) fn run(args: &PlanArgs) -> Result<Done, CliError> {
    let robot = sized_robot(&args.size)?;
    let stack = resolve_stack(args, robot.as_ref())?;
    let loaded = load_map(&args.map.path, args.map.place.placement())?;
    outputs::check(args, &loaded)?;
    let curve = Curve::from_args(args, robot.as_ref());
    let mut map = layers(&loaded.grid, stack.map.clone(), &args.size)?;
    let ends = ends(args, &map)?;
    let all_ends = std::iter::once(ends.start).chain(ends.goals.iter().copied());
    let all_cells: Vec<Cell> = all_ends.map(|end| map.frame().cell_near(end)).collect();
    map.free_ends(&all_cells);
    let planned = plan((&map, &loaded.grid), &stack, &ends, args)?;
    let inputs = inputs(args, robot, &stack, &loaded, &ends);
    let route = planned.route.as_ref();
    let line = route.map(|route| route.line.polyline());
    let smooths = stack.smoother != SmootherConfig::None {};
    let smooth_route = route.filter(|_| smooths);
    let smoothed = smooth_route.map(|route| &route.smoothed);
    let (start, blocked, search) = (ends.start, map.blocked(), &planned.search);
    let goals = PlanGoals::new(&ends.goals, planned.goal, line.is_some(), map.frame());
    let picture =
        PlanPicture { map: &loaded.grid, blocked, start, goals: &goals, search, line, smoothed };
    // A joint at every cell would not be a joint of the path.
    let straight = || line.map(|line| Path::from(&line.merged()));
    let path = smooth_route.map(|route| route.smoothing.path.clone()).or_else(straight);
    let table_of = |(curve, path): (&Curve, &Path)| curve.bytes(path, &inputs);
    let table_of_curve = curve.as_ref().zip(path.as_ref()).map(table_of).transpose()?;
    let files = outputs::write(args, &picture, table_of_curve.as_deref())?;
    let part_of = |route: &Route| SmoothedPart {
        time_s: planned.smoothing_s,
        ..SmoothedPart::of(&route.smoothing, &route.smoothed, &map, &stack.smoother)
    };
    let report = PlanReport {
        schema: "keyway.plan/2",
        smoothed: smooth_route.map(part_of),
        plan: planned.part,
        goal: planned.reached,
        goals: planned.goals,
        inputs,
        files,
    };
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            super::print(&table(&report))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::when(report.plan.outcome == PlanOutcome::Found))
}

/// The parameters for a plan: of a point, and not smoothed, unless the options say otherwise.
pub(super) fn plan_base(robot: &Robot) -> Stack {
    let stack = Stack::key_point_fusion(robot);
    let map = LayerConfig { clearance_m: 0.0, ..stack.map };
    Stack { map, smoother: SmootherConfig::None {}, ..stack }
}

fn resolve_stack(args: &PlanArgs, robot: Option<&Robot>) -> Result<Stack, CliError> {
    let options = [
        FieldOption::new("--planner", "planner.name", args.planner.clone()),
        FieldOption::new(
            "--prepared",
            "planner.name",
            args.prepared.as_ref().map(|_| Prepared::NAME),
        ),
        FieldOption::new("--smoother", "smoother.name", args.smoother.clone()),
        size_option(&args.size, robot),
    ];
    let robot = robot.cloned().unwrap_or_else(Robot::small);
    resolve(&plan_base(&robot), &robot, &args.config, options, &[])
}

/// Positions in metres; at least one goal.
struct Ends {
    start: Point,
    goals: Vec<Point>,
}

fn ends(args: &PlanArgs, map: &SearchMap) -> Result<Ends, CliError> {
    if args.nearest_reachable && args.goal.len() > 1 {
        let message = "--nearest-reachable is for a single --goal";
        return Err(CliError::new(Kind::Usage, message).field("--nearest-reachable"));
    }
    let to_goal = |goal: &PositionArg| position(map.frame(), goal.0, args.cells, "--goal");
    Ok(Ends {
        start: position(map.frame(), args.start.0, args.cells, "--start")?,
        goals: args.goal.iter().map(to_goal).collect::<Result<_, _>>()?,
    })
}

struct Planned {
    /// The goal of the plan, by its place in the command line.
    goal: usize,
    part: PlanPart,
    reached: Option<ReachedGoal>,
    /// All goals, nearest first, where there are several.
    goals: Option<Vec<GoalPart>>,
    route: Option<Route>,
    /// Wall clock of its smoothing.
    smoothing_s: Option<f64>,
    /// What the search did, where somebody wants to see it.
    search: Recording,
}

impl Planned {
    fn failed(goal: usize, part: PlanPart) -> Self {
        Self {
            goal,
            part,
            reached: None,
            goals: None,
            route: None,
            smoothing_s: None,
            search: Recording::default(),
        }
    }
}

/// The planner; a prepared map where there is a file of it.
fn planner(
    map: &SearchMap,
    stack: &Stack,
    args: &PlanArgs,
) -> Result<Box<dyn GlobalPlanner + Send + Sync>, CliError> {
    let Some(path) = &args.prepared else { return build_planner(&stack.planner, map) };
    let prepared = Prepared::load(path, map)
        .map_err(|error| CliError::new(Kind::Input, error).field("--prepared"))?;
    Ok(Box::new(prepared))
}

fn plan(
    (map, grid): (&SearchMap, &OccupancyGrid),
    stack: &Stack,
    ends: &Ends,
    args: &PlanArgs,
) -> Result<Planned, CliError> {
    let planner = planner(map, stack, args)?;
    let planned = plan_with(map, stack, ends, args, &*planner)?;
    let planned = explained(planned, (map, grid), ends, planner.connectivity());
    let path = planned.part.cells.as_deref().filter(|_| args.excess);
    Ok(match path.and_then(|path| optimum_cells(map, &*planner, path)) {
        Some(optimum) => Planned { part: planned.part.beside_optimum(optimum), ..planned },
        None => planned,
    })
}

/// Says what separates a start and a goal that no path joins.
fn explained(
    planned: Planned,
    (map, grid): (&SearchMap, &OccupancyGrid),
    ends: &Ends,
    connectivity: Connectivity,
) -> Planned {
    let cells = [ends.start, ends.goals[planned.goal]].map(|end| map.frame().cell_near(end));
    let is_separated = planned.part.outcome == PlanOutcome::NoPath;
    let why = is_separated.then(|| why_no_path(map, grid, cells, connectivity)).flatten();
    let Some(NoPath { separation, is_joined_through_unknown }) = why else { return planned };
    let hint = if is_joined_through_unknown {
        format!("; {THROUGH_UNKNOWN}, and there is one")
    } else {
        String::new()
    };
    let part = planned.part.separated_by(&separation, format!("{separation}{hint}"));
    Planned { part, ..planned }
}

fn plan_with(
    map: &SearchMap,
    stack: &Stack,
    ends: &Ends,
    args: &PlanArgs,
    planner: &dyn GlobalPlanner,
) -> Result<Planned, CliError> {
    let if_unreachable =
        if args.nearest_reachable { IfUnreachable::NearestReachable } else { IfUnreachable::Fail };
    let to_goal = |&goal: &Point| {
        let query = RouteQuery::new(ends.start, goal);
        RouteQuery { budget: args.budget, if_unreachable, ..query }
    };
    let queries: Vec<RouteQuery> = ends.goals.iter().map(to_goal).collect();
    // They are a layer of the map.
    map.components(planner.connectivity());
    let mut workspace = Workspace::default();
    let planned = match &queries[..] {
        [query] => plan_to_one(map, stack, planner, ends, query, &mut workspace),
        queries => plan_to_several(map, stack, planner, ends, queries, &mut workspace),
    }?;
    if !outputs::are_wanted(args) {
        return Ok(planned);
    }
    let Ok(query) = queries[planned.goal].on_cells(map) else { return Ok(planned) };
    Ok(Planned { search: record(map, planner, &query, &mut workspace), ..planned })
}

/// Searches again, watched this time: the search is the same, and the time of the first one is that of
/// a search without an observer. The result is already known, even where there is none.
fn record(
    map: &SearchMap,
    planner: &dyn GlobalPlanner,
    query: &Query,
    workspace: &mut Workspace,
) -> Recording {
    let mut search = Recording::default();
    let _ = planner.plan_into(map, query, workspace, Some(&mut search), &mut Plan::default());
    search
}

fn plan_to_one(
    map: &SearchMap,
    stack: &Stack,
    planner: &dyn GlobalPlanner,
    ends: &Ends,
    query: &RouteQuery,
    workspace: &mut Workspace,
) -> Result<Planned, CliError> {
    let mut timer = StageTimer::default();
    let route = plan_route(map, planner, &stack.smoother, query, workspace, &mut timer);
    let time_s = timer.search.map_or(0.0, Times::wall_s);
    match route {
        Ok(route) => Ok(planned(map, stack, (0, query), route, (time_s, &timer))),
        Err(error) => PlanPart::failed(planner.name(), &error, Some(time_s))
            .map(|part| Planned::failed(0, part))
            .ok_or_else(|| no_room(map, &error, ends)),
    }
}

/// A route to a goal, and how long it took to find and to smooth it.
fn planned(
    map: &SearchMap,
    stack: &Stack,
    (goal, query): (usize, &RouteQuery),
    route: Route,
    (time_s, timer): (f64, &StageTimer),
) -> Planned {
    let gap_m = route.end().map_or(0.0, |end| query.goal.distance(end));
    let reached = |cell| ReachedGoal { index: goal, cell, gap_m };
    Planned {
        goal,
        part: PlanPart::found(stack.planner.name(), &route.plan, &route.line, map, time_s),
        reached: route.plan.reached().map(reached),
        goals: None,
        smoothing_s: timer.smoothing.map(Times::wall_s),
        route: Some(route),
        search: Recording::default(),
    }
}

/// Paths to all goals, nearest first; the plan is that to the first of them.
fn plan_to_several(
    map: &SearchMap,
    stack: &Stack,
    planner: &dyn GlobalPlanner,
    ends: &Ends,
    queries: &[RouteQuery],
    workspace: &mut Workspace,
) -> Result<Planned, CliError> {
    let goals: Vec<Cell> = ends.goals.iter().map(|&goal| map.frame().cell_near(goal)).collect();
    let query = Query::new(map.frame().cell_near(ends.start), goals[0]);
    let query = Query { budget: queries[0].budget, ..query };
    let begin = Instant::now();
    let found = NearestFirst::new(planner, map, &query, &goals, workspace);
    let found: Vec<(GoalPlan, f64)> =
        found.map(|goal| (goal, begin.elapsed().as_secs_f64())).collect();
    let (first, time_s) = &found[0];
    let nearest = match &first.result {
        Ok(plan) => {
            let (query, mut timer) = (&queries[first.index], StageTimer::default());
            let route = Route::of_plan(map, &stack.smoother, query, plan.clone(), &mut timer);
            planned(map, stack, (first.index, query), route, (*time_s, &timer))
        }
        Err(error) => {
            let is_start = |end: PathEnd| end == PathEnd::Start;
            let refused = match *error {
                PlanError::Blocked { end, .. } | PlanError::OutsideMap { end, .. } => is_start(end),
                ref error => PlanOutcome::of(error).0 == PlanOutcome::Refused,
            };
            if refused {
                return Err(no_room(map, error, ends));
            }
            // A goal without room is a goal without a path.
            let without = PlanPart::without_path(planner.name(), PlanOutcome::NoPath, *time_s);
            let part = PlanPart::failed(planner.name(), error, Some(*time_s));
            Planned::failed(first.index, part.unwrap_or(without))
        }
    };
    let part = |(goal, time_s): &(GoalPlan, f64)| goal_part(map, ends, goal, *time_s);
    Ok(Planned { goals: Some(found.iter().map(part).collect()), ..nearest })
}

fn goal_part(map: &SearchMap, ends: &Ends, found: &GoalPlan, time_s: f64) -> GoalPart {
    let goal = ends.goals[found.index];
    let plan = found.result.as_ref().ok();
    let (outcome, statistics) = match &found.result {
        Ok(plan) => (PlanOutcome::Found, plan.statistics),
        Err(error) => PlanOutcome::of(error),
    };
    GoalPart {
        index: found.index,
        goal,
        outcome,
        length_m: plan.map(|plan| plan.line(map, ends.start, goal).polyline().length_m()),
        cost_cells: plan.map(|plan| plan.cost.cells()),
        expanded: statistics.expanded(),
        generated: statistics.generated(),
        time_s,
    }
}

/// The positions, not only the cells, of an end in an obstacle or outside the map.
fn no_room(map: &SearchMap, error: &PlanError, ends: &Ends) -> CliError {
    let (end, cell, what) = match *error {
        PlanError::OutsideMap { end, cell, .. } => (end, cell, "is outside the map".to_owned()),
        PlanError::Blocked { end, cell, by, .. } => (end, cell, by.to_string()),
        PlanError::Constrained { end, .. } => {
            return CliError::new(Kind::Position, why(error)).field(end_flag(end));
        }
        _ => return CliError::new(Kind::Input, why(error)),
    };
    let Point { x, y } = match end {
        PathEnd::Start => ends.start,
        PathEnd::Goal => ends.goals[0],
    };
    let nearest = map.nearest_free(cell).map_or_else(
        || "there is no free position on this map".to_owned(),
        |free| {
            let Point { x, y } = map.frame().world_from_cell(free);
            format!("the nearest free position is ({x:.3}, {y:.3}), cell {free}")
        },
    );
    let message =
        format!("{end} ({x:.3}, {y:.3}), cell {cell}, {what}; {nearest}{}", remedy(error));
    CliError::new(Kind::Position, message).field(end_flag(end))
}

fn inputs(
    args: &PlanArgs,
    robot: Option<Robot>,
    stack: &Stack,
    loaded: &LoadedMap,
    ends: &Ends,
) -> Inputs {
    // What plays a part in a plan; the rest of the stack does not.
    let config = serde_json::json!({
        "map": stack.map,
        "planner": stack.planner,
        "smoother": stack.smoother,
    });
    Inputs {
        version: env!("CARGO_PKG_VERSION"),
        map: args.map.path.display().to_string(),
        map_digest: loaded.digest.clone(),
        placement: args.map.place.placement().map(Into::into),
        robot,
        stack: None,
        config,
        start: vec![ends.start.x, ends.start.y],
        goal: ends.goals[0],
        goals: (ends.goals.len() > 1).then(|| ends.goals.clone()),
        nearest_reachable: Some(args.nearest_reachable),
        obstacles: Vec::new(),
        time_limit_s: None,
        budget: args.budget,
    }
}
