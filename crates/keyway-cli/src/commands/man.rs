//! `keyway man`: a manual page for the program and each of its commands.

use super::Done;
use crate::args::{Cli, ManArgs};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use crate::stdout::print_files;
use clap::{Command, CommandFactory};
use clap_mangen::Man;

pub(crate) fn run(args: &ManArgs) -> Result<Done, CliError> {
    let mut program = Cli::command();
    program.build();
    let mut pages = Vec::new();
    collect(&program, &mut pages);
    let names: Vec<String> = pages.iter().map(Man::get_filename).collect();
    let mut out = prepare(&args.out, &names)?;
    for (page, name) in pages.iter().zip(&names) {
        let mut text = Vec::new();
        let rendered = page.render(&mut text);
        rendered.map_err(|error| CliError::new(Kind::Output, error))?;
        out.write(name, &text)?;
    }
    let files: Vec<String> =
        names.iter().map(|name| out.path(name).display().to_string()).collect();
    out.finish()?;
    print_files(&files)?;
    Ok(Done::Success)
}

/// Appends the page of a command and those of its subcommands.
fn collect(command: &Command, pages: &mut Vec<Man>) {
    // Subcommands are named by the whole line: `keyway-map-info`.
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    pages.push(Man::new(command.clone().name(name)));
    for subcommand in command.get_subcommands().filter(|it| it.get_name() != "help") {
        collect(subcommand, pages);
    }
}
