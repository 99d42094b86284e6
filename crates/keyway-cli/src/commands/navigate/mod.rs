//! `keyway navigate`: a map, a robot and a goal -> a drive.

mod drive;
mod episode;
mod result_files;

use super::Done;
use crate::args::{Format, NavigateArgs};
use crate::error::CliError;
use crate::out_dir::OutDir;
use crate::report_text::{WithFiles, lowered, smoothed_facts};
use crate::smoothing_targets::SmoothingTargets;
use crate::stdout::print_files;
use crate::table::{facts, quantity};
use drive::Driven;
pub(super) use drive::drive;
pub(super) use episode::episode;
use keyway::episode::{Episode, EpisodeOutcome};
pub(super) use result_files::{FILES, write_files, written};

pub(crate) fn run(args: &NavigateArgs) -> Result<Done, CliError> {
    let episode = episode(args)?;
    // Before the run, which may take long, not after it.
    let out = args.out.as_ref().map(|folder| OutDir::prepare(folder, &FILES)).transpose()?;
    let driven = drive(&episode)?;
    let mut files = Vec::new();
    if let Some(mut out) = out {
        let names = written(&driven).iter();
        files.extend(names.map(|name| out.path(name).display().to_string()));
        write_files(&episode, &driven, &files, &mut out)?;
        out.finish()?;
    }
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &driven.report, files: &files })?,
        Format::Table => {
            super::print(&table(&episode, &driven))?;
            print_files(&files)?;
        }
    }
    Ok(Done::when(driven.report.outcome == EpisodeOutcome::Reached))
}

pub(super) fn table(episode: &Episode, driven: &Driven) -> String {
    let report = &driven.report;
    let mut rows = vec![("outcome", report.outcome.name().to_owned())];
    rows.extend(report.reason.iter().map(|reason| ("reason", reason.clone())));
    rows.push(("planned length", quantity(report.plan.length_m, 3, "m")));
    rows.extend(lowered(&report.plan));
    if let Some((smoothed, drive)) = report.smoothed.as_ref().zip(driven.drive.as_ref()) {
        let (clearance_m, cell_m) = (drive.route.clearance_m, episode.known.frame().resolution_m());
        let smoother = &episode.stack.smoother;
        let targets = SmoothingTargets::new(smoother, clearance_m, cell_m);
        rows.extend(smoothed_facts(smoothed, targets));
    }
    if let Some(run) = &report.run {
        rows.extend([
            ("driven length", quantity(Some(run.length_m), 3, "m")),
            ("time", quantity(Some(run.time_s), 1, "s")),
            ("mean speed", quantity(run.mean_speed_mps, 3, "m/s")),
            ("clearance of the robot", quantity(run.min_clearance_m, 3, "m")),
        ]);
        if let Some(clearance_m) = run.min_mover_clearance_m {
            rows.push(("clearance from movers", quantity(Some(clearance_m), 3, "m")));
        }
        rows.extend([
            ("routes planned", run.routes_planned.to_string()),
            ("cycles", run.cycles.to_string()),
            ("time per cycle", quantity(run.mean_cycle_us, 0, "us")),
        ]);
    }
    facts(rows)
}
