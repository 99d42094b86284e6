//! The formats of map files and their extensions.

use super::MapFileError;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// The formats of map files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MapFormat {
    /// YAML and image, as read by the ROS map server.
    Ros,
    /// `.map` of the MovingAI benchmarks.
    MovingAi,
    /// A PGM image alone.
    Pgm,
    /// A PNG image alone.
    Png,
}

impl MapFormat {
    /// The format for the extension of a file, in upper or lower case.
    pub fn from_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "yaml" | "yml" => Some(Self::Ros),
            "map" => Some(Self::MovingAi),
            "pgm" => Some(Self::Pgm),
            "png" => Some(Self::Png),
            _ => None,
        }
    }

    pub(super) fn of(path: &Path) -> Result<Self, MapFileError> {
        Self::from_path(path).ok_or_else(|| MapFileError::Extension { path: path.to_owned() })
    }
}

impl fmt::Display for MapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ros => "ROS map",
            Self::MovingAi => "MovingAI map",
            Self::Pgm => "PGM image",
            Self::Png => "PNG image",
        })
    }
}
