//! Everything that has a name.

use super::file::file;
use super::parameters::{Parameter, parameters, plain, summary_of};
use super::published::{Published, of_local, of_part, of_stack};
use keyway::guide::GuideConfig;
use keyway::local::LocalConfig;
use keyway::navigate::{ControllerConfig, Stack};
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use schemars::schema_for;
use serde::Serialize;
use serde_json::{Value, json};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum EntryKind {
    Planner,
    Smoother,
    Guide,
    LocalPlanner,
    Stack,
    Robot,
}

impl EntryKind {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Planner => "planner",
            Self::Smoother => "smoother",
            Self::Guide => "guide",
            Self::LocalPlanner => "local planner",
            Self::Stack => "stack",
            Self::Robot => "robot",
        }
    }

    /// Whether defaults are derived for a robot.
    pub(super) const fn depends_on_robot(self) -> bool {
        matches!(self, Self::Guide | Self::LocalPlanner | Self::Stack)
    }
}

/// Something with a name.
#[derive(Debug, Serialize)]
pub(super) struct Entry {
    pub(super) kind: EntryKind,
    pub(super) name: &'static str,
    pub(super) summary: String,
    /// `None` where they were not asked for.
    pub(super) parameters: Option<Vec<Parameter>>,
    /// How the papers use it; `None` where it was not asked for.
    pub(super) published: Option<Vec<Published>>,
    /// A stack or a robot as a file; `None` for everything else.
    #[serde(skip)]
    pub(super) file: Option<String>,
}

/// All entries with their parameters: defaults are for `robot`. Stacks may have the values of their papers instead.
pub(super) fn catalogue(robot: &Robot, as_published: bool) -> Vec<Entry> {
    let planners = PlannerConfig::NAMES.iter().map(|&name| {
        let schema = schema_for!(PlannerConfig).to_value();
        let config = PlannerConfig::by_name(name);
        let readings = config.as_ref().map_or(&[][..], PlannerConfig::readings);
        let paper = published(config.as_ref().and_then(PlannerConfig::as_published), readings);
        alternative(EntryKind::Planner, name, "planner", &schema, &value(config), &paper)
    });
    let smoothers = SmootherConfig::NAMES.iter().map(|&name| {
        let schema = schema_for!(SmootherConfig).to_value();
        let config = SmootherConfig::by_name(name);
        let readings = config.as_ref().map_or(&[][..], SmootherConfig::readings);
        let paper = published(config.as_ref().and_then(SmootherConfig::as_published), readings);
        alternative(EntryKind::Smoother, name, "smoother", &schema, &value(config), &paper)
    });
    let guides = GuideConfig::NAMES.iter().map(|&name| {
        let schema = schema_for!(GuideConfig).to_value();
        let config = GuideConfig::by_name(name, robot);
        let paper = config.as_ref().map_or(Value::Null, paper_guide);
        alternative(EntryKind::Guide, name, "guide", &schema, &value(config), &paper)
    });
    let locals = LocalConfig::NAMES.iter().map(|&name| {
        let schema = schema_for!(LocalConfig).to_value();
        let config = LocalConfig::by_name(name, robot);
        let paper = config.as_ref().map_or(Value::Null, paper_local);
        alternative(EntryKind::LocalPlanner, name, "local", &schema, &value(config), &paper)
    });
    let stacks = Stack::NAMES.iter().filter_map(|&name| {
        let published = Stack::published_by_name(name).filter(|_| as_published);
        Some(stack_entry(name, &published.or_else(|| Stack::by_name(name, robot))?))
    });
    let robots =
        Robot::NAMES.iter().filter_map(|&name| Some(robot_entry(name, &Robot::by_name(name)?)));
    planners.chain(smoothers).chain(guides).chain(locals).chain(stacks).chain(robots).collect()
}

fn value(config: impl Serialize) -> Value {
    serde_json::to_value(config).unwrap_or_default()
}

/// What a paper says: its values without those that it leaves to the reader.
fn published(config: impl Serialize, readings: &[&str]) -> Value {
    let mut paper = value(config);
    for reading in readings {
        let (parents, field) = reading.rsplit_once('.').unwrap_or(("", reading));
        let mut inner = parents.split('.').filter(|parent| !parent.is_empty());
        let object = inner.try_fold(&mut paper, |value, parent| value.get_mut(parent));
        if let Some(values) = object.and_then(Value::as_object_mut) {
            values.remove(field);
        }
    }
    paper
}

/// The values of a local planner's paper, where there is one.
fn paper_local(local: &LocalConfig) -> Value {
    published(local.as_published(), local.readings())
}

/// The same for a guide.
fn paper_guide(guide: &GuideConfig) -> Value {
    published(guide.as_published(), guide.readings())
}

/// One of several alternatives; its parameters are listed by their path in a stack.
fn alternative(
    kind: EntryKind,
    name: &'static str,
    path: &str,
    schema: &Value,
    config: &Value,
    paper: &Value,
) -> Entry {
    let summary = summary_of(schema, name);
    let published = match kind {
        EntryKind::Planner | EntryKind::Smoother => of_part(name),
        EntryKind::LocalPlanner => of_local(name),
        EntryKind::Guide | EntryKind::Stack | EntryKind::Robot => Vec::new(),
    };
    let parameters = Some(parameters(path, schema, config, paper));
    Entry { kind, name, summary, parameters, published: Some(published), file: None }
}

fn stack_entry(name: &'static str, stack: &Stack) -> Entry {
    let schema = schema_for!(Stack).to_value();
    let (about, source) = Stack::about(name).unwrap_or_default();
    let summary = source.map_or_else(|| about.to_owned(), |source| format!("{about} [{source}]"));
    let paper = Stack::published_by_name(name).map_or(Value::Null, |stack| paper_stack(&stack));
    let parameters = parameters("", &schema, &value(stack), &paper);
    let file = Some(file(stack, &format!("{name}: {summary}"), &parameters));
    let (parameters, published) = (Some(parameters), Some(of_stack(name)));
    Entry { kind: EntryKind::Stack, name, summary, parameters, published, file }
}

/// The values of a published stack in those of its parts that have a paper.
fn paper_stack(stack: &Stack) -> Value {
    let Stack { planner, smoother, guide, local, .. } = stack;
    json!({
        "planner": published(planner.as_published().map(|_| planner), planner.readings()),
        "smoother": published(smoother.as_published().map(|_| smoother), smoother.readings()),
        "guide": published(guide.as_published().map(|_| guide), guide.readings()),
        "local": published(local.as_published().map(|_| local), local.readings()),
        "controller": published(ControllerConfig::PAPER, ControllerConfig::READINGS),
    })
}

fn robot_entry(name: &'static str, robot: &Robot) -> Entry {
    let schema = schema_for!(Robot).to_value();
    let summary = plain(&format!(
        "{}, up to {} m/s, sensor range {} m",
        robot.footprint, robot.limits.v_max_mps, robot.sensor.range_m
    ));
    let parameters = parameters("", &schema, &value(robot), &Value::Null);
    let file = Some(file(robot, &format!("{name}: {summary}"), &parameters));
    let (parameters, published) = (Some(parameters), Some(Vec::new()));
    Entry { kind: EntryKind::Robot, name, summary, parameters, published, file }
}
