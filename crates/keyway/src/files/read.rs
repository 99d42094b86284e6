//! Reading files of robots, stacks and parameters, and other text files.

use super::{ConfigFileError, MAX_TOML_BYTES, ParameterFile, TextFileError};
use super::{file_text, parameters_from_bytes, robot_from_bytes, robot_in_place, stack_from_bytes};
use crate::file_system::read_file;
use crate::navigate::Stack;
use crate::robot::Robot;
use std::path::{Path, PathBuf};

/// A bundled robot, or one from a file (if the name looks like one) relative to `folder`, or one
/// that is described inline, as in a robot file: `{ like = "jackal", cycle_s = 0.1 }`.
///
/// # Errors
/// Returns [`ConfigFileError`] if there is no such robot; otherwise as for [`read_robot`].
pub fn find_robot(name: &str, folder: &Path) -> Result<Robot, ConfigFileError> {
    if let Some(robot) = Robot::by_name(name) {
        return Ok(robot);
    }
    if name.trim_start().starts_with('{') {
        return robot_in_place(name);
    }
    match file_of(name, folder) {
        Some(path) => read_robot(&path),
        None => Err(ConfigFileError::NoRobot { name: name.to_owned() }),
    }
}

/// A stack by its name, with the parameters for a robot; or one from a file (if the name looks
/// like one), relative to `folder`, with the parameters of the file.
///
/// # Errors
/// Returns [`ConfigFileError`] if there is no such stack; otherwise as for [`read_stack`].
pub fn find_stack(name: &str, folder: &Path, robot: &Robot) -> Result<Stack, ConfigFileError> {
    if let Some(stack) = Stack::by_name(name, robot) {
        return Ok(stack);
    }
    match file_of(name, folder) {
        Some(path) => read_stack(&path, robot),
        None => Err(ConfigFileError::NoStack { name: name.to_owned() }),
    }
}

/// The path that a name stands for, if it looks like a file.
fn file_of(name: &str, folder: &Path) -> Option<PathBuf> {
    let path = folder.join(name);
    let looks_like_file = path.extension().is_some() || name.contains('/') || path.is_file();
    looks_like_file.then_some(path)
}

/// Reads and checks a robot file.
///
/// # Errors
/// Returns [`ConfigFileError`] if the file cannot be read, or does not describe a valid robot.
pub fn read_robot(path: &Path) -> Result<Robot, ConfigFileError> {
    robot_from_bytes(path, &read_toml(path)?)
}

/// Reads a stack file, all of a [`Stack`] as TOML, and checks it for a robot.
///
/// # Errors
/// Returns [`ConfigFileError`] if the file cannot be read, or does not hold a stack that suits the
/// robot.
pub fn read_stack(path: &Path, robot: &Robot) -> Result<Stack, ConfigFileError> {
    stack_from_bytes(path, &read_toml(path)?, robot)
}

/// Reads a file of parameters: any part of a stack. Its values are checked when they are laid over
/// a stack ([`ParameterLayers::over`](super::ParameterLayers::over)).
///
/// # Errors
/// Returns [`ConfigFileError`] if the file cannot be read, or is not TOML.
pub fn read_parameters(path: &Path) -> Result<ParameterFile, ConfigFileError> {
    parameters_from_bytes(path, &read_toml(path)?)
}

/// Reads the content of a TOML file.
///
/// # Errors
/// Returns [`TextFileError`] if the file cannot be read, or holds more than [`MAX_TOML_BYTES`].
pub fn read_toml(path: &Path) -> Result<Vec<u8>, TextFileError> {
    Ok(read_file(path, MAX_TOML_BYTES)?)
}

/// Reads the text of a file of at most `limit_bytes`, without a byte order mark.
///
/// # Errors
/// Returns [`TextFileError`] if the file cannot be read, holds more, or is not UTF-8.
pub fn read_text(path: &Path, limit_bytes: u64) -> Result<String, TextFileError> {
    file_text(path, &read_file(path, limit_bytes)?, limit_bytes).map(str::to_owned)
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
        let names = "small, jackal, paper, burger, waffle, turtlebot4, husky, mir100, wheelchair, pallet-truck";
        assert_eq!(name, format!("there is no robot `hal`, expected one of {names}, or a file"));
        let in_place = "{ like = \"jackal\", cycle_s = 0.1 }";
        assert_eq!(find_robot(in_place, folder).unwrap().cycle_s, 0.1);
    }

    #[test]
    fn stacks_are_found_by_name_or_as_files() {
        let (folder, robot) = (Path::new("/nowhere"), Robot::small());
        let named = find_stack("s0-key-point", folder, &robot).unwrap();
        assert_eq!(Some(&named), Stack::by_name("s0-key-point", &robot).as_ref());
        let file = find_stack("mine.toml", folder, &robot).unwrap_err().to_string();
        assert!(file.contains("/nowhere/mine.toml: there is no such file"), "{file}");
        let name = find_stack("hay", folder, &robot).unwrap_err().to_string();
        assert!(
            name.starts_with("there is no stack `hay`, expected one of keyway, key-point-fusion")
        );
        assert!(name.ends_with(", rrt-follow, or a file"), "{name}");
    }
}
