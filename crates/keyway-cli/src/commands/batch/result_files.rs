//! The files that a batch leaves.

use super::part::Part;
use super::plan::Planned;
use super::plots;
use crate::args::Shard;
use crate::error::{CliError, Kind};
use crate::inputs::read_text;
use keyway_lab::batch::Row;
use keyway_lab::batch::{
    AgainstFirst, StackSummary, against_first_latex, against_first_markdown, summary_latex,
    summary_markdown,
};
use keyway_lab::batch::{Measured, Record};
use keyway_lab::results::OutDir;
use keyway_lab::results::{JOURNAL_NAME, LinesError, entries, read_lines};
use keyway_lab::table::csv;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

const RUNS: &str = "runs.jsonl";
const RUNS_CSV: &str = "runs.csv";
const ROBOTS: &str = "robots.jsonl";
const ROBOTS_CSV: &str = "robots.csv";
const TIMES: &str = "times.jsonl";
const PART: &str = "part.json";
const SUMMARY_CSV: &str = "summary.csv";
const SUMMARY_MD: &str = "summary.md";
const SUMMARY_TEX: &str = "summary.tex";
const AGAINST_CSV: &str = "against_first.csv";
const AGAINST_TEX: &str = "against_first.tex";
/// More than `part.json` takes.
const MAX_PART_BYTES: u64 = 1 << 20;

/// All but the plots: the runs twice, their robots twice where there are several, what was measured of them, which part of a batch they are, the summary, and the stacks
/// against the first one, for programs, for people and for papers.
const TABLES: [&str; 11] = [
    RUNS,
    RUNS_CSV,
    ROBOTS,
    ROBOTS_CSV,
    TIMES,
    PART,
    SUMMARY_CSV,
    SUMMARY_MD,
    SUMMARY_TEX,
    AGAINST_CSV,
    AGAINST_TEX,
];

/// The plots, too.
pub(super) fn names() -> Vec<&'static str> {
    TABLES.into_iter().chain(plots::NAMES).collect()
}

/// A line of `times.jsonl`.
#[derive(Serialize, Deserialize)]
struct TimeLine {
    digest: String,
    #[serde(flatten)]
    measured: Measured,
}

/// The runs that the folder holds already. Those of another version are made again.
pub(super) fn known(planned: &[Planned], out: &OutDir) -> Result<Vec<Option<Record>>, CliError> {
    let mut records = vec![None; planned.len()];
    if let Some((runs, times)) = out.earlier(RUNS)?.zip(out.earlier(TIMES)?) {
        let robots = out.earlier(ROBOTS)?.unwrap_or_default();
        let robots = robots.lines().filter_map(|line| serde_json::from_str(line).ok());
        let mut robots = Robots::of(robots);
        let lines = runs.lines().zip(times.lines()).filter_map(|(run, time)| {
            Some((serde_json::from_str(run).ok()?, serde_json::from_str(time).ok()?))
        });
        let held = lines.filter_map(|(run, time)| record_of(run, time, &mut robots));
        fill(planned, &mut records, held);
    }
    Ok(records)
}

/// Puts records to the runs that they are of.
pub(super) fn fill(
    planned: &[Planned],
    records: &mut [Option<Record>],
    held: impl IntoIterator<Item = Record>,
) {
    let held: HashMap<String, Record> =
        held.into_iter().map(|record| (record.run.digest.clone(), record)).collect();
    for (planned, record) in planned.iter().zip(records) {
        let Some(found) = held.get(&planned.digest) else { continue };
        let run = &found.run;
        let is_same = run.scene == planned.scene && run.stack == planned.stack;
        if record.is_none() && is_same {
            *record = Some(found.clone());
        }
    }
}

/// A line of `runs.jsonl`, the one of `times.jsonl` that belongs to it, and those of `robots.jsonl`.
fn record_of(run: Row, time: TimeLine, robots: &mut Robots) -> Option<Record> {
    let TimeLine { digest, measured } = time;
    let robots = if run.robots == 1 { Vec::new() } else { robots.take(&run)? };
    (digest == run.digest).then_some(Record { run, robots, measured })
}

/// Lines of `robots.jsonl`, by the names of their scenes and the digests of their runs.
struct Robots(HashMap<(String, String), Vec<Row>>);

impl Robots {
    fn of(rows: impl IntoIterator<Item = Row>) -> Self {
        let mut by_run: HashMap<_, Vec<Row>> = HashMap::new();
        for row in rows {
            by_run.entry((row.scene.clone(), row.digest.clone())).or_default().push(row);
        }
        Self(by_run)
    }

    /// Those of a run, if all are there.
    fn take(&mut self, run: &Row) -> Option<Vec<Row>> {
        let rows = self.0.remove(&(run.scene.clone(), run.digest.clone()))?;
        let are_all = (0..run.robots).map(Some).eq(rows.iter().map(|row| row.robot));
        are_all.then_some(rows)
    }
}

/// All that a folder holds of another batch, which has ended; and which part it is.
pub(super) fn read_results(folder: &Path) -> Result<(Vec<Record>, Option<Part>), CliError> {
    let blame = |name: &str, what: &str| {
        let message = format!("{}: {what}", folder.join(name).display());
        CliError::new(Kind::Input, message).field("DIR")
    };
    if folder.join(JOURNAL_NAME).exists() {
        let what = "the batch has not ended; start it again, and it goes on where it was";
        return Err(blame(JOURNAL_NAME, what));
    }
    let runs: Vec<Row> = read_entries(folder, RUNS)?;
    let times: Vec<TimeLine> = read_entries(folder, TIMES)?;
    if runs.len() != times.len() {
        return Err(blame(TIMES, "it has not as many lines as runs.jsonl; make the batch again"));
    }
    let robots =
        if folder.join(ROBOTS).exists() { read_entries(folder, ROBOTS)? } else { Vec::new() };
    let mut robots = Robots::of(robots);
    let record = |(line, (run, time))| {
        let what = format!(
            "line {line}: {TIMES} or {ROBOTS} lack what belongs to it; make the batch again"
        );
        record_of(run, time, &mut robots).ok_or_else(|| blame(RUNS, &what))
    };
    let records = (1..).zip(runs.into_iter().zip(times)).map(record).collect::<Result<_, _>>()?;
    if !folder.join(PART).exists() {
        return Ok((records, None));
    }
    let text = read_text(&folder.join(PART), MAX_PART_BYTES, "DIR")?;
    let part = serde_json::from_str(&text).ok().filter(Part::is_sound);
    let what =
        format!("it does not say which part of a batch this is, of at most {} parts", Shard::MOST);
    Ok((records, Some(part.ok_or_else(|| blame(PART, &what))?)))
}

/// The lines of a file of results.
fn read_entries<E: DeserializeOwned>(folder: &Path, name: &str) -> Result<Vec<E>, CliError> {
    let path = folder.join(name);
    let what = "it is not from a batch of this version; make the batch again";
    let entries = read_lines(&path).and_then(|text| entries(&path, &text, what));
    entries.map_err(|error| {
        let hint = match error {
            LinesError::Read(_) => "; it is written when a batch has ended",
            _ => "",
        };
        CliError::new(Kind::Input, format!("{error}{hint}")).field("DIR")
    })
}

/// Writes all files; gives their paths.
pub(super) fn write_files(
    records: &[Record],
    part: Option<&Part>,
    stacks: &[StackSummary],
    against_first: &[AgainstFirst],
    mut out: OutDir,
) -> Result<Vec<String>, CliError> {
    let rows: Vec<&Row> = records.iter().map(|record| &record.run).collect();
    let times: Vec<TimeLine> = records
        .iter()
        .map(|record| TimeLine { digest: record.run.digest.clone(), measured: record.measured })
        .collect();
    let robots: Vec<&Row> = records.iter().flat_map(|record| &record.robots).collect();
    // The runs last: what is known of a run is all.
    out.write(TIMES, lines(&times).as_bytes())?;
    if !robots.is_empty() {
        out.write(ROBOTS, lines(&robots).as_bytes())?;
        out.write(ROBOTS_CSV, csv(&robots).as_bytes())?;
    }
    out.write(RUNS, lines(&rows).as_bytes())?;
    out.write(RUNS_CSV, csv(&rows).as_bytes())?;
    if let Some(part) = part {
        out.write(PART, crate::json::to_string(part).as_bytes())?;
    }
    out.write(SUMMARY_CSV, csv(stacks).as_bytes())?;
    out.write(AGAINST_CSV, csv(against_first).as_bytes())?;
    let text = summary_markdown(stacks) + &against_first_markdown(against_first);
    out.write(SUMMARY_MD, text.as_bytes())?;
    out.write(SUMMARY_TEX, summary_latex(stacks).as_bytes())?;
    if let Some(text) = against_first_latex(against_first) {
        out.write(AGAINST_TEX, text.as_bytes())?;
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
