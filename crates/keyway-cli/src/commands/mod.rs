//! The commands: each takes its arguments, calls the library, and writes the results.

pub(crate) mod batch;
pub(crate) mod bench;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod list;
pub(crate) mod man;
pub(crate) mod map;
pub(crate) mod navigate;
#[cfg(feature = "pdf")]
pub(crate) mod pdf;
pub(crate) mod plan;
pub(crate) mod prepare;
pub(crate) mod replay;
pub(crate) mod reproduce;
#[cfg(feature = "ros")]
pub(crate) mod ros;
pub(crate) mod scene;

pub(crate) use navigate::Moment;

use crate::error::{CliError, Kind};
use keyway::map::{BlockedBy, Hindrance, SearchMap};
use keyway::plan::{Advice, GlobalPlanner, PathEnd, PlanError, PlannerConfig};
use keyway::smooth::{Smoother, SmootherConfig};

/// Result of a command that was not refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    /// Exit code 0.
    Success,
    /// No path exists, the goal was not reached, or an answer was wrong. Exit code 1.
    Failure,
}

impl Done {
    pub(crate) const fn when(succeeded: bool) -> Self {
        if succeeded { Self::Success } else { Self::Failure }
    }
}

/// Prints text and a line break.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    crate::stdout::print(&format!("{text}\n"))
}

/// The option for the start or goal of a path.
pub(crate) const fn end_flag(end: PathEnd) -> &'static str {
    match end {
        PathEnd::Start => "--start",
        PathEnd::Goal => "--goal",
    }
}

/// Message of a failed plan, with a remedy.
pub(crate) fn why(error: &PlanError) -> String {
    format!("{error}{}", remedy(error))
}

/// The remedy as options of the command line: a clause that follows the error.
pub(crate) fn remedy(error: &PlanError) -> String {
    match error {
        PlanError::Blocked {
            by: BlockedBy::Unknown | BlockedBy::Clearance { nearest: Hindrance::Unknown { .. }, .. },
            ..
        } => format!("; {THROUGH_UNKNOWN}"),
        PlanError::Blocked {
            by: BlockedBy::Expansion { .. } | BlockedBy::Constraint { .. },
            ..
        } => "; to lift it within 1 m of start and goal, add --set map.free_ends_m=1".to_owned(),
        error => error.advice().map_or_else(String::new, |advice| {
            let Advice { purpose, planner, parameter, value, .. } = advice;
            format!("; {purpose}, add --set {planner}.{parameter}={value}")
        }),
    }
}

/// Remedy if unknown space counts as an obstacle.
pub(crate) const THROUGH_UNKNOWN: &str =
    "with --unknown free, paths may lead through unknown space";

/// Builds a planner for a map, and prepares the map if the planner needs it.
pub(crate) fn build_planner(
    planner: &PlannerConfig,
    map: &SearchMap,
) -> Result<Box<dyn GlobalPlanner + Send + Sync>, CliError> {
    planner.build(map).map_err(unusable_planner)
}

/// Error of a planner that is unusable for any query.
pub(crate) fn unusable_planner(error: PlanError) -> CliError {
    match error {
        PlanError::Config(error) => {
            let error = error.within("planner");
            CliError::new(Kind::Config, &error).field(error.path.as_str())
        }
        error => CliError::new(Kind::Config, error).field("planner.name"),
    }
}

/// Builds a smoother.
pub(crate) fn build_smoother(
    smoother: &SmootherConfig,
) -> Result<Box<dyn Smoother + Send + Sync>, CliError> {
    smoother.build().map_err(|error| {
        let error = error.within("smoother");
        CliError::new(Kind::Config, &error).field(error.path.as_str())
    })
}
