//! Scene files: which robot drives where, in which world, as one small text file.

mod read;
mod scene;
mod toml_messages;
mod toml_text;

pub use read::{
    MAX_TOML_BYTES, SceneFileError, find_robot, find_stack, read_robot, read_scene, read_stack,
    robot_from_bytes, scene_from_bytes, stack_from_bytes,
};
pub use scene::{SceneError, SceneFile, UnknownCircle};
pub use toml_messages::in_plain_words;
pub use toml_text::{TomlError, from_toml};
