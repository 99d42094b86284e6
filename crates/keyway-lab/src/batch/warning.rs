//! Likely mistakes in a batch.

use std::path::PathBuf;
use thiserror::Error;

/// Likely mistake in a batch, which is driven nevertheless.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BatchWarning {
    /// A scene has several seeds but no randomness.
    #[error("{scene}: nothing in it is random; every seed is the same run")]
    NotRandom {
        /// The scene.
        scene: String,
    },
    /// The system cannot prevent other programs from writing results at the same time.
    #[error(
        "{}: files cannot be locked here; see to it that nobody else writes there",
        folder.display()
    )]
    Unguarded {
        /// The folder.
        folder: PathBuf,
    },
}
