//! TOML -> a value, with errors that name the position.

use super::toml_messages::in_plain_words;
use crate::map::formats::shown;
use serde::de::DeserializeOwned;
use thiserror::Error;
use toml::de::{DeTable, DeValue};

/// Maximum length of a field's path in messages \[letters\].
const FIELD_LETTERS: usize = 120;

/// An error in a TOML text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}{}{reason}", place_text(*.line, *.column), field_text(.field))]
pub struct TomlError {
    /// Line, from 1; `None` if the error has no position, such as a missing field.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
    /// The field, as a path such as `limits.v_max_mps`; empty for the whole text.
    pub field: String,
    /// Description of the error.
    pub reason: String,
}

/// Reads a value from a TOML text.
///
/// # Errors
/// Returns [`TomlError`] if the text is not TOML or does not hold such a value; it names line and
/// field.
///
/// ```
/// use keyway::robot::Robot;
/// use keyway::files::from_toml;
/// let text = "footprint = { radius_m = 0.2 }\ncycle_s = \"fast\"\n";
/// let error = from_toml::<Robot>(text).unwrap_err();
/// assert_eq!((error.line, error.field.as_str()), (Some(2), "cycle_s"));
/// ```
pub fn from_toml<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    let at_text = |error: &toml::de::Error, field: String| {
        let place = error.span().map(|span| place(text, span.start));
        TomlError {
            line: place.map(|(line, _)| line),
            column: place.map(|(_, column)| column),
            field: shown(&field, FIELD_LETTERS),
            reason: in_plain_words(error.message()),
        }
    };
    let document = toml::Deserializer::parse(text).map_err(|e| at_text(&e, String::new()))?;
    serde_path_to_error::deserialize(document).map_err(|error| {
        let field = error.path().to_string();
        at_text(error.inner(), if field == "." { String::new() } else { field })
    })
}

/// Line and column, both from 1, of the value of a field, given as a path such as
/// `limits.v_max_mps`. For a missing field, those of the table that it belongs to.
pub(super) fn place_of_field(text: &str, path: &str) -> Option<(usize, usize)> {
    let document = DeTable::parse(text).ok()?;
    let (mut table, mut begin) = (document.get_ref(), None);
    for key in path.split('.') {
        let Some(value) = table.get(key) else { break };
        begin = Some(value.span().start);
        if let DeValue::Table(inner) = value.get_ref() {
            table = inner;
        }
    }
    begin.map(|byte| place(text, byte))
}

/// Line and column, both from 1, of a byte of the text.
fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

fn place_text(line: Option<usize>, column: Option<usize>) -> String {
    match (line, column) {
        (Some(line), Some(column)) => format!("line {line}, column {column}: "),
        _ => String::new(),
    }
}

fn field_text(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!("`{field}`: ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    fn robot_error(change: impl Fn(String) -> String) -> TomlError {
        let text = toml::to_string(&Robot::small()).unwrap();
        assert_eq!(from_toml::<Robot>(&text), Ok(Robot::small()));
        from_toml::<Robot>(&change(text)).unwrap_err()
    }

    #[test]
    fn errors_name_line_and_field() {
        let kind = robot_error(|text| text.replace("range_m = 3.5", "range_m = \"far\""));
        assert_eq!(kind.field, "sensors[0].range_m");
        assert!(
            kind.to_string()
                .contains("`sensors[0].range_m`: invalid type: string \"far\", expected a number")
        );
        let unknown = robot_error(|text| format!("colour = 1\n{text}"));
        assert_eq!((unknown.line, unknown.column), (Some(1), Some(1)));
        assert!(unknown.reason.contains("unknown field `colour`"), "{unknown}");
        let missing = robot_error(|text| text.replace("v_max_mps = 0.5\n", ""));
        assert!(missing.to_string().contains("missing field `v_max_mps`"), "{missing}");
        let syntax = robot_error(|_| "radius_m = 1\nradius_m == 2\n".to_owned());
        assert_eq!(syntax.line, Some(2));
    }

    #[test]
    fn a_footprint_is_one_of_its_kinds() {
        let footprint = |fields: &str| {
            let error = robot_error(|text| text.replace("radius_m = 0.18", fields));
            assert_eq!(error.field, "footprint");
            error.reason
        };
        let both = "radius_m = 0.18\nvertices_m = [[1, 0], [0, 1], [-1, -1]]";
        assert_eq!(footprint(both), "give exactly one kind, got several");
        assert_eq!(footprint(""), "give exactly one kind, got none");
    }

    #[test]
    fn places_count_characters() {
        assert_eq!(place("a\nµb", 4), (2, 2));
        assert_eq!(place("", 0), (1, 1));
        assert_eq!(place("a", 99), (1, 2));
    }
}
