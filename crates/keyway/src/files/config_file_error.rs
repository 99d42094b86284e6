//! Errors of files of robots, stacks and parameters.

use super::did_you_mean;
use super::{TextFileError, TomlError};
use crate::ConfigError;
use crate::navigate::Stack;
use crate::robot::Robot;
use std::path::PathBuf;
use thiserror::Error;

/// Error of a robot or stack file: the file, and the fault.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ConfigFileError {
    /// It cannot be read, or is no text.
    #[error(transparent)]
    File(#[from] TextFileError),
    /// Not the description of a robot, or not a stack.
    #[error("{}: {reason}", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: TomlError,
    },
    /// Neither the name of a bundled robot nor that of a file.
    #[error(
        "there is no robot `{name}`, expected one of {}, or a file{}",
        Robot::NAMES.join(", "), did_you_mean(name, Robot::NAMES)
    )]
    NoRobot {
        /// The name.
        name: String,
    },
    /// Neither the name of a stack nor that of a file.
    #[error(
        "there is no stack `{name}`, expected one of {}, or a file{}",
        Stack::NAMES.join(", "), did_you_mean(name, Stack::NAMES)
    )]
    NoStack {
        /// The name.
        name: String,
    },
    /// A value that cannot be used, or not with the robot.
    #[error("{}: {reason}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: ConfigError,
    },
}

impl ConfigFileError {
    /// Path of the field that is to blame; empty where it is the file, or its name.
    pub fn field(&self) -> &str {
        match self {
            Self::Toml { reason, .. } => &reason.field,
            Self::Value { reason, .. } => &reason.path,
            Self::File(_) | Self::NoRobot { .. } | Self::NoStack { .. } => "",
        }
    }
}
