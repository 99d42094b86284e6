//! Probabilities that a difference is chance.

use crate::table::number;
use keyway::metrics::statistics::holm;

/// Holm's correction of those that are there.
pub(crate) fn holm_of(p_values: impl Iterator<Item = Option<f64>>) -> Vec<Option<f64>> {
    let p_values: Vec<Option<f64>> = p_values.collect();
    let there: Vec<f64> = p_values.iter().copied().flatten().collect();
    // Each is the probability that a test gave.
    let mut corrected = holm(&there).unwrap_or_default().into_iter();
    p_values.into_iter().map(|p| p.and_then(|_| corrected.next())).collect()
}

/// For people.
pub(crate) fn p_value(p: Option<f64>) -> String {
    if p.is_some_and(|p| p < 0.001) { "< 0.001".to_owned() } else { number(p, 3) }
}
