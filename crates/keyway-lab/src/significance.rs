//! Differences between two methods on the same tasks: how large they are, and whether they are more than chance.

use crate::table::number;
use keyway_sim::metrics::statistics::{Confidence, Sample, SignedRankTest, holm};

/// Paired differences, and Wilcoxon's test of them.
pub struct Differences {
    /// Number of pairs.
    pub pairs: usize,
    /// `None` without pairs.
    pub test: Option<SignedRankTest>,
}

impl Differences {
    /// Those of tasks on which both methods gave a value. Equal values, and equal differences, differ by rounding: what is nearer
    /// than `same` counts as equal.
    pub fn of(differences: impl Iterator<Item = f64>, same: f64) -> Self {
        let per_unit = 1.0 / same;
        let rounded: Vec<f64> =
            differences.map(|difference| (difference * per_unit).round() / per_unit).collect();
        let pairs = rounded.len();
        let sample = Sample::new(rounded).ok();
        let test = sample.map(|sample| SignedRankTest::of_differences(&sample, Confidence::USUAL));
        Self { pairs, test }
    }

    /// The ends of the interval of their median.
    pub fn median_ends(&self) -> [Option<f64>; 2] {
        let ends = self.test.as_ref().and_then(|test| test.median_difference_interval);
        [ends.map(|ends| ends.low), ends.map(|ends| ends.high)]
    }
}

/// Holm's correction of those that are there.
pub fn holm_of(p_values: impl Iterator<Item = Option<f64>>) -> Vec<Option<f64>> {
    let p_values: Vec<Option<f64>> = p_values.collect();
    let there: Vec<f64> = p_values.iter().copied().flatten().collect();
    // Each is the probability that a test gave.
    let mut corrected = holm(&there).unwrap_or_default().into_iter();
    p_values.into_iter().map(|p| p.and_then(|_| corrected.next())).collect()
}

/// For people.
pub fn p_value(p: Option<f64>) -> String {
    if p.is_some_and(|p| p < 0.001) { "< 0.001".to_owned() } else { number(p, 3) }
}
