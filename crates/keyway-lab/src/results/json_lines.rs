//! JSON lines files and other results of earlier runs, read within limits.

use keyway::file_error::ReadError;
use keyway::file_system::read_file;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a file: more than all runs of the longest batch take.
const MAX_FILE_BYTES: u64 = 4 << 30;
/// Maximum length of a line: more than a run with the maximum number of robots takes.
const MAX_LINE_BYTES: usize = 16 << 20;

/// Error of a file of an earlier run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LinesError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A line is too long.
    #[error(
        "{}: line {line} has {bytes} bytes, more than the limit of {} MiB",
        path.display(),
        MAX_LINE_BYTES >> 20
    )]
    LongLine {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Length of the line.
        bytes: usize,
    },
    /// A line is not a valid entry.
    #[error("{}: line {line}: {what}", path.display())]
    JournalEntry {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Description of the fault.
        what: &'static str,
    },
}

/// Returns the content of a file. After a killed run, the last line may end within a character.
///
/// # Errors
/// Returns [`LinesError`] if the file cannot be read, or a line is too long.
pub fn read_lines(path: &Path) -> Result<Vec<u8>, LinesError> {
    let text = read_file(path, MAX_FILE_BYTES)?;
    let long = numbered(&text).find(|(_, line)| line.len() > MAX_LINE_BYTES);
    if let Some((line, bytes)) = long.map(|(line, text)| (line, text.len())) {
        return Err(LinesError::LongLine { path: path.to_owned(), line, bytes });
    }
    Ok(text)
}

/// Returns the lines that are not empty, with their numbers, from 1.
fn numbered(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    (1..).zip(text.split(|&byte| byte == b'\n')).filter(|(_, line)| !line.is_empty())
}

/// Returns the entry of each line; `what` describes an invalid line.
///
/// # Errors
/// Returns [`LinesError`] for the first invalid line.
pub fn entries<E: DeserializeOwned>(
    path: &Path,
    text: &[u8],
    what: &'static str,
) -> Result<Vec<E>, LinesError> {
    let entry = |(line, text)| {
        serde_json::from_slice(text).map_err(|_| LinesError::JournalEntry {
            path: path.to_owned(),
            line,
            what,
        })
    };
    numbered(text).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, File};

    #[test]
    fn lines_and_files_have_limits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jsonl");
        let longest = "x".repeat(MAX_LINE_BYTES);
        fs::write(&path, format!("a\n{longest}\nb")).unwrap();
        assert_eq!(read_lines(&path).unwrap().len(), longest.len() + 4);
        fs::write(&path, format!("a\n{longest}x\nb")).unwrap();
        let error = read_lines(&path).unwrap_err().to_string();
        let expected = "a.jsonl: line 2 has 16777217 bytes, more than the limit of 16 MiB";
        assert!(error.ends_with(expected), "{error}");
        File::options().write(true).open(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        let error = read_lines(&path).unwrap_err().to_string();
        assert!(error.ends_with("a.jsonl: it is larger than the limit of 4 GiB"), "{error}");
    }

    #[test]
    fn a_line_that_is_no_entry_is_named() {
        let path = Path::new("a.jsonl");
        assert_eq!(entries::<u32>(path, b"1\n2\n\n3\n", "no number").unwrap(), [1, 2, 3]);
        for text in [&b"1\n{\n"[..], b"1\n\xff\n", b"1\n2 3"] {
            let error = entries::<u32>(path, text, "it is no number").unwrap_err();
            assert_eq!(error.to_string(), "a.jsonl: line 2: it is no number");
        }
    }
}
