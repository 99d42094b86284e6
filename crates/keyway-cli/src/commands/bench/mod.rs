//! `keyway bench`: measures planners and checks their answers.

mod grid;
mod grid_file;
mod scale;
mod scale_run;

use super::Done;
use crate::args::BenchCommand;
use crate::error::CliError;

pub(crate) fn run(command: &BenchCommand) -> Result<Done, CliError> {
    match command {
        BenchCommand::Grid(args) => grid::run(args),
        BenchCommand::Scale(args) => scale::run(args),
    }
}
