//! Why there is no plan.

use super::prepared::PrepareError;
use crate::ConfigError;
use crate::map::{BlockedBy, Cell};
use crate::search::SearchStatistics;
use thiserror::Error;

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The start or goal is not on the map.
    #[error("{end} {cell} is outside the map of {width} x {height} cells")]
    OutsideMap {
        /// Which of the two.
        end: PathEnd,
        /// The cell asked for.
        cell: Cell,
        /// Columns of the map.
        width: u32,
        /// Rows of the map.
        height: u32,
    },
    /// The start or goal is blocked: by an obstacle, or because the map's config asks for more room
    /// around obstacles than there is.
    #[error("{end} {cell} {by}{}", nearest_text(.nearest.as_ref()))]
    Blocked {
        /// Which of the two.
        end: PathEnd,
        /// The cell asked for.
        cell: Cell,
        /// The reason why it is blocked.
        by: BlockedBy,
        /// The nearest free cell, unless all are blocked.
        nearest: Option<Cell>,
    },
    /// Start and goal are in different connected components. Found without a search: the statistics
    /// are zero, unless every cell that can be reached was searched.
    #[error("there is no path from the start to the goal")]
    NoPath {
        /// The work of the search.
        statistics: SearchStatistics,
    },
    /// There is a path, and the planner did not find it.
    #[error("{planner} found no path, although there is one: {miss}")]
    Missed {
        /// The planner.
        planner: &'static str,
        /// The part of the planner that is to blame.
        miss: Miss,
        /// The work of the search.
        statistics: SearchStatistics,
    },
    /// The start or goal is nearer to an obstacle than the planner's constraint allows.
    #[error(
        "{end} {cell} is {distance} from an obstacle, nearer than the constraint of {constraint} that \
         {planner} keeps (L1 norm, in its reference cells); choose another {end}"
    )]
    Constrained {
        /// The planner.
        planner: &'static str,
        /// Which of the two.
        end: PathEnd,
        /// The cell asked for.
        cell: Cell,
        /// Its L1 distance to the nearest obstacle, in reference cells.
        distance: f64,
        /// The least one allowed.
        constraint: f64,
    },
    /// A parameter of the planner cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The planner cannot weigh penalised cells.
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
        "the preparation belongs to another map, or to this one before an edit; prepare this map again"
    )]
    OtherMap,
    /// The budget was used up before a path was found.
    #[error("no path was found within the budget of {budget} expanded nodes")]
    BudgetExhausted {
        /// The budget.
        budget: u64,
        /// The work of the search.
        statistics: SearchStatistics,
    },
}

/// Advice against an error: a parameter of the planner that failed, and its value.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Advice {
    /// Its purpose: "to lower the constraint as far as needed".
    pub purpose: &'static str,
    /// Name of the planner.
    pub planner: &'static str,
    /// The parameter, such as `if_no_path`.
    pub parameter: &'static str,
    /// Its value, such as `relax`.
    pub value: String,
}

impl PlanError {
    /// Advice, where a parameter of the planner helps.
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
                    purpose: "to let the two searches meet wherever both have been",
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

/// One end of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The beginning.
    Start,
    /// The end.
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
        |cell| format!("; nearest free cell is {cell}"),
    )
}

/// Why a planner misses a path that exists: a property of the method, not of the map.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Miss {
    /// The two sides of a bidirectional search have no node in common.
    #[error("its two searches passed each other")]
    SidesPassed,
    /// All paths come nearer to an obstacle than the planner's constraint allows.
    #[error("no path keeps its constraint of {constraint} (L1 norm, in reference cells)")]
    Constraint {
        /// The least distance allowed, in reference cells.
        constraint: f64,
    },
    /// All random samples were used up.
    #[error("its {samples} random samples were used up")]
    SamplesUsedUp {
        /// Their number.
        samples: u64,
    },
}
