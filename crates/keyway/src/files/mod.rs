//! Scene files: which robot drives where, in which world, as one small text file; and files of robots and stacks.

mod meant;
mod overlay;
mod read;
mod scene;
mod scene_error;
mod scene_robots;
mod scene_rules;
mod scene_version;
mod stack;
mod stack_base;
mod toml_messages;
mod toml_text;
mod unknown;

pub use meant::did_you_mean;
pub use overlay::{NamedDefault, Overlay, OverlayError, value_from_text};
pub use read::{
    MAX_TOML_BYTES, SceneFileError, disturbances_from_bytes, find_robot, read_disturbances,
    read_robot, read_scene, robot_from_bytes, scene_from_bytes,
};
pub use scene::{SceneFile, SceneMap};
pub use scene_error::SceneError;
pub use scene_robots::SceneRobot;
pub use scene_rules::SceneRules;
pub use stack::{find_stack, read_stack, stack_from_bytes};
pub use stack_base::{ParameterError, StackBase};
pub use toml_messages::in_plain_words;
pub use toml_text::{TomlError, from_toml};
pub use unknown::{UnknownCircle, UnknownObstacle};
