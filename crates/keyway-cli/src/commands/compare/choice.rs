//! What is compared, each with its own parameters.

use crate::args::{Assignment, CompareArgs};
use crate::commands::why;
use crate::config::{FieldOption, plan_base, resolve, size_option};
use crate::error::{CliError, Kind};
use crate::inputs::sized_robot;
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use keyway_lab::compare::CompareRequest;

/// Parts of a stack of which several are compared.
const PLANNER: &str = "planner";
const SMOOTHER: &str = "smoother";

/// Stands for all names.
const ALL: &str = "all";
/// What is compared where nothing says what: shortest paths on the grid and paths in any direction, each as
/// planned, pulled tight, and with curves.
const USUAL_PLANNERS: [&str; 2] = ["jps", "theta-star"];
const USUAL_SMOOTHERS: [&str; 3] = ["none", "taut", "continuous-curvature"];

/// Request that the arguments stand for. Wrong names and parameters are reported before anything is
/// planned.
pub(super) fn request(args: &CompareArgs) -> Result<CompareRequest, CliError> {
    let is_open =
        args.planners.is_empty() && args.smoothers.is_empty() && args.config.config.is_none();
    let named = |names: &[String], usual: &[&str], all: &[&str], field: &str| {
        refuse_repeated(names, field)?;
        let given = match names {
            [] if is_open => usual,
            [name] if name == ALL => all,
            _ => return Ok(names.to_vec()),
        };
        Ok::<_, CliError>(given.iter().map(|name| (*name).to_owned()).collect())
    };
    let planners = named(&args.planners, &USUAL_PLANNERS, &PlannerConfig::NAMES, "--planners")?;
    let smoothers =
        named(&args.smoothers, &USUAL_SMOOTHERS, &SmootherConfig::NAMES, "--smoothers")?;
    args.config.set.iter().try_for_each(refuse_renaming)?;
    // What is not named is a default, or the one of a config file.
    let usual = Pair { args, planner: planners.first(), smoother: smoothers.first() };
    // Which names are compared is known afterwards.
    let all = PlannerConfig::NAMES.iter().chain(&SmootherConfig::NAMES);
    let base = usual.resolve(&all.map(|name| (*name).to_owned()).collect::<Vec<_>>())?;
    let or = |names: &[String], usual: &str| {
        if names.is_empty() { vec![usual.to_owned()] } else { names.to_vec() }
    };
    let (planners, smoothers) =
        (or(&planners, base.planner.name()), or(&smoothers, base.smoother.name()));
    refuse_absent(&args.config.set, &planners, &smoothers)?;
    let compared = [&planners[..], &smoothers[..]].concat();
    let with_planner = |name| {
        let stack = Pair { planner: Some(name), ..usual }.resolve(&compared)?;
        refuse_other(stack.planner.name(), name, PLANNER).map(|()| stack.planner)
    };
    let with_smoother = |name| {
        let stack = Pair { smoother: Some(name), ..usual }.resolve(&compared)?;
        refuse_other(stack.smoother.name(), name, SMOOTHER).map(|()| stack.smoother)
    };
    Ok(CompareRequest {
        map: base.map,
        leaves_out_unfit: matches!(&args.planners[..], [name] if name == ALL),
        planners: planners.iter().map(with_planner).collect::<Result<_, _>>()?,
        smoothers: smoothers.iter().map(with_smoother).collect::<Result<_, _>>()?,
        repeat: args.repeat,
        has_times: !args.no_times,
        why,
    })
}

/// A planner and a smoother; `None` is the default.
#[derive(Clone, Copy)]
struct Pair<'a> {
    args: &'a CompareArgs,
    planner: Option<&'a String>,
    smoother: Option<&'a String>,
}

impl Pair<'_> {
    /// Parameters of one planner or smoother are left to it, if it is compared.
    fn resolve(&self, compared: &[String]) -> Result<Stack, CliError> {
        let args = self.args;
        let robot = sized_robot(&args.size)?;
        let options = [
            FieldOption::new("--planners", "planner.name", self.planner.cloned()),
            FieldOption::new("--smoothers", "smoother.name", self.smoother.cloned()),
            size_option(&args.size, robot.as_ref()),
        ];
        let robot = robot.unwrap_or_else(Robot::small);
        let stack = Stack::for_plans(&robot);
        let base = plan_base(&stack, &robot, &args.size, args.as_published);
        resolve(base, &args.config, options, compared).map_err(|error| self.with_name(error))
    }

    /// Says which planner's or smoother's parameter is wrong.
    fn with_name(&self, error: CliError) -> CliError {
        let field = error.field.clone().unwrap_or_default();
        let Some((part, rest)) = field.split_once('.') else { return error };
        let name = match part {
            PLANNER => self.planner,
            SMOOTHER => self.smoother,
            _ => None,
        };
        let Some(name) = name else { return error };
        let own = format!("{name}.{rest}");
        let is_own = self.args.config.set.iter().any(|set| set.path == own);
        let field = if is_own { own } else { field };
        let message = format!("{name}: {}", error.message);
        CliError { message, field: Some(field), ..error }
    }
}

/// The planner or smoother whose own parameter a path names, and the parameter.
fn target(path: &str) -> Option<(&str, &str)> {
    let (name, rest) = path.split_once('.')?;
    let is_name = PlannerConfig::NAMES.contains(&name) || SmootherConfig::NAMES.contains(&name);
    is_name.then_some((name, rest))
}

/// A parameter of something that is not compared would be lost.
fn refuse_absent(
    set: &[Assignment],
    planners: &[String],
    smoothers: &[String],
) -> Result<(), CliError> {
    let is_compared = |name: &str| planners.iter().chain(smoothers).any(|one| one == name);
    let is_lost = |set: &&Assignment| target(&set.path).is_some_and(|(name, _)| !is_compared(name));
    let Some(Assignment { path, .. }) = set.iter().find(is_lost) else { return Ok(()) };
    let (planners, smoothers) = (planners.join(", "), smoothers.join(", "));
    let message = format!(
        "--set {path}: not compared here; the planners are {planners}, the smoothers {smoothers}"
    );
    Err(CliError::new(Kind::Config, message).field(path))
}

/// Which planners and smoothers are compared is said elsewhere.
fn refuse_renaming(set: &Assignment) -> Result<(), CliError> {
    let parent = set.path.strip_suffix(".name");
    let is_named = |parent| parent == PLANNER || parent == SMOOTHER;
    if parent.is_some_and(is_named) || target(&set.path).is_some_and(|(_, rest)| rest == "name") {
        return Err(renamed(&set.path));
    }
    Ok(())
}

/// A name may also hide in a table.
fn refuse_other(name: &str, wanted: &str, part: &str) -> Result<(), CliError> {
    if name == wanted { Ok(()) } else { Err(renamed(&format!("{part}.name"))) }
}

fn renamed(path: &str) -> CliError {
    let message = format!(
        "--set: `{path}` cannot be set in a comparison; --planners and --smoothers name what is compared"
    );
    CliError::new(Kind::Config, message).field(path)
}

pub(super) fn refuse_repeated(names: &[String], field: &str) -> Result<(), CliError> {
    if names.iter().any(String::is_empty) {
        let message = format!("{field}: a name is missing in `{}`", names.join(","));
        return Err(CliError::new(Kind::Usage, message).field(field));
    }
    if names.len() > 1 && names.iter().any(|name| name == ALL) {
        let message = format!("{field}: `{ALL}` stands for all names; give it alone");
        return Err(CliError::new(Kind::Usage, message).field(field));
    }
    let repeated = (1..names.len()).find(|&i| names[..i].contains(&names[i]));
    let Some(i) = repeated else { return Ok(()) };
    Err(CliError::new(Kind::Usage, format!("{field}: {} is named twice", names[i])).field(field))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Otherwise `--set NAME.field=value` could mean two things.
    #[test]
    fn names_are_unique() {
        let stack = toml::Table::try_from(Stack::for_plans(&Robot::small())).unwrap();
        let mut names: Vec<&str> = stack.keys().map(String::as_str).collect();
        names.push(ALL);
        names.extend(PlannerConfig::NAMES.iter().chain(&SmootherConfig::NAMES));
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
