//! Local planning: turns a scene into the velocity for the next control cycle, with an
//! explanation.
//!
//! ```
//! use keyway::geometry::{Point, Polyline, Pose, Velocity};
//! use keyway::local::{DriveMemory, LocalConfig, Scene, Scratch};
//! use keyway::map::{BitGrid, DistanceField, FieldConfig, OccupancyGrid};
//! use keyway::robot::Robot;
//!
//! let map = OccupancyGrid::from_ascii(&["........", "....#...", "........"]);
//! let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
//! let robot = Robot::small();
//! let planner = LocalConfig::by_name("dwa", &robot).expect("a name").build(&robot)?;
//! // Both are kept from cycle to cycle, which then allocate nothing.
//! let (mut memory, mut scratch) = (DriveMemory::default(), Scratch::default());
//! let nothing = BitGrid::new(8, 3, false);
//! let path = Polyline::new(vec![Point::new(0.5, 0.5), Point::new(7.5, 0.5)]);
//! let scene = Scene {
//!     obstacles: &obstacles,
//!     sensed: &nothing,
//!     seen: keyway::sense::SeenCells::ANYWHERE,
//!     movers: &[],
//!     walked: &[],
//!     pose: Pose::new(0.5, 0.5, 0.0),
//!     velocity: Velocity::ZERO,
//!     guide: Point::new(7.5, 0.5),
//!     path: &path,
//!     goal_heading_rad: None,
//!     remaining_m: f64::INFINITY,
//!     jerk_limited: None,
//! };
//! let decision = planner.decide(&scene, &mut memory, &mut scratch)?;
//! assert!(decision.command.v > 0.0 && decision.command.omega.abs() < 1e-9);
//! let speed = decision.evaluation.chosen.term("speed");
//! assert_eq!(speed.expect("a term of the dynamic window approach").raw, decision.command.v);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive_dwa;
mod config;
mod decision;
mod dwa;
mod dynamic_window;
mod explanation;
mod follower;
mod guided_dwa;
mod jerk_limited;
mod key_point_dwa;
mod mover_rule;
mod parameters;
mod planner;
mod rear;
mod remedies;
mod scene;
mod space_time;
mod stop_rule;
mod terms;

pub use adaptive_dwa::{AdaptiveDwa, AdaptiveDwaConfig};
pub use config::LocalConfig;
pub use decision::{Decision, Evaluation, NoCommand, Rejection, Rejections, Share, Shares};
pub use dwa::{Dwa, DwaConfig, Weights};
pub use dynamic_window::{
    Admissible, DistanceAt, DynamicWindow, Prediction, Rollout, Term, TermValue, Weighing,
    WindowConfig,
};
pub use explanation::{Change, Explanation, Fate, JudgedCandidate, Remedy, ScoredCandidate};
pub use follower::{Follower, FollowerConfig};
pub use guided_dwa::{DetourConfig, GuidedDwa, GuidedDwaConfig, GuidedWeights};
pub use jerk_limited::JerkLimited;
pub use key_point_dwa::{KeyPointDwa, KeyPointDwaConfig, KeyPointWeights, SpeedWeight};
pub(crate) use mover_rule::MoverRule;
pub use planner::{Course, Detour, DriveMemory, LocalPlanner, OwnMemory, Scratch};
pub use scene::Scene;
pub use space_time::{SpaceTime, SpaceTimeConfig};
pub use stop_rule::{Gated, Refusal, RefusalCounts, StopRule, StopRuleConfig, Surroundings};
