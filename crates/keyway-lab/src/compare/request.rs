//! Request for a comparison.

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
    /// Names of planners; `all` alone means all that can plan on a map. Empty: the default
    /// selection if smoothers and a file of parameters are not given either, otherwise the one of
    /// the stack.
    pub planners: Vec<String>,
    /// Names of smoothers; `all` alone means all. Empty: as for planners.
    pub smoothers: Vec<String>,
    /// Parameters of planners, smoothers and the layers of the maps.
    pub parameters: ParameterLayers,
    /// Values from which the parameters of planners and smoothers start.
    pub values: StartingValues,
    /// The robot for which paths are planned: a name, or a file relative to the current folder.
    pub robot: Option<String>,
    /// Clearance that paths keep from obstacles, in place of the robot's own radius \[m\].
    pub radius_m: Option<f64>,
    /// Queries on each map.
    pub queries: QueryChoice,
    /// Rounds in which every query is answered; the planners take turns, and the fastest time of
    /// each counts.
    pub repeat: u64,
    /// True if times are measured; they differ from run to run.
    pub has_times: bool,
    /// Names of the columns of tables; empty for the default ones.
    pub columns: Vec<String>,
    /// Returns the text for a query without a path, with advice for the reader.
    pub why: fn(&PlanError) -> String,
}

impl CompareRequest {
    /// Maximum number of queries on a map.
    pub const MOST_QUERIES: usize = 1_000_000;
    /// Maximum number of rounds.
    pub const MOST_REPEATS: u64 = 1000;

    /// Returns a request for the default comparison on maps.
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
