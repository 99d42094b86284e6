//! Fields that are missing in a table.

use toml::{Table, Value};

/// Field that a robot file may leave out.
const OPTIONAL: &str = "actuation_delay_s";

/// The fields of a complete table that another table lacks, as paths.
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
