//! A simulated world, robot and lidar. The controller comes in as a closure; nothing here knows how
//! it decides.

mod drive;
mod lidar;
mod motion;
mod world;

pub use drive::{Action, Control, Outcome, Run, RunRules, Sample, SimError, simulate};
pub use world::{Circle, Obstacle, World, WorldAt, WorldError};
