//! Robot files, from a path or from memory.

use super::{ParameterFile, TextFileError, TomlError};
use super::{did_you_mean, file_text, from_toml, read_text};
use crate::ConfigError;
use crate::navigate::Stack;
use crate::robot::Robot;
use std::path::{Path, PathBuf};
use thiserror::Error;
use toml::{Table, Value};

/// More than any scene, robot, stack or file of parameters holds \[bytes\].
pub const MAX_TOML_BYTES: u64 = 16 << 20;

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
        /// What is wrong.
        reason: TomlError,
    },
    /// A robot without some of its fields.
    #[error("{}: missing fields `{}`", path.display(), fields.join("`, `"))]
    Missing {
        /// The file.
        path: PathBuf,
        /// The fields, as paths; more than one.
        fields: Vec<String>,
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
        /// What is wrong.
        reason: ConfigError,
    },
}

impl ConfigFileError {
    /// Path of the field that is to blame; empty where it is the file, or its name.
    pub fn field(&self) -> &str {
        match self {
            Self::Toml { reason, .. } => &reason.field,
            Self::Missing { fields, .. } => fields.first().map_or("", String::as_str),
            Self::Value { reason, .. } => &reason.path,
            Self::File(_) | Self::NoRobot { .. } | Self::NoStack { .. } => "",
        }
    }
}

/// A bundled robot, or one from a file (anything that looks like one), relative to `folder`.
///
/// # Errors
/// When there is no such robot; as for [`read_robot`].
pub fn find_robot(name: &str, folder: &Path) -> Result<Robot, ConfigFileError> {
    if let Some(robot) = Robot::by_name(name) {
        return Ok(robot);
    }
    match file_of(name, folder) {
        Some(path) => read_robot(&path),
        None => Err(ConfigFileError::NoRobot { name: name.to_owned() }),
    }
}

/// The path that a name stands for, where it looks like that of a file.
pub(super) fn file_of(name: &str, folder: &Path) -> Option<PathBuf> {
    let path = folder.join(name);
    let looks_like_file = path.extension().is_some() || name.contains('/') || path.is_file();
    looks_like_file.then_some(path)
}

/// Reads and checks a robot file.
///
/// # Errors
/// When the file cannot be read, or does not describe a robot that can be.
pub fn read_robot(path: &Path) -> Result<Robot, ConfigFileError> {
    robot_from_bytes(path, read_text(path, MAX_TOML_BYTES)?.as_bytes())
}

/// The same from memory; errors call the file `name`.
///
/// ```
/// use keyway::files::robot_from_bytes;
/// use std::path::Path;
/// let error = robot_from_bytes(Path::new("mine.toml"), b"cycle_s = \"fast\"\n").unwrap_err();
/// assert!(error.to_string().starts_with("mine.toml: line 1, column 11: `cycle_s`: "));
/// ```
///
/// # Errors
/// When the content does not describe a robot that can be.
pub fn robot_from_bytes(name: &Path, bytes: &[u8]) -> Result<Robot, ConfigFileError> {
    let text = file_text(name, bytes)?;
    let path = || name.to_owned();
    let robot: Robot = from_toml(text).map_err(|reason| {
        let tables = Table::try_from(Robot::small()).ok().zip(text.parse::<Table>().ok());
        match tables.map_or_else(Vec::new, |(whole, given)| missing_fields(&whole, &given)) {
            fields if reason.reason.starts_with("missing field") && fields.len() > 1 => {
                ConfigFileError::Missing { path: path(), fields }
            }
            _ => ConfigFileError::Toml { path: path(), reason },
        }
    })?;
    match robot.validate() {
        Ok(()) => Ok(robot),
        Err(reason) => Err(ConfigFileError::Value { path: path(), reason }),
    }
}

/// Reads a file of parameters: any part of a stack. Its values are checked when they are laid over
/// a stack ([`ParameterLayers::over`](super::ParameterLayers::over)).
///
/// # Errors
/// When the file cannot be read, or is not TOML.
pub fn read_parameters(path: &Path) -> Result<ParameterFile, ConfigFileError> {
    let table = from_toml(&read_text(path, MAX_TOML_BYTES)?)
        .map_err(|reason| ConfigFileError::Toml { path: path.to_owned(), reason })?;
    Ok(ParameterFile { name: path.display().to_string(), table })
}

/// What a robot file need not have.
const OPTIONAL: &str = "actuation_delay_s";

/// The fields of a whole table that another one does not give, as paths.
pub(super) fn missing_fields(whole: &Table, given: &Table) -> Vec<String> {
    fn walk(whole: &Table, given: Option<&Table>, path: &str, missing: &mut Vec<String>) {
        for (key, value) in whole {
            let (here, given) = (format!("{path}{key}"), given.and_then(|given| given.get(key)));
            match value {
                // A disc and a polygon have different fields.
                Value::Table(whole) if key != "footprint" => {
                    walk(whole, given.and_then(Value::as_table), &format!("{here}."), missing);
                }
                _ if given.is_none() && key != OPTIONAL => missing.push(here),
                _ => {}
            }
        }
    }
    let mut fields = Vec::new();
    walk(whole, Some(given), "", &mut fields);
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_are_found_by_name_or_as_files() {
        let folder = Path::new("/nowhere");
        assert_eq!(find_robot("jackal", folder).unwrap(), Robot::jackal());
        let file = find_robot("mine.toml", folder).unwrap_err();
        assert!(file.to_string().contains("/nowhere/mine.toml: there is no such file"), "{file}");
        let name = find_robot("hal", folder).unwrap_err().to_string();
        assert_eq!(
            name,
            "there is no robot `hal`, expected one of small, jackal, paper, or a file"
        );
    }

    #[test]
    fn errors_name_the_source() {
        let name = Path::new("a/b.toml");
        let robot = toml::to_string(&Robot::small()).unwrap();
        assert_eq!(robot_from_bytes(name, robot.as_bytes()).unwrap(), Robot::small());
        let small = robot.replace("cycle_s = 0.1", "cycle_s = -0.1");
        let errors = [
            robot_from_bytes(name, small.as_bytes()).unwrap_err().to_string(),
            robot_from_bytes(name, b"radius_m = ").unwrap_err().to_string(),
            robot_from_bytes(name, b"\xff").unwrap_err().to_string(),
            robot_from_bytes(name, b"cycle_s = 0.1").unwrap_err().to_string(),
        ];
        for error in &errors {
            assert!(error.starts_with("a/b.toml: "), "{error}");
        }
        assert!(errors[0].contains("cycle_s"), "{}", errors[0]);
        assert!(!errors[3].contains("actuation_delay_s"), "{}", errors[3]);
    }
}
