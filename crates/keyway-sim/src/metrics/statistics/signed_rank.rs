//! Wilcoxon's signed-rank test \[Wilcoxon1945\]: tests which of two methods gives larger values
//! on the same tasks.
//!
//! # Source
//! \[Wilcoxon1945\], with the zeros of \[Pratt1959\] and the effect size of \[Kerby2014\].
//!
//! | source | here |
//! |---|---|
//! | d(i) | differences, first minus second |
//! | rank of \|d(i)\| | from 1; ties: mean rank; zeros are ranked, then dropped \[Pratt1959\] |
//! | T+, T- | [`SignedRankTest::positive_rank_sum`], [`SignedRankTest::negative_rank_sum`] |
//! | r = (T+ - T-) / (T+ + T-) | [`SignedRankTest::rank_biserial`] |
//!
//! # Pratt's zeros
//! Wilcoxon drops zeros before ranking. A result may then become *more* significant when a value
//! moves against it \[Pratt1959\]. Methods that often agree, such as planners on easy tasks, give
//! many zeros.
//!
//! # Exact and approximate p
//! With up to 50 differences other than 0, p is exact, also with ties and zeros: see
//! [`RankSums`]. Beyond that, T+ is approximated as normal, with the mean and the variance of the
//! ranks themselves: half of their sum, and a quarter of the sum of their squares. This includes
//! the usual corrections for ties and zeros; half a rank is the continuity correction.
//!
//! # Errors / cost
//! A sample is never empty, so nothing fails. Sorts the differences; for the cost of the
//! interval, see `walsh.rs`.

use super::confidence::{Confidence, Interval};
use super::normal;
use super::rank_sums::RankSums;
use super::sample::Sample;
use super::walsh::{EXACT_RANKS, WalshAverages};
use serde::{Deserialize, Serialize};

/// Comparison of the values of two methods on the same tasks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignedRankTest {
    /// Number of differences.
    pub pairs: usize,
    /// Number of differences that are 0.
    pub zeros: usize,
    /// Sum of the ranks of the positive differences.
    pub positive_rank_sum: f64,
    /// Sum of the ranks of the negative differences.
    pub negative_rank_sum: f64,
    /// Probability of rank sums at least as different, in either direction, if positive and
    /// negative differences were equally likely.
    pub p_value: f64,
    /// True if p is exact, not approximated by a normal distribution.
    pub is_exact: bool,
    /// Effect size from -1, all differences negative, to 1, all positive; 0 if all are 0.
    pub rank_biserial: f64,
    /// Median of the means of all pairs of differences \[Hodges1963\].
    pub median_difference: f64,
    /// Interval of the median difference; `None` if there are too few pairs for this confidence.
    pub median_difference_interval: Option<Interval>,
}

impl SignedRankTest {
    /// Compares two methods by their differences, first minus second. Sizes that differ only by
    /// rounding are not ties, so round the differences first if that matters.
    pub fn of_differences(differences: &Sample, confidence: Confidence) -> Self {
        let ranks = Ranks::of(differences.values());
        let total = ranks.positive + ranks.negative;
        let is_exact = ranks.doubled.len() <= EXACT_RANKS;
        let difference = ranks.positive as f64 - ranks.negative as f64;
        let walsh = WalshAverages::of(differences);
        Self {
            pairs: differences.values().len(),
            zeros: differences.values().len() - ranks.doubled.len(),
            positive_rank_sum: 0.5 * ranks.positive as f64,
            negative_rank_sum: 0.5 * ranks.negative as f64,
            p_value: if is_exact { ranks.exact_p() } else { ranks.normal_p() },
            is_exact,
            rank_biserial: if total == 0 { 0.0 } else { difference / total as f64 },
            median_difference: walsh.median(),
            median_difference_interval: walsh.interval(confidence),
        }
    }
}

/// Doubled ranks of the differences that are not 0.
struct Ranks {
    doubled: Vec<u64>,
    /// Sum of the ranks of positive differences.
    positive: u64,
    /// Sum of the ranks of negative differences.
    negative: u64,
}

impl Ranks {
    fn of(differences: &[f64]) -> Self {
        let mut by_size = differences.to_vec();
        by_size.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let mut ranks = Self { doubled: Vec::new(), positive: 0, negative: 0 };
        let mut before = 0;
        for ties in by_size.chunk_by(|a, b| a.abs() == b.abs()) {
            // Mean of the ranks before + 1 to before + ties, doubled.
            let rank = (2 * before + 1 + ties.len()) as u64;
            before += ties.len();
            for difference in ties.iter().filter(|difference| **difference != 0.0) {
                ranks.doubled.push(rank);
                *(if *difference > 0.0 { &mut ranks.positive } else { &mut ranks.negative }) +=
                    rank;
            }
        }
        ranks
    }

    fn exact_p(&self) -> f64 {
        // The distribution is symmetric.
        let sums = RankSums::of(self.doubled.iter().copied());
        (2.0 * sums.at_most(self.positive.min(self.negative))).min(1.0)
    }

    fn normal_p(&self) -> f64 {
        let square = |&rank: &u64| rank as f64 * rank as f64;
        let variance = self.doubled.iter().map(square).sum::<f64>() / 4.0;
        let distance = 0.5 * self.positive.abs_diff(self.negative) as f64;
        // Half a rank, doubled like all ranks.
        let z = (distance - 1.0).max(0.0) / variance.sqrt();
        (2.0 * normal::probability_below(-z)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn test_of(differences: &[f64]) -> SignedRankTest {
        let sample = Sample::new(differences.to_vec()).unwrap();
        SignedRankTest::of_differences(&sample, Confidence::USUAL)
    }

    /// Darwin's pairs of plants, in eighths of an inch: only subsets of the ranks 1 to 15 with a
    /// sum of at most 24 are at least as extreme, 676 of 32,768. R's `wilcox.test` gives V = 96 and
    /// p = 0.04126.
    #[test]
    fn darwins_plants() {
        let eighths = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48];
        let test = test_of(&eighths.map(f64::from));
        assert_eq!((test.pairs, test.zeros, test.is_exact), (15, 0, true));
        assert_eq!((test.positive_rank_sum, test.negative_rank_sum), (96.0, 24.0));
        assert_eq!(test.p_value, 2.0 * 676.0 / 32_768.0);
        assert_eq!(test.rank_biserial, 0.6);
    }

    /// The depression scores of \[Hollander1999\], table 3.1: T+ is 5 for second minus first, the
    /// estimate -0.46 and the interval of 96 % -0.786 to -0.010.
    #[test]
    fn depression_scores() {
        let first = [1830, 500, 1620, 2480, 1680, 1880, 1550, 3060, 1300];
        let second = [878, 647, 598, 2050, 1060, 1290, 1060, 3140, 1290];
        let differences: Vec<f64> =
            second.iter().zip(first).map(|(y, x)| f64::from(y - x) / 1000.0).collect();
        let test = test_of(&differences);
        assert_eq!((test.positive_rank_sum, test.p_value), (5.0, 0.039_062_5));
        assert!((test.median_difference + 0.46).abs() < 1e-12, "{test:?}");
        let interval = test.median_difference_interval.unwrap();
        assert!((interval.low + 0.786).abs() < 1e-3, "{test:?}");
        assert!((interval.high + 0.010).abs() < 1e-3, "{test:?}");
    }

    /// The zeros have the ranks 1.5 and 1.5 and are left out; the others have 3.5, 3.5 and 5.
    #[test]
    fn zeros_are_ranked_and_left_out() {
        let test = test_of(&[0.0, 1.0, -1.0, 3.0, -0.0]);
        assert_eq!((test.pairs, test.zeros), (5, 2));
        assert_eq!((test.positive_rank_sum, test.negative_rank_sum), (8.5, 3.5));
        // Three of the eight sums are at most 3.5: 0, 3.5, 3.5.
        assert_eq!(test.p_value, 0.75);
    }

    #[test]
    fn nothing_differs() {
        for count in [1, 7, 60] {
            let test = test_of(&vec![0.0; count]);
            assert_eq!((test.zeros, test.p_value, test.rank_biserial), (count, 1.0, 0.0));
            assert_eq!(test.median_difference, 0.0);
        }
        assert_eq!(test_of(&[2.0]).p_value, 1.0);
        assert_eq!(test_of(&[2.0]).median_difference_interval, None);
    }

    /// Variance as in textbooks: n (n + 1) (2 n + 1) / 24, minus zeros, minus the sum of t³ - t
    /// over 48.
    #[test]
    fn many_pairs_with_zeros_and_ties() {
        let differences: Vec<f64> = (0..120).map(|i| f64::from((i * 37 % 23) - 10) / 2.0).collect();
        let test = test_of(&differences);
        assert!(!test.is_exact && test.zeros > 0, "{test:?}");
        let whole = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0);
        let (n, zeros) = (120.0, test.zeros as f64);
        let mean = (n * (n + 1.0) - zeros * (zeros + 1.0)) / 4.0;
        let ties = (1..40).map(|size| {
            let t = differences.iter().filter(|d| d.abs() == f64::from(size) / 2.0).count() as f64;
            t * t * t - t
        });
        let variance = (whole(n) - whole(zeros)) / 24.0 - ties.sum::<f64>() / 48.0;
        let z = ((test.positive_rank_sum - mean).abs() - 0.5) / variance.sqrt();
        let expected = 2.0 * normal::probability_below(-z);
        assert!((test.p_value / expected - 1.0).abs() < 1e-12, "{test:?} {expected}");
        assert!(expected > 1e-3 && expected < 0.9, "{expected}");
    }

    /// The exact and the normal result agree where both are available.
    #[test]
    fn exact_and_normal() {
        for shift in [4.0, 6.0, 9.0] {
            let differences: Vec<f64> =
                (0..50).map(|i| f64::from((i * 29 % 50) - 25) + shift).collect();
            let ranks = Ranks::of(&differences);
            let (exact, normal) = (ranks.exact_p(), ranks.normal_p());
            assert!((exact - normal).abs() < 2e-3 && exact < 0.5, "{shift}: {exact} {normal}");
        }
    }

    #[test]
    fn as_json() {
        let text = serde_json::to_string(&test_of(&[1.0, 2.5, -3.0])).unwrap();
        let again: SignedRankTest = serde_json::from_str(&text).unwrap();
        assert_eq!(again, test_of(&[1.0, 2.5, -3.0]));
    }

    fn differences() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec((-5i32..6).prop_map(f64::from), 1..11)
    }

    proptest! {
        /// All choices of signs, with zeros and ties.
        #[test]
        fn all_signs(differences in differences()) {
            let test = test_of(&differences);
            let sums = |differences: &[f64]| {
                let ranks = Ranks::of(differences);
                ranks.positive.abs_diff(ranks.negative)
            };
            let sizes: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
            let all = 1u32 << sizes.len();
            let zeros = differences.iter().copied().filter(|d| *d == 0.0);
            let as_far = (0..all).filter(|signs| {
                let signed = sizes.iter().enumerate().map(|(i, size)| {
                    if signs >> i & 1 == 1 { size.abs() } else { -size.abs() }
                });
                let signed: Vec<f64> = signed.chain(zeros.clone()).collect();
                sums(&signed) >= sums(&differences)
            });
            let expected = as_far.count() as f64 / f64::from(all);
            prop_assert!((test.p_value - expected).abs() < 1e-12, "{test:?} {expected}");
        }

        /// The mirrored differences.
        #[test]
        fn mirrored(differences in differences()) {
            let (test, mirror) = (
                test_of(&differences),
                test_of(&differences.iter().map(|d| -d).collect::<Vec<_>>()),
            );
            prop_assert_eq!(test.p_value, mirror.p_value);
            prop_assert_eq!(test.rank_biserial, -mirror.rank_biserial);
            prop_assert_eq!(test.median_difference, -mirror.median_difference);
        }

        /// The interval contains the shifts that the test does not reject. Sums of powers of 2 are
        /// all different.
        #[test]
        fn the_interval_inverts_the_test(order in Just((0..9).collect::<Vec<i32>>()).prop_shuffle(),
                                         signs in 0u32..512) {
            let values: Vec<f64> = order.iter().enumerate().map(|(i, &power)| {
                2f64.powi(power) * if signs >> i & 1 == 1 { 1.0 } else { -1.0 }
            }).collect();
            let p_of = |shift: f64| {
                test_of(&values.iter().map(|value| value - shift).collect::<Vec<_>>()).p_value
            };
            let interval = test_of(&values).median_difference_interval.unwrap();
            let near = 1e-6;
            prop_assert!(p_of(interval.low - near) <= 0.05 && p_of(interval.low + near) > 0.05);
            prop_assert!(p_of(interval.high + near) <= 0.05 && p_of(interval.high - near) > 0.05);
        }
    }
}
