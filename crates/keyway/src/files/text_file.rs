//! Reading text files, within limits.

use crate::file_error::{ReadError, check_length};
use crate::map::formats::{TextError, text_from_bytes};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a scene, robot, stack or parameter file \[bytes\].
pub const MAX_TOML_BYTES: u64 = 16 << 20;

/// Error of a text file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TextFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is not UTF-8.
    #[error("{}: {reason}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Position of the first byte that is not part of a character.
        reason: TextError,
    },
}

/// Text of a file of this name and of at most `limit_bytes`, without a byte order mark.
///
/// # Errors
/// Returns [`TextFileError`] if it holds more, or is not UTF-8.
pub fn file_text<'a>(
    name: &Path,
    bytes: &'a [u8],
    limit_bytes: u64,
) -> Result<&'a str, TextFileError> {
    check_length(name, bytes, limit_bytes)?;
    text_from_bytes(bytes).map_err(|reason| TextFileError::Text { path: name.to_owned(), reason })
}
