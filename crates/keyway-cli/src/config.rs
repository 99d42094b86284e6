//! Which parameters a command runs with: a stack, a file over it, options over both.

use crate::args::{ConfigArgs, Unknown};
use crate::error::{CliError, Kind};
use crate::inputs::{TOML_BYTES, read_text};
use crate::overlay::{NamedDefault, Overlay, OverlayError, value_from_text};
use keyway::local::DwaError;
use keyway::navigate::{LocalConfig, Stack, StackError};
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use serde::Serialize;
use std::path::Path;
use toml::{Table, Value};

/// An option of its own that changes one field, such as `--planner`.
pub(crate) struct FieldOption {
    /// The option's name.
    pub(crate) flag: &'static str,
    /// The field.
    pub(crate) path: &'static str,
    /// Its new value.
    pub(crate) value: Value,
}

impl FieldOption {
    pub(crate) fn new(
        flag: &'static str,
        path: &'static str,
        value: Option<impl Into<Value>>,
    ) -> Option<Self> {
        value.map(|value| Self { flag, path, value: value.into() })
    }
}

/// A stack by its name, with the parameters for a robot.
pub(crate) fn stack_by_name(name: &str, robot: &Robot) -> Result<Stack, CliError> {
    Stack::by_name(name, robot).ok_or_else(|| {
        let names = Stack::NAMES.join(", ");
        let message = format!("there is no stack `{name}`, expected one of {names}");
        CliError::new(Kind::Config, message).field("--stack")
    })
}

/// Lays `--config`, then the options, then each `--set` over a stack, and checks the result.
pub(crate) fn resolve(
    base: &Stack,
    robot: &Robot,
    args: &ConfigArgs,
    options: impl IntoIterator<Item = Option<FieldOption>>,
) -> Result<Stack, CliError> {
    let named: NamedDefault<'_> = &|path, name| named_default(path, name, robot);
    let own = |error: OverlayError| CliError::new(Kind::Config, error);
    let mut overlay = Overlay::of(base, named).map_err(own)?;
    if let Some(path) = &args.config {
        let blame = |error: OverlayError| {
            let field = error.path().to_owned();
            CliError::new(Kind::Config, format!("{}: {error}", path.display())).field(field)
        };
        overlay.merge(&read_table(path)?).map_err(blame)?;
    }
    let unknown = FieldOption::new("--unknown", "map.unknown", args.unknown.map(Unknown::name));
    for FieldOption { flag, path, value } in options.into_iter().chain([unknown]).flatten() {
        let blame = |e| CliError::new(Kind::Config, format!("{flag}: {e}")).field(flag);
        overlay.set(path, value).map_err(blame)?;
    }
    for assignment in &args.set {
        let (path, text) = (assignment.path.as_str(), assignment.value.as_str());
        let blame = |e| CliError::new(Kind::Config, format!("--set: {e}")).field(path);
        overlay.set(path, value_from_text(text)).map_err(blame)?;
    }
    let stack: Stack = overlay.finish().map_err(own)?;
    stack.validate(robot).map_err(|error| {
        let field = match &error {
            StackError::Value { field, .. } => (*field).to_owned(),
            StackError::Smoother(error) => format!("smoother.{}", error.field),
            StackError::Dwa(DwaError::Config(error)) => format!("local.{}", error.field),
            _ => "local".to_owned(),
        };
        CliError::new(Kind::Config, error).field(field)
    })?;
    Ok(stack)
}

fn named_default(path: &str, name: &str, robot: &Robot) -> Result<Table, Vec<&'static str>> {
    match path {
        "planner" => table(PlannerConfig::by_name(name), &PlannerConfig::NAMES),
        "smoother" => table(SmootherConfig::by_name(name), &SmootherConfig::NAMES),
        "local" => table(LocalConfig::by_name(name, robot), &LocalConfig::NAMES),
        _ => Err(Vec::new()),
    }
}

fn table(
    config: Option<impl Serialize>,
    names: &[&'static str],
) -> Result<Table, Vec<&'static str>> {
    config.and_then(|config| Table::try_from(config).ok()).ok_or_else(|| names.to_vec())
}

fn read_table(path: &Path) -> Result<Table, CliError> {
    let text = read_text(path, TOML_BYTES, "--config")?;
    keyway::scene::from_toml(&text).map_err(|error| {
        CliError::new(Kind::Config, format!("{}: {error}", path.display())).field("--config")
    })
}
