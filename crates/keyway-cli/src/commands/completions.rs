//! `keyway completions`.

use super::Done;
use crate::args::Cli;
use crate::error::CliError;
use clap::CommandFactory;
use clap_complete::Shell;

pub(crate) fn run(shell: Shell) -> Result<Done, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "keyway", &mut script);
    super::print(String::from_utf8_lossy(&script).trim_end())?;
    Ok(Done::Success)
}
