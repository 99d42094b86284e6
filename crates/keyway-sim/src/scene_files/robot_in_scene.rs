//! The robot of a scene: a name or a table.

use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::Value;

/// Reads a name as it is, and a table as the text that [`keyway::files::robot_in_place`] reads.
pub(super) fn name_or_table<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    match Value::deserialize(from)? {
        Value::String(name) => Ok(name),
        table @ Value::Table(_) => Ok(table.to_string()),
        other => {
            let got = other.type_str();
            Err(D::Error::custom(format!("expected a name or a table, got {got}")))
        }
    }
}

/// Reads an optional robot, as `name_or_table` does.
pub(super) fn some_name_or_table<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<String>, D::Error> {
    name_or_table(from).map(Some)
}

/// Schema of both forms.
#[cfg(feature = "schema")]
pub(super) fn robot_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
    let file = generator.subschema_for::<keyway::files::RobotFile>();
    schemars::json_schema!({ "anyOf": [{ "type": "string" }, file] })
}

#[cfg(test)]
mod tests {
    use crate::scene_files::SceneFile;

    #[test]
    fn a_robot_may_be_described_in_a_scene() {
        let scene = |robot: &str| {
            let text =
                format!("version = 2\nmap = \"a.map\"\n{robot}\nstart = [1, 1]\ngoal = [2, 2]");
            SceneFile::from_toml(&text).map_err(|error| error.to_string())
        };
        let fast = "{ like = \"small\", limits = { v_max_mps = 0.7 } }";
        let read = scene(&format!("robot = {fast}")).unwrap();
        assert_eq!(read.robot, fast);
        let again = SceneFile::from_toml(&toml::to_string(&read).unwrap()).unwrap();
        assert_eq!(again, read);
        assert!(keyway::files::robot_in_place(&read.robot).is_ok());
        assert_eq!(scene("robot = \"jackal\"").unwrap().robot, "jackal");
        let error = scene("robot = 3").unwrap_err();
        assert!(error.contains("robot") && error.contains("got integer"), "{error}");
    }
}
