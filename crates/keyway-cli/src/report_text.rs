//! Reports with their files.

use serde::Serialize;

/// A report, and the files that were written beside it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct WithFiles<'a, R> {
    #[serde(flatten)]
    pub(crate) report: &'a R,
    /// Their paths, in the order in which they were written.
    pub(crate) files: &'a [String],
}
