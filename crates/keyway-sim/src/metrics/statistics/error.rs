//! Errors of the statistics.

use keyway::given::Given;
use thiserror::Error;

/// Error in input values.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StatisticsError {
    /// The sample is empty.
    #[error("there are no values; a sample needs at least one")]
    NoValues,
    /// A value is not a number, or is too large to be squared.
    #[error("value {number} is {}, expected a number from -1e90 to 1e90", Given(*.value))]
    Value {
        /// Number of the value, from 1.
        number: usize,
        /// The value.
        value: f64,
    },
    /// A confidence is not above 0 and below 1.
    #[error("the confidence is {}, expected a share above 0 and below 1, such as 0.95", Given(*.0))]
    Confidence(f64),
    /// A p-value is not a probability.
    #[error("p-value {number} is {}, expected a number from 0 to 1", Given(*.value))]
    PValue {
        /// Number of the value, from 1.
        number: usize,
        /// The value.
        value: f64,
    },
}
