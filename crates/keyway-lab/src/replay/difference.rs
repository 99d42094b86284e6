//! Differences between a run and its record.

use keyway_sim::episode::RobotReport;
use serde_json::Value;
use thiserror::Error;

/// The first difference between two runs.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Difference {
    /// The runs have different outcomes.
    #[error("its outcome was {recorded} and is {made} now")]
    Outcome {
        /// Outcome in the record.
        recorded: String,
        /// Outcome of the new run.
        made: String,
    },
    /// One run is longer than the other.
    #[error("its trajectory had {recorded} rows and has {made} now; the common rows are the same")]
    Length {
        /// Rows in the record.
        recorded: usize,
        /// Rows of the new run.
        made: usize,
    },
    /// The robot had another pose or another motion.
    #[error("row {row} of its trajectory was {recorded} and is {made} now")]
    Row {
        /// Index of the row, from 0.
        row: usize,
        /// Numbers of the row in the record.
        recorded: String,
        /// Numbers of the row in the new run.
        made: String,
    },
}

impl Difference {
    /// Compares outcome and trajectory, byte for byte: everything else in a report follows from
    /// them.
    pub(super) fn between(recorded: &Value, made: &RobotReport) -> Option<Self> {
        let outcome = recorded["outcome"].as_str().unwrap_or("missing");
        if outcome != made.outcome.name() {
            let made = made.outcome.name().to_owned();
            return Some(Self::Outcome { recorded: outcome.to_owned(), made });
        }
        let no_rows = Vec::new();
        let rows = recorded["trajectory"].as_array().unwrap_or(&no_rows);
        let made = made.trajectory.as_deref().unwrap_or_default();
        let texts = rows.iter().zip(made).map(|(recorded, made)| {
            // Serialising numbers cannot fail.
            (recorded.to_string(), serde_json::to_string(made).unwrap_or_default())
        });
        let differs = |(_, (recorded, made)): &(usize, (String, String))| recorded != made;
        if let Some((row, (recorded, made))) = texts.enumerate().find(differs) {
            return Some(Self::Row { row, recorded, made });
        }
        let (recorded, made) = (rows.len(), made.len());
        (recorded != made).then_some(Self::Length { recorded, made })
    }
}
