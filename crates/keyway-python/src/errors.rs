//! Converts errors of the library into Python exceptions.

use keyway::file_error::ReadError;
use keyway::files::{ConfigFileError, ParameterError, TextFileError};
use keyway::map::formats::MapFileError;
use keyway::map::{BlockedBy, Hindrance, Separation};
use keyway::navigate::NavigateError;
use keyway::plan::{Advice, PlanError, PlannerConfig};
use keyway::route::NoPath as Separated;
use keyway_sim::scene_files::{SceneError, SceneFileError};
use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyUserWarning, PyValueError,
};
use pyo3::types::PyAnyMethods;
use pyo3::{PyErr, PyResult, Python};
use std::ffi::CString;
use std::fmt::Display;
use std::io::ErrorKind;

pyo3::import_exception!(keyway.errors, NoPath);
pyo3::import_exception!(keyway.errors, NoRoom);
pyo3::import_exception!(keyway.errors, Missed);
pyo3::import_exception!(keyway.errors, BudgetExhausted);

/// Issues a `UserWarning` about a likely mistake.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text).map_err(bad_value)?;
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)
}

/// Raises `MemoryError` if the allocation of so many bytes would fail: a failed allocation later
/// would abort the process.
pub(crate) fn check_memory(bytes: u64) -> PyResult<()> {
    let missing = || {
        let gib = bytes as f64 / (1_u64 << 30) as f64;
        PyMemoryError::new_err(format!("a map of this size needs {gib:.1} GiB of memory"))
    };
    let bytes = usize::try_from(bytes).map_err(|_| missing())?;
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| missing())
}

/// Error of an invalid value.
pub(crate) fn bad_value(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Message of a query without a path in a comparison, with the argument that helps.
pub(crate) fn why_without_path(error: &PlanError) -> String {
    // In a comparison, parameters are those of the planner of this name.
    let advice = error.advice();
    let table = advice.as_ref().map_or("planner", |advice| advice.planner);
    format!("{error}{}", remedy(error, table))
}

/// Exception of a failed plan, with the message of the library and the argument that helps.
pub(crate) fn plan_error(error: &PlanError) -> PyErr {
    plan_error_saying(error, format!("{error}{}", remedy(error, "planner")))
}

/// Exception of a start or goal that cannot be used.
pub(crate) fn no_room_error(text: &str, error: &PlanError) -> PyErr {
    NoRoom::new_err(format!("{text}{}", remedy(error, "planner")))
}

/// Exception of a start and a goal that no path joins.
pub(crate) fn no_path_error(why: &Separated, planner: &PlannerConfig) -> PyErr {
    let Separated { separation, .. } = why;
    let remedy = match separation {
        _ if why.is_joined_through_unknown => {
            format!("; there is one through unknown space: pass {THROUGH_UNKNOWN}")
        }
        Separation::Apart { meet_at_corners: true, .. } => {
            let fields = toml::Table::try_from(planner);
            let has_rule = fields.is_ok_and(|fields| fields.contains_key("corners"));
            let planner = if has_rule { "" } else { r#"planner="astar", "# };
            format!(
                r#"; to cut corners, pass {planner}parameters={{"planner": {{"corners": "allow"}}}}"#
            )
        }
        _ => String::new(),
    };
    NoPath::new_err(format!("{separation}{remedy}"))
}

/// The argument with which unknown cells are free.
const THROUGH_UNKNOWN: &str = r#"parameters={"map": {"unknown": "free"}}"#;

/// The remedy for a failed plan as an argument: a clause that follows the error. Parameters of the
/// planner are in the table of this name.
fn remedy(error: &PlanError, table: &str) -> String {
    match error {
        PlanError::Blocked {
            by: BlockedBy::Unknown | BlockedBy::Clearance { nearest: Hindrance::Unknown { .. }, .. },
            ..
        } => format!("; for paths through unknown space, pass {THROUGH_UNKNOWN}"),
        PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        } => r#"; to lift it within 1 m of start and goal, pass parameters={"map": {"free_ends_m": 1}}"#
            .to_owned(),
        error => error.advice().map_or_else(String::new, |advice| {
            let Advice { purpose, parameter, value, .. } = advice;
            let is_number = value.parse::<f64>().is_ok();
            let value = if is_number { value } else { format!("\"{value}\"") };
            format!(
                r#"; {purpose}, pass parameters={{"{table}": {{"{parameter}": {value}}}}}"#
            )
        }),
    }
}

fn plan_error_saying(error: &PlanError, text: String) -> PyErr {
    match error {
        PlanError::OutsideMap { .. }
        | PlanError::Blocked { .. }
        | PlanError::Constrained { .. } => NoRoom::new_err(text),
        PlanError::NoPath { .. } => NoPath::new_err(text),
        PlanError::Missed { .. } => Missed::new_err(text),
        PlanError::BudgetExhausted { .. } => BudgetExhausted::new_err(text),
        _ => bad_value(text),
    }
}

/// Exception of a navigator that cannot accept a goal. Its attribute `kind` is a number that
/// never changes.
pub(crate) fn navigate_error(error: &NavigateError) -> PyErr {
    let remedy = match error {
        NavigateError::NoRoom { why: Hindrance::Unknown { .. }, .. } => {
            format!("; for paths through unknown space, pass {THROUGH_UNKNOWN}")
        }
        // Lifting it around start and goal is for plans, not for robots.
        NavigateError::Plan(PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        }) => String::new(),
        NavigateError::Plan(error) => self::remedy(error, "planner"),
        _ => String::new(),
    };
    navigate_error_saying(error, format!("{error}{remedy}"))
}

/// The same for a scene, which has no argument for parameters.
pub(crate) fn scene_navigate_error(error: &NavigateError) -> PyErr {
    navigate_error_saying(error, error.to_string())
}

fn navigate_error_saying(error: &NavigateError, text: String) -> PyErr {
    let raised = navigate_error_of(error, text);
    // The error is valid without the attribute, too.
    let _ = Python::attach(|py| raised.value(py).setattr("kind", error.kind()));
    raised
}

fn navigate_error_of(error: &NavigateError, text: String) -> PyErr {
    let mut cause = error;
    while let NavigateError::WayPoint { why, .. } = cause {
        cause = why;
    }
    match cause {
        NavigateError::NoRoom { .. }
        | NavigateError::StartTouches { .. }
        | NavigateError::GoalHeading { .. }
        | NavigateError::Misfit(_) => NoRoom::new_err(text),
        NavigateError::NoWay { .. } => NoPath::new_err(text),
        NavigateError::Plan(error) => plan_error_saying(error, text),
        _ => bad_value(text),
    }
}

/// Exception of an invalid map file.
pub(crate) fn map_error(error: &MapFileError) -> PyErr {
    match error {
        MapFileError::Read(read) => read_error(read, error),
        MapFileError::Write(_) => PyOSError::new_err(error.to_string()),
        _ => bad_value(error),
    }
}

/// Exception of an invalid scene.
pub(crate) fn scene_file_error(error: &SceneFileError) -> PyErr {
    match error {
        SceneFileError::Config(error) => config_file_error(error),
        _ => bad_value(error),
    }
}

/// Exception of an invalid robot or stack.
pub(crate) fn config_file_error(error: &ConfigFileError) -> PyErr {
    match error {
        ConfigFileError::File(TextFileError::Read(read)) => read_error(read, error),
        _ => bad_value(error),
    }
}

pub(crate) fn scene_error(error: &SceneError) -> PyErr {
    bad_value(error)
}

pub(crate) fn parameter_error(error: &ParameterError) -> PyErr {
    bad_value(error)
}

/// Exception of a missing or unreadable file.
fn read_error(error: &ReadError, whole: impl Display) -> PyErr {
    match error {
        ReadError::System { reason, .. } if reason.kind() == ErrorKind::NotFound => {
            PyFileNotFoundError::new_err(whole.to_string())
        }
        ReadError::System { .. } | ReadError::Folder { .. } => {
            PyOSError::new_err(whole.to_string())
        }
        _ => bad_value(whole),
    }
}
