//! What is finished of long work that is under way.
//!
//! One line for each piece, as JSON, appended as a whole when the piece is finished. Of a program that is killed while it writes one the
//! last line may be torn: it is cut off, and its piece made again.
//!
//! Whoever has it open has locked it, so that no two programs write the same results. The system unlocks it when the program ends, in whatever
//! way: a journal that a killed program left is open to the next.

use crate::error::{CliError, Kind};
use keyway::map::formats::system_error_in_words;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// A piece of finished work.
pub(crate) trait Entry: Serialize + DeserializeOwned {
    /// The command that does such work, and what a run of it is called.
    const COMMAND: [&'static str; 2];
    /// With which every line begins.
    const BEGIN: &'static [u8];
}

/// The journal of a folder.
pub(crate) struct Journal<E> {
    path: PathBuf,
    file: File,
    /// What it held when it was opened.
    held: Vec<E>,
    /// Whether nothing would be lost without it.
    is_needless: bool,
}

/// Its name in the folder.
pub(crate) const NAME: &str = "journal.jsonl";

impl<E: Entry> Journal<E> {
    /// Opens it for appending, and makes it where there is none, unless another program has it.
    pub(crate) fn open(folder: &Path) -> Result<Self, CliError> {
        let path = folder.join(NAME);
        let blame = |error: std::io::Error| refused(&path, &system_error_in_words(&error));
        fs::create_dir_all(folder).map_err(blame)?;
        let mut file = locked(&path, E::COMMAND)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(blame)?;
        let (held, whole) = entries_of(&text).ok_or_else(|| {
            let [_, run] = E::COMMAND;
            let what = format!(
                "it is not the journal of a {run} of this version; move it away, or choose another folder"
            );
            refused(&path, &what)
        })?;
        file.set_len(whole as u64).map_err(blame)?;
        let is_needless = held.is_empty();
        Ok(Self { path, file, held, is_needless })
    }

    /// What it held when it was opened.
    pub(crate) fn take(&mut self) -> Vec<E> {
        std::mem::take(&mut self.held)
    }

    /// Writes down a finished piece.
    pub(crate) fn append(&mut self, entry: &E) -> Result<(), CliError> {
        // An entry is plain data with string keys: this cannot fail.
        let mut line = serde_json::to_vec(entry).unwrap_or_default();
        line.push(b'\n');
        self.is_needless = false;
        self.file
            .write_all(&line)
            .map_err(|error| refused(&self.path, &system_error_in_words(&error)))
    }

    /// Everything that it holds is written elsewhere.
    pub(crate) fn remove(mut self) {
        self.is_needless = true;
    }
}

impl<E> Drop for Journal<E> {
    fn drop(&mut self) {
        if self.is_needless {
            // Where it stays, it says what the results say, or nothing.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The file of a journal, of which no other program has this or another file.
fn locked(path: &Path, [command, run]: [&str; 2]) -> Result<File, CliError> {
    let blame = |error: &std::io::Error| refused(path, &system_error_in_words(error));
    loop {
        let mut options = OpenOptions::new();
        let options = options.create(true).read(true).append(true);
        let file = options.open(path).map_err(|error| blame(&error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let what = format!(
                    "another `{command}` is at work in this folder; wait until it has ended, or choose another folder"
                );
                return Err(refused(path, &what));
            }
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                crate::stdout::warn(format!(
                    "{}: files cannot be locked here; see to it that no other {run} is made in this folder",
                    path.display()
                ));
            }
            Err(TryLockError::Error(error)) => return Err(blame(&error)),
        }
        // Whoever had it may have removed it since it was opened.
        if is_at(&file, path) {
            return Ok(file);
        }
    }
}

/// Whether a file that is open is the one that is to be found there.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |of: fs::Metadata| (of.dev(), of.ino());
    let found = fs::metadata(path).map(identity);
    found.is_ok_and(|found| file.metadata().map(identity).is_ok_and(|own| own == found))
}

/// Whether there is a file: elsewhere nothing says whether it is the same.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

/// The entries of a journal, and how many of its bytes they are: what follows is a line that was not written to its end. `None`
/// where the text is something else.
fn entries_of<E: Entry>(text: &[u8]) -> Option<(Vec<E>, usize)> {
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let (lines, torn) = text.split_at(whole);
    let is_line = torn.starts_with(E::BEGIN) || E::BEGIN.starts_with(torn);
    let lines = lines.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
    let entries = lines.map(|line| serde_json::from_slice(line).ok()).collect::<Option<_>>()?;
    is_line.then_some((entries, whole))
}

fn refused(path: &Path, what: &str) -> CliError {
    CliError::new(Kind::Output, format!("{}: {what}", path.display())).field("--out")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Serialize, Deserialize)]
    struct Piece {
        run: u32,
    }

    impl Entry for Piece {
        const COMMAND: [&'static str; 2] = ["keyway batch", "batch"];
        const BEGIN: &'static [u8] = b"{\"run\":";
    }

    #[test]
    fn one_program_has_it_at_a_time_and_what_holds_nothing_is_not_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let first = Journal::<Piece>::open(folder.path()).unwrap();
        let Err(refused) = Journal::<Piece>::open(folder.path()) else {
            panic!("it is open twice")
        };
        assert!(refused.message.contains("another `keyway batch` is at work"), "{refused:?}");
        assert!(path.exists());
        drop(first);
        assert!(!path.exists());
        // As a program that was killed leaves it.
        fs::write(&path, "{\"run\":1").unwrap();
        Journal::<Piece>::open(folder.path()).unwrap().remove();
        assert!(!path.exists());
    }

    #[test]
    #[cfg(unix)]
    fn a_file_that_was_removed_or_replaced_is_another_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let file = File::create(&path).unwrap();
        assert!(is_at(&file, &path));
        fs::remove_file(&path).unwrap();
        assert!(!is_at(&file, &path));
        fs::write(&path, "").unwrap();
        assert!(!is_at(&file, &path));
    }
}
