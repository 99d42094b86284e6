//! Routes on the map of a page.

use crate::error::{Kind, PageError};
use crate::map::Opened;
use crate::message::{Message, json};
use keyway::files::{
    FieldValue, ParameterLayers, RobotLayersError, RobotSize, StartingValues, parameters_from_bytes,
};
use keyway::geometry::Point;
use keyway::map::{LayerConfig, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, PlanError, shortest_line};
use keyway::robot::Robot;
use keyway::route::why_no_room;
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::{Smoother, SmootherConfig};
use keyway_lab::corner_rule;
use keyway_sim::report::{RouteAnswer, RouteRequest};
use serde::Deserialize;
use std::path::Path;

/// `{"ask": "plan", ..}` for a route, `{"ask": "search", ..}` to inspect its search. Defaults are
/// those of `keyway plan`.
///
/// The answer to `plan` is the report `keyway.plan/3`; its parts `line`, `smoothed` and
/// `shortest` are points, two 64-bit numbers each \[m\]. The answer to `search` is a
/// [`Search`](crate::search::Search).
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
    /// Parameters of the papers, for maps with cells of 1 m.
    pub as_published: bool,
    /// Start \[m\].
    pub start: [f64; 2],
    /// Goal \[m\].
    pub goal: [f64; 2],
    /// If the goal cannot be reached, plan to the nearest reachable position.
    pub nearest_reachable: bool,
    /// Limit of expanded nodes.
    pub budget: Option<u64>,
    /// Add the shortest any-angle line, if a path is found.
    pub with_shortest: bool,
}

/// The layers of the map, cached between plans.
pub(crate) type Layers = Option<(LayerConfig, RobotSize, SearchMap)>;

/// The robot and the stack of a plan, the layers of the map for them, and the planner.
pub(crate) struct Ready<'l> {
    size: RobotSize,
    stack: Stack,
    pub(crate) map: &'l SearchMap,
    pub(crate) planner: Box<dyn GlobalPlanner + Send + Sync>,
}

fn setup(ask: &Plan) -> Result<(RobotSize, Stack), PageError> {
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
    Ok((size, stack))
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
    let Ready { size, stack, map, planner } = ready(ask, opened, layers)?;
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
        message = with_shortest(message, ask, map, &*planner);
    }
    Ok(message)
}

/// Adds the shortest any-angle line, if it is requested.
pub(crate) fn with_shortest(
    message: Message,
    ask: &Plan,
    map: &SearchMap,
    planner: &dyn GlobalPlanner,
) -> Message {
    let wanted = ask
        .with_shortest
        .then(|| shortest_line(map, corner_rule(planner), point(ask.start), point(ask.goal)));
    match wanted.flatten() {
        Some(line) => message.with("shortest", points(line.points())),
        None => message,
    }
}

pub(crate) const fn if_unreachable(ask: &Plan) -> IfUnreachable {
    if ask.nearest_reachable { IfUnreachable::NearestReachable } else { IfUnreachable::Fail }
}

/// Prepares a plan. The layers of the last plan are reused if they are the same.
pub(crate) fn ready<'l>(
    ask: &Plan,
    opened: &Opened,
    layers: &'l mut Layers,
) -> Result<Ready<'l>, PageError> {
    let (size, stack) = setup(ask)?;
    let known = layers.take().filter(|(config, of, _)| (config, of) == (&stack.map, &size));
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
    Ok(Ready { size, stack, map, planner })
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

/// Error of a start or goal without enough clearance, with its position and not only its cell.
pub(crate) fn refused(map: &SearchMap, ask: &Plan, error: &PlanError) -> PageError {
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

pub(crate) const fn point([x, y]: [f64; 2]) -> Point {
    Point::new(x, y)
}

pub(crate) fn points(points: &[Point]) -> Vec<u8> {
    points.iter().flat_map(|point| [point.x, point.y]).flat_map(f64::to_le_bytes).collect()
}
