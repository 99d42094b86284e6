//! `keyway batch`: many scenes, stacks and seeds, and what came out of them.
//!
//! A run is a pure function of its scene, its stack and its seed; where several robots drive in a scene, it is that of all of them. Each finished one is appended to a journal at once, with a
//! digest of all that it depends on; whoever asks for it again gets it from there. So a batch may be killed at any
//! moment, extended, or made in parts: only the runs that are missing are made. At the end the results are written in the order of the
//! runs, and the journal is removed. Measured times are in a file of their own: everything else is the same, byte for
//! byte, however often it was killed and on however many threads.

mod kept;
mod merge;
mod part;
mod plan;
mod plots;
mod result_files;
mod shared_world;

use super::{Done, print};
use crate::args::{BatchArgs, BatchCli, BatchCommand, Format};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use crate::progress::{Progress, Watcher};
use kept::Kept;
use keyway_lab::batch::{
    AgainstFirst, Record, StackSummary, against_first, against_first_table, summaries,
    summary_table,
};
use keyway_lab::results::{Journal, OutDir};
use keyway_sim::parallel::processors;
use part::Part;
use plan::Planned;
use result_files::{fill, known, names, write_files};
use serde::Serialize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

/// `keyway.batch/1`.
#[derive(Serialize)]
pub(crate) struct BatchReport {
    schema: &'static str,
    /// Runs that were asked for.
    runs: usize,
    /// Of each stack.
    stacks: Vec<StackSummary>,
    /// The stacks but the first, each compared with it.
    against_first: Vec<AgainstFirst>,
    /// The files that were written.
    files: Vec<String>,
    /// How many full records the folder `records` has.
    records: usize,
    /// That folder.
    #[serde(skip)]
    folder: PathBuf,
}

pub(crate) fn run(args: &BatchCli) -> Result<Done, CliError> {
    let report = report(args, &())?;
    report.print(args.format())?;
    Ok(Done::Success)
}

/// Does what is asked for and writes all files, while somebody watches.
pub(crate) fn report(args: &BatchCli, watcher: &dyn Watcher) -> Result<BatchReport, CliError> {
    match (&args.command, &args.run) {
        (Some(BatchCommand::Merge(args)), _) => merge::merged(args),
        (None, Some(args)) => drive_all(args, watcher),
        // The parser of the arguments asks for one of them.
        (None, None) => Err(CliError::new(Kind::Usage, "there are no scenes").field("SCENE.toml")),
    }
}

fn drive_all(args: &BatchArgs, watcher: &dyn Watcher) -> Result<BatchReport, CliError> {
    let (planned, part) = plan::planned(args, watcher)?;
    let ids = || planned.iter().map(Planned::id);
    let out = prepare(&args.out, &names())?;
    let mut journal = Journal::<Record>::open(&out)?;
    let mut records = known(&planned, &out)?;
    fill(&planned, &mut records, journal.take());
    let kept = Kept::prepare(&args.out, args.keep, ids())?;
    for (run, record) in ids().zip(&mut records) {
        record.take_if(|record| kept.lacks(run, record));
    }
    drive_missing(&planned, &mut records, &mut journal, (&kept, args.jobs, watcher))?;
    let records: Vec<Record> = records.into_iter().flatten().collect();
    let report = finish(&records, (part.as_ref(), &kept), out)?;
    journal.remove();
    Ok(report)
}

/// Writes all results; gives what is in them.
fn finish(
    records: &[Record],
    (part, kept): (Option<&Part>, &Kept),
    out: OutDir,
) -> Result<BatchReport, CliError> {
    let stacks = summaries(records);
    let names: Vec<String> = stacks.iter().map(|summary| summary.stack.clone()).collect();
    let against_first = against_first(records, &names);
    let files = write_files(records, part, &stacks, &against_first, out)?;
    let ids = || records.iter().map(|record| record.run.id());
    kept.remove_others(ids());
    let (schema, runs, records) = ("keyway.batch/1", records.len(), kept.count(ids()));
    let folder = kept.folder().to_owned();
    Ok(BatchReport { schema, runs, stacks, against_first, files, records, folder })
}

impl BatchReport {
    fn print(&self, format: Format) -> Result<(), CliError> {
        if format == Format::Json {
            return crate::json::print(self);
        }
        print(&summary_table(&self.stacks))?;
        if let Some(text) = against_first_table(&self.against_first) {
            print(&format!("\n{text}"))?;
        }
        crate::stdout::print_files(&self.files)?;
        if self.records > 0 {
            let (records, folder) = (self.records, self.folder.display());
            print(&format!("\nfull records: {records}, in {folder}; `keyway replay` shows them"))?;
        }
        Ok(())
    }
}

/// Makes the runs that are not known yet, several at a time. Each is in the journal as soon as it is finished.
fn drive_missing(
    planned: &[Planned],
    records: &mut [Option<Record>],
    journal: &mut Journal<Record>,
    (kept, jobs, watcher): (&Kept, Option<usize>, &dyn Watcher),
) -> Result<(), CliError> {
    let mut missing: Vec<usize> = (0..planned.len()).filter(|&i| records[i].is_none()).collect();
    missing.sort_by_key(|&i| planned[i].world.number);
    for &i in &missing {
        planned[i].world.expect_run();
    }
    let jobs = jobs.unwrap_or_else(processors).min(missing.len());
    let progress = Progress::over_runs(missing.len());
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..jobs {
            let (sender, next, missing) = (sender.clone(), &next, &missing);
            scope.spawn(move || {
                while let Some(&index) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                    // Nobody listens any more when one could not be written down.
                    if sender.send((index, drive_one(&planned[index], kept))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        for (index, record) in receiver {
            let record = record?;
            journal.append(&record)?;
            records[index] = Some(record);
            progress.answered_before(watcher)?;
        }
        Ok(())
    })
}

/// Makes a run, and keeps its full record if it is to be kept.
fn drive_one(planned: &Planned, kept: &Kept) -> Result<Record, CliError> {
    let (team, report, wall_s) = planned.drive()?;
    let reference_time_s = planned.reference_time_s();
    let record = Record::of(planned.id(), (&team, &report), reference_time_s, wall_s);
    if kept.wants(record.run.outcome) {
        kept.write(planned.id(), &planned.full_record(&team, &report))?;
    }
    Ok(record)
}
