//! Result folders, with errors in the terms of the command line.

use crate::error::{CliError, Kind};
use keyway_lab::results::{OutDir, ResultsError};
use std::path::Path;

/// A folder that is ready for all planned files ([`OutDir::prepare`]).
pub(crate) fn prepare(folder: &Path, planned: &[impl AsRef<str>]) -> Result<OutDir, CliError> {
    let out = OutDir::prepare(folder, planned)?;
    if out.is_unguarded() {
        warn_of_others(folder);
    }
    Ok(out)
}

/// Warns that the folder cannot be locked against other programs.
pub(crate) fn warn_of_others(path: &Path) {
    crate::stdout::warn(format!(
        "{}: files cannot be locked here; make sure that no other program writes here",
        path.display()
    ));
}

impl From<ResultsError> for CliError {
    fn from(error: ResultsError) -> Self {
        Self::new(Kind::Output, error).field("--out")
    }
}
