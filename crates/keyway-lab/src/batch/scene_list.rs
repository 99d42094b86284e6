//! The scenes of a request: files, the scene files in folders and their subfolders, and those in
//! memory.

use super::{BatchError, BatchRequest, GivenScene, SceneSource};
use keyway_sim::scene_files::{SceneError, SceneFile, SceneFileError, SceneMap, read_scene};
use std::collections::{HashMap, HashSet};
use std::fs::read_dir;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene of a request.
pub(super) struct ListedScene {
    /// Path of the file below the folder that the request names, without `.toml`; for a file that
    /// the request itself names, its name without `.toml`.
    pub(super) name: String,
    /// Path of the file; `None` for a scene in memory.
    path: Option<PathBuf>,
    /// Base folder of the files that the scene names.
    pub(super) folder: PathBuf,
    pub(super) file: SceneFile,
    /// The map, if it is in memory.
    pub(super) map: Option<Arc<SceneMap>>,
}

impl ListedScene {
    fn read(name: String, path: PathBuf, file: SceneFile) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self { name, path: Some(path), folder, file, map: None }
    }

    fn given(GivenScene { name, file, folder, map }: GivenScene) -> Result<Self, BatchError> {
        let scene = Self { name, path: None, folder, file, map };
        if scene.name.is_empty() { Err(BatchError::NoName) } else { Ok(scene) }
    }
}

/// A file that may be a scene.
struct Candidate {
    name: String,
    path: PathBuf,
    /// True if the request names the file itself, not a folder that holds it.
    is_named: bool,
}

/// Reads the scenes of a request, in its order; those of a folder in the order of their paths. A
/// file of a folder that is no scene is left out if a scene or the request refers to it, for
/// example as a robot or a stack.
pub(super) fn listed_scenes(request: &BatchRequest) -> Result<Vec<ListedScene>, BatchError> {
    let (mut scenes, mut others) = (Vec::new(), Vec::new());
    for source in &request.scenes {
        let path = match source {
            SceneSource::Path(path) => path,
            SceneSource::Given(scene) => {
                scenes.push(ListedScene::given(GivenScene::clone(scene))?);
                continue;
            }
        };
        for Candidate { name, path, is_named } in candidates(path)? {
            match read_scene(&path) {
                Ok(file) => scenes.push(ListedScene::read(name, path, file)),
                Err(error) if !is_named && is_of_another_kind(&error) => others.push((path, error)),
                Err(error) => return Err(BatchError::Scene(error)),
            }
        }
    }
    refuse_a_name_twice(&scenes)?;
    let referred = if others.is_empty() { HashSet::new() } else { referred(request, &scenes) };
    let is_strange = |path: &Path| !path.canonicalize().is_ok_and(|path| referred.contains(&path));
    if let Some((_, error)) = others.into_iter().find(|(path, _)| is_strange(path)) {
        return Err(BatchError::OtherFile(error));
    }
    let is_in = |folder: &Path, scene: &ListedScene| {
        scene.path.as_ref().is_some_and(|path| path.starts_with(folder))
    };
    let has_none =
        |given: &&PathBuf| given.is_dir() && !scenes.iter().any(|scene| is_in(given, scene));
    let mut paths = request.scenes.iter().filter_map(|source| match source {
        SceneSource::Path(path) => Some(path),
        SceneSource::Given(_) => None,
    });
    match paths.find(has_none) {
        Some(path) => Err(BatchError::EmptyFolder { path: path.clone() }),
        None => Ok(scenes),
    }
}

/// True if the file has no content of a scene.
const fn is_of_another_kind(error: &SceneFileError) -> bool {
    matches!(error, SceneFileError::Scene { reason: SceneError::NoScene, .. })
}

fn refuse_a_name_twice(scenes: &[ListedScene]) -> Result<(), BatchError> {
    let mut found: HashMap<&str, &Option<PathBuf>> = HashMap::new();
    for ListedScene { name, path, .. } in scenes {
        if let Some(first) = found.insert(name, path) {
            let scene = name.clone();
            return Err(match (first, path) {
                (Some(first), Some(path)) => {
                    BatchError::SceneTwice { scene, paths: [first.clone(), path.clone()] }
                }
                _ => BatchError::NameTwice { scene },
            });
        }
    }
    Ok(())
}

/// Returns the files of robots, stacks and disturbances that the scenes and the request name.
fn referred(request: &BatchRequest, scenes: &[ListedScene]) -> HashSet<PathBuf> {
    let mut paths: Vec<PathBuf> = request.stacks.iter().map(PathBuf::from).collect();
    paths.extend(request.robot.as_ref().map(PathBuf::from));
    paths.extend(request.disturbances.clone());
    for ListedScene { folder, file, .. } in scenes {
        let names = file.robots_and_stacks().into_iter().flat_map(|(robot, stack)| [robot, stack]);
        paths.extend(names.map(|name| folder.join(name)));
    }
    paths.into_iter().filter_map(|path| path.canonicalize().ok()).collect()
}

/// Returns the given file, or those of the given folder and its subfolders.
fn candidates(path: &Path) -> Result<Vec<Candidate>, BatchError> {
    if !path.is_dir() {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok(vec![Candidate { name, path: path.to_owned(), is_named: true }]);
    }
    let mut inside = Vec::new();
    add_files_of(path, &mut inside)?;
    inside.sort();
    let below = |file: PathBuf| {
        let name = name_below(path, &file);
        Candidate { name, path: file, is_named: false }
    };
    Ok(inside.into_iter().map(below).collect())
}

/// Adds the TOML files of a folder and its subfolders. Hidden entries, such as those of an
/// editor, are left out, and so are subfolders that are links, which may form cycles.
fn add_files_of(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), BatchError> {
    let unreadable = |reason| BatchError::Folder { path: folder.to_owned(), reason };
    for entry in read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let (path, is_folder) = (entry.path(), entry.file_type().is_ok_and(|it| it.is_dir()));
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if is_folder {
            add_files_of(&path, files)?;
        } else if path.extension().is_some_and(|end| end == "toml") {
            files.push(path);
        }
    }
    Ok(())
}

/// Returns the path of a file below a folder, without its extension: `fleet/crossing` on any
/// system.
fn name_below(folder: &Path, file: &Path) -> String {
    let below = file.strip_prefix(folder).unwrap_or(file).with_extension("");
    let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_paths_below_the_folder() {
        for (folder, file, name) in [
            ("scenes", "scenes/fleet/crossing.toml", "fleet/crossing"),
            ("scenes/fleet", "scenes/fleet/crossing.toml", "crossing"),
            ("./scenes/", "./scenes/a.b.toml", "a.b"),
            (".", "./a/b/c.toml", "a/b/c"),
        ] {
            assert_eq!(name_below(Path::new(folder), Path::new(file)), name);
        }
    }
}
