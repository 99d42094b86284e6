//! The part of a snapshot that holds the state of decisions.

use super::Counts;
use super::guarding::StoredGuard;
use crate::local::Evaluation;
use serde::{Deserialize, Serialize};

/// State of decisions in serialised form.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::navigate) struct StoredRecord {
    pub(super) evaluation: Evaluation,
    pub(super) guard: StoredGuard,
    pub(super) counts: Counts,
}
