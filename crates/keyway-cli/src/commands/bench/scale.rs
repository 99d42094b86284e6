//! `keyway bench scale`: tiles a map to increasing sizes and measures time and memory of
//! planners.

use crate::args::{BenchScaleArgs, Format, SCALE_TERMS};
use crate::commands::{Done, THROUGH_UNKNOWN, print, unusable_planner};
use crate::config::resolve;
use crate::error::{CliError, Kind};
use crate::inputs::{bad_layers, load_map, robot_size};
use crate::out_dir::prepare;
use crate::pictures::png;
use crate::progress::Progress;
use crate::stdout::print_files;
use keyway::files::{FieldValue, RobotSize, StackBase};
use keyway::navigate::Stack;
use keyway_draw::{LogChart, LogLine, LogPanel, Svg, log_chart};
use keyway_lab::bench::{
    ScaleCurves, ScaleError, ScaleReport, ScaleRequest, ScaleRow, ScaleTask, scale_table,
};
use keyway_lab::results::OutDir;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// Files written to `--out`.
const FILES: [&str; 3] = ["report.json", "scale.svg", "scale.png"];

pub(crate) fn run(args: &BenchScaleArgs) -> Result<Done, CliError> {
    // Wrong names and parameters are reported before anything is measured.
    let size = robot_size(&args.size)?;
    let stacks: Vec<Stack> =
        args.planners.iter().map(|name| stack(args, name, &size)).collect::<Result<_, _>>()?;
    let loaded = load_map(&args.map, &args.limit.reader())?;
    let request =
        ScaleRequest { map: &loaded.grid, stacks: &stacks, sides_cells: &args.sides, size: &size };
    if args.alone {
        let task = ScaleTask { planner: 0, side_cells: args.sides[0] };
        crate::json::print(&request.measure_here(task)?)?;
        return Ok(Done::Success);
    }
    let out = args.out.as_deref().map(|folder| prepare(folder, &FILES)).transpose()?;
    let progress = Progress::over_runs(0);
    let rows = request.run(|task| measure_alone(args, task), &progress)?;
    drop(progress);
    let is_sound = request.is_sound(&rows);
    let mut report = ScaleReport::new(args.map.display().to_string(), loaded.digest, rows);
    out.map(|out| write(&mut report, out)).transpose()?;
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&scale_table(&report.rows))?;
            print(&format!("\n{SCALE_TERMS}"))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::when(is_sound))
}

/// Writes the report, which names its files, and the picture.
fn write(report: &mut ScaleReport, mut out: OutDir) -> Result<(), CliError> {
    let [json, svg, png_file] = FILES;
    report.files = FILES.iter().map(|name| out.path(name).display().to_string()).collect();
    let picture = picture(report);
    out.write(json, crate::json::to_string(report).as_bytes())?;
    out.write(svg, picture.as_str().as_bytes())?;
    out.write(png_file, &png(&picture)?)?;
    out.finish()?;
    Ok(())
}

fn stack(args: &BenchScaleArgs, planner: &str, size: &RobotSize) -> Result<Stack, CliError> {
    let planner = FieldValue::new("planner", "planner.name", planner);
    let robot = size.robot_or_small();
    resolve(
        StackBase::for_robot(&Stack::for_plans(&robot), &robot),
        &args.config,
        [Some(planner), size.clearance()],
        &args.planners,
    )
}

/// Runs this program again for one planner and side.
fn measure_alone(args: &BenchScaleArgs, task: ScaleTask) -> Result<ScaleRow, CliError> {
    let (planner, side) = (args.planners[task.planner].as_str(), task.side_cells);
    let failed = |reason: String| {
        let message = format!("{planner} on {side} x {side} cells: {reason}");
        CliError::new(Kind::Input, message).field("--sides")
    };
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut words: Vec<OsString> = vec!["bench".into(), "scale".into(), args.map.clone().into()];
    words.extend(["--sides".into(), side.to_string().into()]);
    // The first planner is measured; the others are passed so that their parameters are accepted.
    let others = args.planners.iter().map(String::as_str).filter(|name| *name != planner);
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
    // An error reported by the process blames the same argument here.
    if let Ok(error) = CliError::from_report(&answer) {
        let message = format!("{planner} on {side} x {side} cells: {}", error.message);
        return Err(CliError { message, ..error });
    }
    serde_json::from_value(answer)
        .map_err(|_| failed(format!("the process ended early ({})", output.status)))
}

impl From<ScaleError> for CliError {
    fn from(error: ScaleError) -> Self {
        match error {
            ScaleError::Side(error) => Self::new(Kind::Usage, error).field("--sides"),
            ScaleError::Layers(error) => bad_layers(&error),
            ScaleError::Planner(error) => unusable_planner(error),
            ScaleError::NoFreeCell { is_unknown_blocked } => {
                let hint = is_unknown_blocked.then_some(THROUGH_UNKNOWN);
                let hint = hint.map_or_else(String::new, |hint| format!("; {hint}"));
                Self::new(Kind::Input, format!("{error}{hint}")).field("MAP")
            }
            ScaleError::Apart => {
                let message = format!("{error}; --unknown free may connect them");
                Self::new(Kind::Input, message).field("MAP")
            }
            error => Self::new(Kind::Config, error),
        }
    }
}

/// Time of preparation and query, and memory, against the side of the map.
fn picture(report: &ScaleReport) -> Svg {
    let quantities = report.curves();
    let lines: Vec<Vec<LogLine<'_>>> = quantities.iter().map(lines).collect();
    let both = quantities.iter().zip(&lines);
    let panels: Vec<LogPanel<'_>> =
        both.map(|(quantity, lines)| LogPanel { label: quantity.label, lines }).collect();
    let name = Path::new(&report.map).file_name().unwrap_or_default().to_string_lossy();
    let title = format!("From corner to corner of {name}, tiled");
    log_chart(&LogChart { title: &title, x_label: "side of the map [cells]", panels: &panels })
}

fn lines<'a>(quantity: &'a ScaleCurves<'_>) -> Vec<LogLine<'a>> {
    let curves = quantity.curves.iter();
    curves.map(|curve| LogLine { name: curve.planner, points: &curve.points }).collect()
}
