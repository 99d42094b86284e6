//! Differences between two methods on the same tasks: their size and their significance.

use crate::table::number;
use keyway_sim::metrics::statistics::{Confidence, Sample, SignedRankTest, holm};

/// Paired differences with Wilcoxon's test.
pub struct Differences {
    /// Number of pairs.
    pub pairs: usize,
    /// Wilcoxon's test; `None` without pairs.
    pub test: Option<SignedRankTest>,
}

impl Differences {
    /// Compares the tasks on which both methods have a value. Values closer than `same` count as
    /// equal, since equal values, and equal differences, may differ by rounding.
    pub fn of(differences: impl Iterator<Item = f64>, same: f64) -> Self {
        let per_unit = 1.0 / same;
        let rounded: Vec<f64> =
            differences.map(|difference| (difference * per_unit).round() / per_unit).collect();
        let pairs = rounded.len();
        let sample = Sample::new(rounded).ok();
        let test = sample.map(|sample| SignedRankTest::of_differences(&sample, Confidence::USUAL));
        Self { pairs, test }
    }

    /// Ends of the interval of the median.
    pub fn median_ends(&self) -> [Option<f64>; 2] {
        let ends = self.test.as_ref().and_then(|test| test.median_difference_interval);
        [ends.map(|ends| ends.low), ends.map(|ends| ends.high)]
    }
}

/// Returns Holm's correction of the p-values that are present.
pub fn holm_of(p_values: impl Iterator<Item = Option<f64>>) -> Vec<Option<f64>> {
    let p_values: Vec<Option<f64>> = p_values.collect();
    let there: Vec<f64> = p_values.iter().copied().flatten().collect();
    // Each one is a probability from a test.
    let mut corrected = holm(&there).unwrap_or_default().into_iter();
    p_values.into_iter().map(|p| p.and_then(|_| corrected.next())).collect()
}

/// Formats a p-value for display.
pub fn p_value(p: Option<f64>) -> String {
    if p.is_some_and(|p| p < 0.001) { "< 0.001".to_owned() } else { number(p, 3) }
}
