//! A folder of results, in which nothing is overwritten that Keyway did not write.

use crate::error::{CliError, Kind};
use keyway::map::formats::write_atomically;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Lists the files of the folder that Keyway wrote.
const MANIFEST: &str = ".keyway-files";

/// A folder and the files that are about to be written there.
#[derive(Debug)]
pub(crate) struct OutDir {
    folder: PathBuf,
    /// Names that Keyway wrote, in this run or before.
    own: BTreeSet<String>,
    planned: Vec<&'static str>,
    written: Vec<&'static str>,
}

impl OutDir {
    /// Creates the folder, and makes sure that all the planned files may be written.
    ///
    /// # Errors
    /// When the folder cannot be made, or holds a file of a planned name that is not Keyway's.
    pub(crate) fn create(folder: &Path, planned: &[&'static str]) -> Result<Self, CliError> {
        fs::create_dir_all(folder).map_err(|error| {
            output_error(format!("cannot make the folder {}: {error}", folder.display()))
        })?;
        let manifest = folder.join(MANIFEST);
        let own = match fs::read_to_string(&manifest) {
            Ok(text) => text.lines().map(str::to_owned).collect(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => BTreeSet::new(),
            Err(error) => {
                return Err(output_error(format!("cannot read {}: {error}", manifest.display())));
            }
        };
        for &name in planned {
            let path = folder.join(name);
            // A link that leads nowhere is a file of somebody, too.
            let exists = fs::symlink_metadata(&path).is_ok();
            if exists && !own.contains(name) {
                return Err(output_error(format!(
                    "{} is in the way: Keyway did not write it and does not overwrite it",
                    path.display()
                )));
            }
        }
        Ok(Self { folder: folder.to_owned(), own, planned: planned.to_vec(), written: Vec::new() })
    }

    /// Writes one of the planned files as a whole, or not at all.
    pub(crate) fn write(&mut self, name: &'static str, bytes: &[u8]) -> Result<(), CliError> {
        debug_assert!(self.planned.contains(&name), "{name} was not planned");
        if self.own.insert(name.to_owned()) {
            self.write_manifest()?;
        }
        self.write_file(name, bytes)?;
        self.written.push(name);
        Ok(())
    }

    /// Removes planned files of an earlier run that this one did not write: they would seem to
    /// belong to it. Gives the paths of those that it wrote.
    pub(crate) fn finish(mut self) -> Result<Vec<PathBuf>, CliError> {
        let stale: Vec<&str> =
            self.planned.iter().filter(|name| !self.written.contains(name)).copied().collect();
        for name in stale {
            if self.own.remove(name) {
                // Whoever removed it before did the same.
                let _ = fs::remove_file(self.folder.join(name));
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
        let lines: Vec<&str> = self.own.iter().map(String::as_str).collect();
        self.write_file(MANIFEST, (lines.join("\n") + "\n").as_bytes())
    }

    fn write_file(&self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        write_atomically(&self.folder.join(name), bytes).map_err(output_error)
    }
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
        let mut first = OutDir::create(&path, &["a", "b"]).unwrap();
        first.write("a", b"1").unwrap();
        first.write("b", b"1").unwrap();
        assert_eq!(first.finish().unwrap(), [path.join("a"), path.join("b")]);

        fs::write(path.join("c"), "foreign").unwrap();
        let error = OutDir::create(&path, &["a", "c"]).unwrap_err();
        assert!(error.message.contains("c is in the way"), "{error}");
        let mut second = OutDir::create(&path, &["a", "b"]).unwrap();
        second.write("a", b"2").unwrap();
        second.finish().unwrap();
        assert_eq!(fs::read(path.join("a")).unwrap(), b"2");
        assert!(!path.join("b").exists(), "stale");
        assert_eq!(fs::read(path.join("c")).unwrap(), b"foreign");

        // A file of a name that Keyway once wrote, and then gave up, is foreign.
        fs::write(path.join("b"), "foreign").unwrap();
        assert!(OutDir::create(&path, &["b"]).is_err());
    }
}
