//! JSON reports on the standard output.

use crate::error::CliError;
pub(crate) use keyway_lab::results::json_text as to_string;
use serde::Serialize;
use serde_json::Value;

/// A report as a value.
pub(crate) fn value(report: &impl Serialize) -> Value {
    // Reports are plain data with string keys, so this cannot fail.
    serde_json::to_value(report).unwrap_or_default()
}

/// Prints a report.
pub(crate) fn print(report: &impl Serialize) -> Result<(), CliError> {
    crate::stdout::print(&to_string(report))
}
