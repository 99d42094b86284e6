//! Errors of scenes that are generated from files.

use super::table::TableError;
use keyway::ConfigError;
use keyway::files::{ConfigFileError, did_you_mean};
use keyway_sim::episode::EpisodeError;
use keyway_sim::scene_files::SceneError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why scenes cannot be generated. Fields are those of the request.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ScenesError {
    /// A table cannot be used.
    #[error("{reason}")]
    Table {
        /// The field that names the table.
        field: &'static str,
        /// Error of the table.
        reason: TableError,
    },
    /// The cylinders of a BARN world make no scene.
    #[error("world {world}: {reason}")]
    Cylinders {
        /// Number of the world.
        world: u32,
        /// Error of the scene.
        reason: SceneError,
    },
    /// A `DynaBARN` world has a cylinder that does not move.
    #[error("world {world}: `{plugin}` has no key frames")]
    NoKeyFrames {
        /// Number of the world.
        world: u32,
        /// Name of the cylinder.
        plugin: String,
    },
    /// A cylinder of a `DynaBARN` world cannot be used.
    #[error("world {world}, `{plugin}`: {reason}")]
    KeyFrames {
        /// Number of the world.
        world: u32,
        /// Name of the cylinder.
        plugin: String,
        /// Error of its motion.
        reason: ConfigError,
    },
    /// A wall is invalid. All walls are boxes, so this does not happen.
    #[error(transparent)]
    Wall(ConfigError),
    /// A pair names a map that does not exist.
    #[error("{}: pair {pair}, counted from 0: there is no map {}", pairs.display(), map.display())]
    NoMap {
        /// The table of pairs.
        pairs: PathBuf,
        /// The pair, from 0.
        pair: usize,
        /// Path of the map.
        map: PathBuf,
    },
    /// A pair makes no scene.
    #[error("pair {pair}, counted from 0: {reason}")]
    Pair {
        /// The pair, from 0.
        pair: usize,
        /// Error of the scene.
        reason: SceneError,
    },
    /// A pair is given twice: without other obstacles, a batch would drive the same run twice, and
    /// count both.
    #[error(
        "{}: pairs {first} and {pair}, counted from 0, are the same: give each pair once, and drive it with several seeds \
         (`batch --seeds`)",
        pairs.display()
    )]
    SamePair {
        /// The table of pairs.
        pairs: PathBuf,
        /// The pair, from 0.
        pair: usize,
        /// The earlier one, from 0.
        first: usize,
    },
    /// The system cannot resolve a path.
    #[error("{}: {reason}", path.display())]
    Path {
        /// The field that has the path.
        field: &'static str,
        /// The path.
        path: PathBuf,
        /// Error of the system.
        reason: io::Error,
    },
    /// The path of a file is no text, so a scene cannot hold it.
    #[error("{}: the path is not UTF-8, so a scene cannot refer to this file", path.display())]
    Unnameable {
        /// The file.
        path: PathBuf,
    },
    /// The robot cannot be used.
    #[error(transparent)]
    Robot(ConfigFileError),
    /// A requested name does not exist.
    #[error(
        "there is no {what} `{name}`; expected one of {}{}",
        known.join(", "),
        did_you_mean(name, known.iter().copied())
    )]
    Unknown {
        /// The kind of thing, such as a reconstruction.
        what: &'static str,
        /// The name.
        name: String,
        /// All names.
        known: Vec<&'static str>,
    },
    /// A narrow place makes no scene. All robots and places that are drawn are valid, so this
    /// does not happen.
    #[error(transparent)]
    Narrow(SceneError),
    /// Fewer maps fit a paper than were requested.
    #[error("{name}: only {found} of {tried} maps fit; request at most {found}")]
    TooFew {
        /// The reconstruction.
        name: &'static str,
        /// Number of maps that fit.
        found: usize,
        /// Number of maps that were tried.
        tried: u64,
    },
    /// A baseline cannot be used. A test makes all scenes, so this does not happen.
    #[error(transparent)]
    Baseline(EpisodeError),
    /// A reconstruction makes no scene. A test makes all scenes, so this does not happen.
    #[error(transparent)]
    Reconstruction(SceneError),
}

impl ScenesError {
    /// Returns the field of the request that is at fault; `None` if no field is.
    pub const fn field(&self) -> Option<&'static str> {
        Some(match self {
            Self::Table { field, .. } | Self::Path { field, .. } => field,
            Self::Cylinders { .. } => "cylinders",
            Self::NoKeyFrames { .. } => "worlds",
            Self::KeyFrames { .. } => "key_frames",
            Self::NoMap { .. }
            | Self::SamePair { .. }
            | Self::Pair { .. }
            | Self::Unnameable { .. } => "pairs",
            Self::Robot(_) => "robot",
            Self::Unknown { .. } => "names",
            Self::TooFew { .. } => "count",
            Self::Wall(_) | Self::Baseline(_) | Self::Reconstruction(_) | Self::Narrow(_) => {
                return None;
            }
        })
    }

    /// Returns a function that assigns an error of a table to its field.
    pub(super) fn of_table(field: &'static str) -> impl FnOnce(TableError) -> Self {
        move |reason| Self::Table { field, reason }
    }
}
