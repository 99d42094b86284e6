//! Errors of a config: the field and the reason.

use crate::given::Given;
use thiserror::Error;

/// A value of a config that cannot be used. Every config is checked once, when the object that it
/// describes is created.
///
/// ```
/// use keyway::smooth::{KeyPointSmoothingConfig, SmootherConfig};
///
/// let config = KeyPointSmoothingConfig { safe_distance_m: -0.5, ..Default::default() };
/// let error = SmootherConfig::KeyPoints(config).build().unwrap_err().within("smoother");
/// assert_eq!(error.path, "smoother.safe_distance_m");
/// assert_eq!(error.to_string(), "smoother.safe_distance_m must be a number of at least 0, got -0.5");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{path} {reason}")]
#[non_exhaustive]
pub struct ConfigError {
    /// The field, as a path from the config that was checked: `weights.heading` of a local planner,
    /// `local.weights.heading` of a stack.
    pub path: String,
    /// Description of the error and the fix; continues the sentence after the path: `must be a
    /// positive number, got -1`.
    pub reason: String,
}

impl ConfigError {
    /// Creates an error for a field, with a reason that continues the sentence after its path.
    pub fn new(path: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { path: path.into(), reason: reason.into() }
    }

    /// Creates an error for a number that is not the expected one.
    pub fn must_be(path: impl Into<String>, expected: &str, given: f64) -> Self {
        Self::new(path, format!("must be {expected}, got {}", Given(given)))
    }

    /// The same error for a config in the field `parent` of a larger one.
    #[must_use]
    pub fn within(self, parent: &str) -> Self {
        Self { path: format!("{parent}.{}", self.path), ..self }
    }

    /// Rejects a value that is not a positive number.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] with the path if it is not.
    pub fn unless_positive(path: &str, value: f64) -> Result<(), Self> {
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self::must_be(path, if value > 0.0 { "finite" } else { "a positive number" }, value))
    }

    /// Rejects a value that is not a number of at least 0.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] with the path if it is not.
    pub fn unless_not_negative(path: &str, value: f64) -> Result<(), Self> {
        if value >= 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self::must_be(
            path,
            if value > 0.0 { "finite" } else { "a number of at least 0" },
            value,
        ))
    }

    /// Rejects a range that does not consist of two positive numbers in ascending order.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] with the path if it does not.
    pub fn unless_range(path: &str, [low, high]: [f64; 2]) -> Result<(), Self> {
        Self::unless_positive(&format!("{path}[0]"), low)?;
        Self::unless_positive(&format!("{path}[1]"), high)?;
        Self::unless_ordered(path, [low, high])
    }

    /// Rejects bounds of which the first is higher.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] with the path if it is.
    pub fn unless_ordered(path: &str, [low, high]: [f64; 2]) -> Result<(), Self> {
        if low <= high {
            return Ok(());
        }
        let expected = format!("at least the first one, {low}");
        Err(Self::must_be(format!("{path}[1]"), &expected, high))
    }

    /// Rejects a value that is no weight of a sum: only the proportions of weights matter, and
    /// beyond this limit sums lose their digits and finally overflow.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] with the path if it is none.
    pub(crate) fn unless_weight(path: &str, value: f64) -> Result<(), Self> {
        if (0.0..=1e9).contains(&value) {
            return Ok(());
        }
        Err(Self::must_be(path, "a number of at least 0 and at most 1000000000", value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_cannot_be_used_are_refused_with_their_path() {
        for value in [f64::NAN, f64::INFINITY, -1e308] {
            for check in [ConfigError::unless_positive, ConfigError::unless_not_negative] {
                let error = check("horizon_s", value).unwrap_err().within("local").within("stack");
                assert_eq!(error.path, "stack.local.horizon_s");
                let expected = if value > 0.0 { "finite" } else { "a " };
                let start = format!("stack.local.horizon_s must be {expected}");
                assert!(error.to_string().starts_with(&start));
                assert!(error.to_string().ends_with(&format!(", got {}", Given(value))));
            }
        }
        assert_eq!(ConfigError::unless_not_negative("radius_m", 0.0), Ok(()));
        let weight = |value| ConfigError::unless_weight("weights.speed", value);
        assert_eq!((weight(0.0), weight(1e9)), (Ok(()), Ok(())));
        for value in [-0.1, 1.1e9, f64::NAN, f64::INFINITY] {
            let text = weight(value).unwrap_err().to_string();
            assert!(
                text.starts_with("weights.speed must be a number of at least 0 and at most"),
                "{text}"
            );
        }
        assert!(ConfigError::unless_positive("radius_m", 0.0).is_err());
        assert_eq!(ConfigError::unless_positive("radius_m", f64::MIN_POSITIVE), Ok(()));
    }
}
