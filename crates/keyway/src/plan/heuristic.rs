//! The choice of heuristic, as data.

use serde::{Deserialize, Serialize};

/// The estimate of the remaining cost to the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Heuristic {
    /// The cost of the shortest 8-connected path without obstacles.
    #[default]
    Octile,
    /// The straight-line distance.
    Euclidean,
    /// The sum of column and row distances: exact for 4 neighbours, inadmissible for 8.
    Manhattan,
    /// The mean of the Euclidean and the Manhattan distance \[You2021, eq. (3)\]: inadmissible for
    /// 8 neighbours.
    Mean,
}

impl Heuristic {
    /// True if the estimate is consistent for 8 neighbours: no step reduces it by more than the
    /// step costs. Paths of A* are then shortest ones.
    pub(crate) const fn is_consistent(self) -> bool {
        matches!(self, Self::Octile | Self::Euclidean)
    }
}

/// Evaluates an expression with `$metric` bound to the metric of a [`Heuristic`]. Each metric gets
/// its own copy of the search, so that the inner loop does no dispatch.
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
