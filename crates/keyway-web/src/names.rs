//! The names of all available choices.

use keyway::guide::GuideConfig;
use keyway::local::LocalConfig;
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use serde::Serialize;

/// The answer to `{"ask": "names"}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Names {
    /// Version of the library.
    pub version: &'static str,
    /// Bundled robots.
    pub robots: &'static [&'static str],
    /// Global planners.
    pub planners: &'static [&'static str],
    /// Smoothers.
    pub smoothers: &'static [&'static str],
    /// Guides.
    pub guides: &'static [&'static str],
    /// Local planners.
    pub local_planners: &'static [&'static str],
    /// Stacks.
    pub stacks: &'static [&'static str],
}

impl Names {
    /// All names in the library.
    pub const ALL: Self = Self {
        version: env!("CARGO_PKG_VERSION"),
        robots: &Robot::NAMES,
        planners: &PlannerConfig::NAMES,
        smoothers: &SmootherConfig::NAMES,
        guides: &GuideConfig::NAMES,
        local_planners: &LocalConfig::NAMES,
        stacks: &Stack::NAMES,
    };
}
