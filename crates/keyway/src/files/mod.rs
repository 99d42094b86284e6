//! Files of robots, stacks and parameters: TOML that says where it is wrong.

mod meant;
mod overlay;
mod parameter_layers;
mod read;
mod robot_size;
mod stack;
mod stack_base;
mod text_file;
mod toml_messages;
mod toml_text;

pub use meant::did_you_mean;
pub use overlay::{NamedDefault, Overlay, OverlayError, value_from_text};
pub use parameter_layers::{
    Assignment, AssignmentError, FieldValue, LayerError, LayerFault, ParameterFile, ParameterLayer,
    ParameterLayers,
};
pub use read::{
    ConfigFileError, MAX_TOML_BYTES, find_robot, read_parameters, read_robot, robot_from_bytes,
};
pub use robot_size::{RadiusBeyondMap, RobotLayersError, RobotSize, StartingValues};
pub use stack::{find_stack, read_stack, stack_from_bytes};
pub use stack_base::{ParameterError, StackBase};
pub use text_file::{TextFileError, file_text, read_text};
use toml_messages::in_plain_words;
pub use toml_text::{TomlError, from_toml};
