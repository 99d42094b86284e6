//! A scenario file and its map, from their paths to the answers of every planner.

use crate::args::BenchGridArgs;
use crate::commands::unusable_planner;
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, read_text, refuse_a_radius_beyond_the_map};
use crate::progress::{Progress, Watched};
use keyway::map::formats::{MAX_MAP_BYTES, MapFormat, read_scenarios_for};
use keyway_lab::bench::{FileResult, GridError, GridFile, GridRequest, RawMap};
use std::path::{Path, PathBuf};

pub(super) fn bench_file(
    path: &Path,
    args: &BenchGridArgs,
    request: GridRequest<'_>,
    progress: &Progress,
) -> Result<FileResult, CliError> {
    let map_path = map_of(path, args.map_dir.as_deref())?;
    let grid = load_map(&map_path, &args.limit.reader())?.grid;
    for stack in request.stacks {
        let clearance_m = stack.map.clearance_m;
        refuse_a_radius_beyond_the_map(clearance_m, grid.frame(), "map.clearance_m")?;
    }
    let raw = RawMap::new(&read_text(&map_path, MAX_MAP_BYTES, "FILE.scen")?);
    let scenarios = read_scenarios_for(path, grid.frame())
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?;
    let file = GridFile {
        name: path.display().to_string(),
        map_name: map_path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        grid,
        raw,
        scenarios: scenarios.into_iter().step_by(args.every as usize).collect(),
    };
    let result = request.on(&file, &Watched { progress, watcher: &() }).map_err(refused)?;
    progress.finished_file();
    Ok(result)
}

fn refused(error: GridError) -> CliError {
    match error {
        GridError::Map(error) => {
            let error = error.within("map");
            CliError::new(Kind::Config, &error).field(error.path.as_str())
        }
        GridError::Planner(error) => unusable_planner(error),
        error => CliError::new(Kind::Config, error),
    }
}

/// The map of a scenario file: beside it (or in the folder of maps) under the name that the file
/// gives, or under the scenario file's own name without `.scen`.
fn map_of(path: &Path, map_dir: Option<&Path>) -> Result<PathBuf, CliError> {
    let folder = map_dir.or(path.parent()).unwrap_or(Path::new(""));
    let named = keyway::map::formats::read_scenarios(path)
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?
        .first()
        .and_then(|scenario| Path::new(&scenario.map).file_name().map(|name| folder.join(name)));
    let own = folder.join(path.file_stem().unwrap_or_default());
    let candidates: Vec<PathBuf> = named
        .into_iter()
        .chain([own])
        .filter(|map| MapFormat::from_path(map) == Some(MapFormat::MovingAi))
        .collect();
    candidates.iter().find(|map| map.is_file()).cloned().ok_or_else(|| {
        let mut names: Vec<String> =
            candidates.iter().map(|map| map.display().to_string()).collect();
        names.dedup();
        let searched = if names.is_empty() { "a .map file".to_owned() } else { names.join(" or ") };
        let message = format!("{}: there is no map, expected {searched}", path.display());
        CliError::new(Kind::Input, message).field("FILE.scen")
    })
}
