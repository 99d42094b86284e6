//! Atomic writing: a reader sees the old content or the new content, never a part.

use crate::file_error::WriteError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Maximum number of temporary files of one file: one for each program that is writing it.
const TEMPORARY_FILES: u32 = 16;

/// Writes `bytes` to a temporary file in the same folder and renames it to `path`, replacing the
/// previous file (its permissions are kept; a symbolic link is replaced, not followed). A device
/// or a pipe cannot be replaced, so it is written to directly.
///
/// Temporary files of `path` that a killed program left behind are removed.
///
/// # Errors
/// Returns [`WriteError`] if the folder does not exist or cannot be written, or if `path` is a
/// folder. The temporary file is removed.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    Staged::new(path, bytes)?.commit()
}

/// Content that is complete on the disk, but does not have its name yet. Dropping it until then
/// leaves everything as it was.
#[derive(Debug)]
pub(crate) struct Staged<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    /// `None` for a device, which is written to when the others are renamed. The file stays open,
    /// and therefore locked, until it has its name.
    temporary: Option<(PathBuf, File)>,
}

impl<'a> Staged<'a> {
    pub(crate) fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self, WriteError> {
        let failed = |reason| WriteError { path: path.to_owned(), reason };
        let mut staged = Self { path, bytes, temporary: None };
        if !is_device(path) {
            let (_, file) = staged.temporary.insert(create_beside(path).map_err(failed)?);
            fill(file, bytes, path).map_err(failed)?;
        }
        Ok(staged)
    }

    pub(crate) fn commit(mut self) -> Result<(), WriteError> {
        let written = match &self.temporary {
            Some((temporary, _)) => fs::rename(temporary, self.path),
            None => (OpenOptions::new().write(true).open(self.path))
                .and_then(|mut device| device.write_all(self.bytes)),
        };
        if written.is_ok() {
            self.temporary = None;
        }
        written.map_err(|reason| WriteError { path: self.path.to_owned(), reason })
    }
}

impl Drop for Staged<'_> {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.temporary {
            // The first failure is the one to report; a leftover file is the lesser evil.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Checks that [`write_atomically`] could write `path`, and leaves everything as it is. Call it
/// before a long computation, so that the result is not lost.
///
/// # Errors
/// As for [`write_atomically`]. A full disk is detected only when the file is written.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let failed = |reason| WriteError { path: path.to_owned(), reason };
    if is_device(path) {
        // Opening a pipe would wait for its reader.
        return Ok(());
    }
    if path.is_dir() {
        return Err(failed(io::ErrorKind::IsADirectory.into()));
    }
    let (temporary, _file) = create_beside(path).map_err(failed)?;
    fs::remove_file(temporary).map_err(failed)
}

/// Removes the temporary files of `path` that a killed program left behind. Files that a running
/// program is writing are locked, and stay.
pub fn remove_leftovers(path: &Path) {
    for temporary in (0..TEMPORARY_FILES).filter_map(|number| temporary_path(path, number)) {
        if !fs::symlink_metadata(&temporary).is_ok_and(|stands| stands.is_file()) {
            continue;
        }
        let Ok(left) = OpenOptions::new().write(true).open(&temporary) else { continue };
        if left.try_lock().is_ok() {
            // Writers skip a file that cannot be removed.
            let _ = fs::remove_file(&temporary);
        }
    }
}

/// True for an existing path that is neither a file nor a folder.
fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|stands| !stands.is_file() && !stands.is_dir())
}

fn fill(file: &mut File, bytes: &[u8], path: &Path) -> io::Result<()> {
    file.write_all(bytes)?;
    if let Ok(replaced) = fs::metadata(path) {
        if replaced.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        file.set_permissions(replaced.permissions())?;
    }
    // Without this, a power cut may leave the new name without content.
    file.sync_all()
}

/// A new, empty, locked file next to `path`.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    if temporary_path(path, 0).is_none() {
        let message = "the path does not end in a file name";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    remove_leftovers(path);
    for temporary in (0..TEMPORARY_FILES).filter_map(|number| temporary_path(path, number)) {
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Err(taken) if taken.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
            Ok(file) => {
                // Some file systems have no locks. Before the file was locked, another program may
                // have mistaken it for a leftover.
                let is_taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
                if !is_taken && temporary.exists() {
                    return Ok((temporary, file));
                }
            }
        }
    }
    let message = "too many programs are writing it at once";
    Err(io::Error::new(io::ErrorKind::AlreadyExists, message))
}

/// `.NAME.keyway-NUMBER.tmp` in the folder of NAME; `None` if the path does not end in a name.
fn temporary_path(path: &Path, number: u32) -> Option<PathBuf> {
    let mut hidden = OsString::from(".");
    hidden.push(path.file_name()?);
    hidden.push(format!(".keyway-{number}.tmp"));
    Some(path.with_file_name(hidden))
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
    fn what_is_staged_and_dropped_leaves_no_trace() {
        let folder = TestFolder::new();
        let (a, b) = (folder.write("a.txt", "old"), folder.path("b.txt"));
        let staged = [&a, &b].map(|path| Staged::new(path, b"new").unwrap());
        assert_eq!((folder.names().len(), fs::read(&a).unwrap()), (3, b"old".into()));
        let [first, second] = staged;
        first.commit().unwrap();
        drop(second);
        assert_eq!((folder.names(), fs::read(&a).unwrap()), (vec!["a.txt".into()], b"new".into()));
    }

    #[test]
    fn what_a_killed_program_left_is_removed() {
        let folder = TestFolder::new();
        for name in [".a.txt.keyway-0.tmp", ".a.txt.keyway-7.tmp", ".b.txt.keyway-0.tmp"] {
            fs::write(folder.path(name), "left").unwrap();
        }
        // Neither temporary files of another file nor those of another program.
        fs::write(folder.path(".a.txt.0.tmp"), "foreign").unwrap();
        write_atomically(&folder.path("a.txt"), b"new").unwrap();
        assert_eq!(folder.names(), [".a.txt.0.tmp", ".b.txt.keyway-0.tmp", "a.txt"]);
        remove_leftovers(&folder.path("b.txt"));
        assert_eq!(folder.names(), [".a.txt.0.tmp", "a.txt"]);
    }

    #[test]
    fn what_another_program_is_writing_stays() {
        let folder = TestFolder::new();
        let path = folder.path("a.txt");
        let (temporary, mut file) = create_beside(&path).unwrap();
        write_atomically(&path, b"of another").unwrap();
        check_writable(&path).unwrap();
        assert_eq!(folder.names(), [".a.txt.keyway-0.tmp", "a.txt"]);
        fill(&mut file, b"mine", &path).and_then(|()| fs::rename(temporary, &path)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"mine");
    }

    #[test]
    fn whether_a_file_can_be_written_is_found_without_writing() {
        let folder = TestFolder::new();
        let path = folder.write("a.txt", "old");
        for writable in [path.clone(), folder.path("b.txt"), PathBuf::from("/dev/null")] {
            check_writable(&writable).unwrap();
        }
        assert_eq!(
            (folder.names(), fs::read(&path).unwrap()),
            (vec!["a.txt".into()], b"old".into())
        );
        let of = |path: &Path| check_writable(path).unwrap_err().to_string();
        let text = of(&folder.path("none/a.txt"));
        assert!(text.ends_with("none/a.txt: there is no such file or folder"), "{text}");
        let text = of(&folder.path("a.txt/b.txt"));
        assert!(text.ends_with("b.txt: a part of the path is a file, not a folder"), "{text}");
        assert!(of(&folder.path("")).ends_with(": it is a folder"));
        #[cfg(target_os = "linux")]
        check_writable(Path::new("/proc/a.txt")).unwrap_err();
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
