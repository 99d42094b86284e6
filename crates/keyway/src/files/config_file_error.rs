//! Errors of robot, stack and parameter files.

use super::did_you_mean;
use super::{TextFileError, TomlError};
use crate::ConfigError;
use crate::navigate::Stack;
use crate::robot::Robot;
use std::path::PathBuf;
use thiserror::Error;

/// Error of a robot, stack or parameter file: the file, and the fault.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ConfigFileError {
    /// The file cannot be read, or is not text.
    #[error(transparent)]
    File(#[from] TextFileError),
    /// Not TOML, or not a description of a robot or a stack.
    #[error("{}: {reason}", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: TomlError,
    },
    /// Neither a bundled robot nor a file.
    #[error(
        "there is no robot `{name}`, expected one of {}, or a file{}",
        Robot::NAMES.join(", "), did_you_mean(name, Robot::NAMES)
    )]
    NoRobot {
        /// The name.
        name: String,
    },
    /// Neither a stack's name nor a file.
    #[error(
        "there is no stack `{name}`, expected one of {}, or a file{}",
        Stack::NAMES.join(", "), did_you_mean(name, Stack::NAMES)
    )]
    NoStack {
        /// The name.
        name: String,
    },
    /// An invalid value, or one that does not fit the robot.
    #[error("{}: {reason}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: ConfigError,
    },
}

impl ConfigFileError {
    /// Path of the offending field; empty if it is the file, or its name.
    pub fn field(&self) -> &str {
        match self {
            Self::Toml { reason, .. } => &reason.field,
            Self::Value { reason, .. } => &reason.path,
            Self::File(_) | Self::NoRobot { .. } | Self::NoStack { .. } => "",
        }
    }
}
