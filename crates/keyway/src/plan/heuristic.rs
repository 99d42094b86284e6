//! Which estimate a planner uses, as data.

use serde::{Deserialize, Serialize};

/// The estimate of the cost that is still to come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Heuristic {
    /// The cost of the shortest 8-connected path without obstacles.
    #[default]
    Octile,
    /// The straight line.
    Euclidean,
    /// Columns and rows: exact for 4 neighbours, too large for 8.
    Manhattan,
    /// The mean of the straight line and of columns and rows \[You2021, eq. (3)\]: too large for 8
    /// neighbours.
    Mean,
}

impl Heuristic {
    /// True if no step among 8 neighbours makes the estimate smaller by more than it costs: the
    /// paths of A* are then shortest ones.
    pub(crate) const fn is_consistent(self) -> bool {
        matches!(self, Self::Octile | Self::Euclidean)
    }
}

/// Evaluates an expression with `$metric` bound to the metric of a [`Heuristic`]: one copy of the
/// search for each, so that nothing is looked up inside.
macro_rules! with_metric {
    ($heuristic:expr, $metric:ident => $body:expr) => {
        match $heuristic {
            $crate::plan::Heuristic::Octile => {
                let $metric = $crate::search::Octile;
                $body
            }
            $crate::plan::Heuristic::Euclidean => {
                let $metric = $crate::search::Euclidean;
                $body
            }
            $crate::plan::Heuristic::Manhattan => {
                let $metric = $crate::search::Manhattan;
                $body
            }
            $crate::plan::Heuristic::Mean => {
                let $metric = $crate::search::Mean;
                $body
            }
        }
    };
}

pub(super) use with_metric;
