//! Errors of snapshots.

use super::NavigateError;
use crate::ConfigError;
use thiserror::Error;

/// Version of the snapshot format.
pub(super) const FORM: u32 = 1;

/// Reason why a snapshot cannot be restored.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// The snapshot has another format.
    #[error("the snapshot has format {0}; this version reads format {form}", form = FORM)]
    Form(u32),
    /// The robot or the stack of the snapshot cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// One part contradicts the others.
    #[error(
        "`{0}` of the snapshot contradicts its other parts: the snapshot was edited, or belongs to \
         another robot"
    )]
    Contradiction(&'static str),
}

impl NavigateError {
    /// The error for a map for which no navigator can be built.
    pub(super) fn into_restore(self) -> RestoreError {
        match self {
            Self::Config(error) => error.into(),
            _ => RestoreError::Contradiction("map"),
        }
    }
}
