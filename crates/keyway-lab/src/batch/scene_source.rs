//! Sources of scenes: files, folders and memory.

use keyway_sim::scene_files::{SceneFile, SceneMap};
use std::path::PathBuf;
use std::sync::Arc;

/// One or several scenes of a batch.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// A scene file, or a folder with scene files in it or in its subfolders.
    Path(PathBuf),
    /// A scene in memory.
    Given(Box<GivenScene>),
}

/// A scene in memory. Its runs have the same results as those of a file with the same content.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenScene {
    /// Name in the results; that of a file is its name without `.toml`.
    pub name: String,
    /// The scene.
    pub file: SceneFile,
    /// Base folder of the files that the scene names.
    pub folder: PathBuf,
    /// The map, in place of the file that the scene names; `None`: that file.
    pub map: Option<Arc<SceneMap>>,
}

impl From<PathBuf> for SceneSource {
    fn from(path: PathBuf) -> Self {
        Self::Path(path)
    }
}

impl From<&str> for SceneSource {
    fn from(path: &str) -> Self {
        Self::Path(path.into())
    }
}

impl From<GivenScene> for SceneSource {
    fn from(scene: GivenScene) -> Self {
        Self::Given(Box::new(scene))
    }
}
