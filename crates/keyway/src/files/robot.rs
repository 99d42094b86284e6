//! Robots from memory.

use super::{ConfigFileError, MAX_TOML_BYTES, RobotFile, file_text, from_toml};
use crate::robot::Robot;
use std::path::Path;

/// Reads and checks a robot from memory; errors call the file `name`.
///
/// ```
/// use keyway::files::robot_from_bytes;
/// use std::path::Path;
/// let error = robot_from_bytes(Path::new("mine.toml"), b"cycle_s = \"fast\"\n").unwrap_err();
/// assert!(error.to_string().starts_with("mine.toml: line 1, column 11: `cycle_s`: "));
/// ```
///
/// # Errors
/// If the content holds more than [`MAX_TOML_BYTES`], or does not describe a robot that can be.
pub fn robot_from_bytes(name: &Path, bytes: &[u8]) -> Result<Robot, ConfigFileError> {
    let text = file_text(name, bytes, MAX_TOML_BYTES)?;
    let path = || name.to_owned();
    let file: RobotFile =
        from_toml(text).map_err(|reason| ConfigFileError::Toml { path: path(), reason })?;
    file.robot().map_err(|reason| ConfigFileError::Value { path: path(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(errors[3].contains("needs `footprint`"), "{}", errors[3]);
    }
}
