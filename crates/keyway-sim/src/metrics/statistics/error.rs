//! Why there is no answer.

use keyway::given::Given;
use thiserror::Error;

/// What is wrong with the numbers that were given.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StatisticsError {
    /// A sample of nothing.
    #[error("there are no values; a sample needs at least one")]
    NoValues,
    /// A value that is no number, or so large that its square is none.
    #[error("value {number} is {}, expected a number from -1e90 to 1e90", Given(*.value))]
    Value {
        /// Which one, from 1.
        number: usize,
        /// The value.
        value: f64,
    },
    /// A confidence that no interval has.
    #[error("the confidence is {}, expected a share above 0 and below 1, such as 0.95", Given(*.0))]
    Confidence(f64),
    /// A probability that is none.
    #[error("p-value {number} is {}, expected a number from 0 to 1", Given(*.value))]
    PValue {
        /// Which one, from 1.
        number: usize,
        /// The value.
        value: f64,
    },
}
