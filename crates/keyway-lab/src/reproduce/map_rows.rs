//! Results of every method on every map, as lines of a table.

use super::kept::{MapGroup, MapLine};
use super::measure::Measured;
use super::report::Measurements;
use crate::claims::{Experiment, MethodResult};
use keyway_sim::episode::EpisodeOutcome;
use serde::Serialize;

/// A line of `maps.csv`.
#[derive(Default, Serialize)]
pub(super) struct MethodRow {
    experiment: &'static str,
    group: Option<MapGroup>,
    /// Empty for the scene.
    seed: Option<u64>,
    /// True if the map counts.
    counts: bool,
    method: &'static str,
    succeeded: bool,
    expanded: Option<u64>,
    length_m: Option<f64>,
    excess: Option<f64>,
    points: Option<usize>,
    redundant_points: Option<usize>,
    turns: Option<usize>,
    non_smooth_turns: Option<usize>,
    turning_angle_deg: Option<f64>,
    min_clearance_m: Option<f64>,
    revisited: Option<usize>,
    unknown_clearance_m: Option<f64>,
    layers_s: Option<f64>,
    search_s: Option<f64>,
    smoothing_s: Option<f64>,
    outcome: Option<EpisodeOutcome>,
    run_time_s: Option<f64>,
    mean_speed_mps: Option<f64>,
    speed_deviation_mps: Option<f64>,
    speed_variation_per_s: Option<f64>,
    oscillation_per_m: Option<f64>,
    cycle_s: Option<f64>,
    total_search_s: Option<f64>,
}

/// Returns the lines in order: the scene of each experiment, then the maps that fit, then its
/// family.
pub(super) fn map_rows(measurements: &Measurements) -> Vec<MethodRow> {
    let of_one = |one: &Measured| -> Vec<MethodRow> {
        one.lines.iter().flat_map(|line| method_rows(one.experiment, line)).collect()
    };
    measurements.all().flat_map(of_one).collect()
}

fn method_rows(experiment: &'static Experiment, line: &MapLine) -> impl Iterator<Item = MethodRow> {
    let MapLine { group, row, .. } = line;
    let methods = experiment.methods.iter().zip(&row.outcomes);
    methods.map(move |(method, outcome)| MethodRow {
        experiment: experiment.name,
        group: Some(*group),
        seed: row.seed,
        counts: row.counts(experiment),
        method: method.name,
        succeeded: outcome.as_ref().is_some_and(MethodResult::succeeded),
        ..outcome.as_ref().map(measures).unwrap_or_default()
    })
}

fn measures(outcome: &MethodResult) -> MethodRow {
    match outcome {
        MethodResult::Planned(planned) => MethodRow {
            expanded: Some(planned.expanded),
            length_m: Some(planned.path.length_m),
            excess: planned.excess,
            points: Some(planned.path.points),
            redundant_points: Some(planned.path.redundant_points),
            turns: Some(planned.path.turns),
            non_smooth_turns: Some(planned.path.non_smooth_turns),
            turning_angle_deg: Some(planned.path.turning_angle_deg),
            min_clearance_m: planned.path.min_clearance_m,
            revisited: Some(planned.revisited),
            unknown_clearance_m: planned.unknown_clearance_m,
            layers_s: planned.times.map(|times| times.layers_s),
            search_s: planned.times.map(|times| times.search_s),
            smoothing_s: planned.times.map(|times| times.smoothing_s),
            ..MethodRow::default()
        },
        MethodResult::Driven(driven) => MethodRow {
            length_m: Some(driven.length_m),
            min_clearance_m: driven.min_clearance_m,
            non_smooth_turns: Some(driven.non_smooth_turns),
            outcome: Some(driven.outcome),
            run_time_s: Some(driven.time_s),
            mean_speed_mps: driven.mean_speed_mps,
            speed_deviation_mps: driven.speed_deviation_mps,
            speed_variation_per_s: driven.speed_variation_per_s,
            oscillation_per_m: driven.oscillation_per_m,
            cycle_s: driven.cycle_s,
            total_search_s: driven.total_search_s,
            ..MethodRow::default()
        },
    }
}
