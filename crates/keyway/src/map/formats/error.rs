//! Errors of reading and writing map files.

use super::{ImageError, MovingAiError, RosMapError, ScenarioError, TooManyCells};
use crate::file_error::{ReadError, WriteError};
use std::path::PathBuf;
use thiserror::Error;

/// Error of reading or writing a map file: the file, and the reason.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MapFileError {
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Writing failed.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file extension that belongs to no format.
    #[error("{}: expected a file name that ends in .yaml, .yml, .map, .pgm or .png", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// A file name that cannot be written into a YAML file.
    #[error("{}: expected a file name in UTF-8, to write it into the YAML file", path.display())]
    ImageName {
        /// The image file.
        path: PathBuf,
    },
    /// A placement (resolution and origin) for a map that has its own.
    #[error("{}: the YAML file already contains the map's resolution and origin; do not give them again", path.display())]
    Placement {
        /// The YAML file.
        path: PathBuf,
    },
    /// Error in the YAML file of a map.
    #[error("{}: {reason}", path.display())]
    RosMap {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: RosMapError,
    },
    /// Error in an image, alone or named by a YAML file.
    #[error("{}: {reason}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: ImageError,
    },
    /// Error in a MovingAI map.
    #[error("{}: {reason}", path.display())]
    MovingAi {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: MovingAiError,
    },
    /// Error in MovingAI scenarios.
    #[error("{}: {reason}", path.display())]
    Scenarios {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: ScenarioError,
    },
}

impl MapFileError {
    /// The size of a map that was rejected for its number of cells, for callers that can raise
    /// the limit.
    pub const fn too_many_cells(&self) -> Option<&TooManyCells> {
        match self {
            Self::Image { reason: ImageError::TooManyCells(found), .. }
            | Self::MovingAi { reason: MovingAiError::TooManyCells(found), .. } => Some(found),
            _ => None,
        }
    }
}
