//! Scenes.

use crate::errors::{bad_value, config_file_error, map_error, scene_error, scene_file_error};
use crate::given_map::GivenMap;
use crate::map::Map;
use crate::parameters::{Parameters, RobotName};
use crate::values::{Numbers, described, is_path, place};
use keyway::files::{TomlError, find_robot, find_stack};
use keyway::map::OccupancyGrid;
use keyway::map::formats::read_map;
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;
use keyway_lab::batch::GivenScene;
use keyway_sim::episode::{Episode, Start};
use keyway_sim::report::MapSource;
use keyway_sim::scene_files::{SceneError, SceneFile, SceneMap, read_scene};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::{Table, Value};

/// Description of a run: map, robot, start, goal, and the static and moving obstacles that are
/// not on the map.
///
/// For a map in memory, the arguments are those of a scene file, with the same names: `robot`,
/// `stack`, `safe`, `via`, `seed`, `unknown`, `moving`, `random`, `rules`, `disturbances`.
/// `start` and `goal` are positions [m], or poses [m, m, rad]; only in scene files, and so in
/// `to_toml`, headings are in degrees. `Scene.read` reads a scene file.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
/// >>> keyway.Scene(grid, start=(1, 2), goal=(7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
/// <keyway.Scene small with keyway, 1 unknown, 0 moving, seed 0>
#[derive(Clone)]
#[pyclass(frozen, skip_from_py_object, module = "keyway")]
pub(crate) struct Scene {
    pub(crate) file: SceneFile,
    folder: PathBuf,
    /// Name of the file without `.toml`, if the scene was read from one.
    name: Option<String>,
    /// The map, if it is in memory and not a file.
    map: Option<(Arc<OccupancyGrid>, MapSource)>,
}

/// A scene, or the path of its file, which is read here.
pub(crate) struct SceneOrFile(Py<Scene>);

impl<'py> FromPyObject<'_, 'py> for SceneOrFile {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        type_hint_union!(<Scene as pyo3::PyTypeInfo>::TYPE_HINT, PathBuf::INPUT_TYPE);

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scene) = object.cast::<Scene>() {
            return Ok(Self(scene.to_owned().unbind()));
        }
        if is_path(&object) {
            return Ok(Self(Py::new(object.py(), Scene::read(object.extract()?)?)?));
        }
        let got = described(&object);
        let text = format!("expected a keyway.Scene, or the path of a scene file, got {got}");
        Err(PyTypeError::new_err(text))
    }
}

impl Deref for SceneOrFile {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        self.0.get()
    }
}

/// A Python exception inside a scene error.
struct Raised(PyErr);

impl From<SceneError> for Raised {
    fn from(error: SceneError) -> Self {
        Self(scene_error(&error))
    }
}

impl Scene {
    /// Returns the map of the scene.
    fn scene_map(&self) -> PyResult<SceneMap> {
        if let Some((grid, source)) = &self.map {
            return Ok(SceneMap { grid: OccupancyGrid::clone(grid), source: source.clone() });
        }
        if let Some(made) = self.file.generated_map() {
            return made.map_err(|error| scene_error(&error));
        }
        let path = self.file.map.as_deref().unwrap_or(Path::new(""));
        let loaded = read_map(&self.folder.join(path), None).map_err(|error| map_error(&error))?;
        Ok(loaded.into())
    }

    fn found(&self, robot: &str, stack: &str) -> PyResult<(Robot, Stack)> {
        let robot = find_robot(robot, &self.folder).map_err(|error| config_file_error(&error))?;
        let stack =
            find_stack(stack, &self.folder, &robot).map_err(|error| config_file_error(&error))?;
        Ok((robot, stack))
    }

    /// Returns the scene for a batch, with an empty name if it has none.
    pub(crate) fn given(&self) -> GivenScene {
        let map = self.map.as_ref().map(|(grid, source)| {
            Arc::new(SceneMap { grid: OccupancyGrid::clone(grid), source: source.clone() })
        });
        let Self { file, folder, name, .. } = self.clone();
        GivenScene { name: name.unwrap_or_default(), file, folder, map }
    }

    /// Returns the episode of the scene's only robot.
    pub(crate) fn episode_of_one(&self) -> PyResult<Episode> {
        let has_robots = !self.file.robots.is_empty();
        if has_robots { Err(scene_error(&SceneError::SeveralRobots)) } else { self.episode() }
    }

    /// Returns the episode of all robots of the scene.
    pub(crate) fn episode(&self) -> PyResult<Episode> {
        let find = |robot: &str, stack: &str| self.found(robot, stack).map_err(Raised);
        self.file.episode(self.scene_map()?, find).map_err(|Raised(error)| error)
    }
}

/// The arguments that restore a scene: the text of its file, its folder, its map if that is in
/// memory, and its name.
type Parts = (String, PathBuf, Option<Map>, Option<String>);

/// Removes the line number, as the user has not seen the text.
fn without_line(error: SceneError) -> SceneError {
    match error {
        SceneError::Toml(error) => {
            SceneError::Toml(TomlError { line: None, column: None, ..error })
        }
        error => error,
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (grid, start, goal, **fields: "object"))]
    fn new(
        py: Python<'_>,
        grid: GivenMap,
        start: Numbers,
        goal: Numbers,
        fields: Option<Parameters>,
    ) -> PyResult<Self> {
        let given = |numbers: &Numbers, name: &str| {
            let (position, heading_rad) = numbers.place(py, name)?;
            let numbers = Vec::from(Goal { position, heading_rad });
            Ok::<_, PyErr>(Value::Array(numbers.into_iter().map(Value::Float).collect()))
        };
        let mut table: Table = fields.unwrap_or_default().0;
        for (name, value) in [
            ("version", Value::from(SceneFile::VERSION)),
            ("map", Value::from("array")),
            ("start", given(&start, "start")?),
            ("goal", given(&goal, "goal")?),
        ] {
            if table.insert(name.to_owned(), value).is_some() {
                return Err(bad_value(format!("`{name}` cannot be combined with a map in memory")));
            }
        }
        let text = toml::to_string(&table).map_err(bad_value)?;
        let file = SceneFile::from_toml(&text);
        let file = file.map_err(|error| scene_error(&without_line(error)))?;
        let map = Some((Arc::clone(&grid.grid), grid.source.clone()));
        Ok(Self { file, folder: PathBuf::new(), name: None, map })
    }

    /// Reads a scene file. Paths in it are relative to its folder.
    ///
    /// >>> import keyway
    /// >>> keyway.Scene.read("nowhere.toml")
    /// Traceback (most recent call last):
    /// FileNotFoundError: cannot read nowhere.toml: there is no such file or folder
    #[staticmethod]
    pub(crate) fn read(path: PathBuf) -> PyResult<Self> {
        let file = read_scene(&path).map_err(|error| scene_file_error(&error))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned());
        Ok(Self { file, folder, name, map: None })
    }

    /// Parses the text of a scene file; paths in it are relative to `folder`.
    ///
    /// >>> import keyway
    /// >>> keyway.Scene.from_toml("version = 2")
    /// Traceback (most recent call last):
    /// ValueError: a scene has either a `map` or a `[world]`, got neither
    #[staticmethod]
    #[pyo3(signature = (text, folder=None))]
    fn from_toml(text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let file = SceneFile::from_toml(text).map_err(|error| scene_error(&error))?;
        Ok(Self { file, folder: folder.unwrap_or_default(), name: None, map: None })
    }

    /// Returns the same scene with another seed, robot or stack, with or without the stop rule.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    /// >>> keyway.Scene(grid, (1, 2), (7, 2)).replace(seed=3, stack="s1-adaptive")
    /// <keyway.Scene small with s1-adaptive, 0 unknown, 0 moving, seed 3>
    #[pyo3(signature = (seed=None, robot=None, stack=None, safe=None))]
    fn replace(
        &self,
        seed: Option<u64>,
        robot: Option<RobotName>,
        stack: Option<String>,
        safe: Option<bool>,
    ) -> Self {
        let own = &self.file;
        let file = SceneFile {
            seed: seed.unwrap_or(own.seed),
            robot: robot.map_or_else(|| own.robot.clone(), |RobotName(name)| name),
            stack: stack.unwrap_or_else(|| own.stack.clone()),
            safe: safe.unwrap_or(own.safe),
            ..own.clone()
        };
        Self { file, ..self.clone() }
    }

    /// Returns the text of the scene file. A map in memory is called `array` there.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    /// >>> keyway.Scene(grid, (1, 2), (7, 2)).to_toml().splitlines()[0]
    /// 'version = 2'
    fn to_toml(&self) -> PyResult<String> {
        toml::to_string(&self.file).map_err(bad_value)
    }

    /// Supports copying, pickling and sending scenes to other processes.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let map = self.map.clone().map(|(grid, source)| Map::shared(grid, source));
        let parts = (self.to_toml()?, self.folder.clone(), map, self.name.clone());
        Ok((py.get_type::<Self>().getattr("_restored")?, parts))
    }

    #[staticmethod]
    fn _restored(
        text: &str,
        folder: PathBuf,
        map: Option<PyRef<'_, Map>>,
        name: Option<String>,
    ) -> PyResult<Self> {
        let scene = Self::from_toml(text, Some(folder))?;
        let map = map.map(|map| (Arc::clone(&map.grid), map.source.clone()));
        Ok(Self { name, map, ..scene })
    }

    /// Name of the scene's file without `.toml`; `None` for a scene that was not read from a file.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Start (x, y) [m], or with a heading (x, y, yaw) [m, m, rad]; `None` for several robots.
    #[getter]
    fn start(&self) -> Option<Vec<f64>> {
        let Start { position, heading_rad } = self.file.start?;
        Some(place(position, heading_rad))
    }

    /// Goal (x, y) [m], or with a heading (x, y, yaw) [m, m, rad]; `None` for several robots.
    #[getter]
    fn goal(&self) -> Option<Vec<f64>> {
        let Goal { position, heading_rad } = self.file.goal?;
        Some(place(position, heading_rad))
    }

    /// Seed of all random values.
    #[getter]
    fn seed(&self) -> u64 {
        self.file.seed
    }

    /// Name of the robot.
    #[getter]
    fn robot(&self) -> &str {
        &self.file.robot
    }

    /// Name of the stack.
    #[getter]
    fn stack(&self) -> &str {
        &self.file.stack
    }

    /// True if the run depends on the seed.
    #[getter]
    fn is_random(&self) -> bool {
        self.file.is_random()
    }

    fn __repr__(&self) -> String {
        let SceneFile { robot, stack, unknown, moving, seed, .. } = &self.file;
        let (unknown, moving) = (unknown.len(), moving.len());
        format!(
            "<keyway.Scene {robot} with {stack}, {unknown} unknown, {moving} moving, seed {seed}>"
        )
    }
}
