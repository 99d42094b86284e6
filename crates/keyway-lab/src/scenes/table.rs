//! Rows of a CSV file, by the names of its columns.

use keyway::files::{TextFileError, file_text, read_text};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a file \[bytes\]: more than any benchmark's file.
const LARGEST_BYTES: u64 = 256 << 20;

/// Error of a table.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] TextFileError),
    /// A line does not have the columns, or a value is invalid.
    #[error("{}: {}{reason}", path.display(), line.map_or_else(String::new, |n| format!("line {n}: ")))]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1; `None` if the reader cannot determine it.
        line: Option<u64>,
        /// Description of the error, with the name of the column.
        reason: String,
    },
    /// The table has only a header.
    #[error("{}: it has no lines below the header", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
}

/// Reads all lines below the header, and ignores columns that `T` does not have.
pub(super) fn rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, TableError> {
    rows_of(path, &read_text(path, LARGEST_BYTES)?)
}

/// The same for a file in memory; errors use `path` as its path.
pub(super) fn rows_from_bytes<T: DeserializeOwned>(
    path: &Path,
    bytes: &[u8],
) -> Result<Vec<T>, TableError> {
    some(path, rows_of(path, file_text(path, bytes, LARGEST_BYTES)?)?)
}

fn rows_of<T: DeserializeOwned>(path: &Path, text: &str) -> Result<Vec<T>, TableError> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let rows = reader.deserialize().collect::<Result<_, csv::Error>>();
    rows.map_err(|error| {
        let line = error.position().map(csv::Position::line);
        let (line, reason) = match error.kind() {
            csv::ErrorKind::Deserialize { err, .. } => match missing_column(&err.to_string()) {
                Some(column) => (Some(1), no_column(column, &mut reader)),
                None => (line, err.to_string()),
            },
            _ => (line, error.to_string()),
        };
        TableError::Line { path: path.to_owned(), line, reason }
    })
}

/// The column that an error of the parser misses: it blames the first row for a fault of the
/// header.
fn missing_column(message: &str) -> Option<&str> {
    message.strip_prefix("missing field `")?.strip_suffix('`')
}

fn no_column(column: &str, reader: &mut csv::Reader<&[u8]>) -> String {
    // The header has been read before the first row.
    let header = reader.headers().map(|names| names.iter().collect::<Vec<_>>().join(", "));
    format!("the header has no column `{column}`, but: {}", header.unwrap_or_default())
}

/// Reads all lines below the header, and refuses a table without any.
pub(super) fn some_rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, TableError> {
    some(path, rows(path)?)
}

fn some<T>(path: &Path, rows: Vec<T>) -> Result<Vec<T>, TableError> {
    if rows.is_empty() {
        return Err(TableError::Empty { path: path.to_owned() });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, PartialEq, Deserialize)]
    struct Row {
        world: u32,
        x: f64,
    }

    fn read(text: &[u8]) -> Result<Vec<Row>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::fs::write(&path, text).unwrap();
        let shown =
            |error: TableError| error.to_string().replace(&folder.path().display().to_string(), "");
        some_rows(&path).map_err(shown)
    }

    #[test]
    fn columns_are_found_by_their_names() {
        let rows = read(b"\xef\xbb\xbfx, note ,world\n 1.5 ,a,7\n-2,b,8\n").unwrap();
        assert_eq!(rows, [Row { world: 7, x: 1.5 }, Row { world: 8, x: -2.0 }]);
    }

    #[test]
    fn errors_name_file_line_and_column() {
        for (text, expected) in [
            (&b"world,y\n7,1\n"[..], "/a.csv: line 1: the header has no column `x`, but: world, y"),
            (b"world,x\n7,1\n8,wide\n", "/a.csv: line 3: field 1: invalid float literal"),
            (b"world,x\n", "/a.csv: it has no lines below the header"),
            (b"world,x\n7,\xff\n", "/a.csv: line 2 is not UTF-8 text (byte 3 of the line is 0xff)"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
