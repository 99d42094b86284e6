//! Lines of a CSV file, by the names of its columns.

use crate::error::{CliError, Kind};
use crate::inputs::read_text;
use serde::de::DeserializeOwned;
use std::path::Path;

/// More than any benchmark's file holds \[bytes\].
const LARGEST_BYTES: u64 = 256 << 20;

/// All lines below the header; other columns are not looked at.
pub(super) fn rows<T: DeserializeOwned>(path: &Path, field: &str) -> Result<Vec<T>, CliError> {
    let text = read_text(path, LARGEST_BYTES, field)?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let blame = |error: csv::Error| {
        let line = error.position().map_or(String::new(), |at| format!("line {}: ", at.line()));
        let what = match error.kind() {
            csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
            _ => error.to_string(),
        };
        CliError::new(Kind::Input, format!("{}: {line}{what}", path.display())).field(field)
    };
    reader.deserialize().collect::<Result<_, _>>().map_err(blame)
}
