//! Comparison of planners and smoothers on the same queries, and with the shortest lines.
//!
//! A [`CompareRequest`] describes the comparison. A checked request is a [`Comparison`], which
//! returns a [`Compared`] for each map, and a [`CompareReport`] for all of them.

mod against_first;
mod checked;
mod choice;
mod columns;
mod contest;
mod ends;
mod figures;
mod files;
mod left_out;
mod lowered;
mod map_names;
mod pairs;
mod pooled;
mod queries;
mod report;
mod request;
mod request_error;
mod row;
mod unsolved;

pub use against_first::{AgainstFirst, against_first_latex, against_first_note};
pub use columns::{ChosenColumns, ColumnError};
pub use contest::{Answer, Contest, ContestEntry, Found, Oracle};
pub use ends::Ends;
pub use files::CompareFiles;
pub use left_out::{LeftOut, left_out_note};
pub use lowered::lowered_note;
pub use map_names::{AmbiguousMap, SameMap};
pub use pairs::{PairsError, PairsFault};
pub use queries::{QueryChoice, QueryError};
pub use report::{CompareReport, QueryRow, QuerySource, SCHEMA, query_rows};
pub use request::CompareRequest;
pub use request_error::{CompareRequestError, NamesError};
pub use row::CompareRow;
pub use unsolved::{Unsolved, unsolved_note};

use crate::progress::Progress;
use choice::Choice;
use contest::compete;
use keyway::ConfigError;
use keyway::files::RobotLayersError;
use keyway::map::{Cell, OccupancyGrid, SearchMap};
use keyway::plan::PlanError;
use keyway_sim::report::PlacementInput;
use map_names::MapNames;
use row::{compared, most_different, row};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A requested and checked comparison.
#[derive(Debug)]
pub struct Comparison {
    names: MapNames,
    choice: Choice,
    queries: QueryChoice,
    repeat: u64,
    has_times: bool,
    columns: ChosenColumns,
    why: fn(&PlanError) -> String,
}

/// A map with its queries.
pub struct Queried {
    name: String,
    grid: OccupancyGrid,
    map: SearchMap,
    queries: Vec<Ends>,
}

/// A map with all its results.
pub struct Compared {
    /// Unique name of the map.
    pub name: String,
    /// The map.
    pub grid: OccupancyGrid,
    /// Its layers.
    pub map: SearchMap,
    /// The queries.
    pub queries: Vec<Ends>,
    /// The answers.
    pub contest: Contest,
    /// For each query, true if its answers count: every planner that solved any query has solved
    /// it.
    pub counts: Vec<bool>,
}

/// Reason why nothing can be compared on a map.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum QueriedError {
    /// The map has no layers for the robot.
    #[error("{}: {error}", map.display())]
    Layers {
        /// The map.
        map: PathBuf,
        /// Error of the radius or of the config.
        error: RobotLayersError,
    },
    /// The map has no queries.
    #[error(transparent)]
    Queries(#[from] QueryError),
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
        /// Error of the planner; the field of a config error is that of a stack.
        error: PlanError,
    },
    /// A smoother cannot be used; the field is that of a stack.
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
    /// Combines a map with its layers and its queries. If the layers ask for it, the constraints
    /// that keep paths away from obstacles are lifted around the starts and goals of all queries.
    fn new(name: String, grid: OccupancyGrid, mut map: SearchMap, queries: Vec<Ends>) -> Self {
        let ends: Vec<Cell> = queries.iter().flat_map(|q| [q.start_cell, q.goal_cell]).collect();
        map.free_ends(&ends);
        Self { name, grid, map, queries }
    }
}

impl Comparison {
    /// Unique names of the maps: the shortest ends of their paths that differ.
    pub fn map_names(&self) -> Vec<String> {
        self.names.all()
    }

    /// The columns of tables.
    pub const fn columns(&self) -> &ChosenColumns {
        &self.columns
    }

    /// The file of the queries; `None` for random ones.
    pub fn query_file(&self) -> Option<&Path> {
        self.queries.file()
    }

    /// Returns the map of this index in the request with its layers and its queries.
    ///
    /// # Errors
    /// Returns [`QueriedError`] if the map has no clearance for the robot, or there are no
    /// queries on it.
    ///
    /// # Panics
    /// If the request has no map of this index.
    pub fn queried(&self, index: usize, grid: OccupancyGrid) -> Result<Queried, QueriedError> {
        let map = self.choice.size.layers(&grid, self.choice.map.clone());
        let map = map.map_err(|error| QueriedError::Layers {
            map: self.names.path(index).to_owned(),
            error,
        })?;
        let queries = self.queries.on((&self.names, index), &map)?;
        Ok(Queried::new(self.names.name(index).to_owned(), grid, map, queries))
    }

    /// Answers all queries on a map.
    ///
    /// # Errors
    /// Returns [`CompareError`] if a planner or a smoother cannot be used, or the observer stops
    /// the comparison. Queries without a path are results.
    pub fn on(&self, map: Queried, progress: &dyn Progress) -> Result<Compared, CompareError> {
        let Queried { name, grid, map, queries } = map;
        let contest = compete(&map, self, &queries, progress)?;
        let counts = compared(&contest.entries);
        Ok(Compared { name, grid, map, queries, contest, counts })
    }

    /// Returns the report of the results on all maps; `placement` is the placement of maps that
    /// do not define it themselves.
    pub fn report(&self, maps: &[Compared], placement: Option<PlacementInput>) -> CompareReport {
        CompareReport::new(self, maps, placement)
    }
}

impl Compared {
    /// The rows of the table.
    pub fn rows(&self) -> impl Iterator<Item = CompareRow> + '_ {
        self.contest.entries.iter().map(|entry| row(&self.name, &[(entry, &self.counts)]))
    }

    /// Returns the query whose paths differ most in length; `None` if none counts.
    pub fn picture_query(&self) -> Option<usize> {
        most_different(&self.contest.entries, &self.counts)
    }
}
