//! Layers of parameters over a stack: a file, single fields, and assignments.

use super::overlay::{NamedDefault, Overlay, OverlayError, value_from_text};
use super::stack_base::StackBase;
use crate::ConfigError;
use crate::local::LocalConfig;
use crate::navigate::Stack;
use crate::plan::PlannerConfig;
use crate::smooth::SmootherConfig;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;
use toml::{Table, Value};

/// Parameters in layers, each over the one before: a file, single fields, assignments.
///
/// A path may begin with the name of a planner, a smoother or a local planner, such as
/// `hsta.if_no_path`. Such a parameter belongs only to its owner, and is applied after all others.
///
/// ```
/// use keyway::files::{FieldValue, ParameterLayers, StackBase};
/// use keyway::navigate::Stack;
/// use keyway::robot::Robot;
///
/// let robot = Robot::small();
/// let stack = Stack::keyway(&robot);
/// let base = StackBase::for_robot(&stack, &robot);
/// let layers = ParameterLayers {
///     fields: vec![FieldValue::new("planner", "planner.name", "hsta")],
///     assignments: vec!["hsta.l1_constraint=0.5".parse()?, "map.unknown=free".parse()?],
///     ..ParameterLayers::default()
/// };
/// assert_eq!(layers.over(base, &[])?.planner.name(), "hsta");
/// let other = ParameterLayers { fields: Vec::new(), ..layers };
/// let error = other.over(base, &[]).unwrap_err();
/// assert_eq!(error.path, "hsta.l1_constraint");
/// let reason = "hsta.l1_constraint: hsta is not in use; the stack uses jps";
/// assert_eq!(error.fault.to_string(), reason);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterLayers {
    /// Parameters of a file.
    pub file: Option<ParameterFile>,
    /// Single fields over the file.
    pub fields: Vec<FieldValue>,
    /// Assignments over the fields.
    pub assignments: Vec<Assignment>,
}

/// Parameters of a file: any part of a stack.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterFile {
    /// Name of the file, for errors.
    pub name: String,
    /// Content of the file.
    pub table: Table,
}

/// Value for one field of a stack that a caller offers under a name of its own, such as `planner`.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldValue {
    /// Name of the caller's field, for errors.
    pub field: &'static str,
    /// Path in the stack, such as `planner.name`.
    pub path: &'static str,
    /// New value.
    pub value: Value,
}

impl FieldValue {
    /// Value for a field of a stack.
    pub fn new(field: &'static str, path: &'static str, value: impl Into<Value>) -> Self {
        Self { field, path, value: value.into() }
    }

    /// As [`Self::new`], for an optional value.
    pub fn if_given(
        field: &'static str,
        path: &'static str,
        value: Option<impl Into<Value>>,
    ) -> Option<Self> {
        value.map(|value| Self::new(field, path, value))
    }
}

/// Assignment of a value to one parameter, such as `map.unknown=free`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// Path of the parameter.
    pub path: String,
    /// New value.
    pub value: Value,
}

/// Text that is not an assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("expected PATH=VALUE, such as map.unknown=free")]
pub struct AssignmentError;

impl FromStr for Assignment {
    type Err = AssignmentError;

    fn from_str(text: &str) -> Result<Self, AssignmentError> {
        match text.split_once('=') {
            Some((path, value)) if !path.trim().is_empty() => {
                Ok(Self { path: path.trim().to_owned(), value: value_from_text(value.trim()) })
            }
            _ => Err(AssignmentError),
        }
    }
}

impl fmt::Display for Assignment {
    /// Formats it as text that parses to the same assignment.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.path, self.value)
    }
}

impl Assignment {
    /// The same assignment with its path in a robot file, if it is one of the robot's
    /// (`robot.limits.v_max_mps=0.3`).
    pub fn of_robot(&self) -> Option<Self> {
        let path = self.path.strip_prefix("robot.")?.to_owned();
        Some(Self { path, value: self.value.clone() })
    }

    /// Assignments of all values in a table and in its subtables, in their order.
    pub fn all_of(table: &Table) -> Vec<Self> {
        fn walk(table: &Table, path: &str, out: &mut Vec<Assignment>) {
            for (key, value) in table {
                let here = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                match value {
                    Value::Table(inner) => walk(inner, &here, out),
                    value => out.push(Assignment { path: here, value: value.clone() }),
                }
            }
        }
        let mut out = Vec::new();
        walk(table, "", &mut out);
        out
    }
}

/// Layer of a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ParameterLayer {
    /// The file of this name.
    File(String),
    /// The field of this name ([`FieldValue::field`]).
    Field(&'static str),
    /// An assignment.
    Assignment,
}

/// An invalid parameter of a layer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}{fault}", layer_text(.layer.as_ref()))]
#[non_exhaustive]
pub struct LayerError {
    /// Layer with the parameter; `None` if the fault only shows in the result of all layers.
    pub layer: Option<ParameterLayer>,
    /// Path of the parameter; empty for the whole stack.
    pub path: String,
    /// Fault of the parameter.
    pub fault: LayerFault,
}

/// Fault of a parameter of a layer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LayerFault {
    /// No such field, or a value of another type.
    #[error(transparent)]
    Overlay(OverlayError),
    /// As [`LayerFault::Overlay`], for a parameter that names its owner.
    #[error("{owner}: {error}")]
    OwnOverlay {
        /// Name of the planner, smoother or local planner.
        owner: String,
        /// Error with the path in the stack.
        error: OverlayError,
    },
    /// A parameter of a component that the stack does not use.
    #[error("{path}: {owner} is not in use; the stack uses {used}")]
    NotUsed {
        /// Path as given.
        path: String,
        /// Name of the planner, smoother or local planner.
        owner: String,
        /// Name of the one in use.
        used: String,
    },
    /// A `name` among the parameters of a component that is itself selected by its name.
    #[error("the name of {owner} cannot be set")]
    Renamed {
        /// Name of the planner, smoother or local planner.
        owner: String,
    },
    /// A value that is invalid for the stack.
    #[error(transparent)]
    Config(ConfigError),
}

fn layer_text(layer: Option<&ParameterLayer>) -> String {
    match layer {
        None => String::new(),
        Some(ParameterLayer::File(name)) => format!("{name}: "),
        Some(ParameterLayer::Field(field)) => format!("{field}: "),
        Some(ParameterLayer::Assignment) => "parameters: ".to_owned(),
    }
}

impl ParameterLayers {
    /// The stack with all layers; every value is checked.
    ///
    /// Parameters of components in `others`, which a caller uses beside this stack, are ignored.
    ///
    /// # Errors
    /// Names the layer and the path of the first invalid parameter.
    pub fn over(&self, base: StackBase<'_>, others: &[String]) -> Result<Stack, LayerError> {
        let stack =
            if self.is_empty() { base.stack().clone() } else { self.laid_over(base, others)? };
        stack.check_parameters(base.robot()).map_err(|error| LayerError {
            layer: None,
            path: error.path.clone(),
            fault: LayerFault::Config(error),
        })?;
        Ok(stack)
    }

    /// True if nothing is changed.
    pub fn is_empty(&self) -> bool {
        self.file.is_none() && self.fields.is_empty() && self.assignments.is_empty()
    }

    /// The stack with all layers, without checks of the values.
    fn laid_over(&self, base: StackBase<'_>, others: &[String]) -> Result<Stack, LayerError> {
        let named: NamedDefault<'_> = &|path, name| base.part(path, name);
        let mut overlay = Overlay::of(base.stack(), named).map_err(whole)?;
        let mut own = match &self.file {
            Some(file) => file.lay_over(&mut overlay)?,
            None => Vec::new(),
        };
        for FieldValue { field, path, value } in &self.fields {
            let refused = |error| refused(ParameterLayer::Field(field), path, error);
            overlay.set(path, value.clone()).map_err(refused)?;
        }
        for Assignment { path, value } in &self.assignments {
            if is_owner(path.split('.').next().unwrap_or(path)) {
                own.push(Own { layer: ParameterLayer::Assignment, path, value });
                continue;
            }
            let refused = |error| refused(ParameterLayer::Assignment, path, error);
            overlay.set(path, value.clone()).map_err(refused)?;
        }
        own.into_iter().try_for_each(|one| one.lay_over(&mut overlay, others))?;
        overlay.finish().map_err(whole)
    }
}

impl ParameterFile {
    /// Applies the general part of a file to a stack; returns the parameters that name their
    /// owner.
    fn lay_over(&self, overlay: &mut Overlay<'_, Stack>) -> Result<Vec<Own<'_>>, LayerError> {
        let layer = || ParameterLayer::File(self.name.clone());
        let is_own = |(key, _): &(&String, &Value)| is_owner(key);
        let general = self.table.iter().filter(|entry| !is_own(entry));
        let general: Table = general.map(|(key, value)| (key.clone(), value.clone())).collect();
        overlay.merge(&general).map_err(|error| {
            let path = error.path().to_owned();
            refused(layer(), &path, error)
        })?;
        let own = self.table.iter().filter(is_own);
        Ok(own.map(|(path, value)| Own { layer: layer(), path, value }).collect())
    }
}

fn whole(error: OverlayError) -> LayerError {
    LayerError { layer: None, path: String::new(), fault: LayerFault::Overlay(error) }
}

fn refused(layer: ParameterLayer, path: &str, error: OverlayError) -> LayerError {
    let fault = LayerFault::Overlay(error);
    LayerError { layer: Some(layer), path: path.to_owned(), fault }
}

/// True for names of planners, smoothers and local planners.
fn is_owner(name: &str) -> bool {
    part_of(name).is_some()
}

/// The part of a stack that holds a component of this name.
fn part_of(name: &str) -> Option<&'static str> {
    let parts: [(&str, &[&str]); 3] = [
        ("planner", &PlannerConfig::NAMES),
        ("smoother", &SmootherConfig::NAMES),
        ("local", &LocalConfig::NAMES),
    ];
    parts.into_iter().find(|(_, names)| names.contains(&name)).map(|(part, _)| part)
}

/// A parameter that names its owner, such as `hsta.if_no_path`, or a table of them, `hsta`.
struct Own<'a> {
    layer: ParameterLayer,
    path: &'a str,
    value: &'a Value,
}

impl Own<'_> {
    fn lay_over(
        self,
        overlay: &mut Overlay<'_, Stack>,
        others: &[String],
    ) -> Result<(), LayerError> {
        let Self { layer, path, value } = self;
        let (owner, field) = path.split_once('.').unwrap_or((path, ""));
        let refused = |fault, path: &str| LayerError {
            layer: Some(layer.clone()),
            path: path.to_owned(),
            fault,
        };
        let part = part_of(owner).unwrap_or_default();
        let used = overlay.name_at(part).unwrap_or_default();
        if used != owner {
            if others.iter().any(|other| other == owner) {
                return Ok(());
            }
            let (owner, used) = (owner.to_owned(), used.to_owned());
            return Err(refused(LayerFault::NotUsed { path: path.to_owned(), owner, used }, path));
        }
        let renames = value.as_table().is_some_and(|table| table.contains_key("name"));
        if field == "name" || renames {
            return Err(refused(LayerFault::Renamed { owner: owner.to_owned() }, path));
        }
        let in_stack = if field.is_empty() { part.to_owned() } else { format!("{part}.{field}") };
        overlay.set(&in_stack, value.clone()).map_err(|error| {
            let path = error.path().replacen(part, owner, 1);
            refused(LayerFault::OwnOverlay { owner: owner.to_owned(), error }, &path)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn assignments_by_hand() {
        let assignment: Assignment = "planner.corners = allow".parse().unwrap();
        assert_eq!(
            (assignment.path.as_str(), assignment.value.as_str()),
            ("planner.corners", Some("allow"))
        );
        for text in ["planner", "=1", " = 1"] {
            assert_eq!(text.parse::<Assignment>(), Err(AssignmentError));
        }
        for text in
            ["a.b=free", "a=1", "a=-1.5", "a={ b = 1 }", "a=[1, 2]", "a=x=y", "a=", "a=tr\"ue"]
        {
            let assignment: Assignment = text.parse().unwrap();
            assert_eq!(assignment.to_string().parse(), Ok(assignment), "{text}");
        }
        let table: Table = "b = 1\n[a]\nc = \"x\"\n[a.d]\ne = [2]\n".parse().unwrap();
        let all: Vec<String> = Assignment::all_of(&table).iter().map(ToString::to_string).collect();
        assert!(all.len() == 3 && all.contains(&"a.d.e=[2]".to_owned()), "{all:?}");
        assert!(
            all.contains(&"a.c=\"x\"".to_owned()) && all.contains(&"b=1".to_owned()),
            "{all:?}"
        );
    }

    fn laid(layers: &ParameterLayers, others: &[&str]) -> Result<Stack, LayerError> {
        let robot = Robot::small();
        let stack = Stack::for_plans(&robot);
        let others: Vec<String> = others.iter().map(|&name| name.to_owned()).collect();
        layers.over(StackBase::for_robot(&stack, &robot), &others)
    }

    fn layers(file: &str, planner: &str, assignments: &[&str]) -> ParameterLayers {
        ParameterLayers {
            file: Some(ParameterFile { name: "my.toml".to_owned(), table: file.parse().unwrap() }),
            fields: vec![FieldValue::new("planner", "planner.name", planner)],
            assignments: assignments.iter().map(|text| text.parse().unwrap()).collect(),
        }
    }

    #[test]
    fn later_layers_win_and_own_parameters_come_last() {
        let file = "map.clearance_m = 0.5\nplanner.name = \"astar\"\n[hsta]\nl1_constraint = 3.0\n";
        let PlannerConfig::Hsta(hsta) = laid(&layers(file, "hsta", &[]), &[]).unwrap().planner
        else {
            panic!("the field counts more than the file")
        };
        assert_eq!(hsta.l1_constraint, 3.0);
        let all = ["hsta.l1_constraint=4", "map.clearance_m=0.25", "planner.l1_constraint=5"];
        let stack = laid(&layers(file, "hsta", &all), &[]).unwrap();
        let PlannerConfig::Hsta(hsta) = stack.planner else { panic!("{:?}", stack.planner) };
        assert_eq!((hsta.l1_constraint, stack.map.clearance_m), (4.0, 0.25));
    }

    #[test]
    fn errors_name_layer_path_and_fault() {
        let file = "[hsta]\nl1_constraint = 3.0\n";
        assert!(laid(&layers(file, "jps", &[]), &["hsta"]).is_ok());
        for (layers, message, path) in [
            (
                layers(file, "jps", &[]),
                "my.toml: hsta: hsta is not in use; the stack uses jps",
                "hsta",
            ),
            (layers("map.a = 1", "jps", &[]), "my.toml: there is no field `map.a`", "map.a"),
            (layers("", "jsp", &[]), "planner: `planner.name` must be one of ", "planner.name"),
            (layers("", "jps", &["map.a=1"]), "parameters: there is no field `map.a`", "map.a"),
            (
                layers("[hsta]\nname = \"jps\"", "hsta", &[]),
                "my.toml: the name of hsta cannot be set",
                "hsta",
            ),
            (
                layers("", "hsta", &["hsta.l1=1"]),
                "parameters: hsta: there is no field `planner.l1`",
                "hsta.l1",
            ),
            (layers("", "ratio-astar", &["ratio-astar.x=0"]), "planner.x must be", "planner.x"),
        ] {
            let error = laid(&layers, &[]).unwrap_err();
            assert!(error.to_string().starts_with(message), "{error}");
            assert_eq!(error.path, path, "{error}");
        }
    }
}
