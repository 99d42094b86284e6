//! Text files.

use keyway::file_system::{ReadError, read_file};
use keyway::map::formats::{TextError, text_from_bytes};
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

/// Returns the text of a file of at most `limit_bytes`, without a byte order mark.
///
/// # Errors
/// When the file cannot be read, holds more, or is not UTF-8.
pub fn read_text(path: &Path, limit_bytes: u64) -> Result<String, TextFileError> {
    let bytes = read_file(path, limit_bytes)?;
    let text = text_from_bytes(&bytes)
        .map_err(|reason| TextFileError::Text { path: path.to_owned(), reason })?;
    Ok(text.to_owned())
}
