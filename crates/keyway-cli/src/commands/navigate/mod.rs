//! `keyway navigate`: a map, a robot and a goal -> a drive.

mod drive;
mod job;
mod outputs;

use super::Done;
use crate::args::{Format, NavigateArgs};
use crate::error::CliError;
use crate::out_dir::OutDir;
use crate::output::print_files;
use crate::report::NavigateReport;
use crate::table::{facts, quantity};
pub(super) use drive::drive;
pub(super) use job::Job;
pub(super) use outputs::{FILES, write_outputs, written};

pub(crate) fn run(args: &NavigateArgs) -> Result<Done, CliError> {
    let job = Job::from_args(args)?;
    // Before the run, which may take long, not after it.
    let out = args.out.as_ref().map(|folder| OutDir::prepare(folder, &FILES)).transpose()?;
    let mut driven = drive(&job)?;
    if let Some(mut out) = out {
        let files = written(&driven).iter().map(|name| out.path(name).display().to_string());
        driven.report.files = files.collect();
        write_outputs(&job, &driven, &mut out)?;
        out.finish()?;
    }
    match args.format {
        Format::Json => crate::json::print(&driven.report)?,
        Format::Table => {
            super::print(&table(&driven.report))?;
            print_files(&driven.report.files)?;
        }
    }
    Ok(Done::when(driven.report.outcome == "reached"))
}

pub(super) fn table(report: &NavigateReport) -> String {
    let mut rows = vec![("outcome", report.outcome.to_owned())];
    rows.extend(report.reason.iter().map(|reason| ("reason", reason.clone())));
    rows.push(("planned length", quantity(report.plan.length_m, 3, "m")));
    rows.extend(report.plan.lowered());
    if let Some(smoothed) = &report.smoothed {
        rows.extend(smoothed.facts());
    }
    if let Some(run) = &report.run {
        rows.extend([
            ("driven length", quantity(Some(run.length_m), 3, "m")),
            ("time", quantity(Some(run.time_s), 1, "s")),
            ("mean speed", quantity(run.mean_speed_mps, 3, "m/s")),
            ("clearance of the robot", quantity(run.min_clearance_m, 3, "m")),
            ("routes planned", run.routes_planned.to_string()),
            ("cycles", run.cycles.to_string()),
            ("time per cycle", quantity(run.mean_cycle_us, 0, "us")),
        ]);
    }
    facts(rows)
}
