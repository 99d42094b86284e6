//! Benchmark of one scenario file: reads the file and its map, and runs every planner.

use super::unusable_map;
use crate::args::BenchGridArgs;
use crate::commands::unusable_planner;
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, refuse_a_radius_beyond_the_map};
use crate::progress::Progress;
use keyway_lab::bench::{FileResult, GridError, GridFile, GridFileError, GridRequest};
use std::path::Path;

pub(super) fn bench_file(
    path: &Path,
    args: &BenchGridArgs,
    request: GridRequest<'_>,
    progress: &Progress,
) -> Result<FileResult, CliError> {
    let map_path = GridFile::map_of(path, args.map_dir.as_deref())?;
    let grid = load_map(&map_path, &args.limit.reader())?.grid;
    for stack in request.stacks {
        let clearance_m = stack.map.clearance_m;
        refuse_a_radius_beyond_the_map(clearance_m, grid.frame(), "map.clearance_m")?;
    }
    let file = GridFile::read(path, &map_path, grid, args.every as usize)?;
    let result = request.on(&file, progress)?;
    progress.finished_file();
    Ok(result)
}

impl From<GridFileError> for CliError {
    fn from(error: GridFileError) -> Self {
        Self::new(Kind::Input, error).field("FILE.scen")
    }
}

impl From<GridError> for CliError {
    fn from(error: GridError) -> Self {
        match error {
            GridError::Map(error) => unusable_map(error),
            GridError::Planner(error) => unusable_planner(error),
            error => Self::new(Kind::Config, error),
        }
    }
}
