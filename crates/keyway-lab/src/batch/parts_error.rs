//! Errors of results that are to be merged.

use super::Shard;
use crate::results::LinesError;
use keyway::files::TextFileError;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why the results of some folders cannot be merged.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PartsError {
    /// The batch of a folder has not ended.
    #[error(
        "{}: the batch has not finished; start it again to resume it",
        journal.display()
    )]
    NotEnded {
        /// The journal of the batch.
        journal: PathBuf,
    },
    /// A file of results cannot be read.
    #[error("{0}{advice}", advice = advice(.0))]
    Lines(#[source] LinesError),
    /// The times are not those of the runs.
    #[error("{}: its number of lines differs from that of runs.jsonl; run the batch again", times.display())]
    Times {
        /// The file of times.
        times: PathBuf,
    },
    /// The times or the robots of a run are missing.
    #[error(
        "{}: line {line}: times.jsonl or robots.jsonl have no entries for this run; run the batch \
         again",
        runs.display()
    )]
    Incomplete {
        /// The file of runs.
        runs: PathBuf,
        /// The line, from 1.
        line: usize,
    },
    /// The description of a part, or a record, cannot be read.
    #[error(transparent)]
    File(#[from] TextFileError),
    /// The description of a part is invalid.
    #[error(
        "{}: it does not contain a valid part of a batch, of at most {} parts",
        path.display(),
        Shard::MOST
    )]
    NoPart {
        /// The file.
        path: PathBuf,
    },
    /// Two folders hold the same run: a scene of one name with the same stack and seed.
    #[error(
        "the run of {scene} with {stack} and seed {seed} {} {} and {}",
        if *is_same { "is in both" } else { "has different inputs in" },
        folders[0].display(),
        folders[1].display()
    )]
    RunTwice {
        /// The scene.
        scene: String,
        /// The stack.
        stack: String,
        /// The seed.
        seed: u64,
        /// True if all inputs are the same.
        is_same: bool,
        /// The folders.
        folders: [PathBuf; 2],
    },
    /// The folders do not hold all parts of a batch.
    #[error(
        "{}: other parts of the same batch are missing: {}; give the folders of all parts, run with the \
         same scenes, stacks and seeds",
        folder.display(),
        shown(missing, *of)
    )]
    Missing {
        /// A part of the batch.
        folder: PathBuf,
        /// Numbers of the missing parts, from 1.
        missing: Vec<usize>,
        /// Number of parts.
        of: usize,
    },
    /// The parts of a batch were changed.
    #[error(
        "{}: the parts do not match the division of the batch; run them again",
        folder.display()
    )]
    OtherParts {
        /// The first part.
        folder: PathBuf,
    },
}

const fn advice(error: &LinesError) -> &'static str {
    match error {
        LinesError::Read(_) => "; it is written when a batch has finished",
        _ => "",
    }
}

/// Maximum number of missing parts that are listed.
const SHOWN: usize = 10;

fn shown(missing: &[usize], of: usize) -> String {
    let names: Vec<String> = missing.iter().map(|number| format!("{number}/{of}")).collect();
    // A single remaining part takes no more space than the text that replaces it.
    if names.len() < SHOWN + 2 {
        return names.join(", ");
    }
    format!("{} and {} more", names[..SHOWN].join(", "), names.len() - SHOWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_of_many_missing_parts_are_named() {
        let missing = |parts: usize| shown(&(1..=parts).collect::<Vec<_>>(), 20);
        assert_eq!(missing(2), "1/20, 2/20");
        assert!(missing(11).ends_with("10/20, 11/20"));
        assert!(missing(12).ends_with("9/20, 10/20 and 2 more"));
    }
}
