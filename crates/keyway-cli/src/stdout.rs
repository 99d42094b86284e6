//! The standard output, and warnings on the standard error.

use crate::error::{CliError, Kind};
use std::fmt::Display;
use std::io::{ErrorKind, Write};

/// Prints a text. A reader that closes the pipe is not an error; any other failure is.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    check_written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Lists the written files below an answer, in the same form for all commands.
pub(crate) fn print_files(files: &[String]) -> Result<(), CliError> {
    if files.is_empty() { Ok(()) } else { print(&format!("\nwrote {}\n", files.join("\nwrote "))) }
}

/// Checks that writing to the standard output succeeded; a broken pipe counts as success.
pub(crate) fn check_written(written: std::io::Result<()>) -> Result<(), CliError> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let message = format!("cannot write to the standard output: {error}");
            Err(CliError::new(Kind::Output, message))
        }
        _ => Ok(()),
    }
}

/// Prints a warning to the standard error: a likely mistake, or lost information.
pub(crate) fn warn(warning: impl Display) {
    // If this fails, there is no channel left to report it.
    let _ = writeln!(std::io::stderr(), "warning: {warning}");
}
