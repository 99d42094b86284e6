//! What the commands report as JSON; described in `docs/JSON.md`. Members are only ever added.

use crate::asked::Asked;
use crate::commands::why;
use crate::table::quantity;
use keyway::geometry::{PlannedLine, Point, Polyline};
use keyway::map::{Cell, SearchMap, Separation};
use keyway::metrics::{PathMetrics, RunMetrics};
use keyway::plan::{Plan, PlanError, Relaxed, Stop};
use keyway::robot::Robot;
use keyway::search::{SearchStatistics, SideStatistics};
use keyway::sim::{Run, Sample};
use keyway::smooth::{SharpCorner, Smoothed, Smoother, SmootherConfig, Unsmoothed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Everything that a run depends on.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Inputs {
    pub(crate) version: &'static str,
    pub(crate) map: String,
    pub(crate) map_digest: String,
    pub(crate) placement: Option<PlacementInput>,
    pub(crate) robot: Option<Robot>,
    pub(crate) stack: Option<String>,
    pub(crate) config: serde_json::Value,
    /// `[x, y]` or `[x, y, yaw_deg]`.
    pub(crate) start: Vec<f64>,
    pub(crate) goal: Point,
    /// All goals, where there are several.
    pub(crate) goals: Option<Vec<Point>>,
    pub(crate) nearest_reachable: Option<bool>,
    /// `[x, y, radius]` each.
    pub(crate) obstacles: Vec<[f64; 3]>,
    pub(crate) time_limit_s: Option<f64>,
    pub(crate) budget: Option<u64>,
}

/// Where a map lies, when its file does not say so.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct PlacementInput {
    pub(crate) resolution_m: f64,
    /// `[x, y, yaw_deg]`.
    pub(crate) origin: [f64; 3],
}

impl From<keyway::map::formats::ImagePlacement> for PlacementInput {
    fn from(placement: keyway::map::formats::ImagePlacement) -> Self {
        let keyway::geometry::Pose { x, y, theta } = placement.origin;
        Self { resolution_m: placement.resolution_m, origin: [x, y, theta.to_degrees()] }
    }
}

/// `keyway.plan/2`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PlanReport {
    pub(crate) schema: &'static str,
    #[serde(flatten)]
    pub(crate) plan: PlanPart,
    pub(crate) goal: Option<ReachedGoal>,
    pub(crate) goals: Option<Vec<GoalPart>>,
    pub(crate) smoothed: Option<SmoothedPart>,
    pub(crate) inputs: Inputs,
    /// The files that were written.
    pub(crate) files: Vec<String>,
}

/// Which goal a path leads to.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ReachedGoal {
    /// Its place in the order of the command line, from 0.
    pub(crate) index: usize,
    /// The last cell of the path.
    pub(crate) cell: Cell,
    /// From the position asked for to the end of the path; 0 when it was reached.
    pub(crate) gap_m: f64,
}

/// One of several goals.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct GoalPart {
    pub(crate) index: usize,
    pub(crate) goal: Point,
    pub(crate) outcome: PlanOutcome,
    pub(crate) length_m: Option<f64>,
    pub(crate) cost_cells: Option<f64>,
    pub(crate) expanded: u64,
    pub(crate) generated: u64,
    /// Until this goal's place in the order was known, the searches for other goals included.
    pub(crate) time_s: f64,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PlanOutcome {
    Found,
    NoPath,
    BudgetExhausted,
    /// There is a path, and the planner did not find it.
    Missed,
    /// A goal in an obstacle, or outside the map: only for one of several; otherwise it is an
    /// error.
    Blocked,
    OutsideMap,
    /// The planner cannot plan on such a map, which is an error.
    Refused,
}

impl PlanOutcome {
    /// Why there is no path, and what was searched; without a search, nothing.
    pub(crate) fn of(error: &PlanError) -> (Self, SearchStatistics) {
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

    /// For people.
    pub(crate) const fn text(self) -> &'static str {
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

/// A planned path.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PlanPart {
    pub(crate) outcome: PlanOutcome,
    pub(crate) planner: &'static str,
    pub(crate) length_m: Option<f64>,
    pub(crate) cost_cells: Option<f64>,
    pub(crate) expanded: u64,
    pub(crate) generated: u64,
    /// The two sides separately.
    pub(crate) search: SearchStatistics,
    /// Why the search stopped.
    pub(crate) stopped: Option<Stop>,
    /// Where the two sides met.
    pub(crate) meeting: Option<Cell>,
    /// Why there is no path.
    pub(crate) why: Option<String>,
    /// The largest clearance with which there is one \[m\].
    pub(crate) largest_clearance_m: Option<f64>,
    /// The planner's constraint, where that was lowered to leave a path.
    pub(crate) relaxed: Option<Relaxed>,
    /// What the cheapest path of straight and diagonal steps costs.
    pub(crate) optimum_cells: Option<f64>,
    /// The share by which the path costs more; negative where it goes in other directions.
    pub(crate) excess: Option<f64>,
    pub(crate) time_s: Option<f64>,
    pub(crate) turns: Option<usize>,
    pub(crate) turning_angle_deg: Option<f64>,
    pub(crate) min_clearance_m: Option<f64>,
    /// What the line certainly keeps, where that is less than the clearance asked for.
    pub(crate) shortfall_m: Option<f64>,
    pub(crate) waypoints_m: Option<Polyline>,
    pub(crate) cells: Option<Vec<Cell>>,
}

impl PlanPart {
    /// A path that was found; `line` begins and ends at the given positions.
    pub(crate) fn found(
        planner: &'static str,
        plan: &Plan,
        line: &PlannedLine,
        map: &SearchMap,
        time_s: f64,
    ) -> Self {
        let metrics = PathMetrics::of_polyline(line.polyline(), map.clearance());
        // A cell's centre may keep the clearance where a position in it does not.
        let clearance_m = map.config().clearance_m;
        let shortfall_m = Unsmoothed.smooth(line, &map.clearance(), clearance_m).shortfall_m;
        Self {
            outcome: PlanOutcome::Found,
            planner,
            length_m: Some(metrics.length_m),
            cost_cells: Some(plan.cost.cells()),
            expanded: plan.statistics.expanded(),
            generated: plan.statistics.generated(),
            search: plan.statistics,
            stopped: plan.stop,
            meeting: plan.meeting,
            why: None,
            largest_clearance_m: None,
            relaxed: plan.relaxed,
            optimum_cells: None,
            excess: None,
            time_s: Some(time_s),
            turns: Some(metrics.turns),
            turning_angle_deg: Some(metrics.turning_angle_deg),
            min_clearance_m: metrics.min_clearance_m,
            shortfall_m,
            waypoints_m: Some(line.polyline().merged()),
            cells: Some(plan.cells.clone()),
        }
    }

    /// The same, with what the cheapest path of straight and diagonal steps costs.
    pub(crate) fn beside_optimum(self, optimum_cells: f64) -> Self {
        // Without a distance there is nothing to exceed. Costs of steps are exact: no rounding shows.
        let excess =
            |cost: f64| if cost == optimum_cells { 0.0 } else { cost / optimum_cells - 1.0 };
        let excess = self.cost_cells.map(excess);
        Self { optimum_cells: Some(optimum_cells), excess, ..self }
    }

    /// A search without a path; `None` when it was not a search that failed.
    pub(crate) fn failed(
        planner: &'static str,
        error: &PlanError,
        time_s: Option<f64>,
    ) -> Option<Self> {
        let (outcome, statistics) = PlanOutcome::of(error);
        let has_searched = [PlanOutcome::NoPath, PlanOutcome::BudgetExhausted, PlanOutcome::Missed];
        if !has_searched.contains(&outcome) {
            return None;
        }
        let without = Self::without_path(planner, outcome, time_s.unwrap_or_default());
        Some(Self {
            expanded: statistics.expanded(),
            generated: statistics.generated(),
            search: statistics,
            why: Some(why(error)),
            time_s,
            ..without
        })
    }

    /// The same for ends that no path joins: what separates them.
    pub(crate) fn separated_by(self, separation: &Separation, why: String) -> Self {
        let largest_clearance_m = match *separation {
            Separation::TooNarrow { widest_m, .. } => Some(widest_m),
            _ => None,
        };
        Self { why: Some(why), largest_clearance_m, ..self }
    }

    /// The text for people about a constraint that was lowered.
    pub(crate) fn lowered(&self) -> Option<(&'static str, String)> {
        self.relaxed.map(|Relaxed { asked_m, used_m }| {
            let text = format!(
                "lowered from {asked_m:.3} m to {used_m:.3} m, the largest that leaves a path"
            );
            ("constraint", text)
        })
    }

    /// Nothing was found, and nothing searched.
    pub(crate) const fn without_path(
        planner: &'static str,
        outcome: PlanOutcome,
        time_s: f64,
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
            relaxed: None,
            optimum_cells: None,
            excess: None,
            time_s: Some(time_s),
            turns: None,
            turning_angle_deg: None,
            min_clearance_m: None,
            shortfall_m: None,
            waypoints_m: None,
            cells: None,
        }
    }
}

/// A smoothed path.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SmoothedPart {
    pub(crate) length_m: f64,
    pub(crate) turns: usize,
    pub(crate) turning_angle_deg: f64,
    pub(crate) non_smooth_turns: usize,
    pub(crate) min_clearance_m: Option<f64>,
    /// What the path certainly keeps, where that is less than what was asked for.
    pub(crate) shortfall_m: Option<f64>,
    pub(crate) removed_points: usize,
    pub(crate) inserted_points: usize,
    pub(crate) sharp_corners: Vec<SharpCorner>,
    /// Corners, and points along curves.
    pub(crate) waypoints_m: Polyline,
    /// Wall clock of the smoothing, where it was measured.
    pub(crate) time_s: Option<f64>,
    #[serde(skip)]
    pub(crate) asked: Asked,
}

impl SmoothedPart {
    /// `chords` are a line along the path on this map.
    pub(crate) fn of(
        done: &Smoothed,
        chords: &Polyline,
        map: &SearchMap,
        smoother: &SmootherConfig,
    ) -> Self {
        let metrics = PathMetrics::of_path(&done.path, map.clearance());
        let (clearance_m, cell_m) = (map.config().clearance_m, map.frame().resolution_m());
        Self {
            length_m: metrics.length_m,
            turns: metrics.turns,
            turning_angle_deg: metrics.turning_angle_deg,
            non_smooth_turns: metrics.non_smooth_turns,
            min_clearance_m: metrics.min_clearance_m,
            shortfall_m: done.shortfall_m,
            removed_points: done.removed_points,
            inserted_points: done.inserted_points,
            sharp_corners: done.sharp_corners.clone(),
            waypoints_m: chords.clone(),
            time_s: None,
            asked: Asked::new(smoother, clearance_m, cell_m),
        }
    }

    /// The text for people about it.
    pub(crate) fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("smoothed length", quantity(Some(self.length_m), 3, "m")),
            ("smoothed turns", format!("{}, {} not smooth", self.turns, self.non_smooth_turns)),
            ("smoothed turning angle", quantity(Some(self.turning_angle_deg), 1, "deg")),
            ("smoothed clearance", quantity(self.min_clearance_m, 3, "m")),
        ];
        if let Some(time_s) = self.time_s {
            facts.push(("smoothing time", quantity(Some(time_s * 1e3), 3, "ms")));
        }
        facts.extend(not_kept(self.asked, self.shortfall_m));
        let points = format!("{} removed, {} inserted", self.removed_points, self.inserted_points);
        facts.push(("points", points));
        let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for SharpCorner { at, why } in &self.sharp_corners {
            places
                .entry(self.asked.why_sharp(*why))
                .or_default()
                .push(format!("({:.3}, {:.3})", at.x, at.y));
        }
        for (why, places) in places {
            let more = if places.len() > 1 {
                format!(" and {} more", places.len() - 1)
            } else {
                String::new()
            };
            facts.push(("sharp corners", format!("{why}: {}{more}", places[0])));
        }
        facts
    }
}

/// The text for people about a distance that is not kept.
pub(crate) fn not_kept(
    asked: impl Display,
    shortfall_m: Option<f64>,
) -> Option<(&'static str, String)> {
    shortfall_m.map(|kept_m| ("not kept", format!("{asked}, only {kept_m:.3} m")))
}

/// `keyway.navigate/2`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct NavigateReport {
    pub(crate) schema: &'static str,
    pub(crate) outcome: &'static str,
    /// Why the goal was not reached.
    pub(crate) reason: Option<String>,
    pub(crate) plan: PlanPart,
    pub(crate) smoothed: Option<SmoothedPart>,
    pub(crate) key_points_m: Option<Vec<Point>>,
    pub(crate) run: Option<RunPart>,
    pub(crate) trajectory: Option<Vec<[f64; 6]>>,
    pub(crate) inputs: Inputs,
    /// The files that were written.
    pub(crate) files: Vec<String>,
}

/// What was measured of a run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunPart {
    pub(crate) time_s: f64,
    pub(crate) length_m: f64,
    pub(crate) mean_speed_mps: Option<f64>,
    pub(crate) min_clearance_m: Option<f64>,
    pub(crate) cycles: u64,
    pub(crate) mean_cycle_us: Option<f64>,
    pub(crate) routes_planned: u32,
    pub(crate) omega_sign_changes_per_m: Option<f64>,
    pub(crate) v_variation_mps: f64,
    pub(crate) omega_variation_radps: f64,
}

impl RunPart {
    /// `steps_s` is the time that the controller took for its `steps`.
    pub(crate) fn of(run: &Run, routes_planned: u32, steps: u64, steps_s: f64) -> Self {
        let metrics = RunMetrics::of_run(run);
        Self {
            time_s: metrics.time_s,
            length_m: metrics.length_m,
            mean_speed_mps: metrics.mean_speed_mps,
            min_clearance_m: metrics.min_clearance_m,
            cycles: run.cycles,
            mean_cycle_us: (steps > 0).then(|| steps_s * 1e6 / steps as f64),
            routes_planned,
            omega_sign_changes_per_m: metrics.omega_sign_changes_per_m,
            v_variation_mps: metrics.v_variation_mps,
            omega_variation_radps: metrics.omega_variation_radps,
        }
    }
}

/// One sample as `[t_s, x_m, y_m, yaw_rad, v_mps, omega_radps]`.
pub(crate) fn sample_row(sample: &Sample) -> [f64; 6] {
    let Sample { t_s, pose, velocity } = *sample;
    [t_s, pose.x, pose.y, pose.theta, velocity.v, velocity.omega]
}
