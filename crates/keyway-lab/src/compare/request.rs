//! Comparison that is to be made.

use super::queries::QueryChoice;
use keyway::files::{ParameterLayers, StartingValues};
use keyway::plan::PlanError;
use std::path::PathBuf;

/// Planners and smoothers to compare on maps, each planner with every smoother.
///
/// ```
/// use keyway_lab::compare::CompareRequest;
///
/// let request = CompareRequest {
///     planners: vec!["jps".to_owned(), "jsp".to_owned()],
///     ..CompareRequest::new(vec!["office.yaml".into()])
/// };
/// let error = request.check().unwrap_err();
/// assert_eq!(error.field(), "planners");
/// assert!(error.to_string().starts_with("planners: `planner.name` must be one of "), "{error}");
/// ```
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// Files of the maps; any name for a map in memory.
    pub maps: Vec<PathBuf>,
    /// Names of planners; `all` alone stands for all that can plan on a map. Empty: some usual ones
    /// if smoothers and a file of parameters are not given either, otherwise the one of the stack.
    pub planners: Vec<String>,
    /// Names of smoothers; `all` alone stands for all. Empty: as for planners.
    pub smoothers: Vec<String>,
    /// Parameters of planners, smoothers and the layers of the maps.
    pub parameters: ParameterLayers,
    /// Values with which planners and smoothers begin.
    pub values: StartingValues,
    /// The robot that paths are for: a name, or a file relative to the current folder.
    pub robot: Option<String>,
    /// Radius that paths keep from obstacles instead of the robot's own \[m\].
    pub radius_m: Option<f64>,
    /// Queries on each map.
    pub queries: QueryChoice,
    /// Rounds in which every query is answered, the planners in turns; the fastest time of each
    /// counts.
    pub repeat: u64,
    /// True if times are measured; they differ from run to run.
    pub has_times: bool,
    /// Names of the columns of tables; empty for the usual ones.
    pub columns: Vec<String>,
    /// Text for a query without a path, with advice for the reader.
    pub why: fn(&PlanError) -> String,
}

impl CompareRequest {
    /// Largest number of queries that may be asked for on a map.
    pub const MOST_QUERIES: usize = 1_000_000;
    /// Largest number of rounds.
    pub const MOST_REPEATS: u64 = 1000;

    /// Returns a request for the usual comparison on maps.
    pub fn new(maps: Vec<PathBuf>) -> Self {
        Self {
            maps,
            planners: Vec::new(),
            smoothers: Vec::new(),
            parameters: ParameterLayers::default(),
            values: StartingValues::default(),
            robot: None,
            radius_m: None,
            queries: QueryChoice::default(),
            repeat: 1,
            has_times: true,
            columns: Vec::new(),
            why: ToString::to_string,
        }
    }
}
