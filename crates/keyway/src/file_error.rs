//! Errors of files that cannot be read or written.
//!
//! Nothing here accesses a file. Readers of bytes return these errors, too: if the content is too
//! long, or if the caller does not have the image that a map names.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file that cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system refused.
    #[error("cannot read {}: {}", path.display(), system_error_in_words(reason))]
    System {
        /// The file.
        path: PathBuf,
        /// Message of the operating system.
        reason: io::Error,
    },
    /// The path is a folder.
    #[error("cannot read {}: it is a folder, expected a file", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// More than such a file can sensibly hold, or an endless device.
    #[error(
        "cannot read {}: it is larger than the limit of {}",
        path.display(),
        size_text(*limit_bytes)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit \[bytes\].
        limit_bytes: u64,
    },
}

/// A file that could not be written; its previous content is kept.
#[derive(Debug, Error)]
#[error("cannot write {}: {}", path.display(), system_error_in_words(reason))]
pub struct WriteError {
    /// The requested file.
    pub path: PathBuf,
    /// Message of the operating system.
    pub reason: io::Error,
}

/// Refuses content that is longer than the file of this name may be.
pub(crate) fn check_length(name: &Path, bytes: &[u8], limit_bytes: u64) -> Result<(), ReadError> {
    if bytes.len() as u64 > limit_bytes {
        return Err(ReadError::TooLarge { path: name.to_owned(), limit_bytes });
    }
    Ok(())
}

/// Describes an error without numbers that are specific to the operating system.
pub fn system_error_in_words(error: &io::Error) -> String {
    let known = match error.kind() {
        ErrorKind::NotFound => "there is no such file or folder",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::IsADirectory => "it is a folder",
        ErrorKind::NotADirectory => "a part of the path is a file, not a folder",
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only",
        ErrorKind::OutOfMemory => "there is not enough memory",
        ErrorKind::InvalidFilename => "the name is too long, or not a valid file name",
        _ => {
            let text = error.to_string();
            return text.split(" (os error").next().unwrap_or(&text).to_lowercase();
        }
    };
    known.to_owned()
}

fn size_text(bytes: u64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB"), (0, "bytes")];
    let whole =
        units.into_iter().find(|(shift, _)| bytes >> shift << shift == bytes && bytes >> shift > 0);
    whole.map_or_else(
        || format!("{bytes} bytes"),
        |(shift, unit)| format!("{} {unit}", bytes >> shift),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_numbers_of_the_system() {
        assert_eq!(
            system_error_in_words(&io::Error::from_raw_os_error(2)),
            "there is no such file or folder"
        );
        let rare = system_error_in_words(&io::Error::from_raw_os_error(32));
        assert!(!rare.is_empty() && !rare.contains("os error"), "{rare}");
    }

    #[test]
    fn as_many_bytes_as_the_limit_pass() {
        let name = Path::new("a.toml");
        assert!(check_length(name, &[7; 1024], 1024).is_ok());
        let text = check_length(name, &[7; 1025], 1024).unwrap_err().to_string();
        let expected = "cannot read a.toml: it is larger than the limit of 1 KiB";
        assert_eq!(text, expected);
    }
}
