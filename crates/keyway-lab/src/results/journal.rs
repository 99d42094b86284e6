//! Journal of the finished pieces of long work in progress.
//!
//! Each piece has one line of JSON, which is appended as a whole when the piece is finished. If a
//! program is killed while it writes, the last line may be incomplete: it is cut off, and its
//! piece is repeated.
//!
//! An open journal holds the lock of its folder, so that no two programs write the same results.

use super::json_lines::{self, LinesError, read_lines};
use super::lock::OutputLock;
use super::{OutDir, ResultsError};
use keyway::file_error::WriteError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A piece of finished work.
pub trait JournalEntry: Serialize + DeserializeOwned {
    /// Error message for a line that is not of such work.
    const NOT_ONE: &'static str;
    /// Beginning of every line.
    const BEGIN: &'static [u8];
}

/// The journal of a folder.
pub struct Journal<E> {
    path: PathBuf,
    file: File,
    /// Entries that it held when it was opened.
    held: Vec<E>,
    /// True if nothing would be lost without the journal.
    is_needless: bool,
    /// Lock that is held until the file is removed, if it is removed.
    _lock: Arc<OutputLock>,
}

/// Name of the journal in its folder.
pub const JOURNAL_NAME: &str = "journal.jsonl";

impl<E: JournalEntry> Journal<E> {
    /// Opens the journal of a folder for appending, and creates it if it does not exist.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if the file cannot be used.
    pub fn open(out: &OutDir) -> Result<Self, ResultsError> {
        let path = out.path(JOURNAL_NAME);
        let blame = |error| refused(&path, error);
        // A pipe would never end.
        if fs::metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(ResultsError::NoFile { path });
        }
        let mut options = OpenOptions::new();
        let file = options.create(true).append(true).open(&path).map_err(blame)?;
        let text = read_lines(&path)?;
        let (held, whole) = entries_of(&path, &text)?;
        file.set_len(whole as u64).map_err(blame)?;
        let is_needless = held.is_empty();
        Ok(Self { path, file, held, is_needless, _lock: out.lock() })
    }

    /// Removes and returns the entries that it held when it was opened.
    pub fn take(&mut self) -> Vec<E> {
        std::mem::take(&mut self.held)
    }

    /// Appends a finished piece.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if the file cannot be used.
    pub fn append(&mut self, entry: &E) -> Result<(), ResultsError> {
        // An entry is plain data with string keys: this cannot fail.
        let mut line = serde_json::to_vec(entry).unwrap_or_default();
        line.push(b'\n');
        self.is_needless = false;
        self.file.write_all(&line).map_err(|error| refused(&self.path, error))
    }

    /// Removes the journal, after all its entries were written elsewhere.
    pub fn remove(mut self) {
        self.is_needless = true;
    }
}

impl<E> Drop for Journal<E> {
    fn drop(&mut self) {
        if self.is_needless {
            // A journal that remains repeats the results, or is empty.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Returns the entries of a journal, and their number of bytes: any bytes behind them are an
/// incomplete line.
fn entries_of<E: JournalEntry>(path: &Path, text: &[u8]) -> Result<(Vec<E>, usize), LinesError> {
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let (lines, torn) = text.split_at(whole);
    if !torn.starts_with(E::BEGIN) && !E::BEGIN.starts_with(torn) {
        // The part behind the last line end is the incomplete line.
        let line = text.split(|&byte| byte == b'\n').count();
        return Err(LinesError::JournalEntry { path: path.to_owned(), line, what: E::NOT_ONE });
    }
    Ok((json_lines::entries(path, lines, E::NOT_ONE)?, whole))
}

fn refused(path: &Path, reason: std::io::Error) -> ResultsError {
    ResultsError::System(WriteError { path: path.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Serialize, Deserialize)]
    struct Piece {
        run: u32,
    }

    impl JournalEntry for Piece {
        const NOT_ONE: &'static str = "it is no piece";
        const BEGIN: &'static [u8] = b"{\"run\":";
    }

    fn open(folder: &Path) -> Result<Journal<Piece>, ResultsError> {
        Journal::open(&OutDir::prepare(folder, &["a"])?)
    }

    #[test]
    fn one_program_has_it_at_a_time_and_what_holds_nothing_is_not_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL_NAME);
        let first = open(folder.path()).unwrap();
        let Err(refused) = open(folder.path()) else { panic!("it is open twice") };
        assert!(
            refused.to_string().contains("another `keyway` is writing to this folder"),
            "{refused:?}"
        );
        assert!(path.exists());
        drop(first);
        assert!(!path.exists());
        // As left by a program that was killed.
        for torn in [&b"{\"run\":1"[..], b"{\"run\":\"\xc3"] {
            fs::write(&path, torn).unwrap();
            open(folder.path()).unwrap().remove();
            assert!(!path.exists());
        }
    }

    #[test]
    fn what_is_no_journal_stays_and_its_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL_NAME);
        for (text, line) in [
            ("{\"run\":1}\n{\"ran\":2}\n", 2),
            ("diary", 1),
            ("{\"run\":1}\n{\"run\":2}\ndiary", 3),
        ] {
            fs::write(&path, text).unwrap();
            let refused = open(folder.path()).err().unwrap();
            let expected = format!("journal.jsonl: line {line}: it is no piece");
            assert!(refused.to_string().ends_with(&expected), "{refused}");
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        let long = format!("{{\"run\":1}}\n{{\"run\":{}}}\n", "1".repeat(17 << 20));
        fs::write(&path, long).unwrap();
        let refused = open(folder.path()).err().unwrap();
        assert!(refused.to_string().contains("journal.jsonl: line 2 has 1782"), "{refused}");
    }
}
