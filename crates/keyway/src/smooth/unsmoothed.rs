//! No smoothing: a line -> the same line, collinear points merged.
//!
//! # Errors / cost
//! None. Linear in the points of the line.

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::{Smoothed, Smoother};
use crate::ConfigError;
use crate::geometry::PlannedLine;
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// Parameters of [`Unsmoothed`]: none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct UnsmoothedConfig {}

/// Leaves the line as it was planned.
#[derive(Clone, Debug, Default)]
pub struct Unsmoothed;

impl Unsmoothed {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "none";
}

impl SmootherParameters for UnsmoothedConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(Unsmoothed))
    }
}

impl Smoother for Unsmoothed {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        Smoothed::straight(
            line,
            &line.merged(),
            &RequiredClearance::new(clearance, clearance_m, 0.0),
        )
    }
}
