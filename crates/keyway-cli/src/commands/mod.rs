//! The commands: each takes its arguments, calls the library, and writes what came out.

pub(crate) mod bench;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod list;
pub(crate) mod map;
pub(crate) mod navigate;
mod optimum;
pub(crate) mod plan;
pub(crate) mod prepare;

use crate::error::{CliError, Kind};
use keyway::map::SearchMap;
use keyway::plan::{GlobalPlanner, PlanError, PlannerConfig};

/// How a command that was not refused ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    /// Exit code 0.
    Success,
    /// There is no path, the goal was not reached, or an answer was wrong. Exit code 1.
    Failure,
}

impl Done {
    pub(crate) const fn when(succeeded: bool) -> Self {
        if succeeded { Self::Success } else { Self::Failure }
    }
}

/// Prints text and a line break.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    crate::output::print(&format!("{text}\n"))
}

/// A planner for a map, which is prepared if the planner needs it.
pub(crate) fn build_planner(
    planner: &PlannerConfig,
    map: &SearchMap,
) -> Result<Box<dyn GlobalPlanner + Send + Sync>, CliError> {
    planner.build(map).map_err(|error| match error {
        PlanError::Parameter { field, .. } => {
            CliError::new(Kind::Config, format!("planner.{error}"))
                .field(format!("planner.{field}"))
        }
        error => CliError::new(Kind::Config, error).field("planner.name"),
    })
}
