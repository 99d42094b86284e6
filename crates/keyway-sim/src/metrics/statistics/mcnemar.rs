//! McNemar's exact test \[McNemar1947\]: tests which of two methods succeeds more often on the
//! same tasks.
//!
//! # Source
//! \[McNemar1947\]. Only pairs in which exactly one method succeeds show a difference. If neither
//! method is better, each of these pairs is as likely to favour the first method as the second,
//! so the number for one method is binomial. The paper approximates it by a chi-squared
//! distribution; here it is exact.
//!
//! | paper | here |
//! |---|---|
//! | A, D | [`McNemarTest::only_first`], [`McNemarTest::only_second`] |
//! | B, C | [`McNemarTest::both`], [`McNemarTest::neither`] |
//! | p | 2 P(X ≤ min(A, D)) for X ~ Binomial(A + D, 1/2), at most 1 |
//!
//! # Errors / cost
//! Without pairs there is no difference, and p is 1. At most as many operations as there are pairs.

use serde::{Deserialize, Serialize};
use std::f64::consts::LN_2;

/// Comparison of successes and failures of two methods on the same tasks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct McNemarTest {
    /// Tasks in which both succeeded.
    pub both: u64,
    /// Tasks in which only the first method succeeded.
    pub only_first: u64,
    /// Tasks in which only the second method succeeded.
    pub only_second: u64,
    /// Tasks in which neither method succeeded.
    pub neither: u64,
    /// Success rate of the first method minus that of the second; `None` without pairs.
    pub rate_difference: Option<f64>,
    /// Probability of a difference at least as large, in either direction, if both methods were
    /// equally good.
    pub p_value: f64,
}

impl McNemarTest {
    /// Compares outcomes: for each task, true for each method that succeeded.
    pub fn of_pairs(pairs: impl IntoIterator<Item = [bool; 2]>) -> Self {
        let [mut both, mut only_first, mut only_second, mut neither] = [0; 4];
        for pair in pairs {
            match pair {
                [true, true] => both += 1,
                [true, false] => only_first += 1,
                [false, true] => only_second += 1,
                [false, false] => neither += 1,
            }
        }
        let count = both + only_first + only_second + neither;
        let difference = || (only_first as f64 - only_second as f64) / count as f64;
        Self {
            both,
            only_first,
            only_second,
            neither,
            rate_difference: (count > 0).then(difference),
            p_value: two_sided(only_first, only_second),
        }
    }
}

/// Twice the probability of at most this many heads in tosses of a fair coin.
fn two_sided(heads: u64, tails: u64) -> f64 {
    let (few, tosses) = (heads.min(tails) as f64, heads as f64 + tails as f64);
    // The last term, and the earlier ones by their ratios.
    let log_choices =
        libm::lgamma(tosses + 1.0) - libm::lgamma(few + 1.0) - libm::lgamma(tosses - few + 1.0);
    let mut term = libm::exp(log_choices - tosses * LN_2);
    let (mut sum, mut heads) = (term, few);
    while heads > 0.0 && term > 0.0 {
        term *= heads / (tosses - heads + 1.0);
        heads -= 1.0;
        sum += term;
    }
    (2.0 * sum).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(counts: [usize; 4]) -> McNemarTest {
        let kinds = [[true, true], [true, false], [false, true], [false, false]];
        let repeated = kinds.iter().zip(counts);
        McNemarTest::of_pairs(repeated.flat_map(|(&kind, count)| std::iter::repeat_n(kind, count)))
    }

    #[test]
    fn by_hand() {
        // 2 (1 + 14 + 91) / 2^14.
        let test = pairs([20, 12, 2, 6]);
        assert_eq!((test.both, test.only_first, test.only_second, test.neither), (20, 12, 2, 6));
        assert_eq!(test.rate_difference, Some(0.25));
        assert!((test.p_value - 212.0 / 16_384.0).abs() < 1e-15, "{test:?}");
        // 2 / 2^5.
        assert!((pairs([0, 0, 5, 3]).p_value - 0.0625).abs() < 1e-15);
        assert_eq!(pairs([0, 0, 5, 3]).rate_difference, Some(-0.625));
    }

    #[test]
    fn nothing_that_differs() {
        assert_eq!((pairs([0; 4]).p_value, pairs([0; 4]).rate_difference), (1.0, None));
        assert_eq!(
            (pairs([9, 0, 0, 4]).p_value, pairs([9, 0, 0, 4]).rate_difference),
            (1.0, Some(0.0))
        );
        assert_eq!(pairs([1, 7, 7, 0]).p_value, 1.0);
    }

    /// All possible outcomes of the pairs that differ.
    #[test]
    fn all_outcomes_of_up_to_twelve_pairs() {
        for tosses in 0u32..=12 {
            for heads in 0..=tosses {
                let distance = |heads: u32| heads.abs_diff(tosses - heads);
                let as_far = (0u32..1 << tosses)
                    .filter(|toss| distance(toss.count_ones()) >= distance(heads));
                let expected = as_far.count() as f64 / f64::from(1u32 << tosses);
                let test = pairs([3, heads as usize, (tosses - heads) as usize, 1]);
                assert!((test.p_value - expected).abs() < 1e-13, "{heads} of {tosses}: {test:?}");
            }
        }
    }

    /// Sums of binomial coefficients in integers.
    #[test]
    fn exact_sums_of_a_hundred_pairs() {
        let (tosses, mut choices, mut sum) = (100u64, 1u128, 0u128);
        for heads in 0..50 {
            sum += choices;
            let expected = 2.0 * sum as f64 / 2f64.powi(100);
            let p = two_sided(tosses - heads, heads);
            assert!((p / expected - 1.0).abs() < 1e-11, "{heads}: {p} {expected}");
            choices = choices * u128::from(tosses - heads) / u128::from(heads + 1);
        }
    }

    /// The normal distribution with a continuity correction, for many pairs.
    #[test]
    fn many_pairs() {
        let p = two_sided(500_500, 499_500);
        let normal = 2.0 * super::super::normal::probability_below(-(500.0 - 0.5) / 500.0);
        assert!((p / normal - 1.0).abs() < 1e-4, "{p} {normal}");
        assert_eq!(two_sided(1_000_000, 0), 0.0);
    }
}
