//! Scene files: a robot, its start and goal, and its world, as one small text file.
//!
//! [`scene_from_bytes`] and [`disturbances_from_bytes`] read from memory. With the feature `files`,
//! `read_scene` and `read_disturbances` do the same with files.

mod from_bytes;
#[cfg(feature = "files")]
mod read;
mod robot_in_scene;
mod scene;
mod scene_error;
mod scene_robots;
mod scene_version;
mod unknown;

pub use from_bytes::{SceneFileError, disturbances_from_bytes, scene_from_bytes};
#[cfg(feature = "files")]
pub use read::{read_disturbances, read_scene};
pub use scene::{SceneFile, SceneMap};
pub use scene_error::SceneError;
pub use scene_robots::SceneRobot;
pub use unknown::{GroundShape, UnknownDisc, UnknownObstacle};
