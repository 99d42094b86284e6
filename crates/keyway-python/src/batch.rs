//! Batches of simulated runs.

use crate::arrays::{Json, json};
use crate::errors::bad_value;
use crate::parameters::{Parameters, RobotName};
use crate::scene::Scene;
use crate::values::{Listed, described, is_path, items, listed};
use crate::watched::{Progress, Watch, watched_to_its_end};
use keyway::files::Assignment;
use keyway::map::formats::write_map;
use keyway_cli::BatchPlots;
use keyway_lab::batch::{
    BatchError, BatchReport, BatchRequest, GivenScene, Keep, MergeRequest, SceneSource, Shard,
};
use keyway_sim::scene_files::SceneMap;
use keyway_sim::sim::ReachedBy;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use pyo3::types::PyMapping;
use std::fs::create_dir_all;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Drives scenes with stacks and seeds, as `keyway batch` does, and writes the same files, byte
/// for byte, into the folder `out`.
///
/// `scenes` is a list of scene files, folders of them, and objects of `keyway.Scene`. A file has
/// its own name in the results, without `.toml`, and so has a scene that was read from it; a scene
/// in memory is called `scene-0`, by its index in the list. Other names are the keys of a
/// dictionary of scenes and scene files.
///
/// `stacks` are names or files, or `["all"]`. `seeds` is the number of seeds for each scene.
/// `shard=(i, n)` runs only the i-th of n parts; `keyway.merge` merges the parts. `jobs` is the
/// number of threads. `keep` selects the runs that get a full record: `"none"`, `"failures"` or
/// `"all"`. `robot` and `disturbances` are names or files. `reached_by` is the pose that counts
/// as reaching a goal, `"truth"` or `"belief"`. `safe` enables the stop rule for every stack.
/// `parameters` override those of every stack, and their `robot` table those of every robot.
/// Finished runs in the folder are not repeated, so an interrupted batch is resumed.
/// `progress(done, expected)` is called meanwhile.
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
    scenes: Scenes,
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
    let stacks = stacks.map(|stacks| stacks.named("stacks")).transpose()?;
    if stacks.as_ref().is_some_and(Vec::is_empty) {
        return Err(bad_value("stacks: expected at least one stack"));
    }
    let shard = shard.map(|(part, parts)| Shard::new(part, parts)).transpose();
    let keep = keep.map_or(Ok(Keep::None), |keep| choice(&keep))?;
    let (scenes, maps) = match keep {
        Keep::None => (scenes.named()?, Vec::new()),
        _ => with_map_files(scenes.named()?, &out)?,
    };
    let request = BatchRequest {
        stacks: stacks.unwrap_or_default(),
        seeds,
        jobs,
        shard: shard.map_err(bad_value)?,
        keep,
        robot: robot.map(|RobotName(name)| name),
        disturbances,
        reached_by: reached_by.map(|pose| reached(&pose)).transpose()?,
        safe,
        set: parameters.map_or_else(Vec::new, |Parameters(table)| Assignment::all_of(&table)),
        ..BatchRequest::new(scenes, out)
    };
    run(py, progress, move |watch| {
        let report = request.drive(&BatchPlots, watch);
        // Also those of a batch that was stopped.
        write_maps(&maps).and(report)
    })
}

/// Scenes in a list or a dictionary, or the description of something else.
pub(crate) struct Scenes(Result<Vec<SceneSource>, String>);

impl<'py> FromPyObject<'_, 'py> for Scenes {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = {
        use pyo3::{PyTypeInfo, type_hint_identifier, type_hint_subscript};
        type_hint_union!(
            type_hint_subscript!(
                type_hint_identifier!("collections.abc", "Sequence"),
                type_hint_union!(PathBuf::INPUT_TYPE, <Scene as PyTypeInfo>::TYPE_HINT)
            ),
            type_hint_subscript!(
                type_hint_identifier!("collections.abc", "Mapping"),
                type_hint_identifier!("builtins", "str"),
                type_hint_union!(PathBuf::INPUT_TYPE, <Scene as PyTypeInfo>::TYPE_HINT)
            )
        )
    };

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(named) = object.cast::<PyMapping>() {
            return named_scenes(&named).map(|scenes| Self(Ok(scenes)));
        }
        if object.is_instance_of::<Scene>() {
            return Ok(Self(Err(format!("{}: put it into a list", described(&object)))));
        }
        let all = items(&object);
        let sources = all.and_then(|all| {
            let numbers = (0..all.len()).map(|number| format!("scene-{number}"));
            let scenes = listed(&all, source)?;
            Ok(scenes.into_iter().zip(numbers).map(|(scene, number)| named(scene, number)))
        });
        Ok(Self(sources.map(Iterator::collect)))
    }
}

impl Scenes {
    fn named(self) -> PyResult<Vec<SceneSource>> {
        self.0.map_err(|got| {
            let expected = "a list of paths and scenes, or a dictionary of scenes";
            PyTypeError::new_err(format!("scenes: expected {expected}, got {got}"))
        })
    }
}

/// Converts a scene or a path.
fn source(item: &Bound<'_, PyAny>) -> PyResult<SceneSource> {
    match item.cast::<Scene>() {
        Ok(scene) => Ok(scene.get().given().into()),
        Err(_) => item.extract::<PathBuf>().map(Into::into),
    }
}

/// Gives a scene without a name this one.
fn named(source: SceneSource, name: String) -> SceneSource {
    match source {
        SceneSource::Given(scene) if scene.name.is_empty() => GivenScene { name, ..*scene }.into(),
        source => source,
    }
}

/// Converts a dictionary of scenes and scene files.
fn named_scenes(scenes: &Bound<'_, PyMapping>) -> PyResult<Vec<SceneSource>> {
    let mut sources = Vec::new();
    for entry in scenes.items()?.iter() {
        let (name, item): (Bound<'_, PyAny>, Bound<'_, PyAny>) = entry.extract()?;
        let name: String = name.extract().map_err(|_: PyErr| {
            PyTypeError::new_err(format!("scenes: expected names, got {}", described(&name)))
        })?;
        let given = if let Ok(scene) = item.cast::<Scene>() {
            scene.get().given()
        } else if is_path(&item) {
            Scene::read(item.extract()?)?.given()
        } else {
            let got = described(&item);
            let text = format!("scenes: expected a Scene or a scene file as `{name}`, got {got}");
            return Err(PyTypeError::new_err(text));
        };
        sources.push(GivenScene { name, ..given }.into());
    }
    Ok(sources)
}

/// A map in memory, and the file in which the records of its runs expect it.
type MapFile = (PathBuf, Arc<SceneMap>);

/// Lets scenes whose maps are in memory name files beside the records, where a replay finds them.
fn with_map_files(
    sources: Vec<SceneSource>,
    out: &Path,
) -> PyResult<(Vec<SceneSource>, Vec<MapFile>)> {
    let folder = std::path::absolute(out).map_err(bad_value)?.join("records").join("maps");
    let (mut files, mut named) = (Vec::new(), Vec::with_capacity(sources.len()));
    for mut source in sources {
        if let SceneSource::Given(scene) = &mut source
            && let Some(map) = &scene.map
        {
            let path = folder.join(format!("{}.yaml", map.source.digest));
            scene.file.map = Some(path.clone());
            files.push((path, Arc::clone(map)));
        }
        named.push(source);
    }
    Ok((named, files))
}

/// Writes the files of maps that are not there yet, if there are any records.
fn write_maps(files: &[MapFile]) -> Result<(), BatchError> {
    for (path, map) in files {
        let folder = path.parent().unwrap_or(path);
        if !folder.parent().is_some_and(Path::is_dir) || path.exists() {
            continue;
        }
        create_dir_all(folder)
            .map_err(|reason| BatchError::Folder { path: folder.to_owned(), reason })?;
        write_map(path, &map.grid)?;
    }
    Ok(())
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
    let parts = parts.named("parts")?;
    if parts.is_empty() {
        return Err(bad_value("parts: expected at least one folder"));
    }
    let request = MergeRequest { parts, out };
    run(py, None, move |watch| request.merge(&BatchPlots, watch))
}

fn run(
    py: Python<'_>,
    progress: Option<Progress>,
    work: impl FnOnce(&Watch) -> Result<BatchReport, BatchError> + Send + 'static,
) -> PyResult<Json> {
    let report = watched_to_its_end(py, progress.as_ref(), work)?.map_err(|error| match error {
        error @ BatchError::NameTwice { .. } => {
            bad_value(format!("scenes: {error}: pass a dictionary of names and scenes"))
        }
        error @ BatchError::NoName => bad_value(format!("scenes: {error}")),
        error => bad_value(error),
    });
    json(py, &report?)
}
