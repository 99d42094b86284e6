//! Scenes of a batch, with everything that their runs depend on.

use super::{BatchError, BatchRequest};
use crate::progress::Progress;
use crate::results::{digest, json_text};
use keyway::files::{find_robot, find_stack};
use keyway::map::formats::MapReader;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::report::Inputs;
use keyway_sim::scene_files::{
    SceneError, SceneFile, SceneFileError, SceneMap, SceneRobot, read_disturbances, read_scene,
};
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
    /// Name of its file.
    pub(super) name: String,
    pub(super) file: SceneFile,
    /// Folder of its file.
    pub(super) folder: PathBuf,
    pub(super) robots: Vec<Robot>,
    /// The map; `None` where it is made from the seed.
    pub(super) map: Option<Arc<SceneMap>>,
    /// Folder of the files of stacks: that of the scene that names them, otherwise the current one.
    stack_folder: PathBuf,
    /// Digest of all that the runs depend on but stacks and seed.
    digest: String,
}

/// Reader of the scenes of a request. Many scenes have the same map, which is read once.
pub(super) struct SceneReader<'a> {
    request: &'a BatchRequest,
    progress: &'a dyn Progress,
    maps: HashMap<PathBuf, Arc<SceneMap>>,
}

impl<'a> SceneReader<'a> {
    pub(super) fn new(request: &'a BatchRequest, progress: &'a dyn Progress) -> Self {
        Self { request, progress, maps: HashMap::new() }
    }

    /// Reads a scene with everything that it or the request names.
    pub(super) fn read(&mut self, path: &Path, name: String) -> Result<BatchScene, BatchError> {
        let request = self.request;
        let mut file = read_scene(path).map_err(|error| self.no_scene(path, error))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        if let Some(path) = &request.disturbances {
            file.disturbances = read_disturbances(path).map_err(BatchError::Disturbances)?;
        }
        file.safe |= request.safe;
        let robot_of = |(in_scene, _): (&str, &str)| match &request.robot {
            Some(name) => find_robot(name, Path::new("")),
            None => find_robot(in_scene, &folder),
        };
        let robots = file.robots_and_stacks().into_iter().map(robot_of);
        let robots = robots.collect::<Result<Vec<_>, _>>().map_err(BatchError::Robot)?;
        let map = match &file.map {
            Some(map) => Some(self.map(folder.join(map))?),
            None => None,
        };
        let names_stacks = !request.stacks.is_empty();
        let stack_folder = if names_stacks { PathBuf::new() } else { folder.clone() };
        let digest = digest_of(&file, &robots, map.as_deref());
        Ok(BatchScene { name, file, folder, robots, map, stack_folder, digest })
    }

    /// Returns the error of a file that is no scene. A caller who names a folder has not named the
    /// file.
    fn no_scene(&self, path: &Path, error: SceneFileError) -> BatchError {
        let is_other = matches!(error, SceneFileError::Scene { reason: SceneError::NoScene, .. });
        let is_named = self.request.scenes.iter().any(|named| named == path);
        if is_other && !is_named { BatchError::OtherFile(error) } else { BatchError::Scene(error) }
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

/// Returns the digest of a scene with its robots and its map. Places and names of files are no part
/// of a run. The time with which a run is compared is.
fn digest_of(file: &SceneFile, robots: &[Robot], map: Option<&SceneMap>) -> String {
    let (description, robot, stack) = (None, String::new(), String::new());
    let scene = SceneFile { description, map: None, robot, stack, seed: 0, ..file.clone() };
    let nameless = |one: &SceneRobot| SceneRobot { robot: None, stack: None, ..one.clone() };
    let scene = SceneFile { robots: scene.robots.iter().map(nameless).collect(), ..scene };
    let map = map.map(|map| &map.source.digest);
    digest(json_text(&(Inputs::VERSION, scene, robots, map)).as_bytes())
}

impl BatchScene {
    /// Returns the names of the stacks of all robots, once for each choice of stacks. A stack that
    /// the request names drives all robots.
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
            Ok(NamedStack { name: name.clone(), config })
        };
        names.iter().zip(&self.robots).map(named).collect()
    }

    /// Returns the digest of all that the runs with these stacks depend on but the seed.
    pub(super) fn digest_with(&self, stacks: &[NamedStack]) -> String {
        let stacks: Vec<_> = stacks.iter().map(|one| (&one.name, &one.config)).collect();
        digest(json_text(&(&self.digest, stacks)).as_bytes())
    }
}
