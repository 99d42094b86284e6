//! Text files, read within limits.

use crate::file_system::{ReadError, read_file};
use crate::map::formats::{TextError, text_from_bytes};
use std::path::{Path, PathBuf};
use thiserror::Error;

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
        /// Place of the first byte that is not part of a character.
        reason: TextError,
    },
}

/// Reads the text of a file of at most `limit_bytes`, without a byte order mark.
///
/// # Errors
/// When the file cannot be read, holds more, or is not UTF-8.
pub fn read_text(path: &Path, limit_bytes: u64) -> Result<String, TextFileError> {
    file_text(path, &read_file(path, limit_bytes)?).map(str::to_owned)
}

/// Text of a file of this name, without a byte order mark.
///
/// # Errors
/// When it is not UTF-8.
pub fn file_text<'a>(name: &Path, bytes: &'a [u8]) -> Result<&'a str, TextFileError> {
    text_from_bytes(bytes).map_err(|reason| TextFileError::Text { path: name.to_owned(), reason })
}
