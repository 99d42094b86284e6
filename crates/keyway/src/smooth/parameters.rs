//! The interface of every smoother's parameters.

use super::Smoother;
use crate::ConfigError;

/// Parameters of a smoother, and the properties that follow from them.
pub(super) trait SmootherParameters {
    /// The smoother with these parameters.
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError>;

    /// The values of the smoother's paper.
    fn as_published() -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Fields for which the paper gives no value.
    fn readings(&self) -> &'static [&'static str] {
        &[]
    }

    /// See [`SmootherConfig::safe_distance_m`].
    fn safe_distance_m(&self, _cell_m: f64) -> f64 {
        0.0
    }

    /// See [`SmootherConfig::has_turning_limit`].
    fn has_turning_limit(&self) -> bool {
        false
    }
}
