//! The full records of runs, which can be replayed: a file for each in the folder `records`.
//!
//! A record is written before the line of its run in the journal. The record of a known run
//! therefore exists, unless it was not requested at that time: such a run is executed again.

use super::{BatchError, Keep, PartsError, Record, RunId};
use crate::replay::RunRecord;
use crate::results::{ResultsError, digest, json_text};
use keyway::file_error::WriteError;
use keyway::file_system::write_atomically;
use keyway::files::read_text;
use std::collections::HashMap;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The folder of records, and the choice of what it holds.
pub(super) struct Kept {
    folder: PathBuf,
    keep: Keep,
}

impl Kept {
    /// Name of the folder in the folder of the results.
    const FOLDER: &str = "records";

    /// Refuses to replace files that are not records in a folder of results.
    pub(super) fn prepare<'a>(
        out: &Path,
        keep: Keep,
        runs: impl Iterator<Item = RunId<'a>>,
    ) -> Result<Self, BatchError> {
        let kept = Self { folder: out.join(Self::FOLDER), keep };
        if keep != Keep::None {
            let mut paths = runs.map(|run| kept.path(run));
            if let Some(path) = paths.find(|path| path.exists() && !begins(path, None)) {
                return Err(BatchError::RecordInTheWay { path });
            }
        }
        Ok(kept)
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// True if the record of a finished run is to be kept.
    pub(super) fn wants(&self, run: &Record) -> bool {
        self.keep.wants(run.run.outcome)
    }

    /// True if a run is known, but its record, which is to be kept, is missing.
    pub(super) fn lacks(&self, run: RunId<'_>, known: &Record) -> bool {
        self.wants(known) && !self.has(run)
    }

    fn has(&self, run: RunId<'_>) -> bool {
        begins(&self.path(run), Some(run.digest))
    }

    /// Counts the runs that have a record.
    pub(super) fn count<'a>(&self, runs: impl Iterator<Item = RunId<'a>>) -> usize {
        if self.folder.is_dir() { runs.filter(|&run| self.has(run)).count() } else { 0 }
    }

    /// Writes the record of a finished run.
    pub(super) fn write(&self, run: RunId<'_>, record: &RunRecord) -> Result<(), ResultsError> {
        self.write_text(run, json_text(record).as_bytes())
    }

    fn write_text(&self, run: RunId<'_>, text: &[u8]) -> Result<(), ResultsError> {
        fs::create_dir_all(&self.folder).map_err(|reason| {
            ResultsError::System(WriteError { path: self.folder.clone(), reason })
        })?;
        Ok(write_atomically(&self.path(run), text)?)
    }

    /// Copies the record of a run from another folder of results.
    pub(super) fn take_over(&self, run: RunId<'_>, other: &Path) -> Result<(), BatchError> {
        let path = other.join(Self::FOLDER).join(file_name(run));
        if !begins(&path, Some(run.digest)) || self.has(run) {
            return Ok(());
        }
        let text = read_text(&path, RunRecord::MAX_BYTES).map_err(PartsError::File)?;
        Ok(self.write_text(run, text.as_bytes())?)
    }

    /// Removes records of runs that are not, or no longer, among the results.
    pub(super) fn remove_others<'a>(&self, runs: impl Iterator<Item = RunId<'a>>) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let own: HashMap<OsString, &str> =
            runs.map(|run| (file_name(run).into(), run.digest)).collect();
        let is_other = |path: &PathBuf| {
            let digest = path.file_name().and_then(|name| own.get(name));
            digest.is_none_or(|digest| !begins(path, Some(digest)))
        };
        let paths = entries.flatten().map(|entry| entry.path()).filter(is_other);
        for path in paths.filter(|path| begins(path, None)) {
            // On an error, another program has already removed it.
            let _ = fs::remove_file(path);
        }
    }

    fn path(&self, run: RunId<'_>) -> PathBuf {
        self.folder.join(file_name(run))
    }
}

/// Maximum length of a name; longer ones are not valid file names everywhere.
const LONGEST: usize = 180;

/// File name `SCENE.STACK.SEED.json`. Letters, digits, `-` and `_` are kept, everything else is
/// encoded as in a web address, so no two runs have the same name.
fn file_name(run: RunId<'_>) -> String {
    let name = format!("{}.{}.{}", safe(run.scene), safe(run.stack), run.seed);
    if name.len() <= LONGEST {
        return name + ".json";
    }
    // All of it is ASCII.
    format!("{}.{}.json", &name[..LONGEST - 17], digest(name.as_bytes()))
}

fn safe(name: &str) -> String {
    let letter = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' => char::from(byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    name.bytes().map(letter).collect()
}

/// True if a file is a record, and has this digest if one is given. A record is written as a
/// whole, so its first lines are sufficient.
fn begins(path: &Path, digest: Option<&str>) -> bool {
    let head = RunRecord::head(digest);
    let mut found = vec![0; head.len()];
    let is_file = fs::metadata(path).is_ok_and(|it| it.is_file());
    is_file
        && File::open(path).is_ok_and(|mut file| file.read_exact(&mut found).is_ok())
        && found == head.as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_different() {
        assert_eq!(safe("world_007"), "world_007");
        assert_eq!(safe("../my stack.toml"), "%2E%2E%2Fmy%20stack%2Etoml");
        assert_eq!(safe("ü"), "%C3%BC");
        assert_ne!(safe("a b"), safe("a%20b"));
    }
}
