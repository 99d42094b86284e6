//! Scene files: which robot drives where, in which world, as one small text file.

mod read;
mod scene;
mod scene_error;
mod scene_robots;
mod scene_rules;
mod scene_version;
mod unknown;

pub use read::{
    SceneFileError, disturbances_from_bytes, read_disturbances, read_scene, scene_from_bytes,
};
pub use scene::{SceneFile, SceneMap};
pub use scene_error::SceneError;
pub use scene_robots::SceneRobot;
pub use scene_rules::SceneRules;
pub use unknown::{UnknownDisc, UnknownObstacle};
