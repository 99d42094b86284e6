//! The `keyway` program: arguments -> library -> files. It holds no algorithms of its own.
//!
//! It is a library as well, for bindings to other languages: [`run`] is the program, and
//! [`BatchPlots`] draws the results of a batch.

mod args;
mod commands;
mod config;
mod drive_pictures;
mod error;
mod inputs;
mod json;
mod out_dir;
mod out_file;
mod pictures;
mod progress;
mod report_text;
mod stdout;
mod team_pictures;

use args::{Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use commands::Done;
pub use commands::batch::BatchPlots;
use error::CliError;

use std::ffi::OsString;

/// Exit code for bad arguments or input.
const BAD_INPUT: u8 = 2;

/// Runs the program with the words of a command line and returns the exit code. The first word is
/// the name of the program.
pub fn run(argv: &[OsString]) -> u8 {
    let cli = match Cli::try_parse_from(argv) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error, argv),
    };
    let done = match cli.command {
        Command::Demo(args) => commands::demo::run(&args),
        Command::Plan(args) => commands::plan::run(&args),
        Command::Prepare(args) => commands::prepare::run(&args),
        Command::Navigate(args) => commands::navigate::run(&args),
        Command::Batch(args) => commands::batch::run(&args),
        Command::Replay(args) => commands::replay::run(&args),
        Command::Reproduce(args) => commands::reproduce::run(&args),
        Command::Compare(args) => commands::compare::run(&args),
        Command::Bench { command } => commands::bench::run(&command),
        Command::Map { command } => commands::map::run(&command),
        Command::Scene { command } => commands::scene::run(&command),
        Command::List(args) => commands::list::run(&args),
        #[cfg(feature = "ros")]
        Command::Ros { arguments } => commands::ros::run(arguments),
        #[cfg(feature = "pdf")]
        Command::Pdf(args) => commands::pdf::run(&args),
        Command::Man(args) => commands::man::run(&args),
        Command::Completions { shell } => commands::completions::run(shell),
    };
    match done {
        Ok(Done::Success) => 0,
        Ok(Done::Failure) => 1,
        Err(error) => {
            error.print(wants_json(argv));
            BAD_INPUT
        }
    }
}

/// Handles errors of the argument parser: help and version are answers, everything else is a
/// usage error.
fn refuse(error: &clap::Error, argv: &[OsString]) -> u8 {
    let json = wants_json(argv);
    let is_answer = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
    if is_answer {
        return match stdout::check_written(error.print()) {
            Ok(()) => 0,
            Err(error) => {
                error.print(json);
                BAD_INPUT
            }
        };
    }
    let explained =
        CliError::of_split_numbers(error, argv).or_else(|| CliError::of_batch(error, argv));
    if let Some(error) = explained {
        error.print(json);
    } else if json {
        CliError::from_clap(error).print(true);
    } else {
        // If even this fails, there is no channel left to report it.
        let _ = error.print();
    }
    BAD_INPUT
}

/// True if JSON was requested, even if the arguments as a whole are invalid.
fn wants_json(argv: &[OsString]) -> bool {
    let is_pair = |pair: &[OsString]| pair[0] == "--format" && pair[1] == "json";
    argv.windows(2).any(is_pair) || argv.iter().any(|arg| arg == "--format=json")
}
