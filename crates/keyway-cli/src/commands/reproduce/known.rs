//! Maps that were measured before.

use keyway_lab::claims::{Experiment, MapRow};
use keyway_lab::results::Entry;
use keyway_lab::results::digest;
use keyway_sim::report::Inputs;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// What an experiment gave on a map: a line of `maps.jsonl`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Line {
    pub(super) experiment: String,
    /// Of all that it depends on, but for the seed.
    pub(super) digest: String,
    pub(super) group: Group,
    /// 0 for the scene.
    pub(super) seed: u64,
    pub(super) row: MapRow,
}

/// What a map is one of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Group {
    Scene,
    Reconstruction,
    Family,
}

impl Entry for Line {
    const NOT_ONE: &'static str = "it is not the journal of a reproduction of this version; move it away, or choose another folder";
    const BEGIN: &'static [u8] = b"{\"experiment\":";
}

/// Lines by their digests and seeds.
#[derive(Default)]
pub(super) struct Known(HashMap<(String, u64), Line>);

impl Known {
    /// Lines of another version are left out.
    pub(super) fn of(text: &str, held: Vec<Line>) -> Self {
        let written = text.lines().filter_map(|line| serde_json::from_str(line).ok());
        let by_key = |line: Line| ((line.digest.clone(), line.seed), line);
        Self(written.chain(held).map(by_key).collect())
    }

    pub(super) fn get(&self, digest: &str, seed: u64) -> Option<&Line> {
        self.0.get(&(digest.to_owned(), seed))
    }
}

/// Of the version of this program, of all that an experiment is made of, and of whether times are measured.
pub(super) fn digest_of(experiment: &Experiment, group: Group, times: bool) -> String {
    let Experiment { name, about, family, ends, methods, scene, reconstruction, .. } = experiment;
    let maps = match group {
        Group::Scene => format!("{scene:?}"),
        Group::Reconstruction => format!("{reconstruction:?}"),
        Group::Family => format!("{family:?} {ends:?} {about}"),
    };
    let all = format!("{} {name} {maps} {methods:?} {times}", Inputs::VERSION);
    digest(all.as_bytes())
}
