//! Summary of many numbers, for a cell of a table.

use keyway_sim::metrics::statistics::Sample;

/// The mean with this many decimals, and in brackets the quantiles of 0.05 and 0.95, to whole
/// numbers: `12.44 (2 to 34)`; `none` without values.
pub(crate) fn mean_and_range(values: &[f64], decimals: usize) -> String {
    let Ok(sample) = Sample::new(values.to_vec()) else { return "none".to_owned() };
    let [low, high] = [0.05, 0.95].map(|share| rounded(sample.quantile(share)));
    format!("{:.decimals$} ({low} to {high})", sample.mean())
}

/// Rounds to a whole number, without a sign if it is 0.
fn rounded(value: f64) -> f64 {
    value.round() + 0.0
}
