//! Why a map file could not be read or written.

use super::{ImageError, MovingAiError, RosMapError, ScenarioError, TooManyCells};
use crate::file_error::{ReadError, WriteError};
use std::path::PathBuf;
use thiserror::Error;

/// Why a map file could not be read or written: the file, and what is wrong with it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MapFileError {
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Writing failed.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The extension names no format.
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
    /// A resolution and origin where they are known.
    #[error("{}: the YAML file says where the map lies, expected no placement for it", path.display())]
    Placement {
        /// The YAML file.
        path: PathBuf,
    },
    /// The YAML file of a map.
    #[error("{}: {reason}", path.display())]
    RosMap {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: RosMapError,
    },
    /// An image, alone or named by a YAML file.
    #[error("{}: {reason}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: ImageError,
    },
    /// A MovingAI map.
    #[error("{}: {reason}", path.display())]
    MovingAi {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: MovingAiError,
    },
    /// MovingAI scenarios.
    #[error("{}: {reason}", path.display())]
    Scenarios {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: ScenarioError,
    },
}

impl MapFileError {
    /// The size of a map that is refused for its many cells, for those who know how to allow more.
    pub const fn too_many_cells(&self) -> Option<&TooManyCells> {
        match self {
            Self::Image { reason: ImageError::TooManyCells(found), .. }
            | Self::MovingAi { reason: MovingAiError::TooManyCells(found), .. } => Some(found),
            _ => None,
        }
    }
}
