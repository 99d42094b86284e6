//! What every method did on every map, as lines of a table.

use super::measure::Measured;
use keyway::claims::{Experiment, MapRow, Outcome};
use serde::Serialize;

/// A line of `maps.csv`.
#[derive(Serialize)]
pub(super) struct MethodRow {
    experiment: &'static str,
    /// Empty for the scene.
    seed: Option<u64>,
    method: &'static str,
    found: bool,
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
    layers_s: Option<f64>,
    search_s: Option<f64>,
    smoothing_s: Option<f64>,
}

/// The scene of each experiment first, then its maps that count.
pub(super) fn map_rows(measured: &[Measured]) -> Vec<MethodRow> {
    let of_one = |one: &Measured| -> Vec<MethodRow> {
        let maps = one.family.scene.iter().chain(&one.family.rows);
        maps.flat_map(|row| method_rows(one.experiment, row)).collect()
    };
    measured.iter().flat_map(of_one).collect()
}

fn method_rows(experiment: &'static Experiment, row: &MapRow) -> Vec<MethodRow> {
    let methods = experiment.methods.iter().zip(&row.outcomes);
    let line = |(method, outcome): (&keyway::claims::Method, &Option<Outcome>)| {
        let outcome = outcome.as_ref();
        let path = outcome.map(|outcome| outcome.path);
        let times = outcome.and_then(|outcome| outcome.times);
        MethodRow {
            experiment: experiment.name,
            seed: row.seed,
            method: method.name,
            found: outcome.is_some(),
            expanded: outcome.map(|outcome| outcome.expanded),
            length_m: path.map(|path| path.length_m),
            excess: outcome.and_then(|outcome| outcome.excess),
            points: path.map(|path| path.points),
            redundant_points: path.map(|path| path.redundant_points),
            turns: path.map(|path| path.turns),
            non_smooth_turns: path.map(|path| path.non_smooth_turns),
            turning_angle_deg: path.map(|path| path.turning_angle_deg),
            min_clearance_m: path.and_then(|path| path.min_clearance_m),
            revisited: outcome.map(|outcome| outcome.revisited),
            layers_s: times.map(|times| times.layers_s),
            search_s: times.map(|times| times.search_s),
            smoothing_s: times.map(|times| times.smoothing_s),
        }
    };
    methods.map(line).collect()
}
