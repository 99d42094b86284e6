//! `keyway map`: what a map file says, and the same in another format.

use super::{Done, print};
use crate::args::{Format, MapCommand, MapConvertArgs, MapInfoArgs};
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, refuse_to_replace_a_source};
use crate::output::print_files;
use crate::table::facts;
use keyway::geometry::Pose;
use keyway::map::Cell;
use keyway::map::formats::{LoadedMap, MapFormat, write_map};
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
    /// `[[column, row], [column, row]]`: lower left and upper right of all cells that are known.
    known_cells: Option<[[i32; 2]; 2]>,
    has_values: bool,
    /// That were written.
    files: Vec<String>,
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
    let loaded = load_map(&args.map.path, args.map.place.placement())?;
    show(&report(&args.map.path, &loaded), args.format)?;
    Ok(Done::Success)
}

/// Reports on the file that was written, as it is read again.
fn convert(args: &MapConvertArgs) -> Result<Done, CliError> {
    if MapFormat::from_path(&args.out).is_none() {
        let message = format!(
            "{}: expected a file name that ends in .yaml, .yml, .map, .pgm or .png",
            args.out.display()
        );
        return Err(CliError::new(Kind::Usage, message).field("OUT"));
    }
    let loaded = load_map(&args.map.path, args.map.place.placement())?;
    // A map in YAML is written with an image beside it.
    let is_yaml = MapFormat::from_path(&args.out) == Some(MapFormat::Ros);
    let image = is_yaml.then(|| args.out.with_extension("pgm"));
    for path in std::iter::once(&args.out).chain(&image) {
        refuse_to_replace_a_source(&loaded.sources, path, "OUT")?;
    }
    write_map(&args.out, &loaded.grid)
        .map_err(|error| CliError::new(Kind::Output, error).field("OUT"))?;
    let files = std::iter::once(&args.out).chain(&image);
    let files = files.map(|path| path.display().to_string()).collect();
    let report = MapReport { files, ..report(&args.out, &load_map(&args.out, None)?) };
    show(&report, args.format)?;
    Ok(Done::Success)
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
        files: Vec::new(),
    }
}

/// The smallest rectangle around everything that is free or occupied.
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
