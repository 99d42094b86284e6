//! The part of a snapshot that remembers decisions.

use super::Counts;
use super::guarding::StoredGuard;
use crate::local::Evaluation;
use serde::{Deserialize, Serialize};

/// Memory of decisions, as it is stored.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::navigate) struct StoredRecord {
    pub(super) evaluation: Evaluation,
    pub(super) guard: StoredGuard,
    pub(super) counts: Counts,
}
