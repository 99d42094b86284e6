//! The files that a batch writes.

use super::by_scene::{SceneSummary, scenes_markdown};
use super::part::Part;
use super::wins::Contest;
use super::wins_text::wins_markdown;
use super::{
    AgainstFirst, Record, Row, RunTimes, StackSummary, against_first_latex, against_first_markdown,
    summary_latex, summary_markdown,
};
use crate::results::{OutDir, ResultsError, json_text};
use crate::table::csv;
use serde::{Deserialize, Serialize};

pub(super) const RUNS: &str = "runs.jsonl";
const RUNS_CSV: &str = "runs.csv";
pub(super) const ROBOTS: &str = "robots.jsonl";
const ROBOTS_CSV: &str = "robots.csv";
pub(super) const TIMES: &str = "times.jsonl";
pub(super) const PART: &str = "part.json";
const SUMMARY_CSV: &str = "summary.csv";
const SUMMARY_MD: &str = "summary.md";
const SUMMARY_TEX: &str = "summary.tex";
const AGAINST_CSV: &str = "against_first.csv";
const AGAINST_TEX: &str = "against_first.tex";
const BY_SCENE_CSV: &str = "by_scene.csv";
const WINS_CSV: &str = "wins.csv";
const WINS_MD: &str = "wins.md";

/// All files except pictures: the runs in two formats, their robots if there are several, the
/// times, the part of a batch, the summary, the comparison with the first stack, the results by
/// scene, and the wins of the first stack. Tables are for programs, for display and for papers.
pub(super) const TABLES: [&str; 14] = [
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
    BY_SCENE_CSV,
    WINS_CSV,
    WINS_MD,
];

/// A line of `times.jsonl`.
#[derive(Serialize, Deserialize)]
pub(super) struct TimeLine {
    /// Digest of the run.
    pub(super) digest: String,
    #[serde(flatten)]
    pub(super) measured: RunTimes,
}

/// Writes the runs, their robots and their times, and the description of the part of a batch.
pub(super) fn write_runs(
    records: &[Record],
    part: Option<&Part>,
    out: &mut OutDir,
) -> Result<(), ResultsError> {
    let rows: Vec<&Row> = records.iter().map(|record| &record.run).collect();
    let times: Vec<TimeLine> = records
        .iter()
        .map(|record| TimeLine { digest: record.run.digest.clone(), measured: record.measured })
        .collect();
    let robots: Vec<&Row> = records.iter().flat_map(|record| &record.robots).collect();
    // The runs come last, so that a known run is complete.
    out.write(TIMES, lines(&times).as_bytes())?;
    if !robots.is_empty() {
        out.write(ROBOTS, lines(&robots).as_bytes())?;
        out.write(ROBOTS_CSV, csv(&robots).as_bytes())?;
    }
    out.write(RUNS, lines(&rows).as_bytes())?;
    out.write(RUNS_CSV, csv(&rows).as_bytes())?;
    match part {
        Some(part) => out.write(PART, json_text(part).as_bytes()),
        None => Ok(()),
    }
}

/// Writes the summaries of the runs.
pub(super) fn write_summaries(
    stacks: &[StackSummary],
    against_first: &[AgainstFirst],
    scenes: &[SceneSummary],
    out: &mut OutDir,
) -> Result<(), ResultsError> {
    out.write(SUMMARY_CSV, csv(stacks).as_bytes())?;
    out.write(AGAINST_CSV, csv(against_first).as_bytes())?;
    out.write(BY_SCENE_CSV, csv(scenes).as_bytes())?;
    let by_scene = scenes_markdown(scenes).unwrap_or_default();
    let text = summary_markdown(stacks) + &against_first_markdown(against_first) + &by_scene;
    out.write(SUMMARY_MD, text.as_bytes())?;
    out.write(SUMMARY_TEX, summary_latex(stacks).as_bytes())?;
    match against_first_latex(against_first) {
        Some(text) => out.write(AGAINST_TEX, text.as_bytes()),
        None => Ok(()),
    }
}

/// Writes the wins and losses of the first stack, if there are several.
pub(super) fn write_wins(
    records: &[Record],
    contest: &Contest<'_>,
    out: &mut OutDir,
) -> Result<(), ResultsError> {
    if contest.wins.is_empty() {
        return Ok(());
    }
    out.write(WINS_CSV, csv(&contest.lines).as_bytes())?;
    out.write(WINS_MD, wins_markdown(records, contest).as_bytes())
}

/// JSON, a line for each row.
fn lines(rows: &[impl Serialize]) -> String {
    // Rows are plain data with string keys, so this cannot fail.
    let line = |row| serde_json::to_string(row).unwrap_or_default() + "\n";
    rows.iter().map(line).collect()
}
