//! Reading parameters from memory.

use super::{ConfigFileError, MAX_TOML_BYTES, ParameterFile, file_text, from_toml};
use std::path::Path;

/// Reads parameters, any part of a stack, from memory; the result and errors call the file `name`.
/// Values are checked when they are laid over a stack
/// ([`ParameterLayers::over`](super::ParameterLayers::over)).
///
/// # Errors
/// Returns [`ConfigFileError`] if the content holds more than [`MAX_TOML_BYTES`], or is not TOML.
pub fn parameters_from_bytes(name: &Path, bytes: &[u8]) -> Result<ParameterFile, ConfigFileError> {
    let table = from_toml(file_text(name, bytes, MAX_TOML_BYTES)?)
        .map_err(|reason| ConfigFileError::Toml { path: name.to_owned(), reason })?;
    Ok(ParameterFile { name: name.display().to_string(), table })
}
