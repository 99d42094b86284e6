//! Errors of a reproduction.

use super::LEAST_MAPS;
use crate::claims::Claim;
use crate::results::ResultsError;
use keyway_sim::episode::EpisodeError;
use thiserror::Error;

/// Reason why claims cannot be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// There is no claim of this name.
    #[error(
        "there is no claim `{name}`; expected a claim such as S0-1, a paper (s0, s1, s2, s4) or all; the \
         claims are {}",
        Claim::all().map(|claim| claim.id).collect::<Vec<_>>().join(", ")
    )]
    NoClaim {
        /// The name.
        name: String,
    },
    /// There are too few maps for an interval.
    #[error("`maps` must be at least {LEAST_MAPS}, got {maps}")]
    TooFewMaps {
        /// Number of maps.
        maps: usize,
    },
    /// A method cannot be used. A test measures every experiment, so this does not happen.
    #[error(transparent)]
    Experiment(#[from] EpisodeError),
    /// An experiment has no map of this kind. Only existing kinds are measured, so this does not
    /// happen.
    #[error("{experiment} has no such map")]
    NoMap {
        /// The experiment.
        experiment: &'static str,
    },
    /// A result cannot be written, or those of an earlier run cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The observer stopped the measurement.
    #[error("stopped before the end")]
    Stopped,
}

impl ReproduceError {
    /// Returns the field of the request that is at fault; `None` if no field is.
    pub const fn field(&self) -> Option<&'static str> {
        match self {
            Self::NoClaim { .. } => Some("claims"),
            Self::TooFewMaps { .. } => Some("maps"),
            _ => None,
        }
    }
}
