//! Scene files: which robot drives where, in which world, as one small text file.

mod file;
mod read;
mod text;
mod words;

pub use file::{SceneError, SceneFile, UnknownCircle};
pub use read::{
    MAX_TOML_BYTES, SceneFileError, find_robot, read_robot, read_scene, robot_from_bytes,
    scene_from_bytes,
};
pub use text::{TomlError, from_toml};
pub use words::in_plain_words;
