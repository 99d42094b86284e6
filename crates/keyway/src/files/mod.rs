//! Scene files: which robot drives where, in which world, as one small text file; and files of robots and stacks.

mod read;
mod scene;
mod scene_robots;
mod scene_rules;
mod stack;
mod toml_messages;
mod toml_text;

pub use read::{
    MAX_TOML_BYTES, SceneFileError, disturbances_from_bytes, find_robot, read_disturbances,
    read_robot, read_scene, robot_from_bytes, scene_from_bytes,
};
pub use scene::{SceneError, SceneFile, SceneMap, UnknownCircle};
pub use scene_robots::SceneRobot;
pub use scene_rules::SceneRules;
pub use stack::{find_stack, read_stack, stack_from_bytes};
pub use toml_messages::in_plain_words;
pub use toml_text::{TomlError, from_toml};
