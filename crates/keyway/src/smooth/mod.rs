//! Smoothers: from the line of a plan to a shorter line that keeps its clearance; and how fast a path
//! can be driven.

mod continuous_curvature;
mod corner_blend;
mod line_of_sight;
mod smoothed;
mod speed_profile;

pub use continuous_curvature::{ContinuousCurvatureConfig, continuous_curvature};
pub use line_of_sight::line_of_sight;
pub use smoothed::{SharpCorner, Smoothed, WhySharp};
pub use speed_profile::{
    SpeedLimit, SpeedProfile, SpeedProfileConfig, SpeedProfileError, SpeedSample,
};

use crate::geometry::Polyline;
use crate::map::Clearance;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A smoother and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SmootherConfig {
    /// The line as planned, collinear points merged.
    None {},
    /// From each kept point straight on to the farthest point of the path that it can see.
    LineOfSight {},
    /// Line of sight, then every corner rounded by two cubic curves, with continuous curvature within
    /// a turning limit.
    ContinuousCurvature(ContinuousCurvatureConfig),
}

/// A parameter of a smoother that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("smoother.{field} must be {expected}, got {value}")]
pub struct SmootherError {
    /// The field of the smoother's config.
    pub field: &'static str,
    /// What was expected.
    pub expected: &'static str,
    /// What was given.
    pub value: f64,
}

impl SmootherConfig {
    /// Names of all smoothers, for [`Self::by_name`].
    pub const NAMES: [&'static str; 3] = ["none", "line-of-sight", "continuous-curvature"];

    /// A smoother with its default parameters.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "none" => Some(Self::None {}),
            "line-of-sight" => Some(Self::LineOfSight {}),
            "continuous-curvature" => {
                Some(Self::ContinuousCurvature(ContinuousCurvatureConfig::default()))
            }
            _ => None,
        }
    }

    /// The smoother's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::None {} => Self::NAMES[0],
            Self::LineOfSight {} => Self::NAMES[1],
            Self::ContinuousCurvature(_) => Self::NAMES[2],
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn check(&self) -> Result<(), SmootherError> {
        match self {
            Self::None {} | Self::LineOfSight {} => Ok(()),
            Self::ContinuousCurvature(config) => config.check(),
        }
    }

    /// Smooths a line. The result begins and ends where the line does, is never longer, and keeps
    /// `clearance_m` wherever the line did.
    pub fn smooth(&self, line: &Polyline, clearance: &Clearance<'_>, clearance_m: f64) -> Smoothed {
        let smooth = match self {
            Self::None {} => line.merged(),
            Self::LineOfSight {} => line_of_sight(line, clearance, clearance_m),
            Self::ContinuousCurvature(config) => {
                return continuous_curvature(line, clearance, clearance_m, config);
            }
        };
        Smoothed::straight(line, &smooth, clearance, clearance_m)
    }
}
