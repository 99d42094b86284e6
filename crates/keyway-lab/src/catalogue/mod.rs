//! Everything that has a name: planners, smoothers, guides, local planners, stacks and robots, with
//! their parameters and their uses in the papers.

mod file;
mod parameters;
mod published;

pub(crate) use parameters::plain;
pub use parameters::{Parameter, value_text};
pub use published::{PublishedSetup, PublishedUse};

use file::file;
use keyway::guide::GuideConfig;
use keyway::local::LocalConfig;
use keyway::navigate::{ControllerConfig, Stack};
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use parameters::{parameters, summary_of};
use published::{of_local, of_part, of_stack};
use schemars::schema_for;
use serde::Serialize;
use serde_json::{Value, json};

/// Kind of a named part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EntryKind {
    /// A global planner.
    Planner,
    /// A smoother of paths.
    Smoother,
    /// A guide of a local planner.
    Guide,
    /// A local planner.
    LocalPlanner,
    /// A stack of all of these.
    Stack,
    /// A robot.
    Robot,
}

impl EntryKind {
    /// Display name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Planner => "planner",
            Self::Smoother => "smoother",
            Self::Guide => "guide",
            Self::LocalPlanner => "local planner",
            Self::Stack => "stack",
            Self::Robot => "robot",
        }
    }

    /// True if its defaults depend on the robot.
    pub const fn depends_on_robot(self) -> bool {
        matches!(self, Self::Guide | Self::LocalPlanner | Self::Stack)
    }
}

/// A named part.
#[derive(Clone, Debug, PartialEq)]
pub struct CatalogueEntry {
    /// Its kind.
    pub kind: EntryKind,
    /// Its name.
    pub name: String,
    /// Description in one sentence.
    pub summary: String,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Its uses in the papers.
    pub published: Vec<PublishedUse>,
    /// Text of a stack or a robot as a file; `None` for everything else.
    pub file: Option<String>,
}

/// Source of the values of stacks in a catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StackValues {
    /// Defaults, derived for the robot.
    ForRobot,
    /// Values of the paper, if the stack is published; otherwise the defaults.
    AsPublished,
}

/// Returns all entries, with defaults for a robot.
pub fn catalogue(robot: &Robot, values: StackValues) -> Vec<CatalogueEntry> {
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
        let published = match values {
            StackValues::ForRobot => None,
            StackValues::AsPublished => Stack::published_by_name(name),
        };
        Some(stack_entry(name, &published.or_else(|| Stack::by_name(name, robot))?))
    });
    let robots =
        Robot::NAMES.iter().filter_map(|&name| Some(robot_entry(name, &Robot::by_name(name)?)));
    planners.chain(smoothers).chain(guides).chain(locals).chain(stacks).chain(robots).collect()
}

fn value(config: impl Serialize) -> Value {
    serde_json::to_value(config).unwrap_or_default()
}

/// Returns the values of a paper, without those that it leaves open.
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

/// Returns the values of a local planner's paper; null if it has none.
fn paper_local(local: &LocalConfig) -> Value {
    published(local.as_published(), local.readings())
}

/// Returns the values of a guide's paper; null if it has none.
fn paper_guide(guide: &GuideConfig) -> Value {
    published(guide.as_published(), guide.readings())
}

/// Returns the entry of one of several alternatives; its parameters have their paths in a stack.
fn alternative(
    kind: EntryKind,
    name: &'static str,
    path: &str,
    schema: &Value,
    config: &Value,
    paper: &Value,
) -> CatalogueEntry {
    let summary = summary_of(schema, name);
    let published = match kind {
        EntryKind::Planner | EntryKind::Smoother => of_part(name),
        EntryKind::LocalPlanner => of_local(name),
        EntryKind::Guide | EntryKind::Stack | EntryKind::Robot => Vec::new(),
    };
    let parameters = parameters(path, schema, config, paper);
    CatalogueEntry { kind, name: name.to_owned(), summary, parameters, published, file: None }
}

fn stack_entry(name: &'static str, stack: &Stack) -> CatalogueEntry {
    let schema = schema_for!(Stack).to_value();
    let (about, source) = (Stack::summary(name).unwrap_or_default(), Stack::source(name));
    let summary = source.map_or_else(|| about.to_owned(), |source| format!("{about} [{source}]"));
    let paper = Stack::published_by_name(name).map_or(Value::Null, |stack| paper_stack(&stack));
    let parameters = parameters("", &schema, &value(stack), &paper);
    let file = Some(file(stack, &format!("{name}: {summary}"), &parameters));
    let published = of_stack(name).into_iter().collect();
    let (kind, name) = (EntryKind::Stack, name.to_owned());
    CatalogueEntry { kind, name, summary, parameters, published, file }
}

/// Returns the values of a published stack in those of its parts that have a paper.
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

/// Returns the entry of a robot, such as one from a file.
pub fn robot_entry(name: &str, robot: &Robot) -> CatalogueEntry {
    let schema = schema_for!(Robot).to_value();
    let ranges_m = robot.sensors.iter().map(|sensor| sensor.range_m);
    let range_m = ranges_m.fold(0.0, f64::max);
    let summary = plain(&format!(
        "{}, up to {} m/s, sensor range {range_m} m",
        robot.footprint, robot.limits.v_max_mps
    ));
    let parameters = parameters("", &schema, &value(robot), &Value::Null);
    let file = Some(file(robot, &format!("{name}: {summary}"), &parameters));
    CatalogueEntry {
        kind: EntryKind::Robot,
        name: name.to_owned(),
        summary,
        parameters,
        published: Vec::new(),
        file,
    }
}
