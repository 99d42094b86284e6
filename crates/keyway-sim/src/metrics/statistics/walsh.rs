//! Median difference of pairs, with its interval \[Hodges1963\].
//!
//! # Source
//! \[Hodges1963\]; the interval is from \[Hollander1999\], section 3.3. Walsh averages are the
//! means of all pairs of differences, including each difference with itself. Their median
//! estimates the shift between two methods. The number of averages above a value is the sum of
//! the positive ranks after that value is subtracted from the differences. So the interval
//! contains the shifts that a signed-rank test does not reject.
//!
//! | source | here |
//! |---|---|
//! | W(1) ≤ ... ≤ W(M), M = n (n + 1) / 2 | [`WalshAverages::nth`], from 1 |
//! | T+ | a sum of the ranks 1 to n, see [`RankSums`] |
//! | C(α) | the largest c with P(T+ ≤ c - 1) ≤ α / 2; the interval is W(c) to W(M + 1 - c) |
//!
//! # Difference from the source
//! Differences may be equal and may be 0. The interval is then wider than necessary, never too
//! narrow.
//!
//! # Errors / cost
//! `None` if even the widest interval has less than the requested confidence: 95 % needs 6
//! differences. An average is found by bisection in at most 64 n steps, without a list of
//! averages.

use super::confidence::{Confidence, Interval};
use super::rank_sums::RankSums;
use super::sample::Sample;

/// Number of ranks beyond which their sums are approximated as normal.
pub(super) const EXACT_RANKS: usize = 50;

/// Means of all pairs of values of a sample.
pub(super) struct WalshAverages<'a> {
    /// The values in ascending order.
    values: &'a [f64],
}

impl<'a> WalshAverages<'a> {
    pub(super) fn of(sample: &'a Sample) -> Self {
        Self { values: sample.values() }
    }

    /// Returns the estimate of \[Hodges1963\].
    pub(super) fn median(&self) -> f64 {
        let count = self.count();
        let (low, high) = (self.nth(count.div_ceil(2)), self.nth(count / 2 + 1));
        if low == high { low } else { 0.5 * (low + high) }
    }

    /// Returns the interval of the true median difference.
    pub(super) fn interval(&self, confidence: Confidence) -> Option<Interval> {
        let first = self.first_inside(confidence)?;
        let last = self.count() + 1 - first;
        Some(Interval { low: self.nth(first), high: self.nth(last), confidence })
    }

    /// Returns the index of the average at the interval's lower end.
    fn first_inside(&self, confidence: Confidence) -> Option<u64> {
        let n = self.values.len();
        let inside = if n <= EXACT_RANKS {
            let sums = RankSums::of((1..=n as u64).map(|rank| 2 * rank));
            let is_outside = |below: &u64| sums.at_most(2 * below) <= confidence.tail();
            (0..=self.count()).take_while(is_outside).count() as u64
        } else {
            let n = n as f64;
            let (mean, variance) = (n * (n + 1.0) / 4.0, n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
            // The 0.5 is the continuity correction for integer sums.
            (mean - confidence.normal_quantile() * variance.sqrt() + 0.5).max(0.0) as u64
        };
        (inside > 0).then_some(inside)
    }

    /// Number of averages, M.
    fn count(&self) -> u64 {
        let n = self.values.len() as u64;
        n * (n + 1) / 2
    }

    /// Returns the n-th smallest average, from 1.
    fn nth(&self, number: u64) -> f64 {
        let bound = |value: Option<&f64>| place(value.copied().unwrap_or_default());
        let (mut low, mut high) = (bound(self.values.first()), bound(self.values.last()));
        while low < high {
            let middle = low + (high - low) / 2;
            if self.at_most(value_at(middle)) >= number { high = middle } else { low = middle + 1 }
        }
        // Drops the sign of a zero.
        value_at(low) + 0.0
    }

    /// Returns the number of averages up to this limit.
    fn at_most(&self, limit: f64) -> u64 {
        let (mut end, mut count) = (self.values.len(), 0);
        for (i, low) in self.values.iter().enumerate() {
            // The larger this value is, the fewer others are below the limit.
            while end > i && 0.5 * (low + self.values[end - 1]) > limit {
                end -= 1;
            }
            count += end.saturating_sub(i) as u64;
        }
        count
    }
}

/// Position of a number in the order of all floating point numbers: neighbours have consecutive
/// positions.
const fn place(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// Returns the number at a position.
const fn value_at(place: u64) -> f64 {
    f64::from_bits(if place >> 63 == 1 { place & !(1 << 63) } else { !place })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sample(values: &[f64]) -> Sample {
        Sample::new(values.to_vec()).unwrap()
    }

    fn interval(values: &[f64], confidence: f64) -> Option<[f64; 2]> {
        let confidence = Confidence::new(confidence).unwrap();
        let interval = WalshAverages::of(&sample(values)).interval(confidence);
        interval.map(|interval| [interval.low, interval.high])
    }

    #[test]
    fn few_differences() {
        let six = [1.0, 2.0, 3.0, 5.0, 8.0, 13.0];
        // P(T+ = 0) is 1/64, P(T+ <= 1) is 2/64.
        assert_eq!(interval(&six, 0.95), Some([1.0, 13.0]));
        assert_eq!(interval(&six, 0.93), Some([1.5, 10.5]));
        assert_eq!(interval(&six[..5], 0.95), None);
        assert_eq!(interval(&six[..1], 0.95), None);
        assert_eq!(interval(&[0.0; 9], 0.95), Some([0.0, 0.0]));
        // At a confidence near 0, the limits are next to the middle one of 21 averages.
        assert_eq!(interval(&six, 1e-9), Some([4.5, 5.0]));
    }

    /// The index of the lower limit grows smoothly at the change from exact sums to normal ones.
    #[test]
    fn many_differences() {
        let first = |n: u32| {
            let values: Vec<f64> = (0..n).map(f64::from).collect();
            let sample = sample(&values);
            WalshAverages::of(&sample).first_inside(Confidence::USUAL).unwrap()
        };
        // The critical value of 50 is 434.
        assert_eq!(first(50), 435);
        // From the sums of 51 ranks.
        let sums = RankSums::of((1..=51).map(|rank| 2 * rank));
        let exact = (0..700).take_while(|below| sums.at_most(2 * below) <= 0.025).count() as u64;
        assert!(first(51).abs_diff(exact) <= 1, "{} {exact}", first(51));
    }

    proptest! {
        #[test]
        fn all_averages(values in prop::collection::vec(-40i32..40, 1..12), scale in -3..3) {
            let values: Vec<f64> =
                values.into_iter().map(|value| f64::from(value) * 10f64.powi(scale)).collect();
            let sample = sample(&values);
            let walsh = WalshAverages::of(&sample);
            let sorted = sample.values();
            let mut all: Vec<f64> = (0..sorted.len())
                .flat_map(|i| (i..sorted.len()).map(move |j| 0.5 * (sorted[i] + sorted[j])))
                .collect();
            all.sort_by(f64::total_cmp);
            prop_assert_eq!(walsh.count(), all.len() as u64);
            for (i, average) in all.iter().enumerate() {
                prop_assert_eq!(walsh.nth(i as u64 + 1), *average);
            }
            // As for the medians of summaries.
            let middle = Sample::new(all).unwrap().quantile(0.5);
            prop_assert!((walsh.median() - middle).abs() < 1e-12);
        }
    }
}
