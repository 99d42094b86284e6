//! Smoothers turn the polyline of a plan into a shorter path that keeps its clearance. Speed
//! profiles give the fastest traversal of a path.
//!
//! ```
//! use keyway::geometry::{Point, Polyline};
//! use keyway::map::{Clearance, OccupancyGrid};
//! use keyway::smooth::SmootherConfig;
//!
//! let map = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
//! let clearance = Clearance::new(map.frame(), map.occupied());
//! let detour = [[0.5, 0.5], [0.5, 1.5], [1.5, 1.5], [1.5, 0.5], [4.5, 0.5]].map(Point::from);
//! let line = Polyline::new(detour.to_vec());
//! let smoother = SmootherConfig::by_name("line-of-sight").expect("a name").build()?;
//! let done = smoother.smooth(&line.into(), &clearance, 0.3);
//! assert_eq!((done.path.length_m(), done.kept_clearance_m), (4.0, None));
//! # Ok::<(), keyway::ConfigError>(())
//! ```
//!
//! To write your own smoother, implement [`Smoother`].

mod bidirectional;
mod config;
mod continuous_curvature;
mod corner_blend;
mod hidden_region;
mod hierarchical;
mod key_points;
mod line_of_sight;
mod parameters;
mod required_clearance;
mod shortcut;
mod smoothed;
mod smoother;
mod speed_profile;
mod stretches;
mod taut;
mod unsmoothed;
mod visibility;

pub use bidirectional::{BidirectionalSmoothing, BidirectionalSmoothingConfig, Passes, Select};
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
