//! Readers and writers of map files: ROS YAML with an image, MovingAI `.map` and `.scen`, and plain
//! images.
//!
//! [`read_map`] and [`write_map`] pick the format by the extension. Where there are no files,
//! [`map_from_bytes`] and [`scenarios_from_bytes`] read the same, with the same errors, and each
//! format has functions from bytes and to bytes.
//!
//! ```no_run
//! use keyway::map::formats::{read_map, write_map};
//! use std::path::Path;
//!
//! let loaded = read_map(Path::new("maps/office.yaml"), None)?;
//! println!("{} ({})", loaded.digest, loaded.format);
//! write_map(Path::new("office.map"), &loaded.grid)?;
//! # Ok::<(), keyway::map::formats::MapFileError>(())
//! ```

mod cell_limit;
mod decoded_image;
mod digest;
mod error;
mod files;
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
pub use files::{
    MAX_MAP_BYTES, MapFormat, read_scenarios, read_scenarios_for, ros_map_image,
    scenarios_from_bytes, write_map, write_ros_map,
};
pub use image::{ImageKind, grid_from_image, image_from_grid};
pub use movingai::{MovingAiError, movingai_map_from_grid, parse_movingai_map};
pub use notices::{MapLoss, MapWarning};
pub use placement::ImagePlacement;
pub use reader::{LoadedMap, MapReader, map_from_bytes, read_map};
pub use ros::{RosMap, RosMapError};
pub use rule::{CellRule, MapMode};
pub use scenarios::{Scenario, ScenarioError, parse_scenarios};
pub(crate) use text::shown;
pub use text::{TextError, text_from_bytes};
