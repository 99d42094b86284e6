//! Commands for other programs: words of a command line -> what `--format json` prints.

use crate::args::{BatchCli, Cli, Command};
use crate::commands;
use crate::error::{CliError, Kind};
use crate::progress::Watcher;
use clap::Parser;
use serde_json::Value;
use std::ffi::OsString;

/// `keyway batch`, or `keyway batch merge` where that is the first word; gives `keyway.batch/1`. Writes all files and prints
/// nothing. A batch that is stopped goes on where it was when it is started again.
///
/// # Errors
/// As the program; when the watcher stops it.
pub fn batch(words: &[OsString], watcher: &dyn Watcher) -> Result<Value, CliError> {
    let Command::Batch(args) = parsed(&["batch"], words)? else { return Err(other()) };
    let args: &BatchCli = &args;
    Ok(crate::json::value(&commands::batch::report(args, watcher)?))
}

fn parsed(command: &[&str], words: &[OsString]) -> Result<Command, CliError> {
    let argv = ["keyway"].iter().chain(command).map(OsString::from).chain(words.iter().cloned());
    Ok(Cli::try_parse_from(argv).map_err(|error| CliError::from_clap(&error))?.command)
}

/// The first words say which command it is: this cannot happen.
fn other() -> CliError {
    CliError::new(Kind::Usage, "another command was expected")
}
