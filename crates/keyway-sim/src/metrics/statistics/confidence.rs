//! Confidence of an interval.

use super::error::StatisticsError;
use super::normal;
use serde::{Deserialize, Serialize};

/// Share of samples whose interval contains the true value; above 0 and below 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Confidence(f64);

/// Confidence interval of a true value, both limits included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower limit.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
    /// Confidence of the interval.
    pub confidence: Confidence,
}

impl Confidence {
    /// The usual 95 %.
    pub const USUAL: Self = Self(0.95);

    /// Creates a confidence from a share.
    ///
    /// # Errors
    /// Returns an error if the share is not above 0 and below 1.
    pub fn new(share: f64) -> Result<Self, StatisticsError> {
        let is_sound = share > 0.0 && share < 1.0;
        if is_sound { Ok(Self(share)) } else { Err(StatisticsError::Confidence(share)) }
    }

    /// Returns the confidence as a share.
    pub const fn share(self) -> f64 {
        self.0
    }

    /// Returns the probability on each side of an interval.
    pub(super) fn tail(self) -> f64 {
        0.5 * (1.0 - self.0)
    }

    /// Half width of an interval of the normal distribution, in standard deviations.
    pub(super) fn normal_quantile(self) -> f64 {
        -normal::quantile(self.tail())
    }
}

impl Default for Confidence {
    fn default() -> Self {
        Self::USUAL
    }
}

impl TryFrom<f64> for Confidence {
    type Error = StatisticsError;

    fn try_from(share: f64) -> Result<Self, Self::Error> {
        Self::new(share)
    }
}

impl From<Confidence> for f64 {
    fn from(confidence: Confidence) -> Self {
        confidence.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_that_are_none_are_refused() {
        for share in [0.0, 1.0, -0.5, 95.0, f64::NAN] {
            let error = Confidence::new(share).unwrap_err().to_string();
            assert!(error.contains("above 0 and below 1, such as 0.95"), "{error}");
        }
        assert!(serde_json::from_str::<Confidence>("95").is_err());
    }

    #[test]
    fn as_json() {
        let interval = Interval { low: -1.0, high: 2.5, confidence: Confidence::default() };
        let text = serde_json::to_string(&interval).unwrap();
        assert_eq!(text, r#"{"low":-1.0,"high":2.5,"confidence":0.95}"#);
        assert_eq!(serde_json::from_str::<Interval>(&text).unwrap(), interval);
    }

    #[test]
    fn ninety_five_per_cent() {
        assert!((Confidence::USUAL.normal_quantile() - 1.959_963_984_540_054).abs() < 1e-14);
    }
}
