//! `keyway bench`: measures planners and checks their answers.

mod grid;
mod grid_file;
mod scale;

use super::Done;
use crate::args::BenchCommand;
use crate::error::{CliError, Kind};
use keyway::ConfigError;

pub(crate) fn run(command: &BenchCommand) -> Result<Done, CliError> {
    match command {
        BenchCommand::Grid(args) => grid::run(args),
        BenchCommand::Scale(args) => scale::run(args),
    }
}

/// Error of layers that cannot be computed.
fn unusable_map(error: ConfigError) -> CliError {
    let error = error.within("map");
    CliError::new(Kind::Config, &error).field(error.path.as_str())
}
