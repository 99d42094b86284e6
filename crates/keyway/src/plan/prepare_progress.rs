//! The progress of the preparation of a map.

/// The progress of a preparation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PrepareProgress {
    /// Corner cells that have been put into their order, and those whose label was entered.
    pub done: u64,
    /// Both when all is done.
    pub total: u64,
}
