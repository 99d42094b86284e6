//! Smoothers: from the line of a plan to a shorter line that keeps its clearance; and how fast a path
//! can be driven.

mod line_of_sight;
mod smoothed;
mod speed_profile;
mod taut;

pub use line_of_sight::line_of_sight;
pub use smoothed::{SharpCorner, Smoothed, WhySharp};
pub use speed_profile::{
    SpeedLimit, SpeedProfile, SpeedProfileConfig, SpeedProfileError, SpeedSample,
};
pub use taut::taut;

use crate::geometry::Polyline;
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// A smoother and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SmootherConfig {
    /// The line as planned, collinear points merged.
    None {},
    /// From each kept point straight on to the farthest point of the path that it can see.
    LineOfSight {},
    /// The locally shortest path at the clearance, pulled tight like a string around the same
    /// obstacles; its bends are arcs of the clearance's radius.
    Taut {},
}

impl SmootherConfig {
    /// Names of all smoothers, for [`Self::by_name`].
    pub const NAMES: [&'static str; 3] = ["none", "line-of-sight", "taut"];

    /// A smoother with its default parameters.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "none" => Some(Self::None {}),
            "line-of-sight" => Some(Self::LineOfSight {}),
            "taut" => Some(Self::Taut {}),
            _ => None,
        }
    }

    /// The smoother's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::None {} => Self::NAMES[0],
            Self::LineOfSight {} => Self::NAMES[1],
            Self::Taut {} => Self::NAMES[2],
        }
    }

    /// Smooths a line. The result begins and ends where the line does, is never longer, and keeps
    /// `clearance_m` wherever the line did.
    pub fn smooth(&self, line: &Polyline, clearance: &Clearance<'_>, clearance_m: f64) -> Smoothed {
        let smooth = match self {
            Self::None {} => line.merged(),
            Self::LineOfSight {} => line_of_sight(line, clearance, clearance_m),
            Self::Taut {} => return taut(line, clearance, clearance_m),
        };
        Smoothed::straight(line, &smooth, clearance, clearance_m)
    }
}
