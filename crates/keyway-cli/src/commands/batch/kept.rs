//! The full records of runs, which `keyway replay` reads: a file for each in the folder `records`.
//!
//! A record is written before the line of its run in the journal. So of a run that is known, the record is there, unless it
//! was not asked for then: such a run is made again.

use super::plan::Planned;
use super::record::Record;
use crate::args::Keep;
use crate::commands::replay::RunRecord;
use crate::error::{CliError, Kind};
use crate::out_dir::digest;
use keyway::episode::EpisodeOutcome;
use keyway::map::formats::write_atomically;
use std::collections::HashSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The folder of records, and what it is to hold.
pub(super) struct Kept {
    folder: PathBuf,
    keep: Keep,
}

impl Kept {
    /// Its name in the folder of the results.
    const FOLDER: &str = "records";

    /// In the folder of the results. Refuses to replace what is not a record.
    pub(super) fn prepare(out: &Path, keep: Keep, planned: &[Planned]) -> Result<Self, CliError> {
        let kept = Self { folder: out.join(Self::FOLDER), keep };
        if keep != Keep::None {
            let mut paths = planned.iter().map(|planned| kept.path(planned));
            if let Some(path) = paths.find(|path| path.exists() && !begins(path, None)) {
                return Err(refused(
                    &path,
                    "it is in the way, and no record of a run; move it away",
                ));
            }
        }
        Ok(kept)
    }

    /// Whether the record of a run that ended so is to be kept.
    pub(super) fn wants(&self, outcome: EpisodeOutcome) -> bool {
        match self.keep {
            Keep::None => false,
            Keep::Failures => outcome != EpisodeOutcome::Reached,
            Keep::All => true,
        }
    }

    /// Whether a run is known, but not its record.
    pub(super) fn lacks(&self, planned: &Planned, known: &Record) -> bool {
        let is_there = || begins(&self.path(planned), Some(&planned.digest));
        self.wants(known.run.outcome) && !is_there()
    }

    /// Writes the record of a run that has ended.
    pub(super) fn write(&self, planned: &Planned, record: &RunRecord) -> Result<(), CliError> {
        let made = fs::create_dir_all(&self.folder);
        made.map_err(|error| refused(&self.folder, &error.to_string()))?;
        let text = crate::json::to_string(record);
        write_atomically(&self.path(planned), text.as_bytes())
            .map_err(|error| CliError::new(Kind::Output, error).field("--out"))
    }

    /// Removes records of runs that are none of the results, or not any more.
    pub(super) fn remove_others(&self, planned: &[Planned]) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let own: HashSet<OsString> = planned.iter().map(|one| file_name(one).into()).collect();
        let is_other = |path: &PathBuf| !path.file_name().is_some_and(|name| own.contains(name));
        let others = entries.flatten().map(|entry| entry.path()).filter(is_other);
        let replaced = planned.iter().map(|one| (self.path(one), &one.digest));
        let replaced = replaced.filter(|(path, digest)| !begins(path, Some(digest)));
        for path in others.chain(replaced.map(|(path, _)| path)) {
            if begins(&path, None) {
                // Whoever removed it before did the same.
                let _ = fs::remove_file(path);
            }
        }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// How many of the runs have a record.
    pub(super) fn count(&self, planned: &[Planned]) -> usize {
        let has_record = |one: &&Planned| begins(&self.path(one), Some(&one.digest));
        if self.folder.is_dir() { planned.iter().filter(has_record).count() } else { 0 }
    }

    fn path(&self, planned: &Planned) -> PathBuf {
        self.folder.join(file_name(planned))
    }
}

/// Longer names are no file names everywhere.
const LONGEST: usize = 180;

/// `SCENE.STACK.SEED.json`. Letters, digits, `-` and `_` stand for themselves, everything else as in a web address: no two runs
/// have the same name.
fn file_name(planned: &Planned) -> String {
    let name = format!("{}.{}.{}", safe(&planned.scene), safe(&planned.stack), planned.seed);
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

/// Whether a file is a record, of this digest where one is given. It was written as a whole, so its first lines say it.
fn begins(path: &Path, digest: Option<&str>) -> bool {
    let head = RunRecord::head(digest);
    let mut found = vec![0; head.len()];
    let is_file = fs::metadata(path).is_ok_and(|it| it.is_file());
    is_file
        && File::open(path).is_ok_and(|mut file| file.read_exact(&mut found).is_ok())
        && found == head.as_bytes()
}

fn refused(path: &Path, what: &str) -> CliError {
    CliError::new(Kind::Output, format!("{}: {what}", path.display())).field("--out")
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
