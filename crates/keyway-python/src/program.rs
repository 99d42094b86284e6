//! The program `keyway`, and the names of the available choices.

use crate::errors::bad_value;
use keyway::guide::GuideConfig;
use keyway::local::LocalConfig;
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use pyo3::prelude::*;
use std::ffi::OsString;

/// Returns the available names of `planners`, `smoothers`, `guides`, `local-planners`, `stacks`
/// or `robots`. The command `keyway list NAME` describes each of them and its parameters.
///
/// >>> import keyway
/// >>> keyway.names("robots")[:3]
/// ['small', 'jackal', 'paper']
#[pyfunction]
pub(crate) fn names(kind: &str) -> PyResult<Vec<&'static str>> {
    Ok(match kind {
        "planners" => PlannerConfig::NAMES.to_vec(),
        "smoothers" => SmootherConfig::NAMES.to_vec(),
        "guides" => GuideConfig::NAMES.to_vec(),
        "local-planners" => LocalConfig::NAMES.to_vec(),
        "stacks" => Stack::NAMES.to_vec(),
        "robots" => Robot::NAMES.to_vec(),
        _ => {
            let kinds = "planners, smoothers, guides, local-planners, stacks, robots";
            return Err(bad_value(format!("kind: expected one of {kinds}, got `{kind}`")));
        }
    })
}

/// Runs the program `keyway` with the words of a command line and returns its exit code.
///
/// >>> import keyway
/// >>> keyway.program(["map", "info", "nowhere.map", "--format", "xml"])
/// 2
#[pyfunction]
pub(crate) fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    let argv: Vec<OsString> = std::iter::once(OsString::from("keyway")).chain(words).collect();
    py.detach(|| keyway_cli::run(&argv))
}
