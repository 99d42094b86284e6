//! Writing a file so that a reader sees the old content or the new, never a part.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file that could not be written; what stood there before still does.
#[derive(Debug, Error)]
#[error("cannot write {}: {reason}", path.display())]
pub struct WriteError {
    /// The file asked for.
    pub path: PathBuf,
    /// What the operating system said.
    pub reason: io::Error,
}

/// Writes `bytes` to a temporary file in the same folder and renames it to `path`, replacing what
/// stood there (its permissions are kept; a symbolic link is replaced, not followed). What is neither
/// a file nor a folder (a device, a pipe) is written to, as it cannot be replaced.
///
/// # Errors
/// When the folder does not exist or cannot be written, or `path` is a folder. The temporary file
/// is removed.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let failed = |reason| WriteError { path: path.to_owned(), reason };
    if fs::metadata(path).is_ok_and(|stands| !stands.is_file() && !stands.is_dir()) {
        let written = OpenOptions::new().write(true).open(path);
        return written.and_then(|mut device| device.write_all(bytes)).map_err(failed);
    }
    let (temporary, file) = create_beside(path).map_err(failed)?;
    let written = fill(file, bytes, path).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // The first failure is the one to report; a left-over file is the lesser evil.
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(failed)
}

fn fill(mut file: File, bytes: &[u8], path: &Path) -> io::Result<()> {
    file.write_all(bytes)?;
    if let Ok(replaced) = fs::metadata(path) {
        if replaced.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        file.set_permissions(replaced.permissions())?;
    }
    // Without this a power cut may leave the new name with no content.
    file.sync_all()
}

/// A new, empty file next to `path`.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().ok_or_else(|| {
        io::Error::new(io::ErrorKind::InvalidInput, "the path does not end in a file name")
    })?;
    // Names of files that another writer, or one that was killed, has left are passed over.
    for attempt in 0..1000 {
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{attempt}.tmp"));
        let temporary = path.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Err(taken) if taken.kind() == io::ErrorKind::AlreadyExists => {}
            opened => return opened.map(|file| (temporary, file)),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "no free name for a temporary file"))
}

#[cfg(test)]
mod tests {
    use super::super::test_folder::TestFolder;
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_to() {
        use std::os::unix::fs::FileTypeExt;
        let null = Path::new("/dev/null");
        write_atomically(null, b"nothing").unwrap();
        assert!(fs::metadata(null).unwrap().file_type().is_char_device());
        assert!(write_atomically(Path::new("/dev/full"), b"much").is_err());
    }

    #[test]
    fn replaces_and_leaves_nothing_else() {
        let folder = TestFolder::new();
        let path = folder.path("a.txt");
        for content in ["first", "second"] {
            write_atomically(&path, content.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), content);
        }
        assert_eq!(folder.names(), ["a.txt"]);
    }

    #[test]
    fn a_leftover_is_passed_over() {
        let folder = TestFolder::new();
        fs::write(folder.path(".a.txt.0.tmp"), "left").unwrap();
        write_atomically(&folder.path("a.txt"), b"new").unwrap();
        assert_eq!(folder.names(), [".a.txt.0.tmp", "a.txt"]);
    }

    #[test]
    fn failures_name_the_file_and_leave_nothing() {
        let folder = TestFolder::new();
        let missing = folder.path("none/a.txt");
        let error = write_atomically(&missing, b"x").unwrap_err();
        assert_eq!(error.reason.kind(), io::ErrorKind::NotFound);
        assert!(error.to_string().starts_with(&format!("cannot write {}", missing.display())));

        fs::create_dir(folder.path("sub")).unwrap();
        let error = write_atomically(&folder.path("sub"), b"x").unwrap_err();
        assert_eq!(error.reason.kind(), io::ErrorKind::IsADirectory);
        assert!(write_atomically(Path::new("/"), b"x").is_err());
        assert_eq!(folder.names(), ["sub"]);
    }
}
