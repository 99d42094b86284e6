//! Files of prepared maps.

use super::Prepared;
use super::format::PreparedFormatError;
use crate::file_error::{ReadError, WriteError};
use crate::file_system::{read_file, write_atomically};
use crate::map::SearchMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The largest size that 32-bit numbers of nodes and label entries allow, rounded up.
const MAX_FILE_BYTES: u64 = 1 << 37;

/// The reason why a file of a prepared map cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PreparedFileError {
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The content is invalid.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The fault in the file.
        reason: PreparedFormatError,
    },
}

impl Prepared {
    /// Writes a file; returns its size \[bytes\].
    ///
    /// # Errors
    /// Returns an error if it cannot be written; an existing file is kept.
    pub fn save(&self, path: &Path) -> Result<u64, WriteError> {
        let bytes = self.to_bytes();
        write_atomically(path, &bytes)?;
        Ok(bytes.len() as u64)
    }

    /// Reads the file of a preparation of `map`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, is damaged, or belongs to another map.
    pub fn load(path: &Path, map: &SearchMap) -> Result<Self, PreparedFileError> {
        let bytes = read_file(path, MAX_FILE_BYTES)?;
        Self::from_bytes(&bytes, map)
            .map_err(|reason| PreparedFileError::Format { path: path.to_owned(), reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn errors_name_the_file() {
        let folder = std::env::temp_dir().join(format!("keyway-prepared-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.prepared");
        let grid = OccupancyGrid::from_ascii(&[
            "......", ".##.#.", "....#.", ".#....", "...##.", "......",
        ]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let missing = Prepared::load(&path, &map).unwrap_err().to_string();
        assert!(missing.starts_with(&format!("cannot read {}", path.display())), "{missing}");
        let prepared = Prepared::build(&map).unwrap();
        assert_eq!(prepared.save(&path).unwrap(), prepared.to_bytes().len() as u64);
        assert_eq!(Prepared::load(&path, &map).unwrap().labels, prepared.labels);
        std::fs::write(&path, "type octile\n").unwrap();
        let strange = Prepared::load(&path, &map).unwrap_err().to_string();
        assert!(strange.contains("a.prepared: this is not a prepared map"), "{strange}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
