//! A folder of results, in which nothing is overwritten that Keyway did not write.

use crate::error::{CliError, Kind};
use keyway::map::formats::write_atomically;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Lists the files of the folder that Keyway wrote, each with a digest of what it wrote.
const MANIFEST: &str = ".keyway-files";

/// A folder and the files that are about to be written there.
#[derive(Debug)]
pub(crate) struct OutDir {
    folder: PathBuf,
    /// Names that Keyway wrote, in this run or before, with the digests of their contents.
    own: BTreeMap<String, String>,
    planned: Vec<String>,
    written: Vec<String>,
}

impl OutDir {
    /// Makes sure that all the planned files may be written. The folder itself is made by the first
    /// of them, so that a run that is refused leaves nothing behind.
    ///
    /// # Errors
    /// When there is a file in place of the folder, or it holds a file of a planned name that is not
    /// Keyway's, or that somebody changed after Keyway had written it.
    pub(crate) fn prepare(folder: &Path, planned: &[impl AsRef<str>]) -> Result<Self, CliError> {
        if folder.exists() && !folder.is_dir() {
            return Err(output_error(format!("{} is not a folder", folder.display())));
        }
        let planned: Vec<String> = planned.iter().map(|name| name.as_ref().to_owned()).collect();
        let manifest = folder.join(MANIFEST);
        let own = match fs::read_to_string(&manifest) {
            Ok(text) => text
                .lines()
                .filter_map(|line| line.split_once(' '))
                .map(|(digest, name)| (name.to_owned(), digest.to_owned()))
                .collect(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => BTreeMap::new(),
            Err(error) => {
                return Err(output_error(format!("cannot read {}: {error}", manifest.display())));
            }
        };
        for name in &planned {
            let path = folder.join(name);
            // A link that leads nowhere is a file of somebody, too.
            let exists = fs::symlink_metadata(&path).is_ok();
            let is_own = || {
                let now = fs::read(&path).map(|bytes| digest(&bytes)).ok();
                now.is_some() && own.get(name.as_str()) == now.as_ref()
            };
            if exists && !is_own() {
                return Err(output_error(format!(
                    "{} is in the way: Keyway did not write it, or it was changed since, and is not \
                     overwritten",
                    path.display()
                )));
            }
        }
        Ok(Self { folder: folder.to_owned(), own, planned, written: Vec::new() })
    }

    /// Writes one of the planned files as a whole, or not at all.
    pub(crate) fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        debug_assert!(self.planned.iter().any(|planned| planned == name), "{name} was not planned");
        fs::create_dir_all(&self.folder).map_err(|error| {
            output_error(format!("cannot make the folder {}: {error}", self.folder.display()))
        })?;
        self.write_file(name, bytes)?;
        self.own.insert(name.to_owned(), digest(bytes));
        self.write_manifest()?;
        self.written.push(name.to_owned());
        Ok(())
    }

    /// The text of a file of the folder, if Keyway wrote it and nobody changed it since.
    pub(crate) fn earlier(&self, name: &str) -> Option<String> {
        let text = fs::read_to_string(self.folder.join(name)).ok()?;
        (self.own.get(name) == Some(&digest(text.as_bytes()))).then_some(text)
    }

    /// Takes files of an earlier run for planned ones, so that [`Self::finish`] removes them; but not
    /// those that somebody changed.
    pub(crate) fn supersede(&mut self, names: impl IntoIterator<Item = String>) {
        for name in names {
            let now = fs::read(self.folder.join(&name)).map(|bytes| digest(&bytes)).ok();
            if now.is_some() && self.own.get(&name) == now.as_ref() {
                self.planned.push(name);
            }
        }
    }

    /// Removes planned files of an earlier run that this one did not write: they would seem to
    /// belong to it. Gives the paths of those that it wrote.
    pub(crate) fn finish(mut self) -> Result<Vec<PathBuf>, CliError> {
        let stale: Vec<String> =
            self.planned.iter().filter(|name| !self.written.contains(name)).cloned().collect();
        for name in stale {
            if self.own.remove(&name).is_some() {
                // Whoever removed it before did the same.
                let _ = fs::remove_file(self.folder.join(&name));
                self.write_manifest()?;
            }
        }
        Ok(self.written.iter().map(|name| self.folder.join(name)).collect())
    }

    /// The path of a file of the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn write_manifest(&self) -> Result<(), CliError> {
        let lines: Vec<String> =
            self.own.iter().map(|(name, digest)| format!("{digest} {name}")).collect();
        self.write_file(MANIFEST, (lines.join("\n") + "\n").as_bytes())
    }

    fn write_file(&self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        write_atomically(&self.folder.join(name), bytes).map_err(output_error)
    }
}

/// FNV-1a, 64 bits: tells a file that was changed, not one that was forged.
fn digest(bytes: &[u8]) -> String {
    let mix = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix))
}

fn output_error(message: impl std::fmt::Display) -> CliError {
    CliError::new(Kind::Output, message).field("--out")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_files_are_replaced_and_foreign_ones_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run");
        let mut first = OutDir::prepare(&path, &["a", "b"]).unwrap();
        first.write("a", b"1").unwrap();
        first.write("b", b"1").unwrap();
        assert_eq!(first.finish().unwrap(), [path.join("a"), path.join("b")]);

        fs::write(path.join("c"), "foreign").unwrap();
        let error = OutDir::prepare(&path, &["a", "c"]).unwrap_err();
        assert!(error.message.contains("c is in the way"), "{error}");
        let mut second = OutDir::prepare(&path, &["a", "b"]).unwrap();
        second.write("a", b"2").unwrap();
        second.finish().unwrap();
        assert_eq!(fs::read(path.join("a")).unwrap(), b"2");
        assert!(!path.join("b").exists(), "stale");
        assert_eq!(fs::read(path.join("c")).unwrap(), b"foreign");

        // What Keyway wrote and somebody changed is theirs.
        fs::write(path.join("a"), "edited").unwrap();
        assert!(OutDir::prepare(&path, &["a"]).is_err());
        assert!(OutDir::prepare(&folder.path().join("none"), &["a"]).is_ok());
        assert!(!folder.path().join("none").exists(), "nothing is left behind");

        // A file of a name that Keyway once wrote, and then gave up, is foreign.
        fs::write(path.join("b"), "foreign").unwrap();
        assert!(OutDir::prepare(&path, &["b"]).is_err());
    }
}
