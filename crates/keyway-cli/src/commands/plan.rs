//! `keyway plan`: a map and two positions -> a path.

use super::Done;
use crate::args::{Format, PictureFile, PlanArgs};
use crate::config::{FieldOption, resolve};
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, position, refuse_to_replace_a_source};
use crate::pictures::{PlanPicture, png};
use crate::report::{Inputs, PlanOutcome, PlanPart, PlanReport, SmoothedPart};
use crate::table::{facts, quantity};
use keyway::geometry::{Point, Polyline};
use keyway::map::formats::{LoadedMap, write_atomically};
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{PathEnd, Plan, PlanError};
use keyway::robot::Robot;
use keyway::search::{Query, Workspace};
use keyway::smooth::SmootherConfig;
use std::time::Instant;

pub(crate) fn run(args: &PlanArgs) -> Result<Done, CliError> {
    let stack = resolve_stack(args)?;
    let loaded = load_map(&args.map.path, args.map.place.placement())?;
    if let Some(file) = &args.picture {
        refuse_to_replace_a_source(&loaded, &file.path, "--picture")?;
    }
    let map = SearchMap::new(&loaded.grid, stack.map.clone()).map_err(|error| {
        CliError::new(Kind::Config, format!("map.{error}")).field(format!("map.{}", error.field))
    })?;
    let ends = Ends {
        start: position(map.frame(), args.start.0, args.cells, "--start")?,
        goal: position(map.frame(), args.goal.0, args.cells, "--goal")?,
    };
    let planned = plan(&map, &stack, &ends, args.budget)?;
    let inputs = inputs(args, &stack, &loaded, &ends);
    let (line, smoothed) = (planned.line.as_ref(), planned.smoothed.as_ref());
    if let Some(file) = &args.picture {
        let Ends { start, goal } = ends;
        let blocked = map.blocked();
        let picture = PlanPicture { map: &loaded.grid, blocked, start, goal, line, smoothed };
        write_picture(file, &picture)?;
    }
    let report = PlanReport {
        schema: "keyway.plan/1",
        smoothed: smoothed.map(|line| SmoothedPart::of(line, map.clearance())),
        plan: planned.part,
        inputs,
    };
    match args.format {
        Format::Json => crate::json::print(&report),
        Format::Table => super::print(&table(&report)),
    }
    Ok(Done::when(report.plan.outcome == PlanOutcome::Found))
}

/// The parameters for a plan without a robot: a point that is not smoothed, unless told otherwise.
pub(super) fn plan_base() -> Stack {
    let stack = Stack::key_point_fusion(&Robot::small());
    let map = LayerConfig { clearance_m: 0.0, ..stack.map };
    Stack { map, smoother: SmootherConfig::None {}, ..stack }
}

fn resolve_stack(args: &PlanArgs) -> Result<Stack, CliError> {
    let options = [
        FieldOption::new("--planner", "planner.name", args.planner.clone()),
        FieldOption::new("--smoother", "smoother.name", args.smoother.clone()),
        FieldOption::new("--radius", "map.clearance_m", args.radius),
    ];
    resolve(&plan_base(), &Robot::small(), &args.config, options)
}

/// Positions in metres.
struct Ends {
    start: Point,
    goal: Point,
}

struct Planned {
    part: PlanPart,
    line: Option<Polyline>,
    smoothed: Option<Polyline>,
}

fn plan(
    map: &SearchMap,
    stack: &Stack,
    ends: &Ends,
    budget: Option<u64>,
) -> Result<Planned, CliError> {
    let cell = |point| cell_near(map, point);
    let query = Query { budget, ..Query::new(cell(ends.start), cell(ends.goal)) };
    let planner = stack.planner.build();
    let mut plan = Plan::default();
    let mut workspace = Workspace::default();
    let begin = Instant::now();
    let result = planner.plan_into(map, &query, &mut workspace, None, &mut plan);
    let time_s = begin.elapsed().as_secs_f64();
    if let Err(error) = result {
        let part = PlanPart::failed(planner.name(), &error, Some(time_s))
            .ok_or_else(|| no_room(map, &error, ends))?;
        return Ok(Planned { part, line: None, smoothed: None });
    }
    let line = plan.line(map, ends.start, ends.goal);
    let smooths = stack.smoother != SmootherConfig::None {};
    let smooth = || stack.smoother.smooth(&line, &map.clearance(), stack.map.clearance_m);
    let smoothed = smooths.then(smooth);
    let part = PlanPart::found(planner.name(), &plan, &line, map, time_s);
    Ok(Planned { part, line: Some(line), smoothed })
}

/// The cell of a position, also outside the map.
fn cell_near(map: &SearchMap, point: Point) -> Cell {
    let frame = map.frame();
    // On the upper border of the map a position belongs to the last cell.
    frame.cell_from_world(point).unwrap_or_else(|| {
        let grid = frame.grid_from_world(point);
        Cell::new(grid.x.floor() as i32, grid.y.floor() as i32)
    })
}

/// The positions, not only the cells, of an end in an obstacle or outside the map.
fn no_room(map: &SearchMap, error: &PlanError, ends: &Ends) -> CliError {
    let (end, cell, what) = match *error {
        PlanError::OutsideMap { end, cell, .. } => (end, cell, "is outside the map"),
        PlanError::Blocked { end, cell, .. } => (end, cell, "is inside an obstacle"),
        _ => return CliError::new(Kind::Input, error),
    };
    let (flag, Point { x, y }) = match end {
        PathEnd::Start => ("--start", ends.start),
        PathEnd::Goal => ("--goal", ends.goal),
    };
    let clearance_m = map.config().clearance_m;
    let what = if clearance_m > 0.0 && matches!(error, PlanError::Blocked { .. }) {
        format!("leaves no room for a radius of {clearance_m} m")
    } else {
        what.to_owned()
    };
    let nearest = map.nearest_free(cell).map_or_else(
        || "there is no free position on this map".to_owned(),
        |free| {
            let Point { x, y } = map.frame().world_from_cell(free);
            format!("the nearest free position is ({x:.3}, {y:.3}), cell {free}")
        },
    );
    let message = format!("{end} ({x:.3}, {y:.3}), cell {cell}, {what}; {nearest}");
    CliError::new(Kind::Position, message).field(flag)
}

fn inputs(args: &PlanArgs, stack: &Stack, loaded: &LoadedMap, ends: &Ends) -> Inputs {
    // What has a part in a plan; the rest of the stack has none.
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
        robot: None,
        stack: None,
        config,
        start: vec![ends.start.x, ends.start.y],
        goal: ends.goal,
        obstacles: Vec::new(),
        seed: None,
        time_limit_s: None,
        budget: args.budget,
    }
}

fn write_picture(file: &PictureFile, picture: &PlanPicture<'_>) -> Result<(), CliError> {
    let svg = picture.svg();
    let bytes = if file.is_png { png(&svg)? } else { svg.into_string().into_bytes() };
    write_atomically(&file.path, &bytes)
        .map_err(|error| CliError::new(Kind::Output, error).field("--picture"))
}

fn table(report: &PlanReport) -> String {
    let PlanPart { outcome, planner, expanded, generated, .. } = &report.plan;
    let plan = &report.plan;
    let outcome = match outcome {
        PlanOutcome::Found => "found",
        PlanOutcome::NoPath => "no path",
        PlanOutcome::BudgetExhausted => "budget exhausted",
    };
    let mut rows = vec![
        ("outcome", outcome.to_owned()),
        ("planner", (*planner).to_owned()),
        ("length", quantity(plan.length_m, 3, "m")),
        ("cost", quantity(plan.cost_cells, 3, "cells")),
        ("expanded", expanded.to_string()),
        ("generated", generated.to_string()),
        ("time", quantity(plan.time_s.map(|time| time * 1e3), 3, "ms")),
        ("turns", plan.turns.map_or_else(|| "-".to_owned(), |turns| turns.to_string())),
        ("turning angle", quantity(plan.turning_angle_deg, 1, "deg")),
        ("clearance", quantity(plan.min_clearance_m, 3, "m")),
    ];
    if let Some(smoothed) = &report.smoothed {
        rows.push(("smoothed length", quantity(Some(smoothed.length_m), 3, "m")));
        rows.push(("smoothed clearance", quantity(smoothed.min_clearance_m, 3, "m")));
    }
    facts(rows)
}
