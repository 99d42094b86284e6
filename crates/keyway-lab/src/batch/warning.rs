//! Likely mistakes in a batch.

use std::path::PathBuf;
use thiserror::Error;

/// Likely mistake in a batch, which is driven nevertheless.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BatchWarning {
    /// A scene has several seeds but no randomness.
    #[error("{scene}: nothing in the scene is random, so every seed gives the same run")]
    NotRandom {
        /// The scene.
        scene: String,
    },
    /// The system cannot prevent other programs from writing results at the same time.
    #[error(
        "{}: files cannot be locked here; make sure that no other program writes here",
        folder.display()
    )]
    Unguarded {
        /// The folder.
        folder: PathBuf,
    },
}
