//! A scenario file with its map.

use super::raw_map::RawMap;
use keyway::files::{TextFileError, read_text};
use keyway::map::OccupancyGrid;
use keyway::map::formats::{
    MAX_MAP_BYTES, MapFileError, MapFormat, Scenario, read_scenarios, read_scenarios_for,
};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A scenario file with its map.
pub struct GridFile {
    /// Name of the scenario file in the list of mistakes.
    pub name: String,
    /// Name of the map.
    pub map_name: String,
    /// The map.
    pub grid: OccupancyGrid,
    /// The same map as the checker of paths reads it.
    pub raw: RawMap,
    /// The queries.
    pub scenarios: Vec<Scenario>,
}

/// Error of a scenario file or its map.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GridFileError {
    /// The scenario file cannot be used.
    #[error(transparent)]
    Scenarios(MapFileError),
    /// No map is beside the scenario file, or in the folder of maps.
    #[error("{}: its map was not found, expected {}", path.display(), searched(expected))]
    NoMap {
        /// The scenario file.
        path: PathBuf,
        /// Paths at which a map was expected.
        expected: Vec<PathBuf>,
    },
    /// The map cannot be read as text.
    #[error(transparent)]
    Map(TextFileError),
}

impl GridFile {
    /// Returns the path of the map of a scenario file: beside it, or in the folder of maps. The map
    /// has the name that the file gives, or the scenario file's own name without `.scen`.
    ///
    /// # Errors
    /// Returns [`GridFileError`] if the scenario file cannot be used, or there is no such map.
    pub fn map_of(path: &Path, map_folder: Option<&Path>) -> Result<PathBuf, GridFileError> {
        let folder = map_folder.or(path.parent()).unwrap_or(Path::new(""));
        let scenarios = read_scenarios(path).map_err(GridFileError::Scenarios)?;
        let name = scenarios.first().and_then(|scenario| Path::new(&scenario.map).file_name());
        let named = name.map(|name| folder.join(name));
        let own = folder.join(path.file_stem().unwrap_or_default());
        let is_map = |map: &PathBuf| MapFormat::from_path(map) == Some(MapFormat::MovingAi);
        let mut expected: Vec<PathBuf> = named.into_iter().chain([own]).filter(is_map).collect();
        if let Some(map) = expected.iter().find(|map| map.is_file()) {
            return Ok(map.clone());
        }
        expected.dedup();
        Err(GridFileError::NoMap { path: path.to_owned(), expected })
    }

    /// Reads a scenario file for its map, whose grid was already read. It takes every `every`-th
    /// query, beginning with the first.
    ///
    /// # Errors
    /// Returns [`GridFileError`] if a file cannot be read, or the queries are not of this map.
    pub fn read(
        path: &Path,
        map_path: &Path,
        grid: OccupancyGrid,
        every: usize,
    ) -> Result<Self, GridFileError> {
        let text = read_text(map_path, MAX_MAP_BYTES).map_err(GridFileError::Map)?;
        let scenarios = read_scenarios_for(path, grid.frame()).map_err(GridFileError::Scenarios)?;
        Ok(Self {
            name: path.display().to_string(),
            map_name: map_path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            grid,
            raw: RawMap::new(&text),
            scenarios: scenarios.into_iter().step_by(every.max(1)).collect(),
        })
    }
}

fn searched(expected: &[PathBuf]) -> String {
    let names: Vec<String> = expected.iter().map(|map| map.display().to_string()).collect();
    if names.is_empty() { "a .map file".to_owned() } else { names.join(" or ") }
}
