//! `keyway bench scale`: one map, tiled to larger and larger ones -> time and memory of planners.
//!
//! Every planner plans every map in a process of its own, so that its peak memory is its own,
//! and its memory is as fresh as at the first query of a program.

use super::scale_run::{ScaleRow, measure};
use crate::args::{BenchScaleArgs, Format, SCALE_TERMS};
use crate::commands::{Done, print};
use crate::config::{FieldOption, resolve, size_option};
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, sized_robot};
use crate::out_dir::prepare;
use crate::pictures::png;
use crate::progress::Progress;
use crate::stdout::print_files;
use keyway::files::StackBase;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_draw::{LogChart, LogLine, LogPanel, Svg, log_chart};
use keyway_lab::results::OutDir;
use keyway_lab::table::{number, rows};
use serde::Serialize;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// The files that `--out` leaves.
const FILES: [&str; 3] = ["report.json", "scale.svg", "scale.png"];

#[derive(Serialize)]
struct ScaleReport {
    schema: &'static str,
    version: &'static str,
    map: String,
    map_digest: String,
    rows: Vec<ScaleRow>,
    /// The files that were written.
    files: Vec<String>,
}

pub(crate) fn run(args: &BenchScaleArgs) -> Result<Done, CliError> {
    // Wrong names and parameters are reported before anything is measured.
    let stacks: Vec<Stack> =
        args.planner.iter().map(|name| stack(args, name)).collect::<Result<_, _>>()?;
    let loaded = load_map(&args.map, &args.limit.reader())?;
    if args.alone {
        crate::json::print(&measure(&loaded.grid, &stacks[0], args.sides[0], &args.size)?)?;
        return Ok(Done::Success);
    }
    let mut out = args.out.as_deref().map(|folder| prepare(folder, &FILES)).transpose()?;
    let progress = Progress::over_runs(stacks.len() * args.sides.len());
    let mut measured = Vec::new();
    for &side in &args.sides {
        for name in &args.planner {
            measured.push(measure_alone(args, name, side)?);
            progress.answered();
        }
    }
    drop(progress);
    let is_sound = is_sound(&measured, &stacks);
    let report = ScaleReport {
        schema: "keyway.bench.scale/1",
        version: env!("CARGO_PKG_VERSION"),
        map: args.map.display().to_string(),
        map_digest: loaded.digest,
        rows: measured,
        files: out.iter().flat_map(files).collect(),
    };
    if let Some(out) = &mut out {
        let [json, svg, png_file] = FILES;
        let picture = picture(&report);
        out.write(json, crate::json::to_string(&report).as_bytes())?;
        out.write(svg, picture.as_str().as_bytes())?;
        out.write(png_file, &png(&picture)?)?;
    }
    out.map(OutDir::finish).transpose()?;
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&table(&report.rows))?;
            print(&format!("\n{SCALE_TERMS}"))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::when(is_sound))
}

/// The paths of the files in the folder.
fn files(out: &OutDir) -> Vec<String> {
    FILES.iter().map(|name| out.path(name).display().to_string()).collect()
}

fn stack(args: &BenchScaleArgs, planner: &str) -> Result<Stack, CliError> {
    let planner = FieldOption::new("--planner", "planner.name", Some(planner.to_owned()));
    let robot = sized_robot(&args.size)?;
    let size = size_option(&args.size, robot.as_ref());
    let robot = robot.unwrap_or_else(Robot::small);
    resolve(
        StackBase::for_robot(&Stack::for_plans(&robot), &robot),
        &args.config,
        [planner, size],
        &args.planner,
    )
}

/// Runs this program again for one planner and side.
fn measure_alone(args: &BenchScaleArgs, planner: &str, side: u32) -> Result<ScaleRow, CliError> {
    let failed = |reason: String| {
        let message = format!("{planner} on {side} x {side} cells: {reason}");
        CliError::new(Kind::Input, message).field("--sides")
    };
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut words: Vec<OsString> = vec!["bench".into(), "scale".into(), args.map.clone().into()];
    words.extend(["--sides".into(), side.to_string().into()]);
    // The first one is measured; the others are named so that their parameters are not refused.
    let others = args.planner.iter().map(String::as_str).filter(|name| *name != planner);
    for name in std::iter::once(planner).chain(others) {
        words.extend(["--planner".into(), name.into()]);
    }
    words.extend(args.size.words());
    words.extend(args.config.words());
    words.extend(args.limit.words());
    words.extend(["--alone", "--format", "json"].map(OsString::from));
    let output =
        Command::new(program).args(words).output().map_err(|error| failed(error.to_string()))?;
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    // What the process says about an argument holds for the same one here.
    if let Ok(error) = CliError::from_report(&answer) {
        let message = format!("{planner} on {side} x {side} cells: {}", error.message);
        return Err(CliError { message, ..error });
    }
    serde_json::from_value(answer)
        .map_err(|_| failed(format!("the process ended early ({})", output.status)))
}

/// Whether every planner found a path, and all optimal ones paths of the same cost.
fn is_sound(measured: &[ScaleRow], stacks: &[Stack]) -> bool {
    measured.chunks(stacks.len()).all(|side| {
        let optimal = side.iter().zip(stacks).filter(|(_, stack)| stack.planner.is_optimal());
        let costs: Vec<f64> = optimal.filter_map(|(row, _)| row.cost_cells).collect();
        let are_equal = costs.iter().all(|cost| (cost - costs[0]).abs() <= 1e-9 * costs[0]);
        are_equal && side.iter().all(|row| row.cost_cells.is_some())
    })
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

fn table(measured: &[ScaleRow]) -> String {
    let header = [
        "planner",
        "outcome",
        "side",
        "prep ms",
        "wall ms",
        "cpu ms",
        "expanded",
        "cost cells",
        "map MB",
        "search MB",
        "peak MB",
    ];
    let cells = |row: &ScaleRow| {
        vec![
            row.planner.clone(),
            row.outcome.text().to_owned(),
            row.side_cells.to_string(),
            number(Some(row.preparation_ms), 2),
            number(Some(row.wall_ms), 3),
            number(row.cpu_ms, 3),
            row.expanded.to_string(),
            number(row.cost_cells, 2),
            number(Some(megabytes(row.map_bytes)), 1),
            number(Some(megabytes(row.workspace_bytes)), 1),
            number(row.peak_resident_bytes.map(megabytes), 1),
        ]
    };
    rows(&header, measured.iter().map(cells).collect(), 2)
}

/// Time of preparation and query, and memory, against the side of the map.
fn picture(report: &ScaleReport) -> Svg {
    let mut names: Vec<&str> = Vec::new();
    for row in &report.rows {
        if !names.contains(&row.planner.as_str()) {
            names.push(&row.planner);
        }
    }
    let points = |value: &dyn Fn(&ScaleRow) -> f64| -> Vec<Vec<(f64, f64)>> {
        let of = |name: &&str| {
            let own = report.rows.iter().filter(|row| row.planner == **name);
            own.map(|row| (f64::from(row.side_cells), value(row))).collect()
        };
        names.iter().map(of).collect()
    };
    let has_peak = report.rows.iter().all(|row| row.peak_resident_bytes.is_some());
    let memory = |row: &ScaleRow| {
        megabytes(row.peak_resident_bytes.unwrap_or(row.map_bytes + row.workspace_bytes))
    };
    let memory_label = if has_peak { "peak memory [MB]" } else { "memory [MB]" };
    let series = [
        ("query [ms]", points(&|row| row.wall_ms)),
        ("preparation [ms]", points(&|row| row.preparation_ms)),
        (memory_label, points(&memory)),
    ];
    let lines: Vec<Vec<LogLine<'_>>> = series
        .iter()
        .map(|(_, of_planners)| {
            let line = |(name, points)| LogLine { name, points };
            let points = of_planners.iter().map(Vec::as_slice);
            names.iter().copied().zip(points).map(line).collect()
        })
        .collect();
    let panel = |((label, _), lines)| LogPanel { label, lines };
    let lines = lines.iter().map(Vec::as_slice);
    let panels: Vec<LogPanel<'_>> =
        series.iter().map(|(l, p)| (*l, p)).zip(lines).map(panel).collect();
    let name = Path::new(&report.map).file_name().unwrap_or_default().to_string_lossy();
    let title = format!("From corner to corner of {name}, tiled");
    log_chart(&LogChart { title: &title, x_label: "side of the map [cells]", panels: &panels })
}
