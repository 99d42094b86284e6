//! Planners and smoothers of a request, each with its own parameters.

use super::request::CompareRequest;
use super::request_error::{CompareRequestError, NamesError};
use keyway::files::{
    Assignment, FieldValue, LayerError, ParameterLayer, ParameterLayers, RobotSize, find_robot,
};
use keyway::map::LayerConfig;
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::smooth::SmootherConfig;
use std::path::Path;

/// Parts of a stack that are compared.
const PLANNER: &str = "planner";
const SMOOTHER: &str = "smoother";

/// Name that means all names.
const ALL: &str = "all";
/// Default planners and smoothers: shortest paths on the grid and any-angle paths, each as
/// planned, pulled taut, and with curves.
const USUAL_PLANNERS: [&str; 2] = ["jps", "theta-star"];
const USUAL_SMOOTHERS: [&str; 3] = ["none", "taut", "continuous-curvature"];

/// Resolved names and parameters of a request.
#[derive(Debug)]
pub(super) struct Choice {
    pub(super) size: RobotSize,
    pub(super) map: LayerConfig,
    pub(super) planners: Vec<PlannerConfig>,
    pub(super) leaves_out_unfit: bool,
    pub(super) smoothers: Vec<SmootherConfig>,
}

impl Choice {
    /// Resolves the names and parameters of a request.
    pub(super) fn of(request: &CompareRequest) -> Result<Self, CompareRequestError> {
        let planners = Listed::of(request, "planners", &request.planners)?;
        let smoothers = Listed::of(request, "smoothers", &request.smoothers)?;
        let planners = planners.names(&USUAL_PLANNERS, &PlannerConfig::NAMES);
        let smoothers = smoothers.names(&USUAL_SMOOTHERS, &SmootherConfig::NAMES);
        let assignments = &request.parameters.assignments;
        assignments.iter().try_for_each(refuse_renaming)?;
        let size = size(request)?;
        // Parts without a name take the default, or the value of a file.
        let (planner, smoother) = (planners.first(), smoothers.first());
        let usual = Pair { request, size: &size, planner, smoother };
        // Accepts parameters of all names: the compared ones are known only afterwards.
        let all = PlannerConfig::NAMES.iter().chain(&SmootherConfig::NAMES);
        let base = usual.stack(&all.map(|name| (*name).to_owned()).collect::<Vec<_>>())?;
        let planners = or(&planners, base.planner.name());
        let smoothers = or(&smoothers, base.smoother.name());
        refuse_absent(assignments, &planners, &smoothers)?;
        let compared = [&planners[..], &smoothers[..]].concat();
        let with_planner = |name| {
            let stack = Pair { planner: Some(name), ..usual }.stack(&compared)?;
            refuse_other(stack.planner.name(), name, PLANNER).map(|()| stack.planner)
        };
        let with_smoother = |name| {
            let stack = Pair { smoother: Some(name), ..usual }.stack(&compared)?;
            refuse_other(stack.smoother.name(), name, SMOOTHER).map(|()| stack.smoother)
        };
        Ok(Self {
            map: base.map,
            planners: planners.iter().map(with_planner).collect::<Result<_, _>>()?,
            leaves_out_unfit: is_all(&request.planners),
            smoothers: smoothers.iter().map(with_smoother).collect::<Result<_, _>>()?,
            size: size.clone(),
        })
    }
}

fn is_all(names: &[String]) -> bool {
    matches!(names, [name] if name == ALL)
}

/// Returns a list of names, or the name of the default.
fn or(names: &[String], default: &str) -> Vec<String> {
    if names.is_empty() { vec![default.to_owned()] } else { names.to_vec() }
}

/// Names in a request.
enum Listed<'a> {
    /// Neither names nor a file are given.
    Usual,
    /// All existing names.
    All,
    /// These names; an empty list means the default.
    Names(&'a [String]),
}

impl<'a> Listed<'a> {
    fn of(
        request: &CompareRequest,
        field: &'static str,
        names: &'a [String],
    ) -> Result<Self, CompareRequestError> {
        refuse_repeated(field, names)?;
        let is_open = request.planners.is_empty()
            && request.smoothers.is_empty()
            && request.parameters.file.is_none();
        Ok(match names {
            [] if is_open => Self::Usual,
            names if is_all(names) => Self::All,
            names => Self::Names(names),
        })
    }

    fn names(self, usual: &[&str], all: &[&str]) -> Vec<String> {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        match self {
            Self::Usual => owned(usual),
            Self::All => owned(all),
            Self::Names(names) => names.to_vec(),
        }
    }
}

fn size(request: &CompareRequest) -> Result<RobotSize, CompareRequestError> {
    let find = |name: &String| find_robot(name, Path::new(""));
    let robot = request.robot.as_ref().map(find).transpose();
    let robot = robot.map_err(CompareRequestError::Robot)?;
    RobotSize::new(robot, request.radius_m).map_err(CompareRequestError::Footprint)
}

/// A planner and a smoother; `None` means the default.
#[derive(Clone, Copy)]
struct Pair<'a> {
    request: &'a CompareRequest,
    size: &'a RobotSize,
    planner: Option<&'a String>,
    smoother: Option<&'a String>,
}

impl Pair<'_> {
    /// Returns the stack with both; parameters of other `compared` names are ignored.
    fn stack(&self, compared: &[String]) -> Result<Stack, CompareRequestError> {
        let parameters = &self.request.parameters;
        let name = |field, path, name: Option<&String>| {
            name.map(|name| FieldValue::new(field, path, name.as_str()))
        };
        let planner = name("planners", "planner.name", self.planner);
        let smoother = name("smoothers", "smoother.name", self.smoother);
        let fields = planner.into_iter().chain(smoother).chain(parameters.fields.iter().cloned());
        let layers = ParameterLayers { fields: fields.collect(), ..parameters.clone() };
        self.size
            .plan_stack(self.request.values, &layers, compared)
            .map_err(|error| self.refused(error))
    }

    /// Adds the name of the planner or smoother that a wrong parameter belongs to.
    fn refused(&self, error: LayerError) -> CompareRequestError {
        let path = error.path.clone();
        let plain =
            |error| CompareRequestError::Parameters { owner: None, path: path.clone(), error };
        if matches!(error.layer, Some(ParameterLayer::Field(_))) {
            return plain(error);
        }
        let Some((part, rest)) = path.split_once('.') else { return plain(error) };
        let name = match part {
            PLANNER => self.planner,
            SMOOTHER => self.smoother,
            _ => None,
        };
        let Some(name) = name else { return plain(error) };
        let own = format!("{name}.{rest}");
        let is_own = self.request.parameters.assignments.iter().any(|set| set.path == own);
        let path = if is_own { own } else { path.clone() };
        CompareRequestError::Parameters { owner: Some(name.clone()), path, error }
    }
}

/// Returns the planner or smoother whose own parameter a path names, and the parameter.
fn target(path: &str) -> Option<(&str, &str)> {
    let (name, rest) = path.split_once('.')?;
    let is_name = PlannerConfig::NAMES.contains(&name) || SmootherConfig::NAMES.contains(&name);
    is_name.then_some((name, rest))
}

/// Refuses a parameter of a part that is not compared: it would be lost.
fn refuse_absent(
    assignments: &[Assignment],
    planners: &[String],
    smoothers: &[String],
) -> Result<(), CompareRequestError> {
    let is_compared = |name: &str| planners.iter().chain(smoothers).any(|one| one == name);
    let is_lost = |set: &&Assignment| target(&set.path).is_some_and(|(name, _)| !is_compared(name));
    let Some(Assignment { path, .. }) = assignments.iter().find(is_lost) else { return Ok(()) };
    let (path, planners, smoothers) = (path.clone(), planners.to_vec(), smoothers.to_vec());
    Err(CompareRequestError::NotCompared { path, planners, smoothers })
}

/// Refuses a parameter that is the name of a planner or a smoother: other fields give those.
fn refuse_renaming(set: &Assignment) -> Result<(), CompareRequestError> {
    let parent = set.path.strip_suffix(".name");
    let is_named = |parent| parent == PLANNER || parent == SMOOTHER;
    if parent.is_some_and(is_named) || target(&set.path).is_some_and(|(_, rest)| rest == "name") {
        return Err(CompareRequestError::Renamed { path: set.path.clone() });
    }
    Ok(())
}

/// Refuses a name that is set by a table.
fn refuse_other(name: &str, wanted: &str, part: &str) -> Result<(), CompareRequestError> {
    if name == wanted {
        return Ok(());
    }
    Err(CompareRequestError::Renamed { path: format!("{part}.name") })
}

/// Refuses a list with an empty or a repeated name, or with the name for all beside others.
pub(super) fn refuse_repeated(
    field: &'static str,
    names: &[String],
) -> Result<(), CompareRequestError> {
    let refused = |error| Err(CompareRequestError::Names { field, error });
    if names.iter().any(String::is_empty) {
        return refused(NamesError::Missing { names: names.to_vec() });
    }
    if names.len() > 1 && names.iter().any(|name| name == ALL) {
        return refused(NamesError::AllAndOthers { all: ALL });
    }
    let repeated = (1..names.len()).find(|&i| names[..i].contains(&names[i]));
    match repeated {
        Some(i) => refused(NamesError::Repeated { name: names[i].clone() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::robot::Robot;

    /// Otherwise, the path `NAME.field` of a parameter would be ambiguous.
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
