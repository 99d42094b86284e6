//! Scenes and disturbances from memory.

use super::{SceneError, SceneFile};
use crate::sim::Disturbances;
use keyway::ConfigError;
use keyway::files::{ConfigFileError, MAX_TOML_BYTES, TextFileError, file_text, from_toml};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why a scene file, or a file that it names, is invalid.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// A file cannot be read or is not TOML, or a file of a robot, a stack or disturbances is
    /// invalid.
    #[error(transparent)]
    Config(#[from] ConfigFileError),
    /// A file is not a scene.
    #[error("{}: {reason}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// Error of the scene.
        reason: SceneError,
    },
}

impl From<TextFileError> for SceneFileError {
    fn from(error: TextFileError) -> Self {
        Self::Config(error.into())
    }
}

impl SceneFileError {
    /// Path of the invalid field; empty if the error concerns the file, its name, or the whole
    /// scene.
    pub fn field(&self) -> &str {
        match self {
            Self::Config(error) => error.field(),
            Self::Scene { .. } => "",
        }
    }
}

/// Reads and checks a scene from memory. Errors refer to the file as `name`.
///
/// # Errors
/// Returns an error if the content is larger than [`MAX_TOML_BYTES`], or is not a scene.
pub fn scene_from_bytes(name: &Path, bytes: &[u8]) -> Result<SceneFile, SceneFileError> {
    SceneFile::from_toml(file_text(name, bytes, MAX_TOML_BYTES)?)
        .map_err(|reason| SceneFileError::Scene { path: name.to_owned(), reason })
}

/// Reads and checks disturbances, the fields of `[disturbances]` of a scene, from memory. Errors
/// refer to the file as `name`. The random numbers follow from seed 0 until the caller sets
/// another seed.
///
/// # Errors
/// Returns an error if the content is larger than [`MAX_TOML_BYTES`], does not contain
/// disturbances, or sets a seed.
pub fn disturbances_from_bytes(name: &Path, bytes: &[u8]) -> Result<Disturbances, SceneFileError> {
    let path = || name.to_owned();
    let disturbances: Disturbances = from_toml(file_text(name, bytes, MAX_TOML_BYTES)?)
        .map_err(|reason| ConfigFileError::Toml { path: path(), reason })?;
    let no_seed = if disturbances.seed == 0 {
        Ok(())
    } else {
        let expected = "omitted: the scene sets it";
        Err(ConfigError::must_be("seed", expected, disturbances.seed as f64))
    };
    match disturbances.validate().and(no_seed) {
        Ok(()) => Ok(disturbances),
        Err(reason) => Err(ConfigFileError::Value { path: path(), reason }.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_source() {
        let name = Path::new("a/b.toml");
        let errors = [
            disturbances_from_bytes(name, b"[actuation]\ndelay_s = -1.0").unwrap_err().to_string(),
            disturbances_from_bytes(name, b"[motors]").unwrap_err().to_string(),
            disturbances_from_bytes(name, b"seed = 3").unwrap_err().to_string(),
            scene_from_bytes(name, b"version = 2").unwrap_err().to_string(),
            scene_from_bytes(name, b"\xff").unwrap_err().to_string(),
        ];
        for error in &errors {
            assert!(error.starts_with("a/b.toml: "), "{error}");
        }
        assert!(errors[0].contains("actuation.delay_s must be a time"), "{}", errors[0]);
        assert!(errors[2].contains("seed must be omitted"), "{}", errors[2]);
    }
}
