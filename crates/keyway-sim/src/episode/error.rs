//! Errors of runs.

use crate::sim::{SimError, WorldError};
use keyway::ConfigError;
use keyway::navigate::NavigateError;
use thiserror::Error;

/// Reason why an episode cannot be run. A start without a route to the goal is a report, not an
/// error.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{why}", robot.map_or_else(String::new, |index| format!("robot {index}: ")))]
pub struct EpisodeError {
    /// Index of the robot; `None` if the error concerns no single robot, or there is only one.
    pub robot: Option<usize>,
    /// Error of the robot or the episode.
    #[source]
    pub why: RunError,
}

/// Reason why a robot cannot drive.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The robot, the stack, the start or the goal is invalid.
    #[error(transparent)]
    Navigate(#[from] NavigateError),
    /// The obstacles are invalid.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The map layers cannot be derived.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The start's heading or the rules are invalid.
    #[error(transparent)]
    Sim(#[from] SimError),
}

impl EpisodeError {
    pub(super) fn of_robot(robot: Option<usize>, why: impl Into<RunError>) -> Self {
        Self { robot, why: why.into() }
    }

    pub(super) fn of_all(why: impl Into<RunError>) -> Self {
        Self::of_robot(None, why)
    }
}

impl From<ConfigError> for EpisodeError {
    fn from(error: ConfigError) -> Self {
        Self::of_all(error)
    }
}

impl From<NavigateError> for EpisodeError {
    fn from(error: NavigateError) -> Self {
        Self::of_all(error)
    }
}
