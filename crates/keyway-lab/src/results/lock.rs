//! Lock for writing several files that belong together.
//!
//! A program that writes to a folder of results holds a lock on a file in it, so that no two
//! programs mix their results. The system releases the lock when the program ends for any reason,
//! so the next program can continue after a killed one.

use super::ResultsError;
use keyway::file_error::WriteError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Write lock, held until it is dropped.
#[derive(Debug)]
pub struct OutputLock {
    path: PathBuf,
    file: LockFile,
    /// Folders that were created for the lock, the innermost first.
    made: Vec<PathBuf>,
}

impl OutputLock {
    /// Name of the lock file in a folder of results.
    pub const NAME: &str = ".keyway-lock";

    /// Number of attempts to recreate a folder that other programs remove: they do so once for
    /// each of their runs.
    const RETRIES: usize = 1_000;

    /// Locks all files of a folder, which is created if it does not exist.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if another program holds the lock, or the folder cannot be
    /// written to.
    pub fn of_folder(folder: &Path) -> Result<Self, ResultsError> {
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = folder.ancestors().take_while(is_missing).map(Path::to_owned).collect();
        let path = folder.join(Self::NAME);
        let open = || {
            let attempt = || fs::create_dir_all(folder).and_then(|()| open(&path));
            // The program that created the folder may remove it between two steps of this one. If
            // the folder can never be created (in one that is deleted), the last error is
            // returned.
            let refused_in_passing = |it: &io::Result<File>| {
                use ErrorKind::{AlreadyExists, NotFound};
                it.as_ref().is_err_and(|it| matches!(it.kind(), NotFound | AlreadyExists))
            };
            let mut attempts = (0..Self::RETRIES).map(|_| attempt());
            attempts.find(|it| !refused_in_passing(it)).unwrap_or_else(attempt)
        };
        let busy = || ResultsError::FolderBusy { path: folder.to_owned() };
        let file = locked(open, &path, busy)?;
        Ok(Self { path, file, made })
    }

    /// Locks a file and those that are written beside it.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if another program holds the lock, or the folder of the file
    /// cannot be written to.
    pub fn of_file(file: &Path) -> Result<Self, ResultsError> {
        let mut name = OsString::from(".");
        name.push(file.file_name().unwrap_or_default());
        name.push(Self::NAME);
        let path = file.with_file_name(name);
        let busy = || ResultsError::FileBusy { path: file.to_owned() };
        Ok(Self { file: locked(|| open(&path), &path, busy)?, path, made: Vec::new() })
    }

    /// True if the system cannot lock files there: other programs may write at the same time.
    pub const fn is_unguarded(&self) -> bool {
        matches!(self.file, LockFile::Unguarded)
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        // A lock file that remains does no harm.
        let _ = fs::remove_file(&self.path);
        // Only empty folders are removed: a run that is refused leaves nothing behind.
        let _ = self.made.iter().try_for_each(fs::remove_dir);
    }
}

fn open(path: &Path) -> io::Result<File> {
    // Opening a pipe for writing only would block.
    OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path)
}

/// The lock file.
#[derive(Debug)]
enum LockFile {
    /// Locked for as long as it is open.
    Locked { _file: File },
    /// Files cannot be locked there.
    Unguarded,
}

/// Locks the file at a path, and checks that it is still there afterwards; `busy` is the error if
/// another program holds the lock.
fn locked(
    open: impl Fn() -> io::Result<File>,
    path: &Path,
    busy: impl Fn() -> ResultsError,
) -> Result<LockFile, ResultsError> {
    let blame = |reason| ResultsError::System(WriteError { path: path.to_owned(), reason });
    loop {
        let file = open().map_err(blame)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(busy()),
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                return Ok(LockFile::Unguarded);
            }
            Err(TryLockError::Error(error)) => return Err(blame(error)),
        }
        // The previous holder may have removed it since it was opened.
        if is_at(&file, path) {
            return Ok(LockFile::Locked { _file: file });
        }
    }
}

/// True if an open file is the one at this path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |of: fs::Metadata| (of.dev(), of.ino());
    let found = fs::metadata(path).map(identity);
    found.is_ok_and(|found| file.metadata().map(identity).is_ok_and(|own| own == found))
}

/// True if a file exists: this platform cannot tell if it is the same.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    #[test]
    fn one_has_it_at_a_time_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b");
        let first = OutputLock::of_folder(&path).unwrap();
        let refused = OutputLock::of_folder(&path).unwrap_err();
        let expected = "another `keyway` is writing to this folder; wait until it has finished, or \
                        choose another folder";
        assert!(refused.to_string().ends_with(expected), "{refused}");
        assert!(path.join(OutputLock::NAME).exists(), "the one that was refused removed nothing");
        drop(first);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let file = folder.path().join("m.yaml");
        let first = OutputLock::of_file(&file).unwrap();
        assert!(OutputLock::of_file(&file).unwrap_err().to_string().contains("writing this file"));
        let other = OutputLock::of_file(&folder.path().join("n.yaml")).unwrap();
        drop((first, other));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_a_killed_program_left_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(OutputLock::NAME), "").unwrap();
        fs::write(folder.path().join("kept"), "").unwrap();
        drop(OutputLock::of_folder(folder.path()).unwrap());
        let names = fs::read_dir(folder.path()).unwrap().map(|it| it.unwrap().file_name());
        assert_eq!(names.collect::<Vec<_>>(), ["kept"]);
    }

    /// Each holder removes file and folder on release, while others try to lock them.
    #[test]
    fn never_two_have_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b");
        let held = AtomicBool::new(false);
        // The threads take turns in any order; the number of refusals depends on the system.
        let next_turn = || loop {
            match OutputLock::of_folder(&path) {
                Ok(lock) => return lock,
                Err(ResultsError::FolderBusy { .. }) => thread::yield_now(),
                Err(error) => panic!("{error}"),
            }
        };
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..250 {
                        let lock = next_turn();
                        assert!(!held.swap(true, Ordering::SeqCst), "two have it");
                        held.store(false, Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
    }

    #[test]
    #[cfg(unix)]
    fn a_file_that_was_removed_or_replaced_is_another_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(OutputLock::NAME);
        let file = File::create(&path).unwrap();
        assert!(is_at(&file, &path));
        fs::remove_file(&path).unwrap();
        assert!(!is_at(&file, &path));
        fs::write(&path, "").unwrap();
        assert!(!is_at(&file, &path));
    }
}
