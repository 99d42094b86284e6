//! Files of scenes and disturbances.

use super::{SceneFile, SceneFileError, disturbances_from_bytes, scene_from_bytes};
use crate::sim::Disturbances;
use keyway::files::read_toml;
use std::path::Path;

/// Reads and checks a scene file.
///
/// # Errors
/// Returns an error if the file cannot be read, or does not hold a scene.
pub fn read_scene(path: &Path) -> Result<SceneFile, SceneFileError> {
    scene_from_bytes(path, &read_toml(path)?)
}

/// Reads and checks a file of disturbances: the fields of `[disturbances]` of a scene. The random
/// numbers follow from seed 0 until the caller sets another seed.
///
/// # Errors
/// Returns an error if the file cannot be read, does not contain disturbances, or sets a seed.
pub fn read_disturbances(path: &Path) -> Result<Disturbances, SceneFileError> {
    disturbances_from_bytes(path, &read_toml(path)?)
}
