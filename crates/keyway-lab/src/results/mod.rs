//! Result files: a folder in which only files written by Keyway are overwritten, and a journal
//! from which long work resumes after it was killed.

mod error;
mod folder;
mod journal;
mod json_lines;
mod json_text;
mod lock;
mod manifest;

pub use error::ResultsError;
pub use folder::{OutDir, check_folder};
pub use journal::{JOURNAL_NAME, Journal, JournalEntry};
pub use json_lines::{LinesError, entries, read_lines};
pub use json_text::json_text;
pub use lock::OutputLock;
pub use manifest::{ManifestError, digest};
