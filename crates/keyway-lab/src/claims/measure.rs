//! Measures of claims.

use super::driven::RunFigures;
use super::method::MethodResult;
use super::planned::Planned;
use serde::Serialize;

/// A measure of a method on one map. Planning is measured as everywhere in this crate
/// ([`keyway_sim::metrics::PathMetrics`]). Without a path there is no value, except for
/// [`Self::Missed`] and [`Self::Reached`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Measure {
    /// Nodes taken from the open lists.
    Expanded,
    /// Length of the path \[m\].
    Length,
    /// Relative excess of the path's length over a shortest path of straight and diagonal steps
    /// that cuts no corner.
    Excess,
    /// 1 if the path is as short as a shortest one of straight and diagonal steps that cuts no
    /// corner, otherwise 0.
    Shortest,
    /// Points of the path.
    Points,
    /// Redundant points of the path.
    RedundantPoints,
    /// Turns of the path.
    Turns,
    /// Heading jumps of the planned or driven path.
    NonSmoothTurns,
    /// Sum of the absolute heading changes \[deg\].
    TurningAngle,
    /// Smallest distance from the path to an obstacle \[m\].
    Clearance,
    /// Cells of the planned path that were visited before.
    Revisited,
    /// Smallest distance from the path to static obstacles that are not on the map \[m\].
    UnknownClearance,
    /// 1 if a path exists that the planner does not find, otherwise 0.
    Missed,
    /// Length of the planned or driven path \[m\], for papers that compare a run with a path.
    WayLength,
    /// Smallest distance of the path or the robot to any obstacle \[m\].
    WayClearance,
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
    /// Total variation of the speed per metre \[1/s\].
    SpeedVariation,
    /// Sign changes of the turn rate per metre \[1/m\].
    Oscillation,
    /// Smallest distance of the robot to any obstacle in a run \[m\].
    RunClearance,
    /// Time per control cycle \[s\].
    CycleTime,
    /// Planning, and all control cycles of a run \[s\].
    TotalSearchTime,
    /// 1 if the robot reached its goal, otherwise 0.
    Reached,
    /// 1 if the robot touched an obstacle, otherwise 0.
    Touched,
}

/// Scale on which two methods are compared on one map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// (new - old) / old.
    Relative,
    /// new - old: for values that are usually 0 for one of the two.
    Absolute,
}

impl Measure {
    /// Relative difference up to which lengths are equal.
    pub(super) const ROUNDING: f64 = 1e-9;

    /// Returns the scale on which values are compared.
    pub const fn scale(self) -> Scale {
        match self {
            Self::Clearance
            | Self::UnknownClearance
            | Self::RunClearance
            | Self::WayClearance
            | Self::Excess
            | Self::Shortest
            | Self::Revisited
            | Self::Missed
            | Self::Reached
            | Self::Touched => Scale::Absolute,
            _ => Scale::Relative,
        }
    }

    /// Returns the unit of the values; empty for a number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Length
            | Self::Clearance
            | Self::UnknownClearance
            | Self::DrivenLength
            | Self::RunClearance
            | Self::WayLength
            | Self::WayClearance => "m",
            Self::TurningAngle => "deg",
            Self::SearchTime
            | Self::PlanningTime
            | Self::TimeFromMap
            | Self::RunTime
            | Self::CycleTime
            | Self::TotalSearchTime => "s",
            Self::MeanSpeed | Self::SpeedDeviation => "m/s",
            Self::SpeedVariation => "1/s",
            Self::Oscillation => "1/m",
            _ => "",
        }
    }

    /// True if it is measured by a clock, and so differs from run to run.
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

    /// Returns its value on one map; `None` without a path, an obstacle or a clock, or, except for
    /// [`Self::Reached`], if the goal was not reached.
    pub(super) fn of(self, outcome: Option<&MethodResult>) -> Option<f64> {
        let share = |is: bool| Some(if is { 1.0 } else { 0.0 });
        match (self, outcome) {
            (Self::Missed, outcome) => share(outcome.is_none()),
            (Self::Reached, outcome) => share(outcome.is_some_and(MethodResult::succeeded)),
            (Self::Touched, outcome) => {
                share(outcome.and_then(MethodResult::driven).is_some_and(RunFigures::touched))
            }
            (_, Some(MethodResult::Planned(planned))) => self.of_plan(planned),
            (_, Some(MethodResult::Driven(driven))) if driven.reached() => self.of_run(driven),
            (_, None | Some(MethodResult::Driven(_))) => None,
        }
    }

    fn of_plan(self, planned: &Planned) -> Option<f64> {
        let path = &planned.path;
        Some(match self {
            Self::Expanded => planned.expanded as f64,
            Self::Length | Self::WayLength => path.length_m,
            Self::Excess => planned.excess?,
            Self::Shortest => f64::from(planned.excess? <= Self::ROUNDING),
            Self::Points => path.points as f64,
            Self::RedundantPoints => path.redundant_points as f64,
            Self::Turns => path.turns as f64,
            Self::NonSmoothTurns => path.non_smooth_turns as f64,
            Self::TurningAngle => path.turning_angle_deg,
            Self::Clearance => path.min_clearance_m?,
            Self::WayClearance => {
                let both = [path.min_clearance_m, planned.unknown_clearance_m];
                both.into_iter().flatten().reduce(f64::min)?
            }
            Self::Revisited => planned.revisited as f64,
            Self::UnknownClearance => planned.unknown_clearance_m?,
            Self::SearchTime => planned.times?.search_s,
            Self::PlanningTime | Self::TotalSearchTime => planned.times?.planning_s(),
            Self::TimeFromMap => planned.times?.from_map_s(),
            _ => return None,
        })
    }

    fn of_run(self, driven: &RunFigures) -> Option<f64> {
        match self {
            Self::RunTime => Some(driven.time_s),
            Self::DrivenLength | Self::WayLength => Some(driven.length_m),
            Self::MeanSpeed => driven.mean_speed_mps,
            Self::SpeedDeviation => driven.speed_deviation_mps,
            Self::SpeedVariation => driven.speed_variation_per_s,
            Self::Oscillation => driven.oscillation_per_m,
            Self::RunClearance | Self::WayClearance => driven.min_clearance_m,
            Self::NonSmoothTurns => Some(driven.non_smooth_turns as f64),
            Self::CycleTime => driven.cycle_s,
            Self::TotalSearchTime => driven.total_search_s,
            _ => None,
        }
    }
}
