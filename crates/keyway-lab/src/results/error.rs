//! Errors of result files.

use super::{LinesError, ManifestError};
use keyway::file_error::{WriteError, system_error_in_words};
use std::path::PathBuf;
use thiserror::Error;

/// Error of writing results, or of reading those of an earlier run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// A file that Keyway did not write has the name of a result.
    #[error(
        "{} is in the way: Keyway did not write it, or it was changed since, so it is not overwritten; \
         delete it or move it away, or choose another folder",
        path.display()
    )]
    InTheWay {
        /// The file.
        path: PathBuf,
    },
    /// The path of the folder is not a folder.
    #[error("{} is not a folder", path.display())]
    NoFolder {
        /// The path.
        path: PathBuf,
    },
    /// The path of the journal is not a file.
    #[error("{}: it is not a file; move it away, or choose another folder", path.display())]
    NoFile {
        /// The path.
        path: PathBuf,
    },
    /// Another program writes into the folder.
    #[error(
        "{}: another `keyway` is writing to this folder; wait until it has finished, or choose another \
         folder",
        path.display()
    )]
    FolderBusy {
        /// The folder.
        path: PathBuf,
    },
    /// Another program writes the file.
    #[error(
        "{}: another `keyway` is writing this file; wait until it has finished, or choose another name",
        path.display()
    )]
    FileBusy {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be opened.
    #[error("{}: {}", .0.path.display(), system_error_in_words(&.0.reason))]
    System(WriteError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file of an earlier run cannot be read.
    #[error(transparent)]
    Lines(#[from] LinesError),
    /// The list of the folder's files cannot be used.
    #[error(transparent)]
    Manifest(#[from] ManifestError),
}
