//! The standard output, and warnings on the standard error.

use crate::error::{CliError, Kind};
use std::fmt::Display;
use std::io::{ErrorKind, Write};

/// Prints all of a text, or says why it could not. A reader that went away is not an error of this
/// program.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    check_written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Says below an answer which files were written, the same way for all commands.
pub(crate) fn print_files(files: &[String]) -> Result<(), CliError> {
    if files.is_empty() { Ok(()) } else { print(&format!("\nwrote {}\n", files.join("\nwrote "))) }
}

/// True if writing to the standard output succeeded.
pub(crate) fn check_written(written: std::io::Result<()>) -> Result<(), CliError> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let message = format!("cannot write to the standard output: {error}");
            Err(CliError::new(Kind::Output, message))
        }
        _ => Ok(()),
    }
}

/// Says on the standard error what is usually a mistake, or was lost.
pub(crate) fn warn(warning: impl Display) {
    // Nobody is left to read it when this fails.
    let _ = writeln!(std::io::stderr(), "warning: {warning}");
}
