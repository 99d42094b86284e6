//! What the robot decides in each control cycle.

mod body;
mod config;
mod decision;
mod dwa;
mod dwa_config;
mod evaluation;
mod follower;
mod parameters;
mod planner;
mod rollout;
mod scene;
mod terms;
mod window;

pub use config::LocalConfig;
pub use decision::{Decision, Evaluation, NoCommand, Rejection, Rejections, Share, Shares};
pub use dwa::Dwa;
pub use dwa_config::{DwaConfig, Weights};
pub use follower::{Follower, FollowerConfig};
pub use planner::{DriveMemory, LocalPlanner, Scratch};
pub use rollout::{DistanceAt, Prediction};
pub use scene::Scene;
