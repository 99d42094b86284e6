//! JSON reports on the standard output.

use crate::error::CliError;
pub(crate) use keyway_lab::results::json_text as to_string;
use serde::Serialize;

/// Prints a report as JSON.
pub(crate) fn print(report: &impl Serialize) -> Result<(), CliError> {
    crate::stdout::print(&to_string(report))
}
