//! Replay of recordings: recomputes the decisions and compares them.

use super::gap;
use crate::args::{DriveFileArgs, Format, ReplayArgs};
use crate::commands::print;
use crate::error::{CliError, Kind};
use crate::inputs::{refuse_to_replace_a_source, refuse_unwritable};
use crate::out_file::write_file;
use keyway_lab::recording::{Flight, RecordingError, decide_again};
use keyway_sim::episode::{Cycle, CycleReport};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// Replay of a recording in which every decision was identical.
#[derive(Serialize)]
pub(super) struct Redecided {
    /// Path of the recording.
    record: String,
    flight: Flight,
    /// The written files.
    files: Vec<String>,
}

/// Recomputes the decisions of a recording. The result is printed, or returned for the report.
pub(super) fn replay(args: &ReplayArgs, path: &Path) -> Result<Option<Value>, CliError> {
    let explain = args.files.explain.as_ref();
    refuse_pictures(&args.files)?;
    if let Some(explain) = explain {
        refuse_to_replace_a_source(&[path.to_owned()], explain, "--explain")?;
        refuse_unwritable(explain, "--explain")?;
    }
    let mut explanations = String::new();
    let mut watch = |cycle: &Cycle<'_>| {
        if explain.is_some() {
            let report = CycleReport::of(cycle, &cycle.navigator.explain());
            // Plain data with string keys: this cannot fail.
            explanations += &serde_json::to_string(&report).unwrap_or_default();
            explanations.push('\n');
        }
    };
    let flight = decide_again(path, &mut watch);
    // The explanations are most useful if a decision differs.
    if let Some(explain) = explain {
        write_file(explain, explanations.as_bytes(), "--explain")?;
    }
    let flight = flight?;
    let files: Vec<String> = explain.iter().map(|path| path.display().to_string()).collect();
    let record = path.display().to_string();
    if args.format == Format::Json {
        // Plain data with string keys: this cannot fail.
        return Ok(serde_json::to_value(Redecided { record, flight, files }).ok());
    }
    let Flight { cycles, is_complete, .. } = flight;
    let end = if is_complete { "" } else { "; the recording is incomplete" };
    print(&format!("{}{record}: {cycles} decisions, all reproduced{end}", gap(args, path)))?;
    crate::stdout::print_files(&files)?;
    Ok(None)
}

fn refuse_pictures(args: &DriveFileArgs) -> Result<(), CliError> {
    let given = [
        (args.out.is_some(), "--out"),
        (args.fan.is_some(), "--fan"),
        (args.animate.is_some(), "--animate"),
        (args.record.is_some(), "--record"),
    ];
    let Some((_, flag)) = given.into_iter().find(|(is_given, _)| *is_given) else { return Ok(()) };
    let message = format!(
        "{flag} needs a record of a simulated run; a recording does not contain the world; open it in Foxglove or Lichtblick"
    );
    Err(CliError::new(Kind::Usage, message).field(flag))
}

impl From<RecordingError> for CliError {
    fn from(error: RecordingError) -> Self {
        Self::new(Kind::Input, error).field("RECORD.mcap")
    }
}
