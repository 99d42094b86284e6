//! Report of a batch.

use super::{AgainstFirst, Record, SceneSummary, StackSummary, Wins};
use crate::measure::mean;
use crate::table::{number, paragraph};
use serde::Serialize;
use std::path::PathBuf;

/// Report `keyway.batch/1`: summaries of the runs of a batch, and the paths of their files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BatchReport {
    /// Name and version of the format.
    pub schema: &'static str,
    /// Number of runs.
    pub runs: usize,
    /// Summary of each stack.
    pub stacks: Vec<StackSummary>,
    /// The stacks but the first, each compared with the first.
    pub against_first: Vec<AgainstFirst>,
    /// Results of each stack in each scene.
    pub scenes: Vec<SceneSummary>,
    /// Wins and losses of the first stack against each other one, by each measure.
    pub wins: Vec<Wins>,
    /// Wall-clock time of a decision, by stack.
    pub cycles: Vec<StackCycles>,
    /// Paths of the files that were written, in their order.
    pub files: Vec<String>,
    /// Number of full records in the folder of records.
    pub records: usize,
    /// The folder of records.
    #[serde(skip)]
    pub records_folder: PathBuf,
}

/// Wall-clock time of a decision. It differs from batch to batch; no comparison uses it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StackCycles {
    /// Name of the stack.
    pub stack: String,
    /// Mean of the runs' means \[us\]; `None` if no run made a decision.
    pub mean_cycle_us: Option<f64>,
}

impl StackCycles {
    pub(super) fn of(stack: &str, records: &[Record]) -> Self {
        let own = records.iter().filter(|record| record.run.stack == stack);
        let means: Vec<f64> = own.filter_map(|record| record.measured.mean_cycle_us).collect();
        Self { stack: stack.to_owned(), mean_cycle_us: mean(&means) }
    }
}

/// Wall-clock times for the terminal; `None` for a single stack.
pub fn cycles_line(cycles: &[StackCycles]) -> Option<String> {
    let of = |one: &StackCycles| format!("{} {}", one.stack, number(one.mean_cycle_us, 0));
    let all: Vec<String> = cycles.iter().map(of).collect();
    let text = format!("wall-clock time per decision [us]: {}", all.join(", "));
    (cycles.len() > 1).then(|| paragraph(&text))
}

impl BatchReport {
    /// Name and version of the format.
    pub const SCHEMA: &'static str = "keyway.batch/1";
}
