//! The formats of map files, and writing them; errors name the file.

use super::{
    ImageKind, MapFileError, RosMap, Scenario, image, image_from_grid, movingai_map_from_grid,
    parse_scenarios,
};
use crate::file_system::Staged;
use crate::file_system::{read_file, write_atomically};
use crate::map::{Cell, GridFrame, MAX_CELLS, OccupancyGrid};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// No map file may be larger: what the largest map takes as a plain image, four bytes for a cell.
pub const MAX_MAP_BYTES: u64 = 4 * MAX_CELLS;
pub(super) const YAML_BYTES: u64 = 1 << 20;
const SCENARIOS_BYTES: u64 = 1 << 30;

/// The formats of map files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MapFormat {
    /// YAML and image, as the map server of ROS reads them.
    Ros,
    /// `.map` of the MovingAI benchmarks.
    MovingAi,
    /// A PGM image alone.
    Pgm,
    /// A PNG image alone.
    Png,
}

impl MapFormat {
    /// The format that the extension of a file names, in capitals or not.
    pub fn from_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "yaml" | "yml" => Some(Self::Ros),
            "map" => Some(Self::MovingAi),
            "pgm" => Some(Self::Pgm),
            "png" => Some(Self::Png),
            _ => None,
        }
    }

    pub(super) fn of(path: &Path) -> Result<Self, MapFileError> {
        Self::from_path(path).ok_or_else(|| MapFileError::Extension { path: path.to_owned() })
    }
}

impl fmt::Display for MapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ros => "ROS map",
            Self::MovingAi => "MovingAI map",
            Self::Pgm => "PGM image",
            Self::Png => "PNG image",
        })
    }
}

/// Writes a map; its extension (as for [`super::read_map`]) names the format. For a YAML file see
/// [`write_ros_map`], the image is a PGM file. `.map` and image files keep neither where the map
/// lies nor values, and `.map` files do not keep unknown cells either (they become occupied): see
/// [`super::MapLoss`].
///
/// # Errors
/// When a file cannot be written, or the extension is not one of these.
pub fn write_map(path: &Path, grid: &OccupancyGrid) -> Result<(), MapFileError> {
    let bytes = match MapFormat::of(path)? {
        MapFormat::Ros => return write_ros_map(path, grid, ImageKind::Pgm),
        MapFormat::MovingAi => movingai_map_from_grid(grid).into_bytes(),
        MapFormat::Pgm => image_from_grid(grid, ImageKind::Pgm),
        MapFormat::Png => image_from_grid(grid, ImageKind::Png),
    };
    Ok(write_atomically(path, &bytes)?)
}

/// Writes a YAML file and, next to it under the same name, its image. Both are complete on the disk
/// before either gets its name, the YAML file first: should the program be killed just then, the
/// image is named by a YAML file, and whoever writes the map again knows that it may be replaced.
///
/// Reading the YAML file gives the same grid (without its count of revisions). A grid without
/// values is written in trinary mode, with the grey values of Nav2's map saver and thresholds that
/// read unknown back as unknown; a grid with values in raw mode, which keeps them in images without
/// transparency too, all values above 100 as [`OccupancyGrid::UNKNOWN_VALUE`].
///
/// # Errors
/// When a file cannot be written, or its name is not UTF-8.
pub fn write_ros_map(
    path: &Path,
    grid: &OccupancyGrid,
    kind: ImageKind,
) -> Result<(), MapFileError> {
    let files = ros_map_files(path, grid, kind)?;
    let staged: Result<Vec<_>, _> =
        files.iter().map(|(path, bytes)| Staged::new(path, bytes)).collect();
    Ok(staged?.into_iter().try_for_each(Staged::commit)?)
}

/// The files of a map, in the order in which they get their names.
fn ros_map_files(
    path: &Path,
    grid: &OccupancyGrid,
    kind: ImageKind,
) -> Result<[(PathBuf, Vec<u8>); 2], MapFileError> {
    let image_path = path.with_extension(kind.extension());
    let name = image_path.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| MapFileError::ImageName { path: image_path.clone() })?;
    let yaml = RosMap::for_grid(grid, name.to_owned()).to_yaml().into_bytes();
    Ok([(path.to_owned(), yaml), (image_path, ros_map_image(grid, kind))])
}

/// The image that [`write_ros_map`] writes beside a YAML file.
pub fn ros_map_image(grid: &OccupancyGrid, kind: ImageKind) -> Vec<u8> {
    let Some(values) = grid.values() else { return image_from_grid(grid, kind) };
    let width = grid.frame().width() as usize;
    image::encode(grid.frame(), kind, |Cell { x, y }| {
        match values[y as usize * width + x as usize] {
            value @ 0..=100 => value,
            _ => OccupancyGrid::UNKNOWN_VALUE,
        }
    })
}

/// Reads a `.scen` file, see [`parse_scenarios`].
///
/// # Errors
/// When the file cannot be read or is malformed.
pub fn read_scenarios(path: &Path) -> Result<Vec<Scenario>, MapFileError> {
    scenarios_from_bytes(path, &read_file(path, SCENARIOS_BYTES)?)
}

/// The same from memory; errors call the file `name`.
///
/// # Errors
/// When the content is malformed.
pub fn scenarios_from_bytes(name: &Path, bytes: &[u8]) -> Result<Vec<Scenario>, MapFileError> {
    parse_scenarios(bytes)
        .map_err(|reason| MapFileError::Scenarios { path: name.to_owned(), reason })
}

/// Reads a `.scen` file, all of whose scenarios must be for a map of this size.
///
/// # Errors
/// As for [`read_scenarios`]; and when a scenario is for a map of another size, naming its line.
pub fn read_scenarios_for(path: &Path, frame: &GridFrame) -> Result<Vec<Scenario>, MapFileError> {
    let scenarios = read_scenarios(path)?;
    let checked = scenarios.iter().try_for_each(|scenario| scenario.check_map(frame));
    checked.map_err(|reason| MapFileError::Scenarios { path: path.to_owned(), reason })?;
    Ok(scenarios)
}

#[cfg(test)]
#[path = "files_tests.rs"]
mod tests;
