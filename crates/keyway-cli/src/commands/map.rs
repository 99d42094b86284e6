//! `keyway map`: inspects a map file, or converts it to another format.

use super::{Done, print};
use crate::args::{Format, MapCommand, MapConvertArgs, MapInfoArgs};
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, refuse_to_replace_a_source, refuse_unwritable};
use crate::out_dir::warn_of_others;
use crate::stdout::print_files;
use crate::stdout::warn;
use keyway::file_system::read_file;
use keyway::geometry::{Pose, degrees};
use keyway::map::formats::{
    ImageKind, LoadedMap, MAX_MAP_BYTES, MapFormat, MapLoss, MapReader, RosMap, ros_map_image,
    write_map,
};
use keyway::map::{Cell, OccupancyGrid};
use keyway_lab::results::OutputLock;
use keyway_lab::table::facts;
use serde::Serialize;
use std::path::Path;

/// `keyway.map/1`.
#[derive(Serialize)]
struct MapReport {
    schema: &'static str,
    map: String,
    format: MapFormat,
    digest: String,
    width_cells: u32,
    height_cells: u32,
    resolution_m: f64,
    /// `[x, y, yaw_rad]` of the lower left corner.
    origin: [f64; 3],
    cells: CellCounts,
    /// `[[column, row], [column, row]]`: lower left and upper right cell of the bounding box of
    /// all known cells.
    known_cells: Option<[[i32; 2]; 2]>,
    has_values: bool,
    /// Of a conversion: information of the map that the file does not keep.
    #[serde(skip_serializing_if = "Option::is_none")]
    lost: Option<Lost>,
    /// The written files.
    files: Vec<String>,
}

/// Information that a file does not keep; null if nothing was lost.
#[derive(Serialize)]
struct Lost {
    resolution_m: Option<f64>,
    /// `[x, y, yaw_rad]` of the lower left corner.
    origin: Option<[f64; 3]>,
    /// Cells that became occupied.
    unknown_cells: u64,
    /// Cells that keep only their occupancy state.
    value_cells: u64,
}

impl Lost {
    fn of(losses: &[MapLoss]) -> Self {
        let mut lost = Self { resolution_m: None, origin: None, unknown_cells: 0, value_cells: 0 };
        for loss in losses {
            match *loss {
                MapLoss::Resolution(side_m) => lost.resolution_m = Some(side_m),
                MapLoss::Origin(Pose { x, y, theta }) => lost.origin = Some([x, y, theta]),
                MapLoss::Unknown(cells) => lost.unknown_cells = cells,
                MapLoss::Values(cells) => lost.value_cells = cells,
                _ => {}
            }
        }
        lost
    }
}

#[derive(Serialize)]
struct CellCounts {
    free: u64,
    occupied: u64,
    unknown: u64,
}

pub(crate) fn run(command: &MapCommand) -> Result<Done, CliError> {
    match command {
        MapCommand::Info(args) => info(args),
        MapCommand::Convert(args) => convert(args),
    }
}

fn info(args: &MapInfoArgs) -> Result<Done, CliError> {
    let loaded = load_map(&args.map.path, &args.map.place.reader())?;
    show(&report(&args.map.path, &loaded), args.format)?;
    Ok(Done::Success)
}

/// Reports on the written file, after reading it back.
fn convert(args: &MapConvertArgs) -> Result<Done, CliError> {
    let Some(format) = MapFormat::from_path(&args.out) else {
        let message = format!(
            "{}: expected a file name that ends in .yaml, .yml, .map, .pgm or .png",
            args.out.display()
        );
        return Err(CliError::new(Kind::Usage, message).field("OUT"));
    };
    let loaded = load_map(&args.map.path, &args.map.place.reader())?;
    // A YAML map is written with an image beside it.
    let image = (format == MapFormat::Ros).then(|| args.out.with_extension("pgm"));
    for path in std::iter::once(&args.out).chain(&image) {
        refuse_to_replace_a_source(&loaded.sources, path, "OUT")?;
        refuse_unwritable(path, "OUT")?;
    }
    // The lock is held until both are written and have been read back.
    let lock =
        OutputLock::of_file(&args.out).map_err(|error| CliError::from(error).field("OUT"))?;
    if lock.is_unguarded() {
        warn_of_others(&args.out);
    }
    if let Some(image) = &image {
        refuse_to_replace_an_image(&args.out, image, &loaded.grid)?;
    }
    write_map(&args.out, &loaded.grid)
        .map_err(|error| CliError::new(Kind::Output, error).field("OUT"))?;
    let losses = MapLoss::of(&loaded.grid, format);
    for loss in &losses {
        warn(format_args!("{}: {loss}{}", args.out.display(), option_of(loss)));
    }
    let as_written = MapReader { placement: None, ..args.map.place.reader() };
    let written = as_written
        .read(&args.out)
        .map_err(|error| CliError::new(Kind::Output, error).field("OUT"))?;
    let files = std::iter::once(&args.out).chain(&image);
    let files = files.map(|path| path.display().to_string()).collect();
    let lost = Some(Lost::of(&losses));
    let report = MapReport { lost, files, ..report(&args.out, &written) };
    show(&report, args.format)?;
    Ok(Done::Success)
}

/// Returns the option that restores a lost part of a map when the file is read.
fn option_of(loss: &MapLoss) -> String {
    match loss {
        MapLoss::Resolution(side_m) => format!("; read the file with --resolution {side_m}"),
        MapLoss::Origin(Pose { x, y, theta }) => {
            format!("; read the file with --origin {x},{y},{}", degrees(*theta))
        }
        _ => String::new(),
    }
}

/// Refuses to replace an image named neither by the command line nor by the YAML file that will
/// be replaced. An image with the same content is accepted.
fn refuse_to_replace_an_image(
    yaml: &Path,
    image: &Path,
    grid: &OccupancyGrid,
) -> Result<(), CliError> {
    let stands = std::fs::symlink_metadata(image).is_ok();
    if !stands
        || is_image_of(yaml, image)
        || has_content(image, &ros_map_image(grid, ImageKind::Pgm))
    {
        return Ok(());
    }
    let message = format!(
        "{} exists and would be replaced by the image of {}; choose another name, or move the file",
        image.display(),
        yaml.display()
    );
    Err(CliError::new(Kind::Output, message).field("OUT"))
}

/// True if the YAML file refers to the image.
fn is_image_of(yaml: &Path, image: &Path) -> bool {
    let named = read_file(yaml, MAX_MAP_BYTES).ok().and_then(|bytes| RosMap::parse(&bytes).ok());
    let folder = yaml.parent().unwrap_or(Path::new(""));
    let named = named.and_then(|map| folder.join(map.image).canonicalize().ok());
    named.is_some() && named == image.canonicalize().ok()
}

fn has_content(path: &Path, content: &[u8]) -> bool {
    read_file(path, content.len() as u64).is_ok_and(|bytes| bytes == content)
}

fn report(path: &Path, loaded: &LoadedMap) -> MapReport {
    let frame = loaded.grid.frame();
    let Pose { x, y, theta } = frame.origin();
    let (occupied, unknown) =
        (loaded.grid.occupied().count_ones(), loaded.grid.unknown().count_ones());
    MapReport {
        schema: "keyway.map/1",
        map: path.display().to_string(),
        format: loaded.format,
        digest: loaded.digest.clone(),
        width_cells: frame.width(),
        height_cells: frame.height(),
        resolution_m: frame.resolution_m(),
        origin: [x, y, theta],
        cells: CellCounts { free: frame.cell_count() - occupied - unknown, occupied, unknown },
        known_cells: known_cells(loaded),
        has_values: loaded.grid.values().is_some(),
        lost: None,
        files: Vec::new(),
    }
}

/// Bounding box of all free or occupied cells.
fn known_cells(loaded: &LoadedMap) -> Option<[[i32; 2]; 2]> {
    let unknown = loaded.grid.unknown();
    let spans = (0..unknown.height() as i32).filter_map(|y| {
        let is_known = |&x: &i32| !unknown.get(Cell::new(x, y));
        let mut columns = 0..unknown.width() as i32;
        let first = columns.find(is_known)?;
        Some((y, first, columns.rfind(is_known).unwrap_or(first)))
    });
    spans.fold(None, |bounds, (y, first, end)| {
        let [[left, bottom], [right, _]] = bounds.unwrap_or([[first, y], [end, y]]);
        Some([[left.min(first), bottom], [right.max(end), y]])
    })
}

fn show(report: &MapReport, format: Format) -> Result<(), CliError> {
    match format {
        Format::Json => crate::json::print(report),
        Format::Table => {
            print(&table(report))?;
            print_files(&report.files)
        }
    }
}

fn table(report: &MapReport) -> String {
    let MapReport { width_cells, height_cells, resolution_m, .. } = *report;
    let side = |cells: u32| f64::from(cells) * resolution_m;
    let [x, y, yaw] = report.origin;
    let known = report.known_cells.map_or_else(
        || "none".to_owned(),
        |[[left, bottom], [right, top]]| format!("({left}, {bottom}) to ({right}, {top})"),
    );
    facts([
        ("map", report.map.clone()),
        ("format", report.format.to_string()),
        ("digest", report.digest.clone()),
        (
            "size",
            format!(
                "{width_cells} x {height_cells} cells, {:.2} x {:.2} m",
                side(width_cells),
                side(height_cells)
            ),
        ),
        ("resolution", format!("{resolution_m} m")),
        ("origin", format!("({x}, {y}) m, {} deg", yaw.to_degrees())),
        ("free", format!("{} cells", report.cells.free)),
        ("occupied", format!("{} cells", report.cells.occupied)),
        ("unknown", format!("{} cells", report.cells.unknown)),
        ("known cells", known),
    ])
}
