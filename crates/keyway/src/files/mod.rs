//! Robots, stacks and parameters as TOML, with errors that name the line and the field.
//!
//! [`robot_from_bytes`], [`stack_from_bytes`] and [`parameters_from_bytes`] read from memory. With
//! the feature `files`, `read_robot`, `read_stack` and `read_parameters` read from files, with the
//! same limits and errors.

mod config_file_error;
mod meant;
mod missing;
mod overlay;
mod parameter_layers;
mod parameters;
#[cfg(feature = "files")]
mod read;
mod robot;
mod robot_file;
mod robot_size;
mod stack;
mod stack_base;
mod text_file;
mod toml_messages;
mod toml_text;

pub use config_file_error::ConfigFileError;
pub use meant::did_you_mean;
pub use overlay::{NamedDefault, Overlay, OverlayError, value_from_text};
pub use parameter_layers::{
    Assignment, AssignmentError, FieldValue, LayerError, LayerFault, ParameterFile, ParameterLayer,
    ParameterLayers,
};
pub use parameters::parameters_from_bytes;
#[cfg(feature = "files")]
pub use read::{
    find_robot, find_stack, read_parameters, read_robot, read_stack, read_text, read_toml,
};
pub use robot::{robot_from_bytes, robot_in_place};
pub use robot_file::{LimitsPart, RobotChangeError, RobotFile, robot_with};
pub use robot_size::{RadiusBeyondMap, RobotLayersError, RobotSize, StartingValues};
pub use stack::stack_from_bytes;
pub use stack_base::{ParameterError, StackBase};
pub use text_file::{MAX_TOML_BYTES, TextFileError, file_text};
use toml_messages::in_plain_words;
pub use toml_text::{TomlError, from_toml};
