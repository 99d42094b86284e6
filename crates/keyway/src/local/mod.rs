//! What the robot decides in each control cycle.

mod decision;
mod dwa;
mod dwa_config;
mod rollout;
mod scene;
mod window;

pub use decision::{Decision, Evaluation, NoCommand, Rejections, TermShares};
pub use dwa::{Dwa, DwaError};
pub use dwa_config::{DwaConfig, DwaConfigError, Weights};
pub use rollout::{DistanceAt, Prediction};
pub use scene::Scene;
