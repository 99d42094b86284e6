//! A stack or a robot as a file: TOML, with a description above every value.

use super::parameters::{Parameter, value_text};
use crate::table::paragraph;
use serde::Serialize;

/// Returns the file; `head` is the description of its content.
pub(super) fn file(value: &impl Serialize, head: &str, parameters: &[Parameter]) -> String {
    // Both are plain data with string keys: this cannot fail.
    let toml = toml::to_string(value).unwrap_or_default();
    let (mut text, mut table) = (comment(head), String::new());
    for line in toml.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            // The header of an array of tables has a second pair of brackets.
            name.trim_matches(['[', ']']).clone_into(&mut table);
        }
        let key = line.split(" = ").next().unwrap_or_default();
        let path = if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") };
        if let Some(parameter) = parameters.iter().find(|parameter| parameter.path == path) {
            text += &comment(&about(parameter));
        }
        text += line;
        text.push('\n');
    }
    text
}

fn about(parameter: &Parameter) -> String {
    let Parameter { paper, .. } = parameter;
    let description = parameter.description_with_choices();
    let published = paper.as_ref().map(|paper| format!(" As published: {}.", value_text(paper)));
    description + &published.unwrap_or_default()
}

/// Returns a text as comments.
fn comment(text: &str) -> String {
    let mut lines = paragraph(text).replace('\n', "\n# ");
    lines.insert_str(0, "# ");
    lines.push('\n');
    lines
}
