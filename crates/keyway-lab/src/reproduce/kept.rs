//! Results of maps that were measured before.

use crate::claims::{Experiment, MapRow};
use crate::results::{JournalEntry, digest};
use keyway_sim::report::Inputs;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Result of an experiment on a map: a line of `maps.jsonl`, and of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapLine {
    /// Name of the experiment.
    pub experiment: String,
    /// Digest of everything that the result depends on, except the seed.
    pub digest: String,
    /// Kind of the map.
    pub group: MapGroup,
    /// Seed of the map; 0 for the scene.
    pub seed: u64,
    /// Results of all methods.
    pub row: MapRow,
}

/// Kind of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MapGroup {
    /// The paper's scene.
    Scene,
    /// A map that fits the published figures of the baselines.
    Reconstruction,
    /// A map of the experiment's family.
    Family,
}

impl JournalEntry for MapLine {
    const NOT_ONE: &'static str = "it is not the journal of a reproduction of this version of Keyway; \
                                   move it away, or choose another folder";
    const BEGIN: &'static [u8] = b"{\"experiment\":";
}

/// Lines by their digests and seeds.
#[derive(Default)]
pub(super) struct KeptLines(HashMap<(String, u64), MapLine>);

impl KeptLines {
    /// Takes the lines of earlier results and of a journal, without those of another version.
    pub(super) fn new(earlier: &str, journal: Vec<MapLine>) -> Self {
        let written = earlier.lines().filter_map(|line| serde_json::from_str(line).ok());
        let by_key = |line: MapLine| ((line.digest.clone(), line.seed), line);
        Self(written.chain(journal).map(by_key).collect())
    }

    pub(super) fn get(&self, digest: &str, seed: u64) -> Option<&MapLine> {
        self.0.get(&(digest.to_owned(), seed))
    }
}

/// Returns a digest of the version of Keyway, all parts of an experiment, and the choice to
/// measure times.
pub(super) fn digest_of(experiment: &Experiment, group: MapGroup, has_times: bool) -> String {
    let Experiment { name, about, family, ends, methods, scene, reconstruction, .. } = experiment;
    let maps = match group {
        MapGroup::Scene => format!("{scene:?}"),
        MapGroup::Reconstruction => format!("{reconstruction:?}"),
        MapGroup::Family => format!("{family:?} {ends:?} {about}"),
    };
    let all = format!("{} {name} {maps} {methods:?} {has_times}", Inputs::VERSION);
    digest(all.as_bytes())
}
