//! The controller in the simulated world.

use super::Job;
use crate::commands::{THROUGH_UNKNOWN, end_flag, remedy};
use crate::error::{CliError, Kind};
use crate::report::{NavigateReport, PlanPart, RunPart, SmoothedPart, sample_row};
use keyway::geometry::{Point, Pose};
use keyway::map::{BitGrid, BlockedBy, Hindrance, LayerConfig, SearchMap, UnknownPolicy};
use keyway::navigate::{Blocked, Controller, NavigateError, StackError, Step};
use keyway::plan::{Plan, PlanError};
use keyway::route::Route;
use keyway::search::{Query, SearchStatistics, Workspace};
use keyway::sim::{Action, Control, Obstacle, Outcome, Run, RunRules, World, simulate};
use std::time::{Duration, Instant};

/// What came of a job.
pub(crate) struct Driven {
    pub(crate) report: NavigateReport,
    /// `None` when there was no route to drive.
    pub(crate) drive: Option<Drive>,
}

/// A run and what the robot knew.
pub(crate) struct Drive {
    pub(crate) run: Run,
    /// The route at the start.
    pub(crate) route: Route,
    pub(crate) key_points: Vec<Point>,
    pub(crate) sensed: BitGrid,
}

/// A run, and what the controller did in it.
struct Record {
    run: Run,
    steps: u64,
    steps_time: Duration,
    /// What was in the way last, if anything.
    blocked: Option<Blocked>,
}

pub(crate) fn drive(job: &Job) -> Result<Driven, CliError> {
    let world = world(job)?;
    let (known, start) = (&job.loaded.grid, job.start.position);
    let mut controller = match Controller::new(known, &job.robot, &job.stack, start, job.goal) {
        Ok(controller) => controller,
        Err(error) => return no_drive(job, &error),
    };
    let route = controller.route().clone();
    let key_points = controller.guide_points();
    let rules = rules(job, &route);
    let record = simulated(job, &world, &rules, &mut controller)?;
    let map = layer_of(job, &route)?;
    let steps_s = record.steps_time.as_secs_f64();
    let part = RunPart::of(&record.run, controller.routes_planned(), record.steps, steps_s);
    let report = NavigateReport {
        schema: "keyway.navigate/2",
        outcome: outcome_name(record.run.outcome),
        reason: reason(&record, &rules),
        plan: plan_part(job, &route, &map),
        smoothed: Some(SmoothedPart::of(
            &route.smoothing,
            &route.smoothed,
            &map,
            &job.stack.smoother,
        )),
        key_points_m: Some(key_points.clone()),
        run: Some(part),
        trajectory: Some(record.run.samples.iter().map(sample_row).collect()),
        inputs: job.inputs(Some(rules.time_limit_s)),
        files: Vec::new(),
    };
    let sensed = controller.sensed().clone();
    Ok(Driven { report, drive: Some(Drive { run: record.run, route, key_points, sensed }) })
}

/// The real obstacles: the known ones under the policy for unknown cells, and the circles.
fn world(job: &Job) -> Result<World, CliError> {
    let grid = &job.loaded.grid;
    let mut squares = grid.occupied().clone();
    if job.stack.map.unknown == UnknownPolicy::Blocked {
        squares.merge(grid.unknown());
    }
    World::new(*grid.frame(), squares, job.obstacles.clone())
        .map_err(|error| CliError::new(Kind::Input, error).field("--obstacle"))
}

fn rules(job: &Job, route: &Route) -> RunRules {
    let usual_s = 60.0 + 4.0 * route.smoothed.length_m() / job.robot.limits.v_max_mps;
    RunRules {
        goal_tolerance_m: job.stack.controller.goal_tolerance_m,
        time_limit_s: job.time_limit_s.unwrap_or(usual_s),
        stuck_window_s: 20.0,
        stuck_progress_m: 0.1,
    }
}

fn simulated(
    job: &Job,
    world: &World,
    rules: &RunRules,
    controller: &mut Controller,
) -> Result<Record, CliError> {
    let start = start_pose(job, controller.route());
    let (mut steps, mut steps_time, mut blocked) = (0, Duration::ZERO, None);
    let run = simulate(world, &job.robot, start, job.goal, rules, |pose, velocity, scan| {
        let begin = Instant::now();
        let step = controller.step(pose, velocity, scan);
        steps_time += begin.elapsed();
        steps += 1;
        let remaining_m = controller.guidance().remaining_m;
        let action = match step {
            Step::Drive(command) => Action::Drive(command),
            Step::Arrived => Action::Arrived,
            Step::Blocked { command, why } => {
                blocked = Some(why);
                Action::Drive(command)
            }
        };
        Control { action, remaining_m, route: controller.routes_planned() }
    })
    .map_err(|error| CliError::new(Kind::Input, error))?;
    Ok(Record { run, steps, steps_time, blocked })
}

/// Without a yaw the robot faces along its path.
fn start_pose(job: &Job, route: &Route) -> Pose {
    let Point { x, y } = job.start.position;
    let along_path = || route.smoothed.segments().next().map_or(0.0, |s| (s.b - s.a).heading());
    Pose::new(x, y, job.start.yaw_deg.map_or_else(along_path, f64::to_radians))
}

/// The map on which a route was planned.
fn layer_of(job: &Job, route: &Route) -> Result<SearchMap, CliError> {
    let config = LayerConfig { clearance_m: route.clearance_m, ..job.stack.map.clone() };
    SearchMap::new(&job.loaded.grid, config).map_err(|error| CliError::new(Kind::Config, error))
}

/// The first route; its query is repeated for the time alone, on layers that are ready.
fn plan_part(job: &Job, route: &Route, map: &SearchMap) -> PlanPart {
    let planner = &job.stack.planner;
    let time_s = match (planner.build(map), route.plan.cells.first(), route.plan.cells.last()) {
        (Ok(planner), Some(&from), Some(&to)) => {
            let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
            let begin = Instant::now();
            // The route shows that there is a path.
            let _ = planner.plan_into(map, &Query::new(from, to), &mut workspace, None, &mut plan);
            begin.elapsed().as_secs_f64()
        }
        _ => 0.0,
    };
    PlanPart::found(planner.name(), &route.plan, &route.line, map, time_s)
}

/// A start without a route is a result; everything else is bad input.
fn no_drive(job: &Job, error: &NavigateError) -> Result<Driven, CliError> {
    let planner = job.stack.planner.name();
    let plan = match error {
        NavigateError::Plan(error) => PlanPart::failed(planner, error, None),
        NavigateError::NoWay { why } => {
            let statistics = SearchStatistics::default();
            PlanPart::failed(planner, &PlanError::NoPath { statistics }, None)
                .map(|part| part.separated_by(why, error.to_string()))
        }
        _ => None,
    };
    let Some(plan) = plan else {
        return Err(bad_input(error));
    };
    let report = NavigateReport {
        schema: "keyway.navigate/2",
        outcome: "no_path",
        reason: plan.why.clone(),
        plan,
        smoothed: None,
        key_points_m: None,
        run: None,
        trajectory: None,
        inputs: job.inputs(job.time_limit_s),
        files: Vec::new(),
    };
    Ok(Driven { report, drive: None })
}

fn bad_input(error: &NavigateError) -> CliError {
    let named = |field: &str| Some(field.to_owned());
    let (kind, field) = match error {
        NavigateError::Layers(error) => (Kind::Config, Some(format!("map.{}", error.field))),
        NavigateError::Robot(error) => (Kind::Config, named(error.field)),
        NavigateError::Stack(StackError::Value { field, .. }) => (Kind::Config, named(field)),
        NavigateError::Stack(StackError::StaticMap { .. }) => (Kind::Config, named("planner.name")),
        NavigateError::NoRoom { end, .. }
        | NavigateError::Plan(
            PlanError::Blocked { end, .. }
            | PlanError::OutsideMap { end, .. }
            | PlanError::Constrained { end, .. },
        ) => (Kind::Position, named(end_flag(*end))),
        _ => (Kind::Config, None),
    };
    CliError { kind, message: error.to_string() + &help(error), field }
}

/// What helps; discs without clearance around the ends, which would, are not for robots.
fn help(error: &NavigateError) -> String {
    match error {
        NavigateError::NoRoom { why: Hindrance::Unknown { .. }, .. } => {
            format!("; {THROUGH_UNKNOWN}")
        }
        NavigateError::Plan(PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        }) => String::new(),
        NavigateError::Plan(error) => remedy(error),
        _ => String::new(),
    }
}

fn outcome_name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Reached => "reached",
        Outcome::Collided { .. } => "collided",
        Outcome::Timeout => "timeout",
        // An outcome that this program does not know is not an arrival.
        _ => "stuck",
    }
}

/// Why the goal was not reached.
fn reason(record: &Record, rules: &RunRules) -> Option<String> {
    let RunRules { time_limit_s, stuck_window_s, stuck_progress_m, .. } = rules;
    let what = match record.run.outcome {
        Outcome::Reached => return None,
        Outcome::Collided { pose, with } => {
            let with = match with {
                Obstacle::Circle(index) => format!("unknown obstacle {index}"),
                Obstacle::Border => "the border of the map".to_owned(),
                _ => "an obstacle of the map".to_owned(),
            };
            format!("touched {with} at ({:.3}, {:.3})", pose.x, pose.y)
        }
        Outcome::Timeout => format!("the time limit of {time_limit_s:.1} s passed"),
        _ => format!(
            "the remaining way did not become {stuck_progress_m} m shorter within {stuck_window_s} s"
        ),
    };
    let last = record.blocked.as_ref().map(|why| format!("; the last problem: {why}"));
    Some(what + &last.unwrap_or_default())
}
