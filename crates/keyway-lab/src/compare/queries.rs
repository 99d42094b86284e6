//! Starts and goals of a comparison: random ones, or those of a file.

use super::ends::Ends;
use super::map_names::MapNames;
use super::pairs::{PairsError, ends_of_pairs};
use super::report::QuerySource;
use keyway::files::{TextFileError, read_text};
use keyway::map::formats::{MapFileError, Scenario, read_scenarios_for};
use keyway::map::{Connectivity, GridFrame, SearchMap};
use keyway::search::{Query, random_queries};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a file of pairs: millions of pairs \[bytes\].
const PAIRS_BYTES: u64 = 1 << 30;

/// Queries on each map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum QueryChoice {
    /// Random queries between connected cells.
    Random {
        /// Number of queries.
        count: usize,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// All queries of a file of pairs, which has a start and a goal in each line \[m\].
    Pairs {
        /// The file.
        file: PathBuf,
    },
    /// Queries of a scenario file of MovingAI.
    Scenarios {
        /// The file.
        file: PathBuf,
        /// Number of queries, evenly spread over the file; `None` for all.
        count: Option<usize>,
    },
}

impl Default for QueryChoice {
    fn default() -> Self {
        Self::Random { count: Self::USUAL_COUNT, seed: 0 }
    }
}

/// Reason why a map has no queries.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The file of pairs cannot be read.
    #[error(transparent)]
    PairsFile(TextFileError),
    /// A line of the file of pairs is invalid.
    #[error("{}: {error}", path.display())]
    Pairs {
        /// The file.
        path: PathBuf,
        /// Line and fault.
        error: PairsError,
    },
    /// The scenario file cannot be read, or is for a map of another size.
    #[error(transparent)]
    Scenarios(MapFileError),
    /// The scenario file is for another map of the same size.
    #[error("{}: line {line}: for the map {other}, not for {}", path.display(), map.display())]
    OtherMap {
        /// The scenario file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Name of the map in the line.
        other: String,
        /// The map.
        map: PathBuf,
    },
    /// The scenario file is empty.
    #[error("{}: it has no scenarios", path.display())]
    NoScenario {
        /// The scenario file.
        path: PathBuf,
    },
    /// The map has no positions for random queries.
    #[error(
        "{} has no two connected free cells{}",
        map.display(),
        clearance_text(*clearance_m)
    )]
    Unconnected {
        /// The map.
        map: PathBuf,
        /// Clearance of its layers \[m\].
        clearance_m: f64,
    },
}

fn clearance_text(clearance_m: f64) -> String {
    if clearance_m > 0.0 {
        format!("; the clearance of {clearance_m} m may be too large for this map")
    } else {
        String::new()
    }
}

impl QueryChoice {
    /// Default number of random queries.
    pub const USUAL_COUNT: usize = 10;

    /// Requested number of queries; `None` for all queries of a file.
    pub(super) const fn count(&self) -> Option<usize> {
        match self {
            Self::Random { count, .. } => Some(*count),
            Self::Scenarios { count, .. } => *count,
            Self::Pairs { .. } => None,
        }
    }

    /// The file of the queries; `None` for random ones.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Pairs { file } | Self::Scenarios { file, .. } => Some(file),
            Self::Random { .. } => None,
        }
    }

    /// The source of the queries, for the report.
    pub(super) fn source(&self) -> QuerySource {
        let shown = |path: &Path| Some(path.display().to_string());
        match self {
            Self::Random { seed, .. } => {
                QuerySource { seed: Some(*seed), ..QuerySource::default() }
            }
            Self::Pairs { file } => QuerySource { pairs: shown(file), ..QuerySource::default() },
            Self::Scenarios { file, .. } => {
                QuerySource { scen: shown(file), ..QuerySource::default() }
            }
        }
    }

    /// Returns the queries on a map.
    pub(super) fn on(
        &self,
        (names, index): (&MapNames, usize),
        map: &SearchMap,
    ) -> Result<Vec<Ends>, QueryError> {
        let (path, frame) = (names.path(index), map.frame());
        match self {
            Self::Random { count, seed } => random_ends(*count, *seed, path, map),
            Self::Pairs { file } => {
                let text = read_text(file, PAIRS_BYTES).map_err(QueryError::PairsFile)?;
                let in_file = |error| QueryError::Pairs { path: file.clone(), error };
                ends_of_pairs(&text, (names, index), frame).map_err(in_file)
            }
            Self::Scenarios { file, count } => {
                Ok(spread(ends_of_scenarios(file, path, frame)?, *count))
            }
        }
    }
}

/// Returns random queries whose start and goal are connected for every planner, including those
/// that do not cut corners.
fn random_ends(
    count: usize,
    seed: u64,
    path: &Path,
    map: &SearchMap,
) -> Result<Vec<Ends>, QueryError> {
    let queries = random_queries(map, Connectivity::Four, count, seed);
    if queries.is_empty() {
        let clearance_m = map.config().clearance_m;
        return Err(QueryError::Unconnected { map: path.to_owned(), clearance_m });
    }
    let ends = |query: &Query| Ends::of_cells(map.frame(), [query.start, query.goal], None);
    Ok(queries.iter().map(ends).collect())
}

fn ends_of_scenarios(path: &Path, map: &Path, frame: &GridFrame) -> Result<Vec<Ends>, QueryError> {
    let scenarios = read_scenarios_for(path, frame).map_err(QueryError::Scenarios)?;
    // Many maps have the same size, so only the name identifies queries of another map.
    let is_other = |one: &&Scenario| Path::new(&one.map).file_stem() != map.file_stem();
    if let Some(Scenario { line, map: other, .. }) = scenarios.iter().find(is_other) {
        return Err(QueryError::OtherMap {
            path: path.to_owned(),
            line: *line,
            other: other.clone(),
            map: map.to_owned(),
        });
    }
    if scenarios.is_empty() {
        return Err(QueryError::NoScenario { path: path.to_owned() });
    }
    let ends = |one: &Scenario| Ends::of_cells(frame, [one.start, one.goal], Some(one.line));
    Ok(scenarios.iter().map(ends).collect())
}

/// Returns this many of the items, evenly spread and with the first one; without a number, all
/// items.
fn spread<T>(all: Vec<T>, count: Option<usize>) -> Vec<T> {
    let total = all.len();
    let Some(count) = count.filter(|&count| count < total) else { return all };
    let is_kept = |i: usize| (i * count).div_ceil(total) != ((i + 1) * count).div_ceil(total);
    all.into_iter().enumerate().filter(|&(i, _)| is_kept(i)).map(|(_, item)| item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evenly_spread() {
        let all = |count| spread((0..10).collect(), count);
        assert_eq!(all(None), (0..10).collect::<Vec<i32>>());
        assert_eq!(all(Some(99)).len(), 10);
        assert_eq!((all(Some(2)), all(Some(1))), (vec![0, 5], vec![0]));
        for count in 1..=10 {
            assert_eq!((all(Some(count)).len(), all(Some(count))[0]), (count, 0));
        }
    }
}
