//! The standard normal distribution.
//!
//! # Errors / cost
//! The quantile of a share of 0 or less is minus infinity, and that of a share of 1 or more is
//! infinity. A quantile costs about a hundred evaluations of the error function.

use std::f64::consts::FRAC_1_SQRT_2;

/// Returns the probability of a value up to `z`, accurate in the lower tail, too.
pub(super) fn probability_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Returns the value that is not exceeded with this probability, by bisection.
pub(super) fn quantile(share: f64) -> f64 {
    if share <= 0.0 {
        return f64::NEG_INFINITY;
    }
    if share > 0.5 {
        // The lower tail is accurate; from 0.5 on, the difference is exact.
        return -quantile(1.0 - share);
    }
    // Below -40 no probability is above 0.
    let (mut low, mut high) = (-40.0, 0.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if probability_below(middle) < share { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tabulated quantiles, such as those in the test data of algorithm AS 241.
    #[test]
    fn published_values() {
        for (share, z) in [
            (0.975, 1.959_963_984_540_054),
            (0.95, 1.644_853_626_951_472_2),
            (0.995, 2.575_829_303_548_900_4),
            (0.25, -0.674_489_750_196_081_7),
            (0.001, -3.090_232_306_167_813_5),
            (1e-20, -9.262_340_089_798_408),
        ] {
            assert!((quantile(share) - z).abs() < 1e-13 * z.abs(), "{share}: {}", quantile(share));
        }
        assert!(quantile(0.5).abs() < 1e-15);
        assert_eq!((quantile(0.0), quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
    }

    /// The integral of the density, by Simpson's rule.
    #[test]
    fn the_integral_of_the_density() {
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        for z in [-2.5, -1.0, 0.3, 1.7] {
            let (parts, width) = (2000, (z + 12.0) / 2000.0);
            let weight = |i: i32| match i {
                0 => 1.0,
                i if i == parts => 1.0,
                i => f64::from(2 + 2 * (i % 2)),
            };
            let sum: f64 =
                (0..=parts).map(|i| weight(i) * density(-12.0 + width * f64::from(i))).sum();
            assert!((probability_below(z) - sum * width / 3.0).abs() < 1e-9, "{z}");
        }
    }

    #[test]
    fn there_and_back() {
        for i in 1..1000 {
            let share = f64::from(i) / 1000.0;
            assert!((probability_below(quantile(share)) - share).abs() < 1e-15, "{share}");
        }
    }
}
