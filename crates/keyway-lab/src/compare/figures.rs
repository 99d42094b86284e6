//! The metrics of the paths of a comparison: measured on each path, and summarised over the
//! queries that count.

use super::contest::Found;
use crate::measure::Spread;
use keyway_sim::metrics::statistics::{Confidence, Sample};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// Seed of the resamples for the intervals.
const SEED: u64 = 0;

/// A metric of a path.
#[derive(Debug)]
pub(super) struct Figure {
    /// Name in a report, where it follows a prefix such as `mean_`.
    name: &'static str,
    /// Value of a path; `None` if it has none.
    of: fn(&Found) -> Option<f64>,
    /// Name of the worst value in a report, and the order in which the worst value comes last.
    worst: Option<(&'static str, Order)>,
}

type Order = fn(&f64, &f64) -> std::cmp::Ordering;

pub(super) const LENGTH_M: Figure = usual("length_m", |found| Some(found.metrics.length_m));
pub(super) const EXCESS: Figure =
    Figure { name: "excess", of: Found::excess, worst: Some(("max_excess", f64::total_cmp)) };
pub(super) const TURNS: Figure = usual("turns", |found| Some(found.metrics.turns as f64));
pub(super) const TURNING_ANGLE_DEG: Figure =
    usual("turning_angle_deg", |found| Some(found.metrics.turning_angle_deg));
pub(super) const NON_SMOOTH_TURNS: Figure =
    usual("non_smooth_turns", |found| Some(found.metrics.non_smooth_turns as f64));
pub(super) const CLEARANCE_M: Figure = Figure {
    name: "clearance_m",
    of: |found| found.metrics.min_clearance_m,
    worst: Some(("min_clearance_m", |a, b| b.total_cmp(a))),
};

pub(super) const EXPANDED: Figure = usual("expanded", |found| Some(found.expanded as f64));
pub(super) const GENERATED: Figure = usual("generated", |found| Some(found.generated as f64));

/// All metrics, in the order of reports.
const FIGURES: [&Figure; 8] = [
    &LENGTH_M,
    &EXCESS,
    &TURNS,
    &TURNING_ANGLE_DEG,
    &NON_SMOOTH_TURNS,
    &CLEARANCE_M,
    &EXPANDED,
    &GENERATED,
];

const fn usual(name: &'static str, of: fn(&Found) -> Option<f64>) -> Figure {
    Figure { name, of, worst: None }
}

/// Summary of the values of one metric; all fields are `None` without a value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Summary {
    pub(super) mean: Option<f64>,
    /// Standard deviation.
    pub(super) sd: Option<f64>,
    /// 95 % confidence interval of the true mean.
    pub(super) ci: Option<[f64; 2]>,
    pub(super) p5: Option<f64>,
    pub(super) p95: Option<f64>,
    pub(super) worst: Option<f64>,
}

/// Summaries of all metrics.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Summaries([Summary; FIGURES.len()]);

impl Figure {
    /// Returns its index in [`FIGURES`]; `None` if it is not there.
    pub(super) fn place(&self) -> Option<usize> {
        FIGURES.iter().position(|one| one.name == self.name)
    }

    fn summary(&self, found: &[&Found]) -> Summary {
        let values: Vec<f64> = found.iter().filter_map(|found| (self.of)(found)).collect();
        let worst = self.worst.and_then(|(_, order)| values.iter().copied().max_by(order));
        let Ok(sample) = Sample::new(values) else { return Summary::default() };
        let Spread { mean, p5, p95 } = Spread::of(&sample);
        let interval = sample.mean_interval(Confidence::USUAL, SEED);
        let ci = interval.map(|ends| [ends.low, ends.high]);
        Summary { mean, sd: sample.standard_deviation(), ci, p5, p95, worst }
    }
}

impl Summaries {
    /// Summarises the paths that count.
    pub(super) fn of(found: &[&Found]) -> Self {
        Self(FIGURES.map(|figure| figure.summary(found)))
    }

    /// Returns the summary of one metric of [`FIGURES`].
    pub(super) fn get(&self, figure: &Figure) -> Summary {
        figure.place().map_or_else(Summary::default, |place| self.0[place])
    }
}

impl Serialize for Summaries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (Figure { name, worst, .. }, summary) in FIGURES.into_iter().zip(&self.0) {
            let Summary { mean, sd, ci, p5, p95, .. } = *summary;
            let [ci_low, ci_high] = [0, 1].map(|end| ci.map(|ends| ends[end]));
            let values = [mean, sd, ci_low, ci_high, p5, p95];
            for (kind, value) in ["mean", "sd", "ci_low", "ci_high", "p5", "p95"].iter().zip(values)
            {
                map.serialize_entry(&format!("{kind}_{name}"), &value)?;
            }
            if let Some((name, _)) = worst {
                map.serialize_entry(name, &summary.worst)?;
            }
        }
        map.end()
    }
}
