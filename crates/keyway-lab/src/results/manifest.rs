//! The list of the files that Keyway wrote in a folder.
//!
//! Each file has a line `DIGEST NAME`; a name may have several lines while its file is being
//! replaced. Lines `unfinished NAME` list the files of a run that has begun to replace those of
//! an earlier one.
//!
//! There are two copies of the list, and entries of either one are valid. A list that is lost, or
//! restored from a backup, therefore does not make Keyway's own files look foreign.

use keyway::files::{TextFileError, read_text};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a list: more than all files of a run need.
const MAX_BYTES: u64 = 64 << 20;
/// Marker in place of a digest, before a name of [`Manifest::unfinished`].
const UNFINISHED: &str = "unfinished";

/// The files that Keyway wrote in a folder.
#[derive(Debug, Default)]
pub(super) struct Manifest {
    /// Names with the digests of the contents that Keyway wrote, or was about to write.
    own: BTreeMap<String, BTreeSet<String>>,
    unfinished: BTreeSet<String>,
}

/// Error of the list of the files in a folder.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ManifestError {
    /// The list cannot be read, or is no text.
    #[error("{0}; {ADVICE}")]
    File(#[from] TextFileError),
    /// A line names no file.
    #[error(
        "{}: line {line}: expected a digest of 16 digits and the name of a file; {ADVICE}",
        path.display()
    )]
    Line {
        /// The list.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
    },
}

const ADVICE: &str = "this file lists the files that Keyway wrote; if it is damaged, delete it: Keyway uses the \
                      copy beside it; without a copy delete the results, too, or choose another folder";

impl Manifest {
    /// Names of the list and its copy.
    pub(super) const NAMES: [&str; 2] = [".keyway-files", ".keyway-files-copy"];

    /// Reads both lists of a folder; empty without lists.
    pub(super) fn read(folder: &Path) -> Result<Self, ManifestError> {
        let mut manifest = Self::default();
        for name in Self::NAMES {
            let path = folder.join(name);
            if fs::symlink_metadata(&path).is_ok() {
                manifest.add_list(path)?;
            }
        }
        Ok(manifest)
    }

    fn add_list(&mut self, path: PathBuf) -> Result<(), ManifestError> {
        let text = read_text(&path, MAX_BYTES)?;
        for (line, number) in text.lines().zip(1..) {
            if !line.is_empty() && self.add(line).is_none() {
                return Err(ManifestError::Line { path, line: number });
            }
        }
        Ok(())
    }

    fn add(&mut self, line: &str) -> Option<()> {
        let (digest, name) = line.split_once(' ')?;
        let name = unescaped(name);
        if digest == UNFINISHED {
            self.unfinished.insert(name);
        } else if digest.len() == 16 && digest.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            self.own.entry(name).or_default().insert(digest.to_owned());
        } else {
            return None;
        }
        Some(())
    }

    pub(super) fn text(&self) -> String {
        let own = self.own.iter().flat_map(|(name, digests)| {
            digests.iter().map(move |digest| format!("{digest} {}\n", escaped(name)))
        });
        let unfinished =
            self.unfinished.iter().map(|name| format!("{UNFINISHED} {}\n", escaped(name)));
        own.chain(unfinished).collect()
    }

    /// True if a file is as Keyway wrote it.
    pub(super) fn is_own(&self, name: &str, path: &Path) -> bool {
        let Some(digests) = self.own.get(name) else { return false };
        digest_of_file(path).is_ok_and(|digest| digests.contains(&digest))
    }

    /// Records a content that is about to be written.
    pub(super) fn intend(&mut self, name: &str, bytes: &[u8]) {
        self.own.entry(name.to_owned()).or_default().insert(digest(bytes));
    }

    /// Records a content that was written: earlier ones no longer exist.
    pub(super) fn wrote(&mut self, name: &str, bytes: &[u8]) {
        self.own.insert(name.to_owned(), BTreeSet::from([digest(bytes)]));
    }

    pub(super) fn forget(&mut self, name: &str) {
        self.own.remove(name);
    }

    /// Removes files that no longer exist, or never existed.
    pub(super) fn forget_missing(&mut self, folder: &Path) {
        self.own.retain(|name, _| fs::symlink_metadata(folder.join(name)).is_ok());
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.own.keys().map(String::as_str)
    }

    /// Returns the files of a run that has begun, and of all earlier ones that did not end.
    pub(super) fn unfinished(&self) -> impl Iterator<Item = &String> {
        self.unfinished.iter()
    }

    pub(super) fn begin(&mut self, names: &[String]) {
        self.unfinished.extend(names.iter().cloned());
    }

    pub(super) fn end(&mut self) {
        self.unfinished.clear();
    }
}

/// Escapes a name to a single line.
fn escaped(name: &str) -> String {
    name.replace('\\', "\\\\").replace('\n', "\\n").replace('\r', "\\r")
}

fn unescaped(text: &str) -> String {
    let mut name = String::new();
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        name.push(match letter {
            '\\' => match letters.next() {
                Some('n') => '\n',
                Some('r') => '\r',
                other => other.unwrap_or('\\'),
            },
            letter => letter,
        });
    }
    name
}

/// FNV-1a, 64 bits: detects changes of a file, but not forgery.
fn mixed(hash: u64, bytes: &[u8]) -> u64 {
    let mix = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(hash, mix)
}

const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a of some bytes, 64 bits as 16 hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    format!("{:016x}", mixed(EMPTY, bytes))
}

/// The same for the content of a file. Anything else is an error, as a pipe would never end.
fn digest_of_file(path: &Path) -> io::Result<String> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let mut file = BufReader::new(File::open(path)?);
    let mut hash = EMPTY;
    loop {
        let bytes = file.fill_buf()?;
        if bytes.is_empty() {
            return Ok(format!("{hash:016x}"));
        }
        hash = mixed(hash, bytes);
        let count = bytes.len();
        file.consume(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let mut manifest = Manifest::default();
        let names = ["a b.svg", "two\nlines\r.png", "back\\nslash"];
        for name in names {
            manifest.intend(name, b"old");
            manifest.intend(name, b"new");
        }
        manifest.wrote(names[0], b"newer");
        manifest.begin(&[names[1].to_owned()]);
        fs::write(folder.path().join(Manifest::NAMES[0]), manifest.text()).unwrap();
        let read = Manifest::read(folder.path()).unwrap();
        assert_eq!((&read.own, &read.unfinished), (&manifest.own, &manifest.unfinished));
        assert_eq!(read.own[names[0]].len(), 1);
        assert_eq!(read.own[names[2]].len(), 2);
    }

    #[test]
    fn a_damaged_list_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |bytes: &[u8]| {
            fs::write(folder.path().join(Manifest::NAMES[0]), bytes).unwrap();
            Manifest::read(folder.path()).unwrap_err().to_string()
        };
        let good = "0123456789abcdef a.svg\n";
        for line in ["mine", "0123456789abcdeg a.svg", "0123 a.svg", "0123456789abcdef"] {
            let text = refused(format!("{good}{line}\n").as_bytes());
            assert!(text.contains(".keyway-files: line 2: expected a digest"), "{text}");
        }
        let text = refused(b"\xff");
        assert!(
            text.contains(".keyway-files: line 1 is not UTF-8")
                && text.contains("damaged, delete it")
        );
        fs::remove_file(folder.path().join(Manifest::NAMES[0])).unwrap();
        assert_eq!(Manifest::read(folder.path()).unwrap().text(), "");
    }
}
