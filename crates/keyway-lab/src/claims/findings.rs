//! Evidence for a figure, from the maps of a family.

use super::claim::{Expected, Figure};
use super::experiment::{Experiment, MapRow};
use super::verdict::Evidence;
use keyway_sim::metrics::statistics::{Confidence, Rate, Sample};

/// Seed of the resamples for the intervals.
const SEED: u64 = 0;

/// Results for a figure over the maps of a family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Maps on which both values were measured, and their change is defined.
    pub pairs: usize,
    /// Counted maps without such a pair.
    pub undefined: usize,
    /// Mean of the other method over these maps; `None` for a bound, or without maps.
    pub old_mean: Option<f64>,
    /// Mean of this method.
    pub new_mean: Option<f64>,
    /// Evidence for the figure.
    pub evidence: Evidence,
}

impl Finding {
    /// Compares the methods on each map separately, then takes the mean of the changes; `rows` are
    /// the maps that count.
    pub fn of(figure: &Figure, experiment: &Experiment, rows: &[MapRow]) -> Self {
        match figure.expected {
            Expected::Change { .. } => {
                let values: Vec<[f64; 3]> =
                    rows.iter().filter_map(|row| change_on(figure, experiment, row)).collect();
                let mean_of = |i: usize| mean(values.iter().map(|value| value[i]));
                let changes = values.iter().map(|value| value[2]).collect();
                Self {
                    pairs: values.len(),
                    undefined: rows.len() - values.len(),
                    old_mean: mean_of(0),
                    new_mean: mean_of(1),
                    evidence: of_changes(changes),
                }
            }
            Expected::Always(bound) => {
                let values: Vec<f64> = rows
                    .iter()
                    .filter_map(|row| value(figure, figure.of, experiment, row))
                    .collect();
                Self {
                    pairs: values.len(),
                    undefined: rows.len() - values.len(),
                    old_mean: None,
                    new_mean: mean(values.iter().copied()),
                    evidence: Evidence::Kept(Rate::of(
                        values.iter().map(|&value| bound.holds(value)),
                    )),
                }
            }
        }
    }
}

/// Returns the values of the other method and of this one on a map, and the change.
pub fn change_on(figure: &Figure, experiment: &Experiment, row: &MapRow) -> Option<[f64; 3]> {
    let old = value(figure, figure.than()?, experiment, row)?;
    let new = value(figure, figure.of, experiment, row)?;
    Some([old, new, figure.scale().change(old, new)?])
}

/// Returns the value of a figure's method on a map.
pub(super) fn value(
    figure: &Figure,
    method: &str,
    experiment: &Experiment,
    row: &MapRow,
) -> Option<f64> {
    let (i, _) = experiment.method(method)?;
    figure.measure.of(row.outcomes.get(i)?.as_ref())
}

fn of_changes(changes: Vec<f64>) -> Evidence {
    let Ok(sample) = Sample::new(changes) else { return Evidence::Missing };
    let Some(interval) = sample.mean_interval(Confidence::USUAL, SEED) else {
        return Evidence::Missing;
    };
    Evidence::Change { mean: sample.mean(), low: interval.low, high: interval.high }
}

pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    Some(Sample::new(values.collect()).ok()?.mean())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::{Bound, Claim, Measure, MethodResult, Planned, RunFigures};
    use keyway_sim::episode::EpisodeOutcome;
    use keyway_sim::metrics::PathMetrics;

    fn experiment() -> &'static Experiment {
        Claim::named("S0-1")[0].experiment
    }

    fn outcome(expanded: u64, clearance_m: Option<f64>) -> MethodResult {
        let path = PathMetrics {
            length_m: 10.0,
            points: 3,
            redundant_points: 0,
            turns: 1,
            turning_angle_deg: 45.0,
            non_smooth_turns: 1,
            min_clearance_m: clearance_m,
        };
        MethodResult::Planned(Planned {
            expanded,
            path,
            revisited: 0,
            unknown_clearance_m: None,
            excess: None,
            times: None,
        })
    }

    /// A row with the first outcome for the first method, and the second one for the second.
    fn row(old: Option<MethodResult>, new: Option<MethodResult>) -> MapRow {
        MapRow { seed: Some(1), outcomes: vec![old, new] }
    }

    fn figure(measure: Measure) -> Figure {
        let [old, new] = [0, 1].map(|i| experiment().methods[i].name);
        Figure::lower(measure, new, old, None)
    }

    #[test]
    fn changes_are_paired_on_each_map() {
        let with = |old, new| row(Some(outcome(old, None)), Some(outcome(new, None)));
        // -0.5, +0.5 and 0: the mean change is 0, though the sum of nodes falls from 112 to 63.
        let rows = [with(100, 50), with(2, 3), with(10, 10)];
        let found = Finding::of(&figure(Measure::Expanded), experiment(), &rows);
        assert_eq!((found.pairs, found.undefined), (3, 0));
        assert_eq!((found.old_mean, found.new_mean), (Some(112.0 / 3.0), Some(21.0)));
        let Evidence::Change { mean, low, high } = found.evidence else { panic!("{found:?}") };
        assert!(mean == 0.0 && low < 0.0 && high > 0.0, "{found:?}");
    }

    #[test]
    fn undefined_changes_are_counted() {
        let with = |old, new| row(Some(outcome(old, None)), Some(outcome(new, None)));
        let found =
            Finding::of(&figure(Measure::Expanded), experiment(), &[with(0, 5), with(4, 2)]);
        assert_eq!((found.pairs, found.undefined, found.evidence), (1, 1, Evidence::Missing));
        // 0 and 0 are equal; clearances are subtracted, and may be missing.
        let found =
            Finding::of(&figure(Measure::Expanded), experiment(), &[with(0, 0), with(8, 8)]);
        assert_eq!(found.evidence, Evidence::Change { mean: 0.0, low: 0.0, high: 0.0 });
        let near = |old, new| row(Some(outcome(1, Some(old))), Some(outcome(1, Some(new))));
        let rows = [near(0.0, 0.5), near(0.5, 1.0), with(1, 1)];
        let found = Finding::of(&figure(Measure::Clearance), experiment(), &rows);
        assert_eq!((found.pairs, found.undefined), (2, 1));
        assert_eq!(found.evidence, Evidence::Change { mean: 0.5, low: 0.5, high: 0.5 });
        let found = Finding::of(&figure(Measure::SearchTime), experiment(), &rows);
        assert_eq!((found.pairs, found.evidence), (0, Evidence::Missing), "without a clock");
        assert_eq!((found.old_mean, found.new_mean), (None, None));
    }

    #[test]
    fn missing_a_path_is_measured_too() {
        let rows = [row(None, Some(outcome(1, None))), row(None, None)];
        let found = Finding::of(&figure(Measure::Missed), experiment(), &rows);
        assert_eq!((found.old_mean, found.new_mean), (Some(1.0), Some(0.5)));
        let found = Finding::of(&figure(Measure::Expanded), experiment(), &rows);
        assert_eq!((found.pairs, found.undefined), (0, 2));
    }

    #[test]
    fn bounds_are_counted() {
        let with = |clearance_m| row(None, Some(outcome(1, clearance_m)));
        let kept =
            Figure::always(Measure::Clearance, experiment().methods[1].name, Bound::AtLeast(0.5));
        let rows = [with(Some(0.5)), with(Some(0.4)), with(Some(0.9)), with(None)];
        let found = Finding::of(&kept, experiment(), &rows);
        assert_eq!((found.pairs, found.undefined, found.old_mean), (3, 1, None));
        assert_eq!(found.evidence, Evidence::Kept(Rate { successes: 2, failures: 1 }));
    }

    #[test]
    fn runs_are_measured_that_reached_their_goal() {
        let run = |outcome, time_s| {
            Some(MethodResult::Driven(RunFigures {
                outcome,
                time_s,
                length_m: 7.0,
                mean_speed_mps: Some(0.5),
                speed_deviation_mps: None,
                speed_variation_per_s: None,
                oscillation_per_m: None,
                min_clearance_m: None,
                non_smooth_turns: 0,
                cycle_s: None,
                total_search_s: None,
            }))
        };
        let rows = [
            row(run(EpisodeOutcome::Reached, 20.0), run(EpisodeOutcome::Reached, 10.0)),
            row(run(EpisodeOutcome::Reached, 20.0), run(EpisodeOutcome::Stuck, 10.0)),
            row(None, run(EpisodeOutcome::Reached, 30.0)),
        ];
        let found = Finding::of(&figure(Measure::RunTime), experiment(), &rows);
        assert_eq!((found.pairs, found.undefined, found.new_mean), (1, 2, Some(10.0)));
        let found = Finding::of(&figure(Measure::Reached), experiment(), &rows);
        assert_eq!((found.old_mean, found.new_mean), (Some(2.0 / 3.0), Some(2.0 / 3.0)));
        let found = Finding::of(&figure(Measure::Length), experiment(), &rows);
        assert_eq!(found.pairs, 0, "what was driven was not planned");
    }
}
