//! The progress of the preparation of a map.

/// The progress of a preparation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PrepareProgress {
    /// Corner cells that have been ordered, plus those whose labels were entered.
    pub done: u64,
    /// Value of `done` at the end.
    pub total: u64,
}
