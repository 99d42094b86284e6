//! Parts of a batch.

use super::RunId;
use crate::results::digest;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A part of the runs of a batch; the runs are dealt to the parts in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

/// Error of a part number or a number of parts that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "shard must be a part and the number of parts, at most {}, got part {number} of {of}",
    Shard::MOST
)]
pub struct ShardError {
    /// Given number of the part.
    pub number: usize,
    /// Given number of parts.
    pub of: usize,
}

impl Shard {
    /// Largest number of parts of a batch.
    pub const MOST: usize = 10_000;

    /// Returns the part with this number, from 1, of the given number of parts.
    ///
    /// # Errors
    /// Returns [`ShardError`] if there are too many parts, or no part has this number.
    pub const fn new(number: usize, of: usize) -> Result<Self, ShardError> {
        if 1 <= number && number <= of && of <= Self::MOST {
            Ok(Self { number, of })
        } else {
            Err(ShardError { number, of })
        }
    }

    /// True if the part holds the run of this index.
    pub(super) const fn holds(self, index: usize) -> bool {
        index % self.of == self.number - 1
    }
}

/// The part of a batch that a folder holds: `keyway.batch.part/1`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    schema: String,
    /// Number of the part, from 1.
    pub(super) number: usize,
    /// Number of parts.
    pub(super) of: usize,
    /// Digest over all runs of the whole batch, which all its parts have in common.
    pub(super) batch: String,
}

impl Part {
    /// Name and version of this form.
    const SCHEMA: &'static str = "keyway.batch.part/1";

    /// Creates the description of a part; `runs` are all runs of the batch.
    pub(super) fn new<'a>(shard: Shard, runs: impl Iterator<Item = RunId<'a>>) -> Self {
        let Shard { number, of } = shard;
        Self { schema: Self::SCHEMA.to_owned(), number, of, batch: Self::batch_of(runs) }
    }

    /// Returns the digest of a whole batch.
    pub(super) fn batch_of<'a>(runs: impl Iterator<Item = RunId<'a>>) -> String {
        let all: Vec<&str> = runs.map(|run| run.digest).collect();
        digest(all.concat().as_bytes())
    }

    /// True if the schema is known and such a part exists.
    pub(super) fn is_sound(&self) -> bool {
        self.schema == Self::SCHEMA && Shard::new(self.number, self.of).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_in_one_part() {
        let parts: Vec<Shard> = (1..=3).map(|number| Shard::new(number, 3).unwrap()).collect();
        for index in 0..7 {
            let holders: Vec<usize> = (0..3).filter(|&i| parts[i].holds(index)).collect();
            assert_eq!(holders, [index % 3]);
        }
    }

    #[test]
    fn parts_that_cannot_be_are_refused() {
        for (number, of) in [(0, 2), (3, 2), (1, 10_001), (0, 0)] {
            let error = Shard::new(number, of).unwrap_err();
            let expected = format!("at most 10000, got part {number} of {of}");
            assert!(error.to_string().ends_with(&expected), "{error}");
        }
    }
}
