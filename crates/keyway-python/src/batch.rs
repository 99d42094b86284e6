//! Batches of simulated runs.

use crate::arrays::{Json, json};
use crate::errors::bad_value;
use crate::parameters::{Parameters, RobotName};
use crate::values::Listed;
use crate::watched::{Progress, Watch, watched_to_its_end};
use keyway::files::Assignment;
use keyway_cli::BatchPlots;
use keyway_lab::batch::{BatchError, BatchReport, BatchRequest, Keep, MergeRequest, Shard};
use keyway_sim::sim::ReachedBy;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Drives scenes with stacks and seeds, as `keyway batch` does, and writes the same files, byte
/// for byte, into the folder `out`.
///
/// `scenes` are scene files, or folders of them. `stacks` are names or files, or `["all"]`.
/// `seeds` is the number of seeds for each scene. `shard=(i, n)` runs only the i-th of n parts;
/// `keyway.merge` merges the parts. `jobs` is the number of threads. `keep` selects the runs that
/// get a full record: `"none"`, `"failures"` or `"all"`. `robot` and `disturbances` are names or
/// files. `reached_by` is the pose that counts as reaching a goal, `"truth"` or `"belief"`.
/// `safe` enables the stop rule for every stack. `parameters` override those of every stack, and
/// their `robot` table those of every robot. Finished runs in the folder are not repeated, so an
/// interrupted batch is resumed. `progress(done, expected)` is called meanwhile.
///
/// Returns the report `keyway.batch/1` of `docs/reference/json.md`.
///
/// >>> import keyway
/// >>> keyway.batch(["nowhere.toml"], out="unused")
/// Traceback (most recent call last):
/// ValueError: cannot read nowhere.toml: there is no such file or folder
#[pyfunction]
#[pyo3(signature = (scenes, out, stacks=None, seeds=1, jobs=None, shard=None, keep=None, robot=None, disturbances=None, reached_by=None, safe=false, parameters=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn batch(
    py: Python<'_>,
    scenes: Listed<PathBuf>,
    out: PathBuf,
    stacks: Option<Listed<String>>,
    seeds: u64,
    jobs: Option<usize>,
    shard: Option<(usize, usize)>,
    keep: Option<String>,
    robot: Option<RobotName>,
    disturbances: Option<PathBuf>,
    reached_by: Option<String>,
    safe: bool,
    parameters: Option<Parameters>,
    progress: Option<Progress>,
) -> PyResult<Json> {
    if stacks.as_ref().is_some_and(|Listed(stacks)| stacks.is_empty()) {
        return Err(bad_value("stacks: expected at least one stack"));
    }
    let shard = shard.map(|(part, parts)| Shard::new(part, parts)).transpose();
    let request = BatchRequest {
        stacks: stacks.map(|Listed(stacks)| stacks).unwrap_or_default(),
        seeds,
        jobs,
        shard: shard.map_err(bad_value)?,
        keep: keep.map_or(Ok(Keep::None), |keep| choice(&keep))?,
        robot: robot.map(|RobotName(name)| name),
        disturbances,
        reached_by: reached_by.map(|pose| reached(&pose)).transpose()?,
        safe,
        set: parameters.map_or_else(Vec::new, |Parameters(table)| Assignment::all_of(&table)),
        ..BatchRequest::new(scenes.0.into_iter().map(Into::into).collect(), out)
    };
    run(py, progress, move |watch| request.drive(&BatchPlots, watch))
}

fn reached(pose: &str) -> PyResult<ReachedBy> {
    ReachedBy::by_name(pose).ok_or_else(|| {
        let names = ReachedBy::NAMES.join(", ");
        bad_value(format!("reached_by: expected one of {names}, got `{pose}`"))
    })
}

fn choice(keep: &str) -> PyResult<Keep> {
    Keep::by_name(keep).ok_or_else(|| {
        let names = Keep::NAMES.join(", ");
        bad_value(format!("keep: expected one of {names}, got `{keep}`"))
    })
}

/// Merges results of `keyway.batch` from several folders, such as the parts of one batch. Nothing
/// is driven.
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
    let request = MergeRequest { parts: parts.0, out };
    run(py, None, move |watch| request.merge(&BatchPlots, watch))
}

fn run(
    py: Python<'_>,
    progress: Option<Progress>,
    work: impl FnOnce(&Watch) -> Result<BatchReport, BatchError> + Send + 'static,
) -> PyResult<Json> {
    json(py, &watched_to_its_end(py, progress.as_ref(), work)?.map_err(bad_value)?)
}
