//! Holm's correction for several tests \[Holm1979\].
//!
//! # Source
//! \[Holm1979\]: of m tests, the one with the smallest p is judged as one of m, the next as one
//! of m - 1, and so on until one is not significant. The returned values are to be compared with
//! the usual level.
//!
//! | paper | here |
//! |---|---|
//! | P(1) ≤ ... ≤ P(n) | the p-values in ascending order |
//! | α / (n - k + 1) | level of P(k); here (n - k + 1) P(k), made monotonic, is compared with α |
//!
//! # Errors / cost
//! [`StatisticsError`] for a value that is not a probability. Sorts the p-values.

use super::error::StatisticsError;

/// Returns the corrected p-values of tests that are judged together, in the given order. The
/// probability of any false rejection among them stays below the level that they are compared
/// with.
///
/// ```
/// use keyway_sim::metrics::statistics::holm;
///
/// assert_eq!(holm(&[0.25, 0.01, 0.02])?, [0.25, 0.03, 0.04]);
/// # Ok::<(), keyway_sim::metrics::statistics::StatisticsError>(())
/// ```
///
/// # Errors
/// Returns an error if a value is not from 0 to 1.
pub fn holm(p_values: &[f64]) -> Result<Vec<f64>, StatisticsError> {
    let is_sound = |p: &f64| (0.0..=1.0).contains(p);
    if let Some(at) = p_values.iter().position(|p| !is_sound(p)) {
        return Err(StatisticsError::PValue { number: at + 1, value: p_values[at] });
    }
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![0.0; p_values.len()];
    let mut largest = 0.0_f64;
    for (smaller, &i) in order.iter().enumerate() {
        largest = largest.max((p_values.len() - smaller) as f64 * p_values[i]).min(1.0);
        corrected[i] = largest;
    }
    Ok(corrected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values of R's `p.adjust(p, "holm")`.
    #[test]
    fn by_hand() {
        let near = |p: &[f64], expected: &[f64]| {
            let corrected = holm(p).unwrap();
            let is_near = corrected.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(is_near && corrected.len() == expected.len(), "{corrected:?}");
        };
        near(&[0.01, 0.02, 0.03, 0.04, 0.05], &[0.05, 0.08, 0.09, 0.09, 0.09]);
        near(&[0.6, 0.01, 0.5], &[1.0, 0.03, 1.0]);
        near(&[0.04], &[0.04]);
        near(&[], &[]);
    }

    #[test]
    fn what_is_no_probability_is_refused() {
        for value in [-0.1, 1.1, f64::NAN] {
            let error = holm(&[0.5, value]).unwrap_err().to_string();
            assert!(error.starts_with("p-value 2 is "), "{error}");
        }
    }

    proptest! {
        /// The closure principle: a test is significant if every set of tests that contains it is
        /// significant by Bonferroni's inequality.
        #[test]
        fn the_closure_of_bonferronis_tests(
            p_values in prop::collection::vec((0u32..=40).prop_map(|p| f64::from(p) / 40.0), 0..7),
        ) {
            let corrected = holm(&p_values).unwrap();
            for (i, corrected) in corrected.into_iter().enumerate() {
                let sets = (0u32..1 << p_values.len()).filter(|set| set >> i & 1 == 1);
                let of_set = |set: u32| {
                    let members = p_values.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1);
                    let least = members.map(|(_, p)| *p).fold(1.0, f64::min);
                    (f64::from(set.count_ones()) * least).min(1.0)
                };
                let expected = sets.map(of_set).fold(0.0, f64::max);
                prop_assert!((corrected - expected).abs() < 1e-12, "{corrected} {expected}");
            }
        }
    }
}
