//! Smoothers: from the line of a plan to a shorter line that keeps its clearance; and how fast a path
//! can be driven.

mod bidirectional;
mod config;
mod continuous_curvature;
mod corner_blend;
mod hierarchical;
mod key_points;
mod line_of_sight;
mod room;
mod shadow;
mod shadows;
mod shortcut;
mod smoothed;
mod smoother;
mod speed_profile;
mod stretches;
mod taut;
mod unsmoothed;

pub use bidirectional::{BidirectionalSmoothing, BidirectionalSmoothingConfig, Select};
pub use config::SmootherConfig;
pub use continuous_curvature::{ContinuousCurvature, ContinuousCurvatureConfig};
pub use hierarchical::{BendsKeep, HierarchicalSmoothing, HierarchicalSmoothingConfig};
pub use key_points::{KeyPointCandidates, KeyPointSmoothing, KeyPointSmoothingConfig};
pub use line_of_sight::{LineOfSight, LineOfSightConfig};
pub use shortcut::{Shortcut, ShortcutConfig};
pub use smoothed::{SharpCorner, Smoothed, WhySharp};
pub use smoother::Smoother;
pub use speed_profile::{
    SpeedLimit, SpeedProfile, SpeedProfileConfig, SpeedProfileError, SpeedSample,
};
pub use taut::{Taut, TautConfig};
pub use unsmoothed::{Unsmoothed, UnsmoothedConfig};
