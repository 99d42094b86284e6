//! Finished runs of a batch that is under way.
//!
//! One line for each, as JSON, appended as a whole when the run is finished. Of a program that is killed while it writes one the
//! last line may be torn: it is cut off, and its run made again.

use super::plan::Planned;
use super::record::Record;
use crate::error::{CliError, Kind};
use keyway::map::formats::system_error_in_words;
use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// The journal of a folder.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// What it held when it was opened.
    held: Vec<Record>,
}

/// Its name in the folder.
pub(super) const NAME: &str = "journal.jsonl";

impl Journal {
    /// Opens it for appending; makes it where there is none.
    pub(super) fn open(folder: &Path) -> Result<Self, CliError> {
        let path = folder.join(NAME);
        let blame = |error: std::io::Error| refused(&path, &system_error_in_words(&error));
        fs::create_dir_all(folder).map_err(blame)?;
        let mut options = OpenOptions::new();
        let options = options.create(true).read(true).append(true);
        let mut file = options.open(&path).map_err(blame)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(blame)?;
        let (held, whole) = records_of(&text).ok_or_else(|| {
            let what = "it is not the journal of a batch of this version; move it away, or choose another folder";
            refused(&path, what)
        })?;
        file.set_len(whole as u64).map_err(blame)?;
        Ok(Self { path, file, held })
    }

    /// The runs that it holds.
    pub(super) fn take_over(&mut self, planned: &[Planned], records: &mut [Option<Record>]) {
        fill(planned, records, std::mem::take(&mut self.held));
    }

    /// Writes down a finished run.
    pub(super) fn append(&mut self, record: &Record) -> Result<(), CliError> {
        // A record is plain data with string keys: this cannot fail.
        let mut line = serde_json::to_vec(record).unwrap_or_default();
        line.push(b'\n');
        self.file
            .write_all(&line)
            .map_err(|error| refused(&self.path, &system_error_in_words(&error)))
    }

    /// Everything that it holds is written elsewhere.
    pub(super) fn remove(self) {
        // Where it stays, it says what the results say.
        let _ = fs::remove_file(self.path);
    }
}

/// The records of a journal, and how many of its bytes they are: what follows is a line that was not written to its end. `None`
/// where the text is something else.
fn records_of(text: &[u8]) -> Option<(Vec<Record>, usize)> {
    /// With which every line begins.
    const BEGIN: &[u8] = b"{\"run\":{";
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let (lines, torn) = text.split_at(whole);
    let is_line = torn.starts_with(BEGIN) || BEGIN.starts_with(torn);
    let lines = lines.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
    let records = lines.map(|line| serde_json::from_slice(line).ok()).collect::<Option<_>>()?;
    is_line.then_some((records, whole))
}

/// Puts records to the runs that they are of.
pub(super) fn fill(
    planned: &[Planned],
    records: &mut [Option<Record>],
    held: impl IntoIterator<Item = Record>,
) {
    let held: HashMap<String, Record> =
        held.into_iter().map(|record| (record.run.digest.clone(), record)).collect();
    for (planned, record) in planned.iter().zip(records) {
        let Some(found) = held.get(&planned.digest) else { continue };
        let run = &found.run;
        let is_same = run.scene == planned.scene && run.stack == planned.stack;
        if record.is_none() && is_same {
            *record = Some(found.clone());
        }
    }
}

fn refused(path: &Path, what: &str) -> CliError {
    CliError::new(Kind::Output, format!("{}: {what}", path.display())).field("--out")
}
