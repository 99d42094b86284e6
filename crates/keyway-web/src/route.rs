//! Routes and searches on the map of a page.

use crate::error::{Kind, PageError};
use crate::map::Opened;
use crate::message::{Message, json};
use keyway::files::{
    FieldValue, ParameterLayers, RobotLayersError, RobotSize, StartingValues, parameters_from_bytes,
};
use keyway::geometry::Point;
use keyway::map::{LayerConfig, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan as Planned, PlanError};
use keyway::robot::Robot;
use keyway::route::why_no_room;
use keyway::search::{IfUnreachable, Recording, SearchEvent, Side, Workspace};
use keyway::smooth::{Smoother, SmootherConfig};
use keyway_sim::report::{RouteAnswer, RouteRequest};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// `{"ask": "plan", ..}` for a route, `{"ask": "search", ..}` to look into its search. What is not
/// given is as in `keyway plan`.
///
/// The answer to `plan` is the report `keyway.plan/3`; its parts `line` and `smoothed` are points,
/// two numbers of 64 bits each \[m\]. The answer to `search` is a [`Search`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Plan {
    /// Name of the planner.
    pub planner: Option<String>,
    /// Name of the smoother.
    pub smoother: Option<String>,
    /// Name of a bundled robot.
    pub robot: Option<String>,
    /// Radius of the robot \[m\].
    pub radius_m: Option<f64>,
    /// Parameters, as in a file of parameters (TOML).
    pub settings: String,
    /// Values of the papers, for maps with cells of 1 m.
    pub as_published: bool,
    /// Start \[m\].
    pub start: [f64; 2],
    /// Goal \[m\].
    pub goal: [f64; 2],
    /// Drive to the nearest place that can be reached where the goal cannot.
    pub nearest_reachable: bool,
    /// Limit of expanded nodes.
    pub budget: Option<u64>,
}

/// A search to be looked at. The part `events` has six numbers of 32 bits for each event, in their
/// order: kind ([`EVENT_KINDS`]), side (0 from the start, 1 from the goal), column and row of the
/// node, column and row of the other end. The part `path` has two, the column and the row of each
/// cell of the path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Search {
    /// Names of the kinds of events, by their numbers.
    pub kinds: [&'static str; 6],
    /// Number of events.
    pub events: usize,
    /// Nodes that were expanded and generated, on both sides.
    pub expanded: u64,
    /// Nodes that were generated, on both sides.
    pub generated: u64,
    /// Cost of the path \[cells\]; `null` without a path.
    pub cost_cells: Option<f64>,
    /// Reason why there is no path; `null` where there is one.
    pub why: Option<String>,
}

/// The kinds of events of a search ([`SearchEvent`]).
pub const EVENT_KINDS: [&str; 6] =
    ["expanded", "generated", "reparented", "scanned", "linked", "met"];

/// The layers of the map, kept from plan to plan.
pub(crate) type Layers = Option<(LayerConfig, RobotSize, SearchMap)>;

/// The robot and the stack of a plan.
struct Setup {
    size: RobotSize,
    stack: Stack,
}

fn setup(ask: &Plan) -> Result<Setup, PageError> {
    let config = |error: &dyn std::fmt::Display, field: &str| {
        PageError::new(Kind::Config, error).field(field)
    };
    let robot = ask.robot.as_deref().map(robot).transpose()?;
    let size = RobotSize::new(robot, ask.radius_m).map_err(|error| config(&error, "radius_m"))?;
    let file = parameters_from_bytes(Path::new("settings"), ask.settings.as_bytes())
        .map_err(|error| config(&error, error.field()))?;
    let fields = [
        FieldValue::if_given("planner", "planner.name", ask.planner.clone()),
        FieldValue::if_given("smoother", "smoother.name", ask.smoother.clone()),
    ];
    let layers = ParameterLayers {
        file: Some(file),
        fields: fields.into_iter().flatten().collect(),
        ..ParameterLayers::default()
    };
    let values = StartingValues::published_if(ask.as_published);
    let stack =
        size.plan_stack(values, &layers, &[]).map_err(|error| config(&error.fault, &error.path))?;
    Ok(Setup { size, stack })
}

/// A bundled robot.
pub(crate) fn robot(name: &str) -> Result<Robot, PageError> {
    Robot::by_name(name).ok_or_else(|| {
        let message =
            format!("there is no robot `{name}`, expected one of {}", Robot::NAMES.join(", "));
        PageError::new(Kind::Config, message).field("robot")
    })
}

/// Plans a route.
pub(crate) fn plan(
    ask: &Plan,
    opened: &Opened,
    layers: &mut Layers,
    workspace: &mut Workspace,
) -> Result<Message, PageError> {
    let Setup { size, stack } = setup(ask)?;
    let (map, planner) = ready(ask, opened, layers, &size, &stack)?;
    let smoother = smoother(&stack.smoother)?;
    let goals = [point(ask.goal)];
    let request = RouteRequest {
        grid: &opened.grid,
        map,
        planner: &*planner,
        smoother: smoother.as_deref().map(|smoother| smoother as &dyn Smoother),
        start: point(ask.start),
        goals: &goals,
        budget: ask.budget,
        if_unreachable: if_unreachable(ask),
        with_optimum: false,
    };
    let answer = request.answer(None, workspace).map_err(|error| refused(map, ask, &error))?;
    let inputs = request.inputs(opened.source.clone(), size.robot().cloned(), &stack);
    let mut message = Message::new(json(&answer.report(inputs)));
    if let RouteAnswer { route: Some(route), smoothed, .. } = &answer {
        message = message.with("line", points(route.line.polyline().points()));
        if smoothed.is_some() {
            message = message.with("smoothed", points(route.smoothed.points()));
        }
    }
    Ok(message)
}

/// Searches, and tells all that the search did.
pub(crate) fn search(
    ask: &Plan,
    opened: &Opened,
    layers: &mut Layers,
    workspace: &mut Workspace,
) -> Result<Message, PageError> {
    let Setup { size, stack } = setup(ask)?;
    let (map, planner) = ready(ask, opened, layers, &size, &stack)?;
    let query = keyway::route::RouteQuery {
        budget: ask.budget,
        if_unreachable: if_unreachable(ask),
        ..keyway::route::RouteQuery::new(point(ask.start), point(ask.goal))
    };
    let query = query.on_cells(map).map_err(|error| refused(map, ask, &error))?;
    let (mut recording, mut plan) = (Recording::default(), Planned::default());
    let found = planner.plan_into(map, &query, workspace, Some(&mut recording), &mut plan);
    if let Err(error @ (PlanError::Blocked { .. } | PlanError::OutsideMap { .. })) = &found {
        return Err(refused(map, ask, error));
    }
    let counted = recording.statistics();
    let head = Search {
        kinds: EVENT_KINDS,
        events: recording.events().len(),
        expanded: counted.expanded(),
        generated: counted.generated(),
        cost_cells: found.is_ok().then(|| plan.cost.cells()),
        why: found.err().map(|error| error.to_string()),
    };
    let events = recording.events().iter().flat_map(|event| event_numbers(*event));
    let path = plan.cells.iter().flat_map(|cell| [cell.x, cell.y]);
    Ok(Message::new(json(&head)).with("events", numbers(events)).with("path", numbers(path)))
}

const fn if_unreachable(ask: &Plan) -> IfUnreachable {
    if ask.nearest_reachable { IfUnreachable::NearestReachable } else { IfUnreachable::Fail }
}

/// The layers for a plan, those of the last one where they are the same, and the planner.
fn ready<'l>(
    ask: &Plan,
    opened: &Opened,
    layers: &'l mut Layers,
    size: &RobotSize,
    stack: &Stack,
) -> Result<(&'l SearchMap, Box<dyn GlobalPlanner + Send + Sync>), PageError> {
    let known = layers.take().filter(|(config, of, _)| (config, of) == (&stack.map, size));
    let map = match known {
        Some((.., map)) => map,
        None => size.layers(&opened.grid, stack.map.clone()).map_err(|error| no_layers(&error))?,
    };
    let (.., map) = layers.insert((stack.map.clone(), size.clone(), map));
    let ends = [ask.start, ask.goal].map(|end| map.frame().cell_near(point(end)));
    map.free_ends(&ends);
    let planner = stack
        .planner
        .build(map)
        .map_err(|error| PageError::new(Kind::Config, error).field("planner"))?;
    Ok((map, planner))
}

fn no_layers(error: &RobotLayersError) -> PageError {
    let field = match error {
        RobotLayersError::Config(error) => error.path.as_str(),
        RobotLayersError::Clearance(_) => "map.clearance_m",
        _ => "radius_m",
    };
    PageError::new(Kind::Config, error).field(field)
}

fn smoother(config: &SmootherConfig) -> Result<Option<Box<dyn Smoother + Send + Sync>>, PageError> {
    if matches!(config, SmootherConfig::None(_)) {
        return Ok(None);
    }
    let blame = |error: keyway::ConfigError| {
        let path = format!("smoother.{}", error.path);
        PageError::new(Kind::Config, error).field(path)
    };
    config.build().map(Some).map_err(blame)
}

/// The positions, not only the cells, of an end without room.
fn refused(map: &SearchMap, ask: &Plan, error: &PlanError) -> PageError {
    let ends = [ask.start, ask.goal].map(point);
    let (PlanError::OutsideMap { end, .. }
    | PlanError::Blocked { end, .. }
    | PlanError::Constrained { end, .. }) = error
    else {
        return PageError::new(Kind::Config, error).field("planner");
    };
    let message = why_no_room(map, ends, error).unwrap_or_else(|| error.to_string());
    PageError::new(Kind::Position, message).field(end.to_string())
}

const fn point([x, y]: [f64; 2]) -> Point {
    Point::new(x, y)
}

fn points(points: &[Point]) -> Vec<u8> {
    points.iter().flat_map(|point| [point.x, point.y]).flat_map(f64::to_le_bytes).collect()
}

fn numbers(numbers: impl Iterator<Item = i32>) -> Vec<u8> {
    numbers.flat_map(i32::to_le_bytes).collect()
}

/// Kind, side, node, other end.
fn event_numbers(event: SearchEvent) -> [i32; 6] {
    let (kind, side, at, other) = match event {
        SearchEvent::Expanded { side, at } => (0, side, at, at),
        SearchEvent::Generated { side, at, parent } => (1, side, at, parent),
        SearchEvent::Reparented { side, at, parent } => (2, side, at, parent),
        SearchEvent::Scanned { side, from, to } => (3, side, from, to),
        SearchEvent::Linked { side, at, parent } => (4, side, at, parent),
        SearchEvent::Met { at } => (5, Side::Forward, at, at),
    };
    [kind, i32::from(side == Side::Backward), at.x, at.y, other.x, other.y]
}
