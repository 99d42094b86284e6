//! A folder of results, in which only files written by Keyway are overwritten.
//!
//! The folder's list of files ([`Manifest`]) contains the files that Keyway wrote, with a digest
//! of each content. A content is listed before it is written. A run may therefore be killed at
//! any moment: each file then has its previous content or the one listed last, and the next run
//! knows both. Only one run at a time may write to the folder ([`OutputLock`]).

use super::ResultsError;
use super::json_lines::read_lines;
use super::lock::OutputLock;
use super::manifest::Manifest;
use keyway::file_error::WriteError;
use keyway::file_system::{check_writable, remove_leftovers, write_atomically};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder and the files that are about to be written to it.
#[derive(Debug)]
pub struct OutDir {
    folder: PathBuf,
    manifest: Manifest,
    planned: Vec<String>,
    written: Vec<String>,
    /// True if files of an earlier run are to be removed ([`Self::supersede`]).
    supersedes: bool,
    lock: Arc<OutputLock>,
}

impl OutDir {
    /// Checks that all the planned files may be written, and locks the folder until all have been
    /// written. A run that is refused leaves nothing behind, not even the folder.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if there is a file in place of the folder, the folder cannot be
    /// created or written to, another program writes to it, or it holds a file of a planned name
    /// that is not Keyway's, or was changed after Keyway had written it.
    pub fn prepare(folder: &Path, planned: &[impl AsRef<str>]) -> Result<Self, ResultsError> {
        check_folder(folder)?;
        // Locks before anything in the folder is read, since a concurrent writer changes it.
        let lock = Arc::new(OutputLock::of_folder(folder)?);
        let planned: Vec<String> = planned.iter().map(|name| name.as_ref().to_owned()).collect();
        let manifest = Manifest::read(folder)?;
        let mut out = Self {
            folder: folder.to_owned(),
            manifest,
            planned,
            written: Vec::new(),
            supersedes: false,
            lock,
        };
        out.planned.iter().try_for_each(|name| out.check_free(name))?;
        out.remove_leftovers();
        out.manifest.forget_missing(folder);
        Ok(out)
    }

    /// Writes one of the planned files as a whole, or not at all.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if a foreign file has this name, or the file cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        debug_assert!(self.planned.iter().any(|planned| planned == name), "{name} was not planned");
        // A name may have a folder within this one.
        let path = self.path(name);
        let folder = path.parent().unwrap_or(&self.folder);
        fs::create_dir_all(folder).map_err(|reason| folder_error(folder, reason))?;
        // A foreign file may have appeared there since.
        self.check_free(name)?;
        self.manifest.intend(name, bytes);
        if self.supersedes {
            self.manifest.begin(&self.planned);
        }
        self.write_manifest()?;
        write_atomically(&self.path(name), bytes)?;
        record(&self.folder);
        self.manifest.wrote(name, bytes);
        self.written.push(name.to_owned());
        Ok(())
    }

    /// Returns the text of a file of the folder, if Keyway wrote it and it was not changed since.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if it is larger than such a file can be.
    pub fn earlier(&self, name: &str) -> Result<Option<String>, ResultsError> {
        let path = self.path(name);
        if !self.manifest.is_own(name, &path) {
            return Ok(None);
        }
        Ok(String::from_utf8(read_lines(&path)?).ok())
    }

    /// True if the system cannot prevent other programs from writing there at the same time.
    pub fn is_unguarded(&self) -> bool {
        self.lock.is_unguarded()
    }

    /// Returns the write lock, for work after [`Self::finish`].
    pub fn lock(&self) -> Arc<OutputLock> {
        Arc::clone(&self.lock)
    }

    /// Treats files of an earlier run as planned ones, so that [`Self::finish`] removes them,
    /// except those that were changed by others. The same applies to the files of an earlier run
    /// of this kind that was killed.
    pub fn supersede(&mut self, names: impl IntoIterator<Item = String>) {
        self.supersedes = true;
        let unfinished: Vec<String> = self.manifest.unfinished().cloned().collect();
        for name in names.into_iter().chain(unfinished) {
            if self.manifest.is_own(&name, &self.path(&name)) {
                self.planned.push(name);
            }
        }
    }

    /// Removes planned files of an earlier run that this one did not write: they would seem to
    /// belong to it. Returns the paths of the files that this run wrote.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if the list of files cannot be written.
    pub fn finish(mut self) -> Result<Vec<PathBuf>, ResultsError> {
        let stale: Vec<String> =
            self.planned.iter().filter(|name| !self.written.contains(name)).cloned().collect();
        for name in stale {
            if self.manifest.is_own(&name, &self.path(&name)) {
                // On an error, another program has already removed it.
                let _ = fs::remove_file(self.path(&name));
                record(&self.folder);
                self.manifest.forget(&name);
            }
        }
        if self.supersedes {
            self.manifest.end();
        }
        if self.folder.is_dir() {
            self.write_manifest()?;
        }
        Ok(self.written.iter().map(|name| self.folder.join(name)).collect())
    }

    /// Returns the path of a file of the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Refuses to replace a file that Keyway did not write.
    fn check_free(&self, name: &str) -> Result<(), ResultsError> {
        let path = self.path(name);
        // A dangling link is a foreign file, too.
        if fs::symlink_metadata(&path).is_err() || self.manifest.is_own(name, &path) {
            return Ok(());
        }
        Err(ResultsError::InTheWay { path })
    }

    /// Removes temporary files of a run that was killed.
    fn remove_leftovers(&self) {
        if self.folder.is_dir() {
            let names = self.planned.iter().map(String::as_str).chain(self.manifest.names());
            names.chain(Manifest::NAMES).for_each(|name| remove_leftovers(&self.path(name)));
        }
    }

    fn write_manifest(&self) -> Result<(), ResultsError> {
        let text = self.manifest.text();
        for name in Manifest::NAMES {
            write_atomically(&self.path(name), text.as_bytes())?;
            record(&self.folder);
        }
        Ok(())
    }
}

/// Refuses a folder that cannot be created or written to, before anything is computed.
///
/// # Errors
/// Returns [`ResultsError`] for such a folder.
pub fn check_folder(folder: &Path) -> Result<(), ResultsError> {
    let current = Path::new(".");
    let parents = folder.ancestors().map(|it| if it == Path::new("") { current } else { it });
    // The nearest parent that exists: the others are created in it.
    let Some(stands) = parents.into_iter().find(|it| fs::symlink_metadata(it).is_ok()) else {
        return Ok(());
    };
    if !stands.is_dir() {
        return Err(ResultsError::NoFolder { path: stands.to_owned() });
    }
    check_writable(&stands.join(Manifest::NAMES[0]))
        .map_err(|error| folder_error(folder, error.reason))
}

fn folder_error(folder: &Path, reason: std::io::Error) -> ResultsError {
    // The message for a file is suitable for a folder, too.
    WriteError { path: folder.to_owned(), reason }.into()
}

/// Hook for the tests, called after every change of a folder: its content is then what a run that
/// is killed at this moment leaves.
#[cfg(not(test))]
const fn record(_folder: &Path) {}

#[cfg(test)]
use tests::record;

#[cfg(test)]
#[path = "folder_tests.rs"]
mod tests;
