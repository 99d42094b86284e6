//! Reports with the list of their files.

use serde::Serialize;

/// A report, and the files written beside it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct WithFiles<'a, R> {
    #[serde(flatten)]
    pub(crate) report: &'a R,
    /// Paths of the files, in the order of writing.
    pub(crate) files: &'a [String],
}
