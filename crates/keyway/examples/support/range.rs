//! What many numbers say together, in a cell of a table.

/// The mean with this many decimals, and in brackets what 5 and 95 % of the values do not exceed, to whole
/// numbers: `12.44 (2 to 34)`.
pub(crate) fn mean_and_range(values: &[f64], decimals: usize) -> String {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let rank = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.max(1) - 1).copied().unwrap_or_default()
    };
    let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
    let (low, high) = (rounded(quantile(0.05)), rounded(quantile(0.95)));
    format!("{mean:.decimals$} ({low} to {high})")
}

/// To a whole number, without a sign where it is 0.
fn rounded(value: f64) -> f64 {
    value.round() + 0.0
}
