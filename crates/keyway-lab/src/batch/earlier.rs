//! Results of earlier batches.

use super::files::{PART, ROBOTS, RUNS, TIMES, TimeLine};
use super::part::Part;
use super::{PartsError, Record, Row};
use crate::results::{JOURNAL_NAME, LinesError, OutDir, ResultsError, entries, read_lines};
use keyway::files::read_text;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Upper bound of the size of `part.json`.
const MAX_PART_BYTES: u64 = 1 << 20;

/// All results of a finished batch, or of a part of one.
pub(super) struct EarlierBatch {
    pub(super) folder: PathBuf,
    pub(super) records: Vec<Record>,
    pub(super) part: Option<Part>,
}

/// Returns the runs that a folder already holds, except those of another version.
pub(super) fn known(out: &OutDir) -> Result<Vec<Record>, ResultsError> {
    let Some((runs, times)) = out.earlier(RUNS)?.zip(out.earlier(TIMES)?) else {
        return Ok(Vec::new());
    };
    let robots = out.earlier(ROBOTS)?.unwrap_or_default();
    let robots = robots.lines().filter_map(|line| serde_json::from_str(line).ok());
    let mut robots = Robots::of(robots);
    let lines = runs.lines().zip(times.lines()).filter_map(|(run, time)| {
        Some((serde_json::from_str(run).ok()?, serde_json::from_str(time).ok()?))
    });
    Ok(lines.filter_map(|(run, time)| record_of(run, time, &mut robots)).collect())
}

/// Joins a line of `runs.jsonl` with its lines of `times.jsonl` and `robots.jsonl`.
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

    /// Removes and returns the robots of a run, if all are present.
    fn take(&mut self, run: &Row) -> Option<Vec<Row>> {
        let rows = self.0.remove(&(run.scene.clone(), run.digest.clone()))?;
        let are_all = (0..run.robots).map(Some).eq(rows.iter().map(|row| row.robot));
        are_all.then_some(rows)
    }
}

impl EarlierBatch {
    pub(super) fn read(folder: &Path) -> Result<Self, PartsError> {
        let journal = folder.join(JOURNAL_NAME);
        if journal.exists() {
            return Err(PartsError::NotEnded { journal });
        }
        let runs: Vec<Row> = read_entries(folder, RUNS)?;
        let times: Vec<TimeLine> = read_entries(folder, TIMES)?;
        if runs.len() != times.len() {
            return Err(PartsError::Times { times: folder.join(TIMES) });
        }
        let robots =
            if folder.join(ROBOTS).exists() { read_entries(folder, ROBOTS)? } else { Vec::new() };
        let mut robots = Robots::of(robots);
        let record = |(line, (run, time))| {
            let incomplete = || PartsError::Incomplete { runs: folder.join(RUNS), line };
            record_of(run, time, &mut robots).ok_or_else(incomplete)
        };
        let records =
            (1..).zip(runs.into_iter().zip(times)).map(record).collect::<Result<_, _>>()?;
        Ok(Self { folder: folder.to_owned(), records, part: read_part(folder)? })
    }
}

/// Reads the part of a batch that a folder holds; `None` for a whole batch.
fn read_part(folder: &Path) -> Result<Option<Part>, PartsError> {
    let path = folder.join(PART);
    if !path.exists() {
        return Ok(None);
    }
    let text = read_text(&path, MAX_PART_BYTES)?;
    let part = serde_json::from_str(&text).ok().filter(Part::is_sound);
    part.map(Some).ok_or(PartsError::NoPart { path })
}

/// Reads the lines of a file of results.
fn read_entries<E: DeserializeOwned>(folder: &Path, name: &str) -> Result<Vec<E>, PartsError> {
    const NOT_ONE: &str = "it is not from a batch of this version of Keyway; run the batch again";
    let path = folder.join(name);
    let lines = |text: Vec<u8>| -> Result<Vec<E>, LinesError> { entries(&path, &text, NOT_ONE) };
    read_lines(&path).and_then(lines).map_err(PartsError::Lines)
}
