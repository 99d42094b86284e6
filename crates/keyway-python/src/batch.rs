//! Batches of simulated runs.

use crate::arrays::{Json, json};
use crate::comparison::{Words, refused};
use crate::errors::bad_value;
use crate::values::Listed;
use crate::watched::{Progress, watched_to_its_end};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Drives scenes with stacks and seeds, as `keyway batch` does, and writes the same files, byte for byte, into the folder `out`.
///
/// `scenes` are scene files and folders of them; `stacks` names or files, or `["all"]`; `seeds` how many seeds each scene is driven
/// with. `shard=(i, n)` makes the i-th of n parts only; `keyway.merge` puts parts together. `jobs` is the number of threads.
/// `keep` says of which runs to store a full record: `"none"`, `"failures"` or `"all"`. `robot` and `disturbances` are names or
/// files. With `safe` the stop rule is behind every stack. Runs that the folder holds are not made again: whoever stops a batch goes on where it was. `progress(done, expected)`
/// is called meanwhile.
///
/// Gives the report `keyway.batch/1` of `docs/JSON.md`.
///
/// >>> import keyway
/// >>> keyway.batch(["nowhere.toml"], out="unused")
/// Traceback (most recent call last):
/// ValueError: cannot read nowhere.toml: there is no such file or folder
#[pyfunction]
#[pyo3(signature = (scenes, out, stacks=None, seeds=1, jobs=None, shard=None, keep=None, robot=None, disturbances=None, safe=false, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn batch(
    py: Python<'_>,
    scenes: Listed<PathBuf>,
    out: PathBuf,
    stacks: Option<Listed<String>>,
    seeds: u64,
    jobs: Option<u64>,
    shard: Option<(u64, u64)>,
    keep: Option<String>,
    robot: Option<String>,
    disturbances: Option<PathBuf>,
    safe: bool,
    progress: Option<Progress>,
) -> PyResult<Json> {
    let mut words = Words::default();
    words.list("--stacks", stacks);
    words.option("--seeds", Some(seeds));
    words.option("--jobs", jobs);
    words.option("--shard", shard.map(|(part, parts)| format!("{part}/{parts}")));
    words.option("--keep", keep);
    words.option("--robot", robot);
    words.0.extend(safe.then(|| "--safe".into()));
    words.0.extend(path_option("--disturbances", disturbances));
    words.0.extend(path_option("--out", Some(out)));
    words.0.push("--".into());
    words.0.extend(scenes.0.into_iter().map(OsString::from));
    run(py, words, progress)
}

/// Puts together what `keyway.batch` has made in other folders, such as the parts of one batch; nothing is driven.
///
/// >>> import keyway
/// >>> keyway.merge([], out="unused")
/// Traceback (most recent call last):
/// ValueError: parts: expected at least one folder
#[pyfunction]
pub(crate) fn merge(py: Python<'_>, parts: Listed<PathBuf>, out: PathBuf) -> PyResult<Json> {
    if parts.0.is_empty() {
        return Err(bad_value("parts: expected at least one folder"));
    }
    let mut words = Words(vec!["merge".into()]);
    words.0.extend(path_option("--out", Some(out)));
    words.0.push("--".into());
    words.0.extend(parts.0.into_iter().map(OsString::from));
    run(py, words, None)
}

fn path_option(option: &str, path: Option<PathBuf>) -> impl Iterator<Item = OsString> {
    path.into_iter().map(move |path| {
        let mut word = OsString::from(format!("{option}="));
        word.push(path);
        word
    })
}

fn run(py: Python<'_>, words: Words, progress: Option<Progress>) -> PyResult<Json> {
    let batch = move |watch: &crate::watched::Watch| keyway_cli::batch(&words.0, watch);
    let report =
        watched_to_its_end(py, progress.as_ref(), batch)?.map_err(|error| refused(&error))?;
    json(py, &report)
}
