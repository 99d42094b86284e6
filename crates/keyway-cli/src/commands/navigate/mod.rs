//! `keyway navigate`: drives a robot to a goal on a map.

mod drive;
mod episode;
mod recording;
mod result_files;
pub(super) mod team;
mod watch;

use super::Done;
use crate::args::{Format, NavigateArgs};
use crate::error::CliError;
use crate::report_text::WithFiles;
use crate::stdout::print_files;
pub(super) use drive::{Driven, drive};
use episode::Given;
pub(super) use episode::{given, given_scene};
use keyway_lab::run_tables::{SmoothingTargets, episode_table};
use keyway_sim::episode::{Episode, EpisodeOutcome};
use keyway_sim::report::Placed;
pub(super) use result_files::{FILES, prepared, wanted, write_all, write_files, written};
pub(crate) use watch::{Moment, Wanted};

pub(crate) fn run(args: &NavigateArgs) -> Result<Done, CliError> {
    let scene = given_scene(args)?;
    if let Some(scene) = scene.as_ref().filter(|scene| !scene.robots.is_empty()) {
        return team::run(args, scene);
    }
    let Given { episode, sources } = given(args, scene.as_ref())?;
    warn_of_those_left_out(episode.random);
    // Checked before the run, which may take long.
    let out = prepared(&args.files, &sources)?;
    let driven = drive(&episode, wanted(&args.files))?;
    let files = write_all(&args.files, &episode, &driven, out)?;
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &driven.report, files: &files })?,
        Format::Table => {
            super::print(&table(&episode, &driven))?;
            print_files(&files)?;
        }
    }
    Ok(Done::when(driven.report.outcome == EpisodeOutcome::Reached))
}

/// Warns that fewer random obstacles were placed than requested: the world is then a different
/// one.
fn warn_of_those_left_out(random: Option<Placed>) {
    if let Some(left_out) = random.map(|placed| placed.left_out()).filter(|&n| n > 0) {
        let message = format!(
            "no free position was found for {left_out} of the random obstacles; they were omitted"
        );
        crate::stdout::warn(message);
    }
}

/// The run as a table.
pub(super) fn table(episode: &Episode, driven: &Driven) -> String {
    let targets = driven.drive.as_ref().map(|drive| {
        let (clearance_m, cell_m) = (drive.route.clearance_m, episode.known.frame().resolution_m());
        SmoothingTargets::new(&episode.robots[0].stack.smoother, clearance_m, cell_m)
    });
    episode_table(&driven.report, targets)
}
