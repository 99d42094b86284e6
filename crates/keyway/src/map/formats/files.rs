//! Reading and writing map files; errors name the file.

use super::reader::{Check, SCENARIOS_BYTES};
use super::{
    ImageKind, ImagePlacement, LoadedMap, MapFileError, MapFormat, MapReader, RosMap, Scenario,
    image_from_grid, movingai_map_from_grid, ros_map_image, scenarios_for_from_bytes,
    scenarios_from_bytes,
};
use crate::file_system::{Staged, read_file, read_file_if, write_atomically};
use crate::map::{GridFrame, OccupancyGrid};
use std::path::{Path, PathBuf};

/// Reads a map of at most [`DEFAULT_MAX_CELLS`](super::DEFAULT_MAX_CELLS) cells; its extension
/// (`.yaml`, `.yml`, `.map`, `.pgm`, `.png`) selects the format.
///
/// A YAML file contains the placement of its map. Other maps are placed by `placement`, by
/// default with cells of 1 m from (0, 0). Images without a YAML file are read by
/// [`CellRule::IMAGE`](super::CellRule::IMAGE).
///
/// ```no_run
/// use keyway::map::formats::{read_map, write_map};
/// use std::path::Path;
///
/// let loaded = read_map(Path::new("maps/office.yaml"), None)?;
/// println!("{} ({})", loaded.digest, loaded.format);
/// write_map(Path::new("office.map"), &loaded.grid)?;
/// # Ok::<(), keyway::map::formats::MapFileError>(())
/// ```
///
/// # Errors
/// As for [`MapReader::read`].
pub fn read_map(path: &Path, placement: Option<ImagePlacement>) -> Result<LoadedMap, MapFileError> {
    MapReader { placement, ..MapReader::default() }.read(path)
}

impl MapReader {
    /// Reads a map, like [`read_map`].
    ///
    /// ```no_run
    /// use keyway::map::formats::MapReader;
    /// use std::path::Path;
    ///
    /// let reader = MapReader { max_cells: 1 << 30, ..MapReader::default() };
    /// let loaded = reader.read(Path::new("maps/city.png"))?;
    /// # Ok::<(), keyway::map::formats::MapFileError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`MapFileError`] if the file, or the image that it names, cannot be read or is
    /// malformed; if the extension is not one of those; if there is a placement for a YAML file;
    /// or if the map has too many cells.
    pub fn read(&self, path: &Path) -> Result<LoadedMap, MapFileError> {
        self.load(path, |path, limit_bytes, check: Check<'_>| {
            read_file_if(path, limit_bytes, check)
        })
    }
}

/// Writes a map; its extension (as for [`read_map`]) selects the format. For a YAML file see
/// [`write_ros_map`]; its image is a PGM file. `.map` and image files keep neither the pose of
/// the map nor values, and `.map` files do not keep unknown cells either (they become occupied):
/// see [`super::MapLoss`].
///
/// # Errors
/// Returns [`MapFileError`] if a file cannot be written, or the extension is not one of these.
pub fn write_map(path: &Path, grid: &OccupancyGrid) -> Result<(), MapFileError> {
    let bytes = match MapFormat::of(path)? {
        MapFormat::Ros => return write_ros_map(path, grid, ImageKind::Pgm),
        MapFormat::MovingAi => movingai_map_from_grid(grid).into_bytes(),
        MapFormat::Pgm => image_from_grid(grid, ImageKind::Pgm),
        MapFormat::Png => image_from_grid(grid, ImageKind::Png),
    };
    Ok(write_atomically(path, &bytes)?)
}

/// Writes a YAML file and, next to it under the same name, its image. Both are complete on the
/// disk before either gets its name, the YAML file first: if the program is killed just then, a
/// YAML file names the image, so a program that writes the map again knows that it may be
/// replaced.
///
/// Reading the YAML file returns the same grid (without its revision count). A grid without
/// values is written in trinary mode, with the grey values of Nav2's map saver and thresholds
/// that read unknown back as unknown. A grid with values is written in raw mode, which keeps them
/// in images without transparency too, all values above 100 as [`OccupancyGrid::UNKNOWN_VALUE`].
///
/// # Errors
/// Returns [`MapFileError`] if a file cannot be written, or its name is not UTF-8.
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

/// Reads a `.scen` file, see [`parse_scenarios`](super::parse_scenarios).
///
/// # Errors
/// Returns [`MapFileError`] if the file cannot be read or is malformed.
pub fn read_scenarios(path: &Path) -> Result<Vec<Scenario>, MapFileError> {
    scenarios_from_bytes(path, &read_file(path, SCENARIOS_BYTES)?)
}

/// Reads a `.scen` file, all of whose scenarios must be for a map of this size.
///
/// # Errors
/// As for [`read_scenarios`]; also if a scenario is for a map of another size (the error names
/// its line).
pub fn read_scenarios_for(path: &Path, frame: &GridFrame) -> Result<Vec<Scenario>, MapFileError> {
    scenarios_for_from_bytes(path, &read_file(path, SCENARIOS_BYTES)?, frame)
}

#[cfg(test)]
#[path = "files_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "reader_tests.rs"]
mod reader_tests;
