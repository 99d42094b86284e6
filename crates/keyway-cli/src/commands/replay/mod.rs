//! `keyway replay`: records of runs -> the same runs, made again, as `keyway navigate` shows them.

mod difference;
mod record;

use super::navigate::{drive, prepared, table, wanted, write_all};
use super::{Done, print};
use crate::args::{DriveFileArgs, Format, ReplayArgs};
use crate::error::{CliError, Kind};
use crate::report_text::WithFiles;
use crate::stdout::print_files;
use keyway::episode::EpisodeReport;
pub(super) use record::RunRecord;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// `keyway.replay/1`.
#[derive(Serialize)]
struct ReplayReport {
    schema: &'static str,
    /// [`Replayed`], in the order of the records.
    runs: Vec<Value>,
}

/// A run that was the same again.
#[derive(Serialize)]
struct Replayed<'a> {
    /// Path of its record.
    record: String,
    /// `keyway.navigate/4`.
    report: WithFiles<'a, EpisodeReport>,
}

pub(crate) fn run(args: &ReplayArgs) -> Result<Done, CliError> {
    refuse_one_file_for_several(args)?;
    let mut runs = Vec::new();
    for path in &args.records {
        runs.extend(replay(args, path)?);
    }
    if args.format == Format::Json {
        crate::json::print(&ReplayReport { schema: "keyway.replay/1", runs })?;
    }
    Ok(Done::Success)
}

/// Makes a run again; what is to be said of it is printed, or given for the report.
fn replay(args: &ReplayArgs, path: &Path) -> Result<Option<Value>, CliError> {
    let record = RunRecord::read(path)?;
    let (episode, sources) = record.episode(path, args.map_dir.as_deref())?;
    let name = path.file_stem().unwrap_or_default();
    let out = args.files.out.as_ref().map(|folder| folder.join(name));
    let files = DriveFileArgs { out, ..args.files.clone() };
    let out = prepared(&files, &sources)?;
    let driven = drive(&episode, wanted(&files))?;
    record.check(path, &driven.report)?;
    let files = write_all(&files, &episode, &driven, out)?;
    if args.format == Format::Json {
        let report = WithFiles { report: &driven.report, files: &files };
        let replayed = Replayed { record: path.display().to_string(), report };
        // Plain data with string keys: this cannot fail.
        return Ok(serde_json::to_value(replayed).ok());
    }
    let gap = if args.records.first().is_some_and(|first| first == path) { "" } else { "\n" };
    print(&format!("{gap}{}, the same run again:\n", path.display()))?;
    print(&table(&episode, &driven))?;
    print_files(&files)?;
    Ok(None)
}

fn refuse_one_file_for_several(args: &ReplayArgs) -> Result<(), CliError> {
    let DriveFileArgs { explain, animate, .. } = &args.files;
    let given = [(explain.is_some(), "--explain"), (animate.is_some(), "--animate")];
    let Some((_, flag)) = given.into_iter().find(|(is_given, _)| *is_given) else { return Ok(()) };
    if args.records.len() == 1 {
        return Ok(());
    }
    let message = format!("{flag} is one file, and there are {} records", args.records.len());
    Err(CliError::new(Kind::Usage, message).field(flag))
}
