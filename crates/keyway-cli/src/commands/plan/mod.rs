//! `keyway plan`: plans a path between two positions on a map.

mod curve;
mod result_files;

use super::{Done, THROUGH_UNKNOWN, build_planner, build_smoother, end_flag, remedy, why};
use crate::args::{Format, PlanArgs, PositionArg};
use crate::config::given_parameters;
use crate::error::{CliError, Kind};
use crate::inputs::{layers, load_map, position, robot_size, source_of};
use crate::pictures::{PlanGoals, PlanPicture};
use crate::report_text::WithFiles;
use crate::stdout::print_files;
use curve::Curve;
use keyway::files::{FieldValue, RobotSize, StartingValues};
use keyway::geometry::{Path, Point};
use keyway::map::{Cell, SearchMap, Separation};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan, PlanError, PlannerConfig, Prepared};
use keyway::route::{NoPath, Route, why_no_room};
use keyway::search::{IfUnreachable, Recording, Workspace};
use keyway::smooth::{Smoother, SmootherConfig};
use keyway_lab::measure::wall_clock;
use keyway_lab::run_tables::{SmoothingTargets, route_table};
use keyway_sim::report::{PlanOutcome, PlanPart, RouteAnswer, RouteFailure, RouteRequest};
use toml::Table;

pub(crate) fn run(args: &PlanArgs) -> Result<Done, CliError> {
    let size = robot_size(&args.size)?;
    let stack = resolve_stack(args, &size)?;
    let loaded = load_map(&args.map.path, &args.map.place.reader())?;
    result_files::check(args, &loaded)?;
    let curve = Curve::from_args(args, size.robot());
    let mut map = layers(&loaded.grid, stack.map.clone(), &size)?;
    let ends = ends(args, &map)?;
    let all_ends = std::iter::once(ends.start).chain(ends.goals.iter().copied());
    let all_cells: Vec<Cell> = all_ends.map(|end| map.frame().cell_near(end)).collect();
    map.free_ends(&all_cells);
    let planner = planner(&map, &stack, args)?;
    let if_unreachable =
        if args.nearest_reachable { IfUnreachable::NearestReachable } else { IfUnreachable::Fail };
    let smoother = match &stack.smoother {
        SmootherConfig::None(_) => None,
        config => Some(build_smoother(config)?),
    };
    let request = RouteRequest {
        grid: &loaded.grid,
        map: &map,
        planner: &*planner,
        smoother: smoother.as_deref().map(|smoother| smoother as &dyn Smoother),
        start: ends.start,
        goals: &ends.goals,
        budget: args.budget,
        if_unreachable,
        with_optimum: args.excess,
    };
    let mut workspace = Workspace::default();
    let answer = request
        .answer(Some(&wall_clock()), &mut workspace)
        .map_err(|error| no_room(&map, &error, &ends))?;
    let search = if result_files::show_search(args) {
        record(&request, answer.goal, &mut workspace)
    } else {
        Recording::default()
    };
    let source = source_of(&loaded, args.map.place.placement());
    let report = with_remedy(answer.clone(), &stack.planner).report(request.inputs(
        source,
        size.robot().cloned(),
        &stack,
    ));
    let route = answer.route.as_ref();
    let line = route.map(|route| route.line.polyline());
    let goals = PlanGoals::new(&ends.goals, answer.goal, route.is_some(), map.frame());
    let picture = PlanPicture {
        map: &loaded.grid,
        blocked: map.blocked(),
        start: ends.start,
        goals: &goals,
        search: &search,
        line,
        smoothed: route.filter(|_| smoother.is_some()).map(|route| &route.smoothed),
    };
    let path = route.map(|route| driven_path(route, smoother.is_some()));
    let table_of = |(curve, path): (&Curve, &Path)| curve.bytes(path, &report.inputs);
    let table_of_curve = curve.as_ref().zip(path.as_ref()).map(table_of).transpose()?;
    let files = result_files::write(args, &picture, table_of_curve.as_deref())?;
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &report, files: &files })?,
        Format::Table => {
            let (clearance_m, cell_m) = (map.config().clearance_m, map.frame().resolution_m());
            let targets = SmoothingTargets::new(&stack.smoother, clearance_m, cell_m);
            super::print(&route_table(&report, targets))?;
            print_files(&files)?;
        }
    }
    Ok(Done::when(report.plan.outcome == PlanOutcome::Found))
}

/// The path of a route: smoothed, or the line as planned.
fn driven_path(route: &Route, is_smoothed: bool) -> Path {
    if is_smoothed {
        route.smoothing.path.clone()
    } else {
        // Merges straight segments: a joint at every cell is not a corner of the path.
        Path::from(&route.line.polyline().merged())
    }
}

fn resolve_stack(args: &PlanArgs, size: &RobotSize) -> Result<Stack, CliError> {
    let options = [
        FieldValue::if_given("planner", "planner.name", args.planner.clone()),
        FieldValue::if_given(
            "prepared",
            "planner.name",
            args.prepared.as_ref().map(|_| Prepared::NAME),
        ),
        FieldValue::if_given("smoother", "smoother.name", args.smoother.clone()),
    ];
    let values = StartingValues::published_if(args.as_published);
    Ok(size.plan_stack(values, &given_parameters(&args.config, options)?, &[])?)
}

/// Start and goals in metres; at least one goal.
struct Ends {
    start: Point,
    goals: Vec<Point>,
}

fn ends(args: &PlanArgs, map: &SearchMap) -> Result<Ends, CliError> {
    if args.nearest_reachable && args.goal.len() > 1 {
        let message = "--nearest-reachable supports only a single --goal";
        return Err(CliError::new(Kind::Usage, message).field("--nearest-reachable"));
    }
    let to_goal = |goal: &PositionArg| position(map.frame(), goal.0, args.cells, "--goal");
    Ok(Ends {
        start: position(map.frame(), args.start.0, args.cells, "--start")?,
        goals: args.goal.iter().map(to_goal).collect::<Result<_, _>>()?,
    })
}

/// Builds the planner, from a prepared map if a file of it is given.
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

/// Advice on the option that allows cutting corners.
fn corner_setting(planner: &PlannerConfig) -> String {
    let has_rule = Table::try_from(planner).is_ok_and(|fields| fields.contains_key("corners"));
    if has_rule {
        format!("add --set {}.corners=allow", planner.name())
    } else {
        "use --planner astar --set astar.corners=allow".to_owned()
    }
}

/// Adds a remedy, in options of the command line, if there is no route.
fn with_remedy(answer: RouteAnswer, planner: &PlannerConfig) -> RouteAnswer {
    let why = match &answer.failure {
        Some(RouteFailure::Plan(error)) => why(error),
        Some(RouteFailure::Separated(NoPath {
            separation,
            is_joined_through_unknown: true,
            ..
        })) => {
            format!("{separation}; {THROUGH_UNKNOWN}, and such a path exists")
        }
        Some(RouteFailure::Separated(NoPath {
            separation: separation @ Separation::Apart { meet_at_corners: true, .. },
            ..
        })) => format!("{separation}; to cut corners, {}", corner_setting(planner)),
        _ => return answer,
    };
    let plan = PlanPart { why: Some(why), ..answer.plan };
    RouteAnswer { plan, ..answer }
}

/// Repeats the search with an observer, so that the measured time of the first one is free of its
/// overhead. The search and its result are the same.
fn record(request: &RouteRequest<'_>, goal: usize, workspace: &mut Workspace) -> Recording {
    let (mut search, mut plan) = (Recording::default(), Plan::default());
    let RouteRequest { map, planner, goals, .. } = *request;
    if let Ok(query) = request.query(goals[goal]).on_cells(map) {
        let _ = planner.plan_into(map, &query, workspace, Some(&mut search), &mut plan);
    }
    search
}

/// Error of a start or goal in an obstacle or outside the map, with its position and not only its
/// cell.
fn no_room(map: &SearchMap, error: &PlanError, ends: &Ends) -> CliError {
    let (PlanError::OutsideMap { end, .. }
    | PlanError::Blocked { end, .. }
    | PlanError::Constrained { end, .. }) = *error
    else {
        return CliError::new(Kind::Input, why(error));
    };
    let message = why_no_room(map, [ends.start, ends.goals[0]], error)
        .map_or_else(|| why(error), |text| text + &remedy(error));
    CliError::new(Kind::Position, message).field(end_flag(end))
}
