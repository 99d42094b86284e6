//! Comparison of planners and smoothers on the same queries, and with the shortest lines.
//!
//! A [`CompareRequest`] describes the comparison. It gives a [`Compared`] for each map, and a
//! [`CompareReport`] for all of them.

mod against_first;
mod columns;
mod contest;
mod ends;
mod left_out;
mod lowered;
mod report;
mod row;
mod unsolved;

pub use against_first::{AgainstFirst, against_first_note};
pub use columns::{ChosenColumns, ColumnError};
pub use contest::{Answer, Contest, Entry, Found, Oracle};
pub use ends::Ends;
pub use left_out::{LeftOut, left_out_note};
pub use lowered::lowered_note;
pub use report::{CompareReport, QueryRow, QuerySource, SCHEMA, query_rows};
pub use row::CompareRow;
pub use unsolved::{Unsolved, unsolved_note};

use crate::progress::Progress;
use contest::compete;
use keyway::ConfigError;
use keyway::map::formats::LoadedMap;
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::plan::{PlanError, PlannerConfig};
use keyway::smooth::SmootherConfig;
use row::{compared, most_different, row};
use thiserror::Error;

/// Planners and smoothers to compare, each planner with every smoother.
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// Layers of the maps.
    pub map: LayerConfig,
    /// The planners.
    pub planners: Vec<PlannerConfig>,
    /// True if planners that cannot plan on a map are left out there; otherwise they are an error.
    pub leaves_out_unfit: bool,
    /// The smoothers.
    pub smoothers: Vec<SmootherConfig>,
    /// Rounds in which every query is answered, the planners in turns; the fastest time of each
    /// counts.
    pub repeat: u64,
    /// True if times are measured; they differ from run to run.
    pub has_times: bool,
    /// Text for a query without a path, with advice for the reader.
    pub why: fn(&PlanError) -> String,
}

/// A map with its queries.
pub struct Queried {
    name: String,
    loaded: LoadedMap,
    map: SearchMap,
    queries: Vec<Ends>,
}

/// A map with all its results.
pub struct Compared {
    /// Unique name of the map.
    pub name: String,
    /// The map as read.
    pub loaded: LoadedMap,
    /// Its layers.
    pub map: SearchMap,
    /// The queries.
    pub queries: Vec<Ends>,
    /// The answers.
    pub contest: Contest,
    /// For each query, whether its answers count: all planners that solved any query have solved
    /// it.
    pub counts: Vec<bool>,
}

/// Reason why planners and smoothers cannot be compared.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A planner cannot be used on a map.
    #[error("{name}: {error}")]
    Planner {
        /// Name of the planner.
        name: &'static str,
        /// Error of the planner.
        error: PlanError,
    },
    /// A smoother cannot be used.
    #[error(transparent)]
    Smoother(ConfigError),
    /// A query is not valid.
    #[error(transparent)]
    Query(PlanError),
    /// The observer stopped the comparison.
    #[error("stopped before the end")]
    Stopped,
}

impl Queried {
    /// Combines a map of a unique name with its layers and its queries. Where the layers ask for
    /// it, the constraints that keep paths away from obstacles are lifted around the ends of all
    /// queries alike.
    pub fn new(name: String, loaded: LoadedMap, mut map: SearchMap, queries: Vec<Ends>) -> Self {
        let ends: Vec<Cell> = queries.iter().flat_map(|q| [q.start_cell, q.goal_cell]).collect();
        map.free_ends(&ends);
        Self { name, loaded, map, queries }
    }
}

impl CompareRequest {
    /// Answers all queries on a map.
    ///
    /// # Errors
    /// When a planner or a smoother cannot be used, or the observer stops the comparison. Queries
    /// without a path are results.
    pub fn on(&self, map: Queried, progress: &dyn Progress) -> Result<Compared, CompareError> {
        let Queried { name, loaded, map, queries } = map;
        let contest = compete(&map, self, &queries, progress)?;
        let contest = if self.has_times { contest } else { contest.without_times() };
        let counts = compared(&contest.entries);
        Ok(Compared { name, loaded, map, queries, contest, counts })
    }
}

impl Compared {
    /// The rows of the table.
    pub fn rows(&self) -> impl Iterator<Item = CompareRow> + '_ {
        self.contest.entries.iter().map(|entry| row(&self.name, entry, &self.counts))
    }

    /// Returns the query whose paths differ most in length; `None` where none counts.
    pub fn picture_query(&self) -> Option<usize> {
        most_different(&self.contest.entries, &self.counts)
    }
}
