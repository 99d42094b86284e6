//! What the operating system says, in plain words.

use std::io::{Error, ErrorKind};

/// What went wrong, without numbers that only the operating system knows.
pub fn system_error_in_words(error: &Error) -> String {
    let known = match error.kind() {
        ErrorKind::NotFound => "there is no such file or folder",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::IsADirectory => "it is a folder",
        ErrorKind::NotADirectory => "a part of the path is a file, not a folder",
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only",
        ErrorKind::OutOfMemory => "there is not enough memory",
        ErrorKind::InvalidFilename => "the name is too long, or cannot be that of a file",
        _ => {
            let text = error.to_string();
            return text.split(" (os error").next().unwrap_or(&text).to_lowercase();
        }
    };
    known.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_numbers_of_the_system() {
        assert_eq!(
            system_error_in_words(&Error::from_raw_os_error(2)),
            "there is no such file or folder"
        );
        let rare = system_error_in_words(&Error::from_raw_os_error(32));
        assert!(!rare.is_empty() && !rare.contains("os error"), "{rare}");
    }
}
