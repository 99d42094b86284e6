//! Which part of a batch a folder holds: `keyway.batch.part/1`.

use crate::args::Shard;
use keyway_lab::batch::RunId;
use keyway_lab::results::digest;
use serde::{Deserialize, Serialize};

/// The I-th of N parts. The runs of the batch go to the parts in turn.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    schema: String,
    /// From 1.
    pub(super) number: usize,
    pub(super) of: usize,
    /// Over all runs of the whole batch: parts of the same batch have the same.
    pub(super) batch: String,
}

impl Part {
    /// Name and version of this form.
    pub(super) const SCHEMA: &'static str = "keyway.batch.part/1";

    /// `runs` are all those of the batch.
    pub(super) fn new<'a>(shard: Shard, runs: impl Iterator<Item = RunId<'a>>) -> Self {
        let Shard { number, of } = shard;
        Self { schema: Self::SCHEMA.to_owned(), number, of, batch: Self::batch_of(runs) }
    }

    /// The digest of a whole batch.
    pub(super) fn batch_of<'a>(runs: impl Iterator<Item = RunId<'a>>) -> String {
        let all: Vec<&str> = runs.map(|run| run.digest).collect();
        digest(all.concat().as_bytes())
    }

    /// Whether it is what it says.
    pub(super) fn is_sound(&self) -> bool {
        let Self { schema, number, of, .. } = self;
        schema == Self::SCHEMA && (1..=*of).contains(number) && *of <= Shard::MOST
    }
}
