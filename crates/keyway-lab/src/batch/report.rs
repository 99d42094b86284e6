//! Report of a batch.

use super::{AgainstFirst, StackSummary};
use serde::Serialize;
use std::path::PathBuf;

/// `keyway.batch/1`: what the runs of a batch say together, and where they are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BatchReport {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Number of runs.
    pub runs: usize,
    /// Summary of each stack.
    pub stacks: Vec<StackSummary>,
    /// The stacks but the first, each compared with the first.
    pub against_first: Vec<AgainstFirst>,
    /// Paths of the files that were written, in their order.
    pub files: Vec<String>,
    /// Number of full records in the folder of records.
    pub records: usize,
    /// The folder of records.
    #[serde(skip)]
    pub records_folder: PathBuf,
}

impl BatchReport {
    /// Name and version of the form.
    pub const SCHEMA: &'static str = "keyway.batch/1";
}
