//! Reading robots from memory.

use super::{ConfigFileError, MAX_TOML_BYTES, RobotFile, TomlError, file_text, from_toml};
use crate::robot::Robot;
use serde::Deserialize;
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
/// Returns [`ConfigFileError`] if the content holds more than [`MAX_TOML_BYTES`], or does not
/// describe a valid robot.
pub fn robot_from_bytes(name: &Path, bytes: &[u8]) -> Result<Robot, ConfigFileError> {
    let text = file_text(name, bytes, MAX_TOML_BYTES)?;
    let path = || name.to_owned();
    let file: RobotFile =
        from_toml(text).map_err(|reason| ConfigFileError::Toml { path: path(), reason })?;
    file.robot().map_err(|reason| ConfigFileError::Value { path: path(), reason })
}

/// Reads and checks a robot that is described inline, in place of a name: an inline TOML table
/// with the fields of a robot file.
///
/// # Errors
/// Returns [`ConfigFileError`] if the text does not describe a valid robot.
pub fn robot_in_place(text: &str) -> Result<Robot, ConfigFileError> {
    #[derive(Deserialize)]
    struct InPlace {
        robot: RobotFile,
    }
    let path = || "robot".into();
    let InPlace { robot } = from_toml(&format!("robot = {text}")).map_err(|error| {
        // Columns would count the prefix.
        let field = error.field.strip_prefix("robot").unwrap_or(&error.field);
        let field = field.trim_start_matches('.').to_owned();
        let reason = TomlError { line: None, column: None, field, ..error };
        ConfigFileError::Toml { path: path(), reason }
    })?;
    robot.robot().map_err(|reason| ConfigFileError::Value { path: path(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_in_place_of_a_name() {
        let fast = robot_in_place("{ like = \"small\", limits = { v_max_mps = 0.7 } }").unwrap();
        assert_eq!((fast.limits.v_max_mps, fast.cycle_s), (0.7, Robot::small().cycle_s));
        let error = |text| robot_in_place(text).unwrap_err().to_string();
        assert_eq!(
            error("{ like = \"small\", cycle_s = -1 }"),
            "robot: cycle_s must be a time from 0.001 to 10 s, got -1"
        );
        assert!(error("{ cycle_s = \"fast\" }").starts_with("robot: `cycle_s`: invalid type"));
        assert!(error("{ speed = 1 }").contains("unknown field `speed`"));
        assert!(error("{ like = ").starts_with("robot: "));
        assert!(error("{ v_max_mps = 1 }").contains("needs `footprint`"));
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
        assert!(errors[3].contains("needs `footprint`"), "{}", errors[3]);
    }
}
