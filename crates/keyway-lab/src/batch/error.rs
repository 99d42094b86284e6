//! Errors of batches.

use super::PartsError;
use super::limits::SEEDS;
use crate::results::ResultsError;
use keyway::file_error::system_error_in_words;
use keyway::files::{ConfigFileError, LayerError, RobotChangeError};
use keyway::map::formats::MapFileError;
use keyway_sim::episode::EpisodeError;
use keyway_sim::scene_files::{SceneError, SceneFileError};
use std::error::Error;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a batch cannot be driven, or batches cannot be merged.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BatchError {
    /// `scenes` is empty.
    #[error("scenes must name at least one scene")]
    NoScenes,
    /// `parts` is empty.
    #[error("parts must name at least one folder")]
    NoParts,
    /// `out` is empty.
    #[error("out must name a folder")]
    NoOut,
    /// `seeds` is out of range.
    #[error("seeds must be a whole number from {} to {}, got {found}", SEEDS.start(), SEEDS.end())]
    Seeds {
        /// Given number.
        found: u64,
    },
    /// The folder `out` holds runs of another batch.
    #[error(
        "{} holds runs that this batch does not have, such as {run}, and they would be lost; give another folder, or remove this one first",
        folder.display()
    )]
    OtherRuns {
        /// The folder.
        folder: PathBuf,
        /// One of its runs.
        run: String,
    },
    /// `jobs` is 0.
    #[error("jobs must be at least 1")]
    NoJobs,
    /// `stacks` names a stack twice.
    #[error("the stack `{stack}` is given twice")]
    StackTwice {
        /// The stack.
        stack: String,
    },
    /// Two of the `scenes` have the same name.
    #[error(
        "two scenes are named `{scene}`, {} and {}; give each file or folder once, and files of the same name through a folder that contains both",
        paths[0].display(),
        paths[1].display()
    )]
    SceneTwice {
        /// The name.
        scene: String,
        /// Their files.
        paths: [PathBuf; 2],
    },
    /// Two of the `scenes` have the same name, and one of them is in memory.
    #[error("two scenes are named `{scene}`; one of them needs another name")]
    NameTwice {
        /// The name.
        scene: String,
    },
    /// A scene in memory has no name.
    #[error("the name of a scene must not be empty")]
    NoName,
    /// A folder of `scenes` cannot be read.
    #[error("{}: {}", path.display(), system_error_in_words(reason))]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the operating system.
        reason: io::Error,
    },
    /// A folder of `scenes` and its subfolders hold no scene.
    #[error("{}: there is no scene (*.toml) in this folder and its subfolders; give a scene file or a folder with scene files", path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A file of `scenes` cannot be used.
    #[error(transparent)]
    Scene(SceneFileError),
    /// A folder of `scenes` holds another file, such as a stack, to which no scene refers.
    #[error("{0}; move the file to another folder, or give the scenes one by one")]
    OtherFile(#[source] SceneFileError),
    /// `disturbances` cannot be used.
    #[error(transparent)]
    Disturbances(SceneFileError),
    /// `robot`, or the robot of a scene, cannot be used.
    #[error(transparent)]
    Robot(ConfigFileError),
    /// A value of a robot in `set` cannot be used.
    #[error("of the robot: {0}")]
    RobotValue(RobotChangeError),
    /// A parameter in `set` cannot be used.
    #[error(transparent)]
    Set(Box<LayerError>),
    /// One of the `stacks`, or the stack of a scene, cannot be used.
    #[error(transparent)]
    Stack(ConfigFileError),
    /// The map of a scene cannot be read.
    #[error(transparent)]
    Map(#[from] MapFileError),
    /// The world of a scene cannot be created.
    #[error("{scene}: {reason}")]
    World {
        /// The scene.
        scene: String,
        /// Error of the world.
        reason: SceneError,
    },
    /// A run cannot be executed.
    #[error("{scene}, {stack}, seed {seed}: {reason}")]
    Run {
        /// The scene.
        scene: String,
        /// The stack.
        stack: String,
        /// The seed.
        seed: u64,
        /// Error of the robots.
        reason: EpisodeError,
    },
    /// A file that is no record has the name of a record that is to be written to `out`.
    #[error("{}: this file is not a record of a run and is not overwritten; move it away", path.display())]
    RecordInTheWay {
        /// The file.
        path: PathBuf,
    },
    /// `out` is one of the `parts`.
    #[error("{} is one of the folders to merge; choose another one", out.display())]
    OutIsPart {
        /// The folder.
        out: PathBuf,
    },
    /// The `parts` cannot be merged.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// Results cannot be written to `out`.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(Box<dyn Error + Send + Sync>),
    /// The observer stopped the batch.
    #[error("stopped before the end")]
    Stopped,
}

impl BatchError {
    /// Name of the request's field that is at fault; `None` if no single field is.
    pub const fn field(&self) -> Option<&'static str> {
        match self {
            Self::NoScenes
            | Self::SceneTwice { .. }
            | Self::NameTwice { .. }
            | Self::NoName
            | Self::Folder { .. }
            | Self::EmptyFolder { .. }
            | Self::Scene(_)
            | Self::OtherFile(_)
            | Self::World { .. } => Some("scenes"),
            Self::NoParts | Self::Parts(_) => Some("parts"),
            Self::NoOut
            | Self::OutIsPart { .. }
            | Self::OtherRuns { .. }
            | Self::RecordInTheWay { .. }
            | Self::Results(_) => Some("out"),
            Self::Seeds { .. } => Some("seeds"),
            Self::NoJobs => Some("jobs"),
            Self::StackTwice { .. } | Self::Stack(_) => Some("stacks"),
            Self::Disturbances(_) => Some("disturbances"),
            Self::Robot(_) => Some("robot"),
            Self::RobotValue(_) | Self::Set(_) => Some("set"),
            Self::Map(_) | Self::Run { .. } | Self::Picture(_) | Self::Stopped => None,
        }
    }
}
