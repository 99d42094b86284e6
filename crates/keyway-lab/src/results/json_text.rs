//! Human-readable JSON: one line per member, lists of numbers on one line.

use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;

/// Returns the text of a report, with a line break at its end.
pub fn json_text(report: &impl Serialize) -> String {
    // Reports are plain data with string keys, so this cannot fail.
    let value = serde_json::to_value(report).unwrap_or_default();
    let mut text = String::new();
    write_value(&value, 0, &mut text);
    text.push('\n');
    text
}

fn write_value(value: &Value, depth: usize, text: &mut String) {
    match value {
        Value::Object(members) if !members.is_empty() => {
            write_block('{', '}', members.iter(), depth, text, |(key, value), text| {
                let _ = write!(text, "{}: ", Value::from(key.as_str()));
                write_value(value, depth + 1, text);
            });
        }
        Value::Array(items) if items.iter().any(|item| item.is_array() || item.is_object()) => {
            write_block('[', ']', items.iter(), depth, text, |item, text| {
                write_value(item, depth + 1, text);
            });
        }
        // Numbers, strings, and lists of them.
        scalar => {
            let _ = write!(text, "{scalar}");
        }
    }
}

fn write_block<T>(
    open: char,
    close: char,
    items: impl Iterator<Item = T>,
    depth: usize,
    text: &mut String,
    mut write_item: impl FnMut(T, &mut String),
) {
    text.push(open);
    for (i, item) in items.enumerate() {
        text.push_str(if i == 0 { "\n" } else { ",\n" });
        text.push_str(&"  ".repeat(depth + 1));
        write_item(item, text);
    }
    let _ = write!(text, "\n{}{close}", "  ".repeat(depth));
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn layout() {
        let value = json!({"a": 1.5, "b": {}, "c": [[1, 2], [3, 4]], "d": {"e": [], "f": null}});
        let expected = "{\n  \"a\": 1.5,\n  \"b\": {},\n  \"c\": [\n    [1,2],\n    [3,4]\n  ],\n  \
                        \"d\": {\n    \"e\": [],\n    \"f\": null\n  }\n}\n";
        assert_eq!(json_text(&value), expected);
        assert_eq!(serde_json::from_str::<Value>(&json_text(&value)).unwrap(), value);
    }
}
