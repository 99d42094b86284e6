//! `keyway replay`: recomputes recorded runs and shows them as `keyway navigate` does.

mod flight;
mod refused;

use super::navigate::{drive, prepared, table, team, wanted, write_all};
use super::{Done, print};
use crate::args::{DriveFileArgs, Format, ReplayArgs};
use crate::error::{CliError, Kind};
use crate::progress::RunBar;
use crate::report_text::WithFiles;
use crate::stdout::print_files;
use keyway_lab::replay::ReplayRequest;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// `keyway.replay/1`.
#[derive(Serialize)]
struct ReplayReport {
    schema: &'static str,
    /// [`Replayed`] or [`flight::Redecided`], in the order of the records.
    runs: Vec<Value>,
}

/// A run that was reproduced identically.
#[derive(Serialize)]
struct Replayed<'a, R> {
    /// Path of its record.
    record: String,
    /// `keyway.navigate/4`, or `keyway.team/1`.
    report: WithFiles<'a, R>,
}

pub(crate) fn run(args: &ReplayArgs) -> Result<Done, CliError> {
    refuse_one_file_for_several(args)?;
    let mut runs = Vec::new();
    for path in &args.records {
        let is_recording = ReplayArgs::is_recording(path);
        let run = if is_recording { flight::replay(args, path) } else { replay(args, path) };
        runs.extend(run?);
    }
    if args.format == Format::Json {
        crate::json::print(&ReplayReport { schema: "keyway.replay/1", runs })?;
    }
    Ok(Done::Success)
}

/// Recomputes a run. The result is printed, or returned for the report.
fn replay(args: &ReplayArgs, path: &Path) -> Result<Option<Value>, CliError> {
    let request = ReplayRequest {
        record: path.to_owned(),
        map_dir: args.map_dir.clone(),
        max_cells: args.limit.max_cells,
    };
    let replay = request.read(&RunBar::default())?;
    let sources = &replay.sources;
    let name = path.file_stem().unwrap_or_default();
    let out = args.files.out.as_ref().map(|folder| folder.join(name));
    let files = DriveFileArgs { out, ..args.files.clone() };
    let episode = &replay.episode;
    if replay.has_robots {
        team::refuse_what_is_for_one(&files)?;
        let out = prepared(&files, sources)?;
        let report = team::drive(episode)?;
        replay.check_episode(&report)?;
        let files = team::write_all(&files, episode, &report, out)?;
        let shown_report = WithFiles { report: &report, files: &files };
        return shown(args, path, shown_report, || team::table(&report));
    }
    let out = prepared(&files, sources)?;
    let driven = drive(episode, wanted(&files))?;
    replay.check(&driven.report)?;
    let files = write_all(&files, episode, &driven, out)?;
    let shown_report = WithFiles { report: &driven.report, files: &files };
    shown(args, path, shown_report, || table(episode, &driven))
}

/// Output for a run that was reproduced identically.
fn shown<R: Serialize>(
    args: &ReplayArgs,
    path: &Path,
    report: WithFiles<'_, R>,
    table: impl FnOnce() -> String,
) -> Result<Option<Value>, CliError> {
    if args.format == Format::Json {
        let replayed = Replayed { record: path.display().to_string(), report };
        // Plain data with string keys: this cannot fail.
        return Ok(serde_json::to_value(replayed).ok());
    }
    print(&format!("{}{}, run reproduced:\n", gap(args, path), path.display()))?;
    print(&table())?;
    print_files(report.files)?;
    Ok(None)
}

/// An empty line between records.
fn gap(args: &ReplayArgs, path: &Path) -> &'static str {
    if args.records.first().is_some_and(|first| first == path) { "" } else { "\n" }
}

fn refuse_one_file_for_several(args: &ReplayArgs) -> Result<(), CliError> {
    let DriveFileArgs { explain, animate, record, .. } = &args.files;
    let given = [
        (explain.is_some(), "--explain"),
        (animate.is_some(), "--animate"),
        (record.is_some(), "--record"),
    ];
    let Some((_, flag)) = given.into_iter().find(|(is_given, _)| *is_given) else { return Ok(()) };
    if args.records.len() == 1 {
        return Ok(());
    }
    let message = format!(
        "{flag} writes one file, but there are {} records; replay them one by one",
        args.records.len()
    );
    Err(CliError::new(Kind::Usage, message).field(flag))
}
