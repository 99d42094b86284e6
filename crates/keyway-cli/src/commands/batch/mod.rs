//! `keyway batch`: drives many scenes, stacks and seeds, and reports the results.

mod plots;
mod refused;

use super::{Done, print};
use crate::args::{BatchArgs, BatchCli, BatchCommand, Format, Keep, MergeArgs};
use crate::error::{CliError, Kind};
use crate::progress::RunBar;
use keyway_lab::batch::{
    self, BatchReport, BatchRequest, MergeRequest, against_first_table, cycles_line, scenes_table,
    summary_table, wins_table,
};
pub use plots::BatchPlots;

pub(crate) fn run(args: &BatchCli) -> Result<Done, CliError> {
    let bar = RunBar::default();
    let report = match (&args.command, &args.run) {
        (Some(BatchCommand::Merge(args)), _) => merge_request(args).merge(&BatchPlots, &bar),
        (None, Some(args)) => request(args).drive(&BatchPlots, &bar),
        // The argument parser requires one of them.
        (None, None) => {
            return Err(CliError::new(Kind::Usage, "there are no scenes").field("SCENE.toml"));
        }
    };
    // Clears the terminal before anything is printed.
    drop(bar);
    show(&report?, args.format())?;
    Ok(Done::Success)
}

fn request(args: &BatchArgs) -> BatchRequest {
    BatchRequest {
        scenes: args.scenes.iter().cloned().map(Into::into).collect(),
        out: args.out.clone(),
        stacks: args.stacks.clone(),
        robot: args.robot.clone(),
        set: args.set.clone(),
        safe: args.safe,
        disturbances: args.disturbances.clone(),
        reached_by: args.reached_by.map(Into::into),
        seeds: args.seeds,
        jobs: args.jobs,
        shard: args.shard,
        keep: match args.keep {
            Keep::None => batch::Keep::None,
            Keep::Failures => batch::Keep::Failures,
            Keep::All => batch::Keep::All,
        },
        max_cells: args.max_cells,
    }
}

fn merge_request(args: &MergeArgs) -> MergeRequest {
    MergeRequest { parts: args.folders.clone(), out: args.out.clone() }
}

fn show(report: &BatchReport, format: Format) -> Result<(), CliError> {
    if format == Format::Json {
        return crate::json::print(report);
    }
    print(&summary_table(&report.stacks))?;
    if let Some(text) = against_first_table(&report.against_first) {
        print(&format!("\n{text}"))?;
    }
    let by_scene = scenes_table(&report.scenes);
    let more = [by_scene, wins_table(&report.wins), cycles_line(&report.cycles)];
    for text in more.into_iter().flatten() {
        print(&format!("\n{text}"))?;
    }
    crate::stdout::print_files(&report.files)?;
    if report.records > 0 {
        let (records, folder) = (report.records, report.records_folder.display());
        print(&format!("\nfull records: {records}, in {folder}; `keyway replay` shows them"))?;
    }
    Ok(())
}
