//! The files that a batch leaves.

use super::against_first::{self, AgainstFirst};
use super::journal::fill;
use super::plan::Planned;
use super::plots;
use super::record::{Measured, Record, Row};
use super::summary::{StackSummary, latex, markdown};
use crate::args::BatchArgs;
use crate::csv_text::csv;
use crate::error::{CliError, Kind};
use crate::out_dir::OutDir;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// All but the plots: the runs twice, what was measured of them, the summary, the stacks against the first one, and both for people
/// and for papers.
const NAMES: [&str; 8] = [
    "runs.jsonl",
    "runs.csv",
    "times.jsonl",
    "summary.csv",
    "against_first.csv",
    "summary.md",
    "summary.tex",
    "against_first.tex",
];

/// The plots, too.
pub(super) fn names() -> Vec<&'static str> {
    NAMES.into_iter().chain(plots::NAMES).collect()
}

/// A line of `times.jsonl`.
#[derive(Serialize, Deserialize)]
struct TimeLine {
    digest: String,
    #[serde(flatten)]
    measured: Measured,
}

/// The runs that the folder and those of `--from` hold already.
pub(super) fn known(
    planned: &[Planned],
    out: &OutDir,
    args: &BatchArgs,
) -> Result<Vec<Option<Record>>, CliError> {
    let mut records = vec![None; planned.len()];
    let [runs, _, times, ..] = NAMES;
    let texts = out.earlier(runs).zip(out.earlier(times));
    if let Some((runs, times)) = texts {
        fill(planned, &mut records, of_lines(&runs, &times));
    }
    for folder in &args.from {
        let (runs, times) = (read(&folder.join(runs))?, read(&folder.join(times))?);
        fill(planned, &mut records, of_lines(&runs, &times));
    }
    Ok(records)
}

fn read(path: &Path) -> Result<String, CliError> {
    fs::read_to_string(path).map_err(|error| {
        let message = format!("{}: {error}; it is written when a batch has ended", path.display());
        CliError::new(Kind::Input, message).field("--from")
    })
}

/// Lines that are of another version are not looked at: their runs are made again.
fn of_lines(runs: &str, times: &str) -> Vec<Record> {
    let runs = runs.lines().map(|line| serde_json::from_str::<Row>(line).ok());
    let times = times.lines().map(|line| serde_json::from_str::<TimeLine>(line).ok());
    let both = runs.zip(times).filter_map(|(run, time)| run.zip(time));
    both.filter(|(run, time)| run.digest == time.digest)
        .map(|(run, time)| Record { run, measured: time.measured })
        .collect()
}

/// Writes all files; gives their paths.
pub(super) fn write_files(
    records: &[Record],
    stacks: &[StackSummary],
    against_first: &[AgainstFirst],
    mut out: OutDir,
) -> Result<Vec<String>, CliError> {
    let rows: Vec<&Row> = records.iter().map(|record| &record.run).collect();
    let times: Vec<TimeLine> = records
        .iter()
        .map(|record| TimeLine { digest: record.run.digest.clone(), measured: record.measured })
        .collect();
    let [runs, runs_csv, times_name, summary, against, markdown_name, tex, against_tex] = NAMES;
    // The times first: what is known of a run is both.
    out.write(times_name, lines(&times).as_bytes())?;
    out.write(runs, lines(&rows).as_bytes())?;
    out.write(runs_csv, csv(&rows).as_bytes())?;
    out.write(summary, csv(stacks).as_bytes())?;
    out.write(against, csv(against_first).as_bytes())?;
    let text = markdown(stacks) + &against_first::markdown(against_first);
    out.write(markdown_name, text.as_bytes())?;
    out.write(tex, latex(stacks).as_bytes())?;
    if let Some(text) = against_first::latex(against_first) {
        out.write(against_tex, text.as_bytes())?;
    }
    let names: Vec<&str> = stacks.iter().map(|summary| summary.stack.as_str()).collect();
    for (name, bytes) in plots::plots(records, &names)? {
        out.write(name, &bytes)?;
    }
    let written = out.finish()?;
    Ok(written.iter().map(|path| path.display().to_string()).collect())
}

/// JSON, a line for each.
fn lines(rows: &[impl Serialize]) -> String {
    // Rows are plain data with string keys: this cannot fail.
    let line = |row| serde_json::to_string(row).unwrap_or_default() + "\n";
    rows.iter().map(line).collect()
}
