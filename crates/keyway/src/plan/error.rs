//! Errors of planners.

use super::prepared::PrepareError;
use crate::ConfigError;
use crate::map::{BlockedBy, Cell};
use crate::search::SearchStatistics;
use thiserror::Error;

/// The reason for a failed plan.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The start or goal is not on the map.
    #[error("{end} {cell} is outside the map of {width} x {height} cells")]
    OutsideMap {
        /// The start or the goal.
        end: PathEnd,
        /// The requested cell.
        cell: Cell,
        /// Columns of the map.
        width: u32,
        /// Rows of the map.
        height: u32,
    },
    /// The start or goal is blocked: by an obstacle, or because its clearance is below the one
    /// that the map's config requires.
    #[error("{end} {cell} {by}{}", nearest_text(.nearest.as_ref()))]
    Blocked {
        /// The start or the goal.
        end: PathEnd,
        /// The requested cell.
        cell: Cell,
        /// The cause of the blockage.
        by: BlockedBy,
        /// The nearest free cell; `None` if all cells are blocked.
        nearest: Option<Cell>,
    },
    /// Start and goal are in different connected components. This is found without a search, so
    /// the statistics are zero, unless every reachable cell was searched.
    #[error("no path exists from the start to the goal")]
    NoPath {
        /// The counters of the search.
        statistics: SearchStatistics,
    },
    /// A path exists, but the planner did not find it.
    #[error("{planner} missed an existing path: {miss}")]
    Missed {
        /// The planner.
        planner: &'static str,
        /// The part of the planner that caused the miss.
        miss: Miss,
        /// The counters of the search.
        statistics: SearchStatistics,
    },
    /// The start or goal is nearer to an obstacle than the planner's constraint allows.
    #[error(
        "{end} {cell} is {distance} from the nearest obstacle, but {planner} requires {constraint} \
         (L1 norm, in its reference cells); choose another {end}"
    )]
    Constrained {
        /// The planner.
        planner: &'static str,
        /// The start or the goal.
        end: PathEnd,
        /// The requested cell.
        cell: Cell,
        /// Its L1 distance to the nearest obstacle, in reference cells.
        distance: f64,
        /// The smallest distance allowed, in reference cells.
        constraint: f64,
    },
    /// A parameter of the planner is out of range.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The planner does not support penalised cells.
    #[error(
        "{planner} needs one cost for all cells; treat unknown cells as blocked or free, or use astar"
    )]
    NeedsUniformCost {
        /// The planner.
        planner: &'static str,
    },
    /// The map cannot be prepared.
    #[error(transparent)]
    Preparation(PrepareError),
    /// The planner was prepared for another map.
    #[error(
        "the preparation was made for another map, or before this map was edited; prepare this map again"
    )]
    OtherMap,
    /// The budget was used up before a path was found.
    #[error("no path was found within the budget of {budget} expanded nodes")]
    BudgetExhausted {
        /// The budget.
        budget: u64,
        /// The counters of the search.
        statistics: SearchStatistics,
    },
}

/// Advice on an error: a parameter of the planner that failed, and the value to set.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Advice {
    /// Purpose of the change: "to lower the constraint as far as needed".
    pub purpose: &'static str,
    /// Name of the planner.
    pub planner: &'static str,
    /// The parameter, such as `if_no_path`.
    pub parameter: &'static str,
    /// The value to set, such as `relax`.
    pub value: String,
}

impl PlanError {
    /// Advice, if a parameter of the planner can help.
    pub fn advice(&self) -> Option<Advice> {
        let relax = |planner| Advice {
            purpose: "to lower the constraint as far as needed",
            planner,
            parameter: "if_no_path",
            value: "relax".to_owned(),
        };
        match *self {
            Self::Constrained { planner, .. } => Some(relax(planner)),
            Self::Missed { planner, ref miss, .. } => Some(match miss {
                Miss::Constraint { .. } => relax(planner),
                Miss::SidesPassed => Advice {
                    purpose: "to let the two searches meet at any node that both have reached",
                    planner,
                    parameter: "meeting",
                    value: "generated".to_owned(),
                },
                Miss::SamplesUsedUp { samples } => Advice {
                    purpose: "to draw more samples",
                    planner,
                    parameter: "samples",
                    value: samples.saturating_mul(10).to_string(),
                },
            }),
            _ => None,
        }
    }
}

/// Start or goal of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The start of the path.
    Start,
    /// The end of the path.
    Goal,
}

impl std::fmt::Display for PathEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

fn nearest_text(nearest: Option<&Cell>) -> String {
    nearest.map_or_else(
        || "; no cell of this map is free".to_owned(),
        |cell| format!("; the nearest free cell is {cell}"),
    )
}

/// The reason why a planner missed an existing path: a property of the method, not of the map.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Miss {
    /// The two sides of a bidirectional search have no node in common.
    #[error("the forward and backward searches passed each other without meeting")]
    SidesPassed,
    /// All paths come nearer to an obstacle than the planner's constraint allows.
    #[error("no path keeps its constraint of {constraint} (L1 norm, in reference cells)")]
    Constraint {
        /// The smallest distance allowed, in reference cells.
        constraint: f64,
    },
    /// All random samples were used up.
    #[error("the limit of {samples} random samples was reached")]
    SamplesUsedUp {
        /// The number of samples.
        samples: u64,
    },
}
