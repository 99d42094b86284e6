//! Reading maps from memory: the extension of a name selects the format, and errors repeat the
//! name.

use super::image::{grid_of_at_most, size_of_image};
use super::movingai::{Octile, map_of_at_most, size_of_map};
use super::rule::Doubts;
use super::{
    CellRule, DEFAULT_MAX_CELLS, ImageError, ImagePlacement, MapFileError, MapFormat, MapWarning,
    MovingAiError, RosMap, Scenario, check_size, digest, parse_scenarios,
};
use crate::file_error::{ReadError, check_length};
use crate::map::{GridFrame, MAX_CELLS, OccupancyGrid};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Largest allowed map file: the size of the largest map as a plain image, four bytes per cell.
pub const MAX_MAP_BYTES: u64 = 4 * MAX_CELLS;
const YAML_BYTES: u64 = 1 << 20;
pub(super) const SCENARIOS_BYTES: u64 = 1 << 30;

/// A map with the data that identify it in reports.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedMap {
    /// The map.
    pub grid: OccupancyGrid,
    /// The format of its file.
    pub format: MapFormat,
    /// The [`digest`] of the map.
    pub digest: String,
    /// The files read: the map's, and the image of a YAML file.
    pub sources: Vec<PathBuf>,
    /// Likely mistakes in these files.
    pub warnings: Vec<MapWarning>,
}

/// Settings for reading map files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapReader {
    /// Placement of a map whose file does not contain one; `None`: cells of 1 m from (0, 0).
    pub placement: Option<ImagePlacement>,
    /// Largest allowed number of cells; larger maps are rejected before memory is allocated.
    pub max_cells: u64,
}

impl Default for MapReader {
    fn default() -> Self {
        Self { placement: None, max_cells: DEFAULT_MAX_CELLS }
    }
}

/// Reads a map of at most [`DEFAULT_MAX_CELLS`] cells from memory. The extension of `name`
/// (`.yaml`, `.yml`, `.map`, `.pgm`, `.png`) selects the format, and errors and warnings use
/// `name` for the map; no such file needs to exist. `image` returns the content of the image that
/// a YAML file names, given its name there after the folder of `name`; no other format needs it.
/// If there is no such image, it returns [`ReadError::System`] with
/// [`std::io::ErrorKind::NotFound`].
///
/// A YAML file contains the placement of its map. Other maps are placed by `placement`, by
/// default with cells of 1 m from (0, 0). Images without a YAML file are read by
/// [`CellRule::IMAGE`].
///
/// ```
/// use keyway::map::formats::map_from_bytes;
/// use std::path::Path;
///
/// let yaml = b"image: office.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n\
///              negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
/// let image = |name: &Path| {
///     assert_eq!(name, Path::new("maps/office.pgm"));
///     Ok(b"P5\n3 2\n255\n\x00\xfe\xfe\xfe\xfe\xfe".to_vec())
/// };
/// let loaded = map_from_bytes(Path::new("maps/office.yaml"), yaml, image, None)?;
/// assert_eq!((loaded.grid.frame().width(), loaded.grid.frame().resolution_m()), (3, 0.05));
///
/// let error = map_from_bytes(Path::new("upload.map"), b"type tile", |_| Ok(vec![]), None).unwrap_err();
/// assert!(error.to_string().starts_with("upload.map: line 1: "));
/// # Ok::<(), keyway::map::formats::MapFileError>(())
/// ```
///
/// # Errors
/// As for [`MapReader::from_bytes`].
pub fn map_from_bytes(
    name: &Path,
    bytes: &[u8],
    image: impl Fn(&Path) -> Result<Vec<u8>, ReadError>,
    placement: Option<ImagePlacement>,
) -> Result<LoadedMap, MapFileError> {
    MapReader { placement, ..MapReader::default() }.from_bytes(name, bytes, image)
}

/// Check that can reject a file by its beginning, before the rest is read.
pub(super) type Check<'a> = &'a dyn Fn(&[u8]) -> Result<(), MapFileError>;

impl MapReader {
    /// Reads a map from memory, like [`map_from_bytes`].
    ///
    /// # Errors
    /// Returns [`MapFileError`] if the map, or the image that it names, is malformed or longer
    /// than a file of its kind may be; if the extension is not one of those; if there is a
    /// placement for a YAML file; if the map has too many cells; and if `image` returns an error.
    pub fn from_bytes(
        &self,
        name: &Path,
        bytes: &[u8],
        image: impl Fn(&Path) -> Result<Vec<u8>, ReadError>,
    ) -> Result<LoadedMap, MapFileError> {
        self.load(name, |path, limit_bytes, check: Check<'_>| {
            let bytes = if path == name { Cow::Borrowed(bytes) } else { Cow::Owned(image(path)?) };
            check(&bytes)?;
            check_length(path, &bytes, limit_bytes)?;
            Ok(bytes)
        })
    }

    /// Loads a map; `read` returns the content of a file of at most this many bytes, if the check
    /// of its beginning allows it.
    pub(super) fn load<B: AsRef<[u8]>>(
        &self,
        path: &Path,
        read: impl Fn(&Path, u64, Check<'_>) -> Result<B, MapFileError>,
    ) -> Result<LoadedMap, MapFileError> {
        let format = MapFormat::of(path)?;
        let mut sources = vec![path.to_owned()];
        let mut warnings = Vec::new();
        let image =
            |path: &Path, rule, placement| self.grid_of_image(path, (rule, placement), &read);
        let grid = match format {
            MapFormat::Ros if self.placement.is_some() => {
                return Err(MapFileError::Placement { path: path.to_owned() });
            }
            MapFormat::Ros => {
                let map = RosMap::parse(read(path, YAML_BYTES, &|_| Ok(()))?.as_ref())
                    .map_err(|reason| MapFileError::RosMap { path: path.to_owned(), reason })?;
                // An absolute name replaces the folder.
                let image_path = path.parent().unwrap_or(Path::new("")).join(&map.image);
                let (grid, found) = image(&image_path, &map.rule, map.placement)?;
                warnings.extend(MapWarning::of_ros_map(path, &map));
                warnings.extend(MapWarning::of_raw_values(path, &map, &grid));
                warnings.extend(MapWarning::of_image(path, &image_path, (&map.rule, found)));
                sources.push(image_path);
                grid
            }
            MapFormat::MovingAi => {
                let Octile { grid, has_heights } = self.octile(path, &read)?;
                let heights = MapWarning::Heights { path: path.to_owned() };
                warnings.extend(has_heights.then_some(heights));
                grid
            }
            MapFormat::Pgm | MapFormat::Png => {
                if self.placement.is_none() {
                    warnings.push(MapWarning::Resolution { path: path.to_owned() });
                }
                let rule = &CellRule::IMAGE;
                let (grid, found) = image(path, rule, self.placement.unwrap_or_default())?;
                warnings.extend(MapWarning::of_image(path, path, (rule, found)));
                grid
            }
        };
        Ok(LoadedMap { digest: digest(&grid), grid, format, sources, warnings })
    }

    fn grid_of_image<B: AsRef<[u8]>>(
        &self,
        path: &Path,
        (rule, placement): (&CellRule, ImagePlacement),
        read: &impl Fn(&Path, u64, Check<'_>) -> Result<B, MapFileError>,
    ) -> Result<(OccupancyGrid, Doubts), MapFileError> {
        let blame = |reason: ImageError| MapFileError::Image { path: path.to_owned(), reason };
        let check = |head: &[u8]| match size_of_image(head) {
            Some(size) => check_size(size, self.max_cells).map_err(blame),
            None => Ok(()),
        };
        let bytes = read(path, MAX_MAP_BYTES, &check)?;
        grid_of_at_most(self.max_cells, bytes.as_ref(), rule, placement).map_err(blame)
    }

    fn octile<B: AsRef<[u8]>>(
        &self,
        path: &Path,
        read: &impl Fn(&Path, u64, Check<'_>) -> Result<B, MapFileError>,
    ) -> Result<Octile, MapFileError> {
        let blame =
            |reason: MovingAiError| MapFileError::MovingAi { path: path.to_owned(), reason };
        let check = |head: &[u8]| match size_of_map(head) {
            Some(size) => check_size(size, self.max_cells).map_err(blame),
            None => Ok(()),
        };
        let bytes = read(path, MAX_MAP_BYTES, &check)?;
        map_of_at_most(self.max_cells, bytes.as_ref(), self.placement.unwrap_or_default())
            .map_err(blame)
    }
}

/// Reads MovingAI scenarios from memory, see [`parse_scenarios`]; errors use `name` for the file.
///
/// # Errors
/// Returns [`MapFileError`] if the content is malformed, or longer than a `.scen` file may be.
pub fn scenarios_from_bytes(name: &Path, bytes: &[u8]) -> Result<Vec<Scenario>, MapFileError> {
    check_length(name, bytes, SCENARIOS_BYTES)?;
    parse_scenarios(bytes)
        .map_err(|reason| MapFileError::Scenarios { path: name.to_owned(), reason })
}

/// Reads MovingAI scenarios, all of which must be for a map of this size; errors use `name` for
/// the file.
///
/// # Errors
/// As for [`scenarios_from_bytes`]; also if a scenario is for a map of another size (the error
/// names its line).
pub fn scenarios_for_from_bytes(
    name: &Path,
    bytes: &[u8],
    frame: &GridFrame,
) -> Result<Vec<Scenario>, MapFileError> {
    let scenarios = scenarios_from_bytes(name, bytes)?;
    let checked = scenarios.iter().try_for_each(|scenario| scenario.check_map(frame));
    checked.map_err(|reason| MapFileError::Scenarios { path: name.to_owned(), reason })?;
    Ok(scenarios)
}
