//! Report of a planned path.

use crate::metrics::PathMetrics;
use keyway::geometry::{PlannedLine, Polyline};
use keyway::map::{Cell, SearchMap, Separation};
use keyway::plan::{Plan, PlanError, PlanNote, Relaxed, Stop};
use keyway::search::{SearchStatistics, SideStatistics};
use keyway::smooth::{Smoother, Unsmoothed};
use serde::{Deserialize, Serialize};

/// Outcome of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PlanOutcome {
    /// A path was found.
    Found,
    /// No path exists.
    NoPath,
    /// The budget of expanded nodes is exhausted.
    BudgetExhausted,
    /// A path exists, but the planner did not find it.
    Missed,
    /// The goal is in an obstacle: only for one of several goals; otherwise it is an error.
    Blocked,
    /// The goal is outside the map: only for one of several goals; otherwise it is an error.
    OutsideMap,
    /// The planner does not support the map; this is an error.
    Refused,
}

impl PlanOutcome {
    /// Returns the outcome of an error, with the statistics of the search, which are empty
    /// without a search.
    pub fn of(error: &PlanError) -> (Self, SearchStatistics) {
        let none = SearchStatistics::default();
        match error {
            PlanError::NoPath { statistics } => (Self::NoPath, *statistics),
            PlanError::BudgetExhausted { statistics, .. } => (Self::BudgetExhausted, *statistics),
            PlanError::Missed { statistics, .. } => (Self::Missed, *statistics),
            PlanError::Blocked { .. } => (Self::Blocked, none),
            PlanError::OutsideMap { .. } => (Self::OutsideMap, none),
            _ => (Self::Refused, none),
        }
    }

    /// Text for human readers.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::NoPath => "no path",
            Self::BudgetExhausted => "budget exhausted",
            Self::Missed => "missed by the planner",
            Self::Blocked => "blocked",
            Self::OutsideMap => "outside the map",
            Self::Refused => "refused",
        }
    }
}

/// A planned path, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPart {
    /// Outcome of the search.
    pub outcome: PlanOutcome,
    /// Name of the planner.
    pub planner: &'static str,
    /// Length of the line [`Self::waypoints_m`] \[m\].
    pub length_m: Option<f64>,
    /// Cost of the grid path, penalties included \[cells\].
    pub cost_cells: Option<f64>,
    /// Nodes taken from the open list.
    pub expanded: u64,
    /// Nodes added to the open list, or improved there.
    pub generated: u64,
    /// Statistics of the search, separately for its two sides.
    pub search: SearchStatistics,
    /// Reason why the search stopped.
    pub stopped: Option<Stop>,
    /// Cell where the two sides met.
    pub meeting: Option<Cell>,
    /// Reason why there is no path, for human readers.
    pub why: Option<String>,
    /// The largest clearance with which a path exists \[m\].
    pub largest_clearance_m: Option<f64>,
    /// First and last cell of the narrow passage that limits this clearance, if any; their
    /// centres have the clearance.
    pub narrowest_cells: Option<[Cell; 2]>,
    /// The planner's constraint, if it was relaxed to leave a path.
    pub relaxed: Option<Relaxed>,
    /// Cost of the cheapest path of straight and diagonal steps \[cells\].
    pub optimum_cells: Option<f64>,
    /// Relative excess cost of the path; negative if it uses other directions.
    pub excess: Option<f64>,
    /// Wall-clock time of the query on prepared layers \[s\].
    pub time_s: Option<f64>,
    /// Interior waypoints at which the heading changes.
    pub turns: Option<usize>,
    /// Sum of the absolute heading changes \[deg\].
    pub turning_angle_deg: Option<f64>,
    /// Smallest distance from the line to an obstacle's square \[m\].
    pub min_clearance_m: Option<f64>,
    /// Certified clearance of the line if it is less than the requested clearance \[m\].
    pub kept_clearance_m: Option<f64>,
    /// The line: begins and ends at the given positions, collinear points merged \[m\].
    pub waypoints_m: Option<Polyline>,
    /// Every cell of the grid path.
    pub cells: Option<Vec<Cell>>,
}

impl PlanPart {
    /// Describes a found path; `line` begins and ends at the given positions.
    pub fn found(
        planner: &'static str,
        plan: &Plan,
        line: &PlannedLine,
        map: &SearchMap,
        time_s: Option<f64>,
    ) -> Self {
        let metrics = PathMetrics::of_polyline(line.polyline(), map.clearance());
        // A cell's centre may have the clearance while another position in the cell does not.
        let clearance_m = map.config().clearance_m;
        let kept_clearance_m =
            Unsmoothed.smooth(line, &map.clearance(), clearance_m).kept_clearance_m;
        Self {
            length_m: Some(metrics.length_m),
            cost_cells: Some(plan.cost.cells()),
            expanded: plan.statistics.expanded(),
            generated: plan.statistics.generated(),
            search: plan.statistics,
            stopped: plan.stop,
            meeting: plan.meeting,
            relaxed: Self::lowered(plan),
            turns: Some(metrics.turns),
            turning_angle_deg: Some(metrics.turning_angle_deg),
            min_clearance_m: metrics.min_clearance_m,
            kept_clearance_m,
            waypoints_m: Some(line.polyline().merged()),
            cells: Some(plan.cells.clone()),
            ..Self::without_path(planner, PlanOutcome::Found, time_s)
        }
    }

    /// Constraint that the planner relaxed, according to its note.
    fn lowered(plan: &Plan) -> Option<Relaxed> {
        match plan.note? {
            PlanNote::Relaxed(relaxed) => Some(relaxed),
            _ => None,
        }
    }

    /// Adds the cost of the cheapest path of straight and diagonal steps.
    pub(super) fn beside_optimum(self, optimum_cells: f64) -> Self {
        // Paths of length 0 have no excess. Step costs are exact, so rounding does not show.
        let excess =
            |cost: f64| if cost == optimum_cells { 0.0 } else { cost / optimum_cells - 1.0 };
        let excess = self.cost_cells.map(excess);
        Self { optimum_cells: Some(optimum_cells), excess, ..self }
    }

    /// Describes a search without a path; `None` if the error is not a failed search.
    pub fn failed(planner: &'static str, error: &PlanError, time_s: Option<f64>) -> Option<Self> {
        let (outcome, statistics) = PlanOutcome::of(error);
        let has_searched = [PlanOutcome::NoPath, PlanOutcome::BudgetExhausted, PlanOutcome::Missed];
        has_searched.contains(&outcome).then(|| Self {
            expanded: statistics.expanded(),
            generated: statistics.generated(),
            search: statistics,
            why: Some(error.to_string()),
            ..Self::without_path(planner, outcome, time_s)
        })
    }

    /// Adds the separation of a start and a goal that no path connects.
    pub(crate) fn separated_by(self, separation: &Separation, why: String) -> Self {
        let (largest_clearance_m, narrowest_cells) = match *separation {
            Separation::TooNarrow { widest_m, narrowest, .. } => (Some(widest_m), Some(narrowest)),
            _ => (None, None),
        };
        Self { why: Some(why), largest_clearance_m, narrowest_cells, ..self }
    }

    /// Describes a goal without a search.
    pub(super) const fn without_path(
        planner: &'static str,
        outcome: PlanOutcome,
        time_s: Option<f64>,
    ) -> Self {
        Self {
            outcome,
            planner,
            length_m: None,
            cost_cells: None,
            expanded: 0,
            generated: 0,
            search: SearchStatistics::one_sided(SideStatistics { expanded: 0, generated: 0 }),
            stopped: None,
            meeting: None,
            why: None,
            largest_clearance_m: None,
            narrowest_cells: None,
            relaxed: None,
            optimum_cells: None,
            excess: None,
            time_s,
            turns: None,
            turning_angle_deg: None,
            min_clearance_m: None,
            kept_clearance_m: None,
            waypoints_m: None,
            cells: None,
        }
    }
}
