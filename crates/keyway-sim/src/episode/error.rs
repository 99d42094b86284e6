//! Errors of runs.

use crate::sim::{SimError, WorldError};
use keyway::ConfigError;
use keyway::navigate::NavigateError;
use thiserror::Error;

/// Reason why an episode cannot be run. A start without a route to the goal is not an error but a
/// report.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EpisodeError {
    /// The robot, the stack, the start or the goal cannot be used.
    #[error(transparent)]
    Navigate(#[from] NavigateError),
    /// The obstacles cannot be used.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The map layers cannot be derived.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The start's heading or the rules cannot be used.
    #[error(transparent)]
    Sim(#[from] SimError),
}

/// Reason why the robots of a [`Team`](super::Team) cannot be driven.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{why}", robot.map_or_else(String::new, |index| format!("robot {index}: ")))]
pub struct TeamError {
    /// Index of the robot; `None` where no single one is to blame.
    pub robot: Option<usize>,
    /// Error of the robot or the team.
    #[source]
    pub why: EpisodeError,
}

impl TeamError {
    pub(super) fn of_robot(index: usize, why: impl Into<EpisodeError>) -> Self {
        Self { robot: Some(index), why: why.into() }
    }

    pub(super) fn of_all(why: impl Into<EpisodeError>) -> Self {
        Self { robot: None, why: why.into() }
    }
}
