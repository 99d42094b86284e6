//! Files of scenes and disturbances.

use super::{SceneFile, SceneFileError, disturbances_from_bytes, scene_from_bytes};
use crate::sim::Disturbances;
use keyway::file_system::read_file;
use keyway::files::{MAX_TOML_BYTES, TextFileError};
use std::path::Path;

/// Reads and checks a scene file.
///
/// # Errors
/// When the file cannot be read, or does not hold a scene.
pub fn read_scene(path: &Path) -> Result<SceneFile, SceneFileError> {
    scene_from_bytes(path, &read_toml(path)?)
}

/// Reads and checks a file of disturbances: the fields of `[disturbances]` of a scene. The random
/// numbers are those of seed 0 until the caller gives another seed.
///
/// # Errors
/// When the file cannot be read, does not contain disturbances, or names a seed.
pub fn read_disturbances(path: &Path) -> Result<Disturbances, SceneFileError> {
    disturbances_from_bytes(path, &read_toml(path)?)
}

/// The content of a file of TOML.
fn read_toml(path: &Path) -> Result<Vec<u8>, TextFileError> {
    Ok(read_file(path, MAX_TOML_BYTES)?)
}
