//! Rows as CSV.

use serde::Serialize;
use serde_json::Value;

/// Returns one line for each row, under a header of the member names; a missing value is empty.
pub fn csv(rows: &[impl Serialize]) -> String {
    let line = |cells: Vec<String>| cells.join(",") + "\n";
    let mut text = String::new();
    for row in rows {
        // Rows are plain data with string keys, so this cannot fail.
        let Ok(Value::Object(members)) = serde_json::to_value(row) else { continue };
        if text.is_empty() {
            text.push_str(&line(members.keys().cloned().collect()));
        }
        text.push_str(&line(members.values().map(csv_cell).collect()));
    }
    text
}

/// Returns a cell, quoted if necessary (RFC 4180).
fn csv_cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_table_by_hand() {
        let rows = [
            json!({"map": "a, \"b\".map", "solved": 3, "mean_excess": -0.5}),
            json!({"map": "c", "solved": 0, "mean_excess": null}),
        ];
        let expected = "map,solved,mean_excess\n\"a, \"\"b\"\".map\",3,-0.5\nc,0,\n";
        assert_eq!(csv(&rows), expected);
    }
}
