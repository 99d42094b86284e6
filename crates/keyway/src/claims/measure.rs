//! What a claim is about.

use super::method::Outcome;
use serde::Serialize;

/// Something that is measured of a method on one map. Planning is measured as everywhere in this crate
/// ([`crate::metrics::PathMetrics`]); no path, no measure, but for [`Self::Missed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Measure {
    /// Nodes taken from the open lists.
    Expanded,
    /// Length of the path \[m\].
    Length,
    /// Share by which the path is longer than a shortest one of straight and diagonal steps that cuts no corner.
    Excess,
    /// Points of the path.
    Points,
    /// Points of the path that change nothing.
    RedundantPoints,
    /// Turns of the path.
    Turns,
    /// Heading jumps of the path.
    NonSmoothTurns,
    /// Sum of the absolute heading changes \[deg\].
    TurningAngle,
    /// Smallest distance from the path to an obstacle \[m\].
    Clearance,
    /// Cells of the planned path that it has been in before.
    Revisited,
    /// 1 where there is a path that the planner does not find, otherwise 0.
    Missed,
    /// The search alone \[s\].
    SearchTime,
    /// Search and smoothing \[s\].
    PlanningTime,
    /// The layers of the map, search and smoothing \[s\].
    TimeFromMap,
    /// Simulated time of a run \[s\].
    RunTime,
    /// Distance driven \[m\].
    DrivenLength,
    /// Distance driven over time \[m/s\].
    MeanSpeed,
    /// Standard deviation of the speed \[m/s\].
    SpeedDeviation,
    /// Sign changes of the turn rate per metre \[1/m\].
    Oscillation,
    /// Smallest distance of the robot to any obstacle in a run \[m\].
    RunClearance,
    /// Time per control cycle \[s\].
    CycleTime,
    /// Planning and all control cycles of a run \[s\].
    TotalSearchTime,
    /// 1 where the robot reached its goal, otherwise 0.
    Reached,
}

/// How two methods are compared on one map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// (new - old) / old.
    Relative,
    /// new - old: for what is usually 0 with one of the two.
    Absolute,
}

impl Measure {
    /// How values are compared.
    pub const fn scale(self) -> Scale {
        match self {
            Self::Clearance
            | Self::RunClearance
            | Self::Excess
            | Self::Revisited
            | Self::Missed
            | Self::Reached => Scale::Absolute,
            _ => Scale::Relative,
        }
    }

    /// The unit of its values; empty for a number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Length | Self::Clearance | Self::DrivenLength | Self::RunClearance => "m",
            Self::TurningAngle => "deg",
            Self::SearchTime
            | Self::PlanningTime
            | Self::TimeFromMap
            | Self::RunTime
            | Self::CycleTime
            | Self::TotalSearchTime => "s",
            Self::MeanSpeed | Self::SpeedDeviation => "m/s",
            Self::Oscillation => "1/m",
            _ => "",
        }
    }

    /// Whether it is measured by a clock, and so another one each time.
    pub const fn is_timed(self) -> bool {
        matches!(
            self,
            Self::SearchTime
                | Self::PlanningTime
                | Self::TimeFromMap
                | Self::CycleTime
                | Self::TotalSearchTime
        )
    }

    /// Its value on one map; `None` where there is none: no path, no obstacle, no clock, or a measure of driving.
    pub(super) fn of(self, outcome: Option<&Outcome>) -> Option<f64> {
        if self == Self::Missed {
            return Some(if outcome.is_some() { 0.0 } else { 1.0 });
        }
        let outcome = outcome?;
        let path = &outcome.path;
        Some(match self {
            Self::Expanded => outcome.expanded as f64,
            Self::Length => path.length_m,
            Self::Excess => outcome.excess?,
            Self::Points => path.points as f64,
            Self::RedundantPoints => path.redundant_points as f64,
            Self::Turns => path.turns as f64,
            Self::NonSmoothTurns => path.non_smooth_turns as f64,
            Self::TurningAngle => path.turning_angle_deg,
            Self::Clearance => path.min_clearance_m?,
            Self::Revisited => outcome.revisited as f64,
            Self::SearchTime => outcome.times?.search_s,
            Self::PlanningTime => outcome.times?.planning_s(),
            Self::TimeFromMap => outcome.times?.from_map_s(),
            _ => return None,
        })
    }
}
