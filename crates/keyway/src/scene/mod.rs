//! Scene files: which robot drives where, in which world, as one small text file.

mod file;
mod text;
mod words;

pub use file::{SceneError, SceneFile, UnknownCircle};
pub use text::{TomlError, from_toml};
pub use words::in_plain_words;
