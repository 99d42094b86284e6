//! Scenes of a folder, as runs.

use keyway::files::{find_robot, find_stack};
use keyway::map::formats::read_map;
use keyway_sim::episode::Episode;
use keyway_sim::scene_files::{SceneFile, SceneMap, read_scene};
use std::error::Error;
use std::path::{Path, PathBuf};

/// The scene files of a folder, by name.
pub(crate) fn paths(folder: &str) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut paths: Vec<PathBuf> = entries.collect::<std::io::Result<_>>()?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    Ok(paths)
}

/// The run that a scene file describes.
pub(crate) fn episode(path: &Path) -> Result<Episode, Box<dyn Error>> {
    let scene = read_scene(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let robot = find_robot(&scene.robot, folder)?;
    let stack = find_stack(&scene.stack, folder, &robot)?;
    let map: SceneMap = match (&scene.map, scene.generated_map()) {
        (Some(map), _) => read_map(&folder.join(map), None)?.into(),
        (None, Some(map)) => map?,
        (None, None) => return Err("it has no map".into()),
    };
    Ok(SceneFile::episode_with(&scene, map, &robot, &stack)?)
}
