//! Which parameters a command runs with: a stack, a file over it, options over both.

use crate::args::{ConfigArgs, SizeArgs, Unknown};
use crate::error::{CliError, Kind};
use crate::inputs::read_text;
use keyway::files::{NamedDefault, Overlay, OverlayError, StackBase, value_from_text};
use keyway::local::LocalConfig;
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use std::path::Path;
use toml::{Table, Value};

/// A separate option that changes one field, such as `--planner`.
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

/// The clearance that a robot of this size needs.
pub(crate) fn size_option(size: &SizeArgs, robot: Option<&Robot>) -> Option<FieldOption> {
    let flag = if size.radius.is_some() { "--radius" } else { "--robot" };
    let radius_m = size.radius.or(robot.map(|robot| robot.footprint.inscribed_radius_m()));
    FieldOption::new(flag, "map.clearance_m", radius_m)
}

/// Base over which the parameters of a plan are laid: parts that are chosen by their names begin
/// with distances for the robot where one is given, otherwise for the radius, and without both with
/// their usual ones.
pub(crate) fn plan_base<'a>(
    stack: &'a Stack,
    robot: &'a Robot,
    size: &SizeArgs,
    as_published: bool,
) -> StackBase<'a> {
    if as_published {
        StackBase::as_published(stack, robot)
    } else if size.robot.is_some() {
        StackBase::for_robot(stack, robot)
    } else {
        StackBase::for_radius(stack, robot, size.radius)
    }
}

/// Lays `--config`, then the options, then each `--set` over a stack, and checks the result. Parameters
/// that name their planner or smoother come last; where that is one of `others`, which are used beside
/// this stack, they are for that one.
pub(crate) fn resolve(
    base: StackBase<'_>,
    args: &ConfigArgs,
    options: impl IntoIterator<Item = Option<FieldOption>>,
    others: &[String],
) -> Result<Stack, CliError> {
    let named: NamedDefault<'_> = &|path, name| base.part(path, name);
    let whole = |error: OverlayError| CliError::new(Kind::Config, error);
    let mut overlay = Overlay::of(base.stack(), named).map_err(whole)?;
    let mut own = match &args.config {
        Some(path) => lay_file(&mut overlay, path)?,
        None => Vec::new(),
    };
    let unknown = FieldOption::new("--unknown", "map.unknown", args.unknown.map(Unknown::name));
    for FieldOption { flag, path, value } in options.into_iter().chain([unknown]).flatten() {
        let blame = |e| CliError::new(Kind::Config, format!("{flag}: {e}")).field(flag);
        overlay.set(path, value).map_err(blame)?;
    }
    for assignment in &args.set {
        let (path, text) = (assignment.path.as_str(), assignment.value.as_str());
        let value = value_from_text(text);
        if is_name(path.split('.').next().unwrap_or(path)) {
            own.push(Own::new("--set", path.to_owned(), value));
            continue;
        }
        let blame = |e| CliError::new(Kind::Config, format!("--set: {e}")).field(path);
        overlay.set(path, value).map_err(blame)?;
    }
    own.into_iter().try_for_each(|one| one.apply(&mut overlay, others))?;
    let stack: Stack = overlay.finish().map_err(whole)?;
    stack
        .check_parameters(base.robot())
        .map_err(|error| CliError::new(Kind::Config, &error).field(error.path.as_str()))?;
    Ok(stack)
}

/// Lays the general part of a file over a stack; gives the rest.
fn lay_file(overlay: &mut Overlay<'_, Stack>, path: &Path) -> Result<Vec<Own>, CliError> {
    let blame = |error: OverlayError| {
        let field = error.path().to_owned();
        CliError::new(Kind::Config, format!("{}: {error}", path.display())).field(field)
    };
    let (own, general): (Table, Table) =
        read_table(path)?.into_iter().partition(|(key, _)| is_name(key));
    overlay.merge(&general).map_err(blame)?;
    let source = path.display().to_string();
    Ok(own.into_iter().map(|(path, value)| Own::new(&source, path, value)).collect())
}

/// Whether this is the name of a planner, a smoother or a local planner.
pub(crate) fn is_name(name: &str) -> bool {
    part_of(name).is_some()
}

/// The part of a stack that holds something of this name.
fn part_of(name: &str) -> Option<&'static str> {
    let parts: [(&str, &[&str]); 3] = [
        ("planner", &PlannerConfig::NAMES),
        ("smoother", &SmootherConfig::NAMES),
        ("local", &LocalConfig::NAMES),
    ];
    parts.into_iter().find(|(_, names)| names.contains(&name)).map(|(part, _)| part)
}

/// A parameter that names what it belongs to, such as `hsta.if_no_path`; or a table of them, `hsta`.
struct Own {
    /// Where it was given: an option, or a file.
    source: String,
    path: String,
    value: Value,
}

impl Own {
    fn new(source: &str, path: String, value: Value) -> Self {
        Self { source: source.to_owned(), path, value }
    }

    fn apply(self, overlay: &mut Overlay<'_, Stack>, others: &[String]) -> Result<(), CliError> {
        let Self { source, path, value } = self;
        let (name, field) = path.split_once('.').unwrap_or((&path, ""));
        let refused = |message: String, field: &str| {
            CliError::new(Kind::Config, format!("{source}: {message}")).field(field)
        };
        let part = part_of(name).unwrap_or_default();
        let used = overlay.name_at(part).unwrap_or_default();
        if used != name {
            if others.iter().any(|other| other == name) {
                return Ok(());
            }
            return Err(refused(format!("{path}: {name} is not used here; {used} is"), &path));
        }
        let renames = value.as_table().is_some_and(|table| table.contains_key("name"));
        if field == "name" || renames {
            return Err(refused(format!("the name of {name} cannot be set"), &path));
        }
        let in_stack = if field.is_empty() { part.to_owned() } else { format!("{part}.{field}") };
        overlay.set(&in_stack, value).map_err(|error| {
            let field = error.path().replacen(part, name, 1);
            refused(format!("{name}: {error}"), &field)
        })
    }
}

fn read_table(path: &Path) -> Result<Table, CliError> {
    let text = read_text(path, keyway::files::MAX_TOML_BYTES, "--config")?;
    keyway::files::from_toml(&text).map_err(|error| {
        CliError::new(Kind::Config, format!("{}: {error}", path.display())).field("--config")
    })
}
