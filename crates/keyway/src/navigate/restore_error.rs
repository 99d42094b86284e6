//! Errors of snapshots.

use super::NavigateError;
use crate::ConfigError;
use thiserror::Error;

/// Number of the form in which snapshots are stored.
pub(super) const FORM: u32 = 1;

/// Reason why a snapshot cannot be restored.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// It was stored in another form.
    #[error("the snapshot has form {0}, and this version reads form {form}", form = FORM)]
    Form(u32),
    /// Its robot or its stack cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// One part contradicts the others.
    #[error(
        "`{0}` of the snapshot contradicts its other parts: it was changed, or is of another robot"
    )]
    Contradiction(&'static str),
}

impl NavigateError {
    /// The error of a map that no navigator can be made for.
    pub(super) fn into_restore(self) -> RestoreError {
        match self {
            Self::Config(error) => error.into(),
            _ => RestoreError::Contradiction("map"),
        }
    }
}
