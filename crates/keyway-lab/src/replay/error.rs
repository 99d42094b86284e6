//! Errors of records.

use super::{Difference, SCHEMA};
use keyway::ConfigError;
use keyway::file_error::ReadError;
use keyway::map::formats::MapFileError;
use keyway_sim::report::Inputs;
use keyway_sim::scene_files::SceneError;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a record cannot be replayed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The record cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is not a record.
    #[error("{}: this is not a record of a run, as written by a batch: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Error of its content.
        reason: serde_json::Error,
    },
    /// The record has another format.
    #[error("{}: its schema is {found}; this program replays {SCHEMA}", path.display())]
    Schema {
        /// The record.
        path: PathBuf,
        /// Name of its format.
        found: String,
    },
    /// The scene of the record cannot be used.
    #[error("{}: {reason}", path.display())]
    Scene {
        /// The record.
        path: PathBuf,
        /// Error of the scene.
        reason: SceneError,
    },
    /// A robot of the record is invalid.
    #[error("{}: `{}` {}", path.display(), reason.path, reason.reason)]
    Robot {
        /// The record.
        path: PathBuf,
        /// Error of the robot.
        reason: ConfigError,
    },
    /// The record does not have the robots of its scene.
    #[error("{}: it must contain {}", path.display(), drivers(*robots))]
    Drivers {
        /// The record.
        path: PathBuf,
        /// Number of robots that the scene lists; 0 if it has one and no list.
        robots: usize,
    },
    /// The record has neither a map file nor a generated map.
    #[error("{}: it contains neither the path of its map nor a generated map", path.display())]
    NoMap {
        /// The record.
        path: PathBuf,
    },
    /// The map cannot be read.
    #[error(transparent)]
    Map(#[from] MapFileError),
    /// The map is not that of the recorded run.
    #[error(
        "{}: the map {} has changed since: its digest was {recorded} and is {found} now",
        path.display(),
        map.display()
    )]
    OtherMap {
        /// The record.
        path: PathBuf,
        /// The map.
        map: PathBuf,
        /// Digest of the map in the record.
        recorded: String,
        /// Digest of the map that was read.
        found: String,
    },
    /// The run differs from the recorded one.
    #[error(
        "{}: the replayed run differs from the record: {}{difference}; it was recorded by keyway \
         {recorded_by} and replayed by keyway {}",
        path.display(),
        robot.map_or_else(String::new, |index| format!("robot {index}: ")),
        Inputs::VERSION
    )]
    OtherRun {
        /// The record.
        path: PathBuf,
        /// Index of the robot whose run differs, if there are several.
        robot: Option<usize>,
        /// The first difference.
        difference: Difference,
        /// Version of Keyway that recorded the run.
        recorded_by: String,
    },
}

/// Returns the fields that list the robots and their stacks.
fn drivers(robots: usize) -> String {
    if robots == 0 {
        return "`robot` and `config`, because the scene has one robot".to_owned();
    }
    format!(
        "`robots`, one for each robot of the scene ({robots}), and neither `robot` nor `config`"
    )
}
