//! Converts errors of the library into Python exceptions.

use keyway::file_error::ReadError;
use keyway::files::{ConfigFileError, ParameterError, TextFileError};
use keyway::map::formats::MapFileError;
use keyway::map::{BlockedBy, Hindrance};
use keyway::navigate::NavigateError;
use keyway::plan::{Advice, PlanError};
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

/// Message of a query without a path in a comparison, with the parameter that helps.
pub(crate) fn why_without_path(error: &PlanError) -> String {
    let advice = match error {
        PlanError::Blocked {
            by: BlockedBy::Unknown | BlockedBy::Clearance { nearest: Hindrance::Unknown { .. }, .. },
            ..
        } => "; with the parameter `map.unknown` set to free, paths may lead through unknown space"
            .to_owned(),
        PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        } => "; to lift it within 1 m of start and goal, set the parameter `map.free_ends_m` to 1"
            .to_owned(),
        error => error.advice().map_or_else(String::new, |advice| {
            let Advice { purpose, planner, parameter, value, .. } = advice;
            format!("; {purpose}, set the parameter `{planner}.{parameter}` to {value}")
        }),
    };
    format!("{error}{advice}")
}

/// Exception of a failed plan, with the message of the library and the setting that helps.
pub(crate) fn plan_error(error: &PlanError) -> PyErr {
    let advice = error.advice().map_or_else(String::new, |advice| {
        let Advice { purpose, parameter, value, .. } = advice;
        format!("; {purpose}, set the parameter `planner.{parameter}` to {value}")
    });
    plan_error_saying(error, format!("{error}{advice}"))
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
    let raised = navigate_error_of(error);
    // The error is valid without the attribute, too.
    let _ = Python::attach(|py| raised.value(py).setattr("kind", error.kind()));
    raised
}

fn navigate_error_of(error: &NavigateError) -> PyErr {
    let text = error.to_string();
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
