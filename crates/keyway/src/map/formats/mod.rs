//! Readers and writers of map files: ROS YAML with an image, MovingAI `.map` and `.scen`, and plain
//! images.
//!
//! [`map_from_bytes`] and [`scenarios_from_bytes`] read from memory and select the format by the
//! extension of a name; each format has functions from bytes and to bytes, too. With the feature
//! `files`, `read_map` and `write_map` do the same with files, with the same limits and errors.

mod cell_limit;
mod decoded_image;
mod digest;
mod error;
#[cfg(feature = "files")]
mod files;
mod format;
mod image;
mod layout;
mod movingai;
mod notices;
#[cfg(feature = "images")]
mod other_image;
mod placement;
mod png;
mod pnm;
mod reader;
mod ros;
mod rule;
mod scenarios;
mod text;

use cell_limit::check_size;
pub use cell_limit::{DEFAULT_MAX_CELLS, TooManyCells};
pub use decoded_image::ImageError;
pub use digest::digest;
pub use error::MapFileError;
#[cfg(feature = "files")]
pub use files::{read_map, read_scenarios, read_scenarios_for, write_map, write_ros_map};
pub use format::MapFormat;
pub use image::{ImageKind, grid_from_image, image_from_grid, ros_map_image};
pub use movingai::{MovingAiError, movingai_map_from_grid, parse_movingai_map};
pub use notices::{MapLoss, MapWarning};
pub use placement::ImagePlacement;
pub use reader::{
    LoadedMap, MAX_MAP_BYTES, MapReader, map_from_bytes, scenarios_for_from_bytes,
    scenarios_from_bytes,
};
pub use ros::{RosMap, RosMapError};
pub use rule::{CellRule, MapMode};
pub use scenarios::{Scenario, ScenarioError, parse_scenarios};
pub(crate) use text::shown;
pub use text::{TextError, text_from_bytes};
