//! Reading stacks from memory: a complete stack as TOML.

use super::missing::missing_fields;
use super::overlay::{NamedDefault, Overlay, OverlayError};
use super::toml_text::place_of_field;
use super::{ConfigFileError, MAX_TOML_BYTES, StackBase, TomlError, file_text, from_toml};
use crate::navigate::Stack;
use crate::robot::Robot;
use std::path::Path;
use toml::Table;

/// Reads a complete [`Stack`] from memory, as TOML, and checks it for a robot; errors call the
/// file `name`.
///
/// # Errors
/// Returns [`ConfigFileError`] if the content holds more than [`MAX_TOML_BYTES`], or is not a
/// stack that suits the robot.
pub fn stack_from_bytes(
    name: &Path,
    bytes: &[u8],
    robot: &Robot,
) -> Result<Stack, ConfigFileError> {
    let path = || name.to_owned();
    let text = file_text(name, bytes, MAX_TOML_BYTES)?;
    let stack: Stack = from_toml(text).map_err(|error| {
        let reason = in_part(text, &error, robot).unwrap_or(error);
        ConfigFileError::Toml { path: path(), reason }
    })?;
    match stack.fit(robot) {
        Ok(_) => Ok(stack),
        Err(reason) => Err(ConfigFileError::Value { path: path(), reason }),
    }
}

/// Locates a fault within a named part: the parser only knows the position at which the part
/// begins. Applying the part to a valid one, field by field, shows the invalid field.
fn in_part(text: &str, error: &TomlError, robot: &Robot) -> Option<TomlError> {
    let tree: Table = text.parse().ok()?;
    let part = tree.get(&error.field)?.as_table()?;
    let stack = Stack::for_plans(robot);
    let base = StackBase::for_robot(&stack, robot);
    let sound = base.part(&error.field, part.get("name")?.as_str()?).ok()?;
    let named: NamedDefault<'_> = &|path, name| base.part(path, name);
    let laid_over = Overlay::of(&stack, named).ok()?.set(&error.field, part.clone().into());
    let (field, reason) = match laid_over {
        Err(OverlayError::Rejected { path, reason }) => (path, reason),
        Err(error) => (error.path().to_owned(), error.to_string()),
        Ok(()) => {
            let is_it = |path: &String| {
                path.rsplit('.')
                    .next()
                    .is_some_and(|key| error.reason.ends_with(&format!("`{key}`")))
            };
            let path = missing_fields(&sound, part).into_iter().find(is_it)?;
            (format!("{}.{path}", error.field), error.reason.clone())
        }
    };
    let (line, column) = place_of_field(text, &field).unzip();
    Some(TomlError { line, column, field, reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stack_is_a_file_with_all_of_it() {
        let (name, robot) = (Path::new("my.toml"), Robot::small());
        for stack in Stack::NAMES.map(|name| Stack::by_name(name, &robot).unwrap()) {
            let text = toml::to_string(&stack).unwrap();
            assert_eq!(stack_from_bytes(name, text.as_bytes(), &robot).unwrap(), stack, "{text}");
        }
        let text = toml::to_string(&Stack::key_point_fusion(&robot)).unwrap();
        let error = |from: &str, to: &str| {
            let changed = text.replacen(from, to, 1);
            assert_ne!(changed, text, "{from}");
            stack_from_bytes(name, changed.as_bytes(), &robot).unwrap_err().to_string()
        };
        let line = 1 + text.lines().position(|line| line.starts_with("horizon_s")).unwrap();
        let far = error("horizon_s = ", "horizon_s = \"far\" # ");
        let place = format!("my.toml: line {line}, column 13: `local.window.horizon_s`: ");
        assert_eq!(far, place + "invalid type: string \"far\", expected a number");
        let none = error("name = \"dwa\"", "name = \"hay\"");
        assert!(none.contains("`hay`") && none.contains("key-point-dwa"), "{none}");
        let without = error("horizon_s", "prospect_s");
        let line = format!("my.toml: line {line}, ");
        assert!(
            without.starts_with(&line) && without.contains("no field `local.window.prospect_s`"),
            "{without}"
        );
        let least = error("least_clearance_m = ", "least_clearance_m = true # ");
        assert!(least.contains("`controller.least_clearance_m`: invalid type: boolean"), "{least}");
        let missing = error("distance_cap_m", "# distance_cap_m");
        let line = 1 + text.lines().position(|line| line == "[local.window]").unwrap();
        let expected = format!(
            "my.toml: line {line}, column 1: `local.window.distance_cap_m`: missing field `distance_cap_m`"
        );
        assert_eq!(missing, expected);
        let negative = error("horizon_s = ", "horizon_s = -");
        let expected = "my.toml: local.window.horizon_s must be a positive number, got -";
        assert!(negative.starts_with(expected), "{negative}");
        let part = stack_from_bytes(name, b"[map]\n", &robot).unwrap_err().to_string();
        assert_eq!(part, "my.toml: line 1, column 1: missing field `planner`");
    }
}
