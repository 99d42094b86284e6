//! The `keyway` program: arguments -> library -> files. It holds no algorithms of its own.

mod args;
mod commands;
mod config;
mod csv_text;
mod drive_pictures;
mod error;
mod inputs;
mod journal;
mod json;
mod latex;
mod measure;
mod out_dir;
mod out_file;
mod overlay;
mod parallel;
mod pictures;
mod progress;
mod report_text;
mod significance;
mod smoothing_targets;
mod stdout;
mod table;
mod team_pictures;

use args::{Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use commands::Done;
use error::CliError;
use std::ffi::OsString;
use std::process::ExitCode;

/// Bad arguments or input.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let argv: Vec<OsString> = std::env::args_os().collect();
    let cli = match Cli::try_parse_from(&argv) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error, wants_json(&argv)),
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
        Command::Completions { shell } => commands::completions::run(shell),
    };
    match done {
        Ok(Done::Success) => ExitCode::SUCCESS,
        Ok(Done::Failure) => ExitCode::FAILURE,
        Err(error) => {
            error.print(wants_json(&argv));
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// Help and version are answers, not errors; everything else is a usage error.
fn refuse(error: &clap::Error, json: bool) -> ExitCode {
    let is_answer = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
    if is_answer {
        return match stdout::check_written(error.print()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                error.print(json);
                ExitCode::from(BAD_INPUT)
            }
        };
    }
    if json {
        CliError::from_clap(error).print(true);
    } else {
        // Nobody is left to tell when even this cannot be printed.
        let _ = error.print();
    }
    ExitCode::from(BAD_INPUT)
}

/// Whether JSON was asked for, even where the arguments as a whole cannot be understood.
fn wants_json(argv: &[OsString]) -> bool {
    let is_pair = |pair: &[OsString]| pair[0] == "--format" && pair[1] == "json";
    argv.windows(2).any(is_pair) || argv.iter().any(|arg| arg == "--format=json")
}
