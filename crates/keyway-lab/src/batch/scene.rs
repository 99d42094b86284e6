//! Scenes of a batch, with all inputs of their runs.

use super::scene_list::ListedScene;
use super::{BatchError, BatchRequest};
use crate::progress::Progress;
use crate::results::{digest, json_text};
use keyway::files::{Assignment, ParameterLayers, StackBase, find_robot, find_stack, robot_with};
use keyway::map::formats::MapReader;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::report::Inputs;
use keyway_sim::scene_files::{SceneFile, SceneMap, SceneRobot, read_disturbances};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A stack with the parameters for the robot that it drives.
pub(super) struct NamedStack {
    pub(super) name: String,
    pub(super) config: Stack,
}

/// A scene with its robots and its map.
pub(super) struct BatchScene {
    /// Name among the scenes of the request.
    pub(super) name: String,
    pub(super) file: SceneFile,
    /// Folder of its file.
    pub(super) folder: PathBuf,
    pub(super) robots: Vec<Robot>,
    /// Changed parameters of all stacks.
    set: Vec<Assignment>,
    /// The map; `None` if it is generated from the seed.
    pub(super) map: Option<Arc<SceneMap>>,
    /// Base folder of stack files: that of the scene that names them, otherwise the current one.
    stack_folder: PathBuf,
    /// Digest of all inputs of the runs except stacks and seed.
    digest: String,
}

/// Reader of the scenes of a request. A map that several scenes use is read once.
pub(super) struct SceneReader<'a> {
    request: &'a BatchRequest,
    progress: &'a dyn Progress,
    maps: HashMap<PathBuf, Arc<SceneMap>>,
}

impl<'a> SceneReader<'a> {
    pub(super) fn new(request: &'a BatchRequest, progress: &'a dyn Progress) -> Self {
        Self { request, progress, maps: HashMap::new() }
    }

    /// Reads all files that a scene or the request names.
    pub(super) fn read(&mut self, listed: ListedScene) -> Result<BatchScene, BatchError> {
        let request = self.request;
        let ListedScene { name, folder, mut file, map, .. } = listed;
        if let Some(path) = &request.disturbances {
            file.disturbances = read_disturbances(path).map_err(BatchError::Disturbances)?;
        }
        file.safe |= request.safe;
        file.rules.reached_by = request.reached_by.unwrap_or(file.rules.reached_by);
        let robot_of = |(in_scene, _): (&str, &str)| match &request.robot {
            Some(name) => find_robot(name, Path::new("")),
            None => find_robot(in_scene, &folder),
        };
        let robots = file.robots_and_stacks().into_iter().map(robot_of);
        let robots = robots.collect::<Result<Vec<_>, _>>().map_err(BatchError::Robot)?;
        let changes: Vec<_> = request.set.iter().filter_map(Assignment::of_robot).collect();
        let robots = robots.iter().map(|robot| robot_with(robot, &changes));
        let robots = robots.collect::<Result<Vec<_>, _>>().map_err(BatchError::RobotValue)?;
        let set = request.set.iter().filter(|one| one.of_robot().is_none()).cloned().collect();
        let map = match (map, &file.map) {
            (Some(map), _) => Some(map),
            (None, Some(map)) => Some(self.map(folder.join(map))?),
            (None, None) => None,
        };
        let names_stacks = !request.stacks.is_empty();
        let stack_folder = if names_stacks { PathBuf::new() } else { folder.clone() };
        let digest = digest_of(&file, &robots, map.as_deref());
        Ok(BatchScene { name, file, folder, robots, set, map, stack_folder, digest })
    }

    fn map(&mut self, path: PathBuf) -> Result<Arc<SceneMap>, BatchError> {
        if let Some(map) = self.maps.get(&path) {
            return Ok(Arc::clone(map));
        }
        let reader = MapReader { max_cells: self.request.max_cells, ..MapReader::default() };
        let loaded = reader.read(&path)?;
        loaded.warnings.iter().for_each(|warning| self.progress.warned(warning));
        let map = Arc::new(SceneMap::from(loaded));
        self.maps.insert(path, Arc::clone(&map));
        Ok(map)
    }
}

/// Returns the digest of a scene with its robots and its map. It excludes paths and names of
/// files, and includes the reference time of the score.
fn digest_of(file: &SceneFile, robots: &[Robot], map: Option<&SceneMap>) -> String {
    let (description, robot, stack) = (None, String::new(), String::new());
    let scene = SceneFile { description, map: None, robot, stack, seed: 0, ..file.clone() };
    let nameless = |one: &SceneRobot| SceneRobot { robot: None, stack: None, ..one.clone() };
    let scene = SceneFile { robots: scene.robots.iter().map(nameless).collect(), ..scene };
    let map = map.map(|map| &map.source.digest);
    digest(json_text(&(Inputs::VERSION, scene, robots, map)).as_bytes())
}

impl BatchScene {
    /// Returns the names of the stacks of all robots, once for each choice of stacks. A stack
    /// that the request names drives all robots.
    pub(super) fn stack_names(&self, request: &BatchRequest) -> Vec<Vec<String>> {
        let own = self.file.robots_and_stacks();
        let of_all = |name: &str| vec![name.to_owned(); own.len()];
        match &request.stacks[..] {
            [] => vec![own.iter().map(|&(_, stack)| stack.to_owned()).collect()],
            [all] if all == "all" => Stack::NAMES.map(of_all).to_vec(),
            names => names.iter().map(|name| of_all(name)).collect(),
        }
    }

    /// Returns stacks with the parameters for the robots that they drive.
    pub(super) fn stacks(&self, names: &[String]) -> Result<Arc<[NamedStack]>, BatchError> {
        let named = |(name, robot): (&String, &Robot)| {
            let config = find_stack(name, &self.stack_folder, robot).map_err(BatchError::Stack)?;
            let config = config.safe_if(self.file.safe, robot);
            let config = self.changed(config, robot)?;
            Ok(NamedStack { name: name.clone(), config })
        };
        names.iter().zip(&self.robots).map(named).collect()
    }

    /// Returns a stack with the parameters that the request changes.
    fn changed(&self, stack: Stack, robot: &Robot) -> Result<Stack, BatchError> {
        if self.set.is_empty() {
            return Ok(stack);
        }
        let assignments = self.set.clone();
        let layers = ParameterLayers { assignments, ..ParameterLayers::default() };
        let changed = layers.over(StackBase::for_robot(&stack, robot), &[]);
        changed.map_err(|error| BatchError::Set(Box::new(error)))
    }

    /// Returns the digest of all inputs of the runs with these stacks except the seed.
    pub(super) fn digest_with(&self, stacks: &[NamedStack]) -> String {
        let stacks: Vec<_> = stacks.iter().map(|one| (&one.name, &one.config)).collect();
        digest(json_text(&(&self.digest, stacks)).as_bytes())
    }
}
