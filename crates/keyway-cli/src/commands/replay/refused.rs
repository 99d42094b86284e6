//! Errors of records, in the terms of the command line.

use crate::error::{CliError, Kind};
use crate::inputs::map_error;
use keyway_lab::replay::ReplayError;

impl From<ReplayError> for CliError {
    fn from(error: ReplayError) -> Self {
        let message = match error {
            ReplayError::Map(error) => map_error(&error).message,
            ReplayError::OtherMap { .. } => {
                format!("{error}; use --map-dir to give a folder with the original map")
            }
            ReplayError::Content { path, reason } => format!(
                "{}: this is not a record of a run, as written by `keyway batch --keep`: {reason}",
                path.display()
            ),
            error => error.to_string(),
        };
        Self::new(Kind::Input, message).field("RECORD.json")
    }
}
