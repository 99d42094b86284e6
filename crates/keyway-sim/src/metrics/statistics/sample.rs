//! A sample and its summary.
//!
//! # Source
//! Quantiles follow definition 7 of \[Hyndman1996\], the default of R and `NumPy`.
//!
//! | paper | here |
//! |---|---|
//! | X(1) ≤ ... ≤ X(n) | [`Sample::values`] |
//! | p | the share of a quantile |
//! | (n - 1) p | the position of the quantile, from 0; interpolated between two positions |
//!
//! # Errors / cost
//! [`StatisticsError`] for no values, and for a value that is not a number. Values are sorted
//! once; everything else is at most linear.

use super::error::StatisticsError;
use serde::{Deserialize, Serialize};

/// Limit beyond which the sums of squares and cubes are meaningless.
const LARGEST: f64 = 1e90;

/// At least one value, all of them numbers, in ascending order, so that no result depends on the
/// order of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    sorted: Vec<f64>,
}

/// Summary of the values of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Square root of the sum of squared deviations over n - 1; `None` for a single value.
    pub standard_deviation: Option<f64>,
    /// Smallest value.
    pub min: f64,
    /// Quantile of 0.25.
    pub lower_quartile: f64,
    /// Quantile of 0.5: the mean of the two middle values if their number is even.
    pub median: f64,
    /// Quantile of 0.75.
    pub upper_quartile: f64,
    /// Largest value.
    pub max: f64,
}

impl Sample {
    /// Creates a sample of these values, in any order.
    ///
    /// # Errors
    /// Returns an error if there are no values, or one is not a number from -1e90 to 1e90.
    pub fn new(mut values: Vec<f64>) -> Result<Self, StatisticsError> {
        if values.is_empty() {
            return Err(StatisticsError::NoValues);
        }
        let is_sound = |value: &f64| (-LARGEST..=LARGEST).contains(value);
        if let Some(at) = values.iter().position(|value| !is_sound(value)) {
            return Err(StatisticsError::Value { number: at + 1, value: values[at] });
        }
        values.sort_by(f64::total_cmp);
        Ok(Self { sorted: values })
    }

    /// The values in ascending order.
    pub fn values(&self) -> &[f64] {
        &self.sorted
    }

    /// Sum of the values over their number.
    pub fn mean(&self) -> f64 {
        let mean = self.sorted.iter().sum::<f64>() / self.sorted.len() as f64;
        // Rounding may leave the range of the values: three times 0.1 is more than 0.3.
        mean.clamp(self.min(), self.max())
    }

    /// Square root of the sum of squared deviations over n - 1; `None` for a single value.
    pub fn standard_deviation(&self) -> Option<f64> {
        let (mean, count) = (self.mean(), self.sorted.len());
        let squares: f64 = self.sorted.iter().map(|value| (value - mean) * (value - mean)).sum();
        (count > 1).then(|| (squares / (count - 1) as f64).sqrt())
    }

    /// Returns the value that this share of the values does not exceed, interpolated between
    /// neighbours. The share is clamped to the interval from 0 to 1.
    pub fn quantile(&self, share: f64) -> f64 {
        let place = share.clamp(0.0, 1.0) * (self.sorted.len() - 1) as f64;
        let (below, part) = (place.floor() as usize, place.fract());
        let (low, high) = (self.sorted[below], self.sorted[self.sorted.len().min(below + 2) - 1]);
        // Equal values are not interpolated, to avoid rounding.
        if low == high { low } else { low + part * (high - low) }
    }

    /// Returns the complete summary.
    pub fn summary(&self) -> Summary {
        Summary {
            count: self.sorted.len(),
            mean: self.mean(),
            standard_deviation: self.standard_deviation(),
            min: self.min(),
            lower_quartile: self.quantile(0.25),
            median: self.quantile(0.5),
            upper_quartile: self.quantile(0.75),
            max: self.max(),
        }
    }

    fn min(&self) -> f64 {
        self.sorted[0]
    }

    fn max(&self) -> f64 {
        self.sorted[self.sorted.len() - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(values: &[f64]) -> Summary {
        Sample::new(values.to_vec()).unwrap().summary()
    }

    /// Examples of R's `quantile(x, type = 7)`: 1:10, and 2, 4, 4, 4, 5, 5, 7, 9, whose sum of
    /// squared deviations is 32.
    #[test]
    fn summaries_by_hand() {
        let tens = summary(&[3.0, 10.0, 1.0, 2.0, 9.0, 8.0, 4.0, 7.0, 5.0, 6.0]);
        assert_eq!((tens.count, tens.mean, tens.min, tens.max), (10, 5.5, 1.0, 10.0));
        assert_eq!((tens.lower_quartile, tens.median, tens.upper_quartile), (3.25, 5.5, 7.75));
        let deviation = tens.standard_deviation.unwrap();
        assert!((deviation * deviation - 82.5 / 9.0).abs() < 1e-12, "{deviation}");
        let eight = summary(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
        assert_eq!((eight.mean, eight.median, eight.upper_quartile), (5.0, 4.5, 5.5));
        assert!((eight.standard_deviation.unwrap() - (32f64 / 7.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn few_and_equal_values() {
        let one = summary(&[-2.5]);
        assert_eq!((one.mean, one.median, one.standard_deviation), (-2.5, -2.5, None));
        let two = Sample::new(vec![4.0, 1.0]).unwrap();
        assert_eq!((two.quantile(0.25), two.quantile(-1.0), two.quantile(2.0)), (1.75, 1.0, 4.0));
        let equal = summary(&[0.1; 3]);
        assert_eq!((equal.mean, equal.standard_deviation), (0.1, Some(0.0)));
    }

    #[test]
    fn no_result_depends_on_the_order() {
        let values = [0.1, 1e9, 0.7, -3.3, 1e-9, 0.3];
        let backwards: Vec<f64> = values.iter().rev().copied().collect();
        assert_eq!(summary(&values), summary(&backwards));
    }

    #[test]
    fn what_is_no_number_is_refused() {
        assert_eq!(Sample::new(Vec::new()), Err(StatisticsError::NoValues));
        for value in [f64::NAN, f64::INFINITY, -1e91] {
            let error = Sample::new(vec![1.0, value]).unwrap_err().to_string();
            assert!(error.starts_with("value 2 is ") && error.contains("-1e90 to 1e90"), "{error}");
        }
        let huge = summary(&[-1e90, 1e90, 1e90]);
        assert!(huge.standard_deviation.is_some_and(f64::is_finite), "{huge:?}");
    }
}
