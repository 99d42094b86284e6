//! Maps, robots and positions that the command line names.

use crate::args::SizeArgs;
use crate::error::{CliError, Kind};
use keyway::file_system::check_writable;
use keyway::files::{
    Assignment, ConfigFileError, RadiusBeyondMap, RobotLayersError, RobotSize, did_you_mean,
    find_robot, find_stack, robot_with,
};
use keyway::geometry::Point;
use keyway::map::formats::{ImagePlacement, LoadedMap, MapFileError, MapReader, MapWarning};
use keyway::map::{Cell, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::robot::{Footprint, FootprintError, Robot};
use keyway_sim::report::MapSource;
use keyway_sim::scene_files::{SceneFileError, read_disturbances};
use keyway_sim::sim::Disturbances;
use std::path::{Path, PathBuf};

/// Default robot.
pub(crate) const DEFAULT_ROBOT: &str = "small";

/// Robot that the stacks were published with.
pub(crate) const PAPER_ROBOT: &str = "paper";

pub(crate) fn load_map(path: &Path, reader: &MapReader) -> Result<LoadedMap, CliError> {
    let loaded = reader.read(path).map_err(|error| map_error(&error))?;
    for warning in &loaded.warnings {
        let advice = match warning {
            MapWarning::Resolution { .. } => {
                "; set it with --resolution, or use the map's YAML file"
            }
            _ => "",
        };
        crate::stdout::warn(format_args!("{warning}{advice}"));
    }
    Ok(loaded)
}

/// Converts the error of a map file. If the map has too many cells, the message names the option
/// that allows more.
pub(crate) fn map_error(error: &MapFileError) -> CliError {
    let error = match error.too_many_cells() {
        Some(found) => format!("{error} with --max-cells {}", found.needed()),
        None => error.to_string(),
    };
    CliError::new(Kind::Input, error).field("MAP")
}

/// Identification of a map in reports.
pub(crate) fn source_of(loaded: &LoadedMap, placement: Option<ImagePlacement>) -> MapSource {
    MapSource { placement: placement.map(Into::into), ..MapSource::from(loaded) }
}

/// Refuses a radius for which no cell can be free: half of the map's shorter side or more.
pub(crate) fn refuse_a_radius_beyond_the_map(
    radius_m: f64,
    frame: &GridFrame,
    field: &str,
) -> Result<(), CliError> {
    RadiusBeyondMap::check(radius_m, frame)
        .map_err(|error| CliError::new(Kind::Config, error).field(field))
}

/// A bundled robot, or one from a file, relative to `folder`.
pub(crate) fn robot(name: &str, folder: &Path) -> Result<Robot, CliError> {
    find_robot(name, folder).map_err(|error| bad_file(error, "--robot"))
}

/// Reads the disturbances of a robot from a file.
pub(crate) fn disturbances(path: &Path) -> Result<Disturbances, CliError> {
    read_disturbances(path).map_err(|error| bad_file(error, "--disturbances"))
}

/// A stack by name, with the parameters for a robot, or one from a file, relative to `folder`.
/// `option` is blamed in errors.
pub(crate) fn stack(
    name: &str,
    folder: &Path,
    robot: &Robot,
    option: &str,
) -> Result<Stack, CliError> {
    find_stack(name, folder, robot).map_err(|error| bad_file(error, option))
}

/// A stack with the parameters of its paper.
pub(crate) fn published_stack(name: &str) -> Result<Stack, CliError> {
    Stack::published_by_name(name).ok_or_else(|| {
        let is_published = |name: &&str| Stack::published_by_name(name).is_some();
        let published: Vec<&str> = Stack::NAMES.into_iter().filter(is_published).collect();
        let message = format!(
            "the stack `{name}` has no published parameters; with --as-published it must be one of {}{}",
            published.join(", "),
            did_you_mean(name, published.iter().copied())
        );
        CliError::new(Kind::Config, message).field("--stack")
    })
}

/// Error of a robot or stack. It blames the field of the file if there is one, otherwise the
/// option.
pub(crate) fn bad_file(error: impl Into<SceneFileError>, option: &str) -> CliError {
    let error = error.into();
    let cannot_be_read = matches!(error, SceneFileError::Config(ConfigFileError::File(_)));
    let kind = if cannot_be_read { Kind::Input } else { Kind::Config };
    let field = error.field();
    CliError::new(kind, &error).field(if field.is_empty() { option } else { field })
}

/// Refuses an output file that would replace one of the input files.
pub(crate) fn refuse_to_replace_a_source(
    sources: &[PathBuf],
    out: &Path,
    field: &str,
) -> Result<(), CliError> {
    let Ok(out_file) = out.canonicalize() else { return Ok(()) };
    let is_out = |source: &PathBuf| source.canonicalize().is_ok_and(|source| source == out_file);
    if !sources.iter().any(is_out) {
        return Ok(());
    }
    let message =
        format!("{} is an input file and would be replaced; choose another name", out.display());
    Err(CliError::new(Kind::Output, message).field(field))
}

/// Refuses an output file that cannot be written, before anything is computed for it.
pub(crate) fn refuse_unwritable(out: &Path, field: &str) -> Result<(), CliError> {
    let blame = |message: String| CliError::new(Kind::Output, message).field(field);
    // A bare file name has the empty path as its parent: the current folder.
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.exists()) {
        let (out, folder) = (out.display(), folder.display());
        return Err(blame(format!(
            "cannot write {out}: the folder {folder} does not exist; create it first"
        )));
    }
    check_writable(out).map_err(|error| blame(error.to_string()))
}

/// Size of the named robot, with the requested radius.
pub(crate) fn robot_size(size: &SizeArgs) -> Result<RobotSize, CliError> {
    let robot = size.robot.as_deref().map(|name| robot(name, Path::new(""))).transpose()?;
    RobotSize::new(robot, size.radius).map_err(|error| bad_radius(&error))
}

/// The layers of a map. An error names the option with the wrong value.
pub(crate) fn layers(
    grid: &OccupancyGrid,
    config: LayerConfig,
    size: &RobotSize,
) -> Result<SearchMap, CliError> {
    size.layers(grid, config).map_err(|error| bad_layers(&error))
}

/// Names the option whose value is invalid for the layers of a map.
pub(crate) fn bad_layers(error: &RobotLayersError) -> CliError {
    let field = match error {
        RobotLayersError::Radius(_) => "--radius",
        RobotLayersError::Config(error) => &error.path,
        _ => "map.clearance_m",
    };
    CliError::new(Kind::Config, error).field(field)
}

/// The same robot with the values of `--set`.
pub(crate) fn with_values(robot: Robot, changes: &[Assignment]) -> Result<Robot, CliError> {
    if changes.is_empty() {
        return Ok(robot);
    }
    robot_with(&robot, changes).map_err(|error| {
        let error = CliError::new(Kind::Config, format!("--set: of the robot: {error}"));
        error.field("--set")
    })
}

/// The same robot as a disc of another radius.
pub(crate) fn with_radius(robot: Robot, radius_m: Option<f64>) -> Result<Robot, CliError> {
    let Some(radius_m) = radius_m else { return Ok(robot) };
    let footprint = Footprint::circle(radius_m).map_err(|error| bad_radius(&error))?;
    Ok(Robot { footprint, ..robot })
}

/// Error of a radius that no robot can have.
pub(crate) fn bad_radius(error: &FootprintError) -> CliError {
    let message = format!("{error}; lengths are in metres, not in millimetres");
    CliError::new(Kind::Config, message).field("--radius")
}

/// A position in metres: as given, or the centre of the given cell.
pub(crate) fn position(
    frame: &GridFrame,
    given: Point,
    are_cells: bool,
    field: &str,
) -> Result<Point, CliError> {
    if !are_cells {
        return Ok(given);
    }
    let whole = |number: f64| {
        let cell = number as i32;
        let (kind, what) = if f64::from(cell) == number {
            return Ok(cell);
        } else if number.fract() == 0.0 {
            let (width, height) = (frame.width(), frame.height());
            let what = format!("cell {number} is outside the map of {width} x {height} cells");
            (Kind::Position, what)
        } else {
            (Kind::Usage, format!("the coordinates of cells are whole numbers, got {number:?}"))
        };
        Err(CliError::new(kind, format!("{field}: {what}")).field(field))
    };
    Ok(frame.world_from_cell(Cell::new(whole(given.x)?, whole(given.y)?)))
}
