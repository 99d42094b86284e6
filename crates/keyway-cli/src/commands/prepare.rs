//! `keyway prepare`: a map -> a file with which paths on it are found in microseconds.

use super::{Done, print};
use crate::args::{Format, PrepareArgs};
use crate::config::resolve;
use crate::error::{CliError, Kind};
use crate::inputs::{layers, load_map, refuse_to_replace_a_source, refuse_unwritable, robot_size};
use crate::stdout::print_files;
use indicatif::{ProgressBar, ProgressStyle};
use keyway::files::StackBase;
use keyway::map::{LayerConfig, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{Preparation, PrepareProgress, Prepared};
use keyway_lab::table::{facts, quantity};
use serde::Serialize;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::time::Instant;

/// `keyway.prepare/1`.
#[derive(Serialize)]
struct PrepareReport {
    schema: &'static str,
    map: String,
    map_digest: String,
    out: String,
    #[serde(flatten)]
    preparation: Preparation,
    preparation_ms: f64,
    file_bytes: u64,
    config: LayerConfig,
    /// The files that were written.
    files: Vec<String>,
}

pub(crate) fn run(args: &PrepareArgs) -> Result<Done, CliError> {
    let size = robot_size(&args.size)?;
    let robot = size.robot_or_small();
    let config = resolve(
        StackBase::for_robot(&Stack::for_plans(&robot), &robot),
        &args.config,
        [size.clearance()],
        &[],
    )?
    .map;
    let loaded = load_map(&args.map.path, &args.map.place.reader())?;
    refuse_to_replace_a_source(&loaded.sources, &args.out, "--out")?;
    refuse_unwritable(&args.out, "--out")?;
    let map = layers(&loaded.grid, config.clone(), &size)?;
    let begin = Instant::now();
    let prepared = prepare(&map)?;
    let preparation_ms = begin.elapsed().as_secs_f64() * 1e3;
    let file_bytes = prepared
        .save(&args.out)
        .map_err(|error| CliError::new(Kind::Output, error).field("--out"))?;
    let report = PrepareReport {
        schema: "keyway.prepare/1",
        map: args.map.path.display().to_string(),
        map_digest: loaded.digest,
        out: args.out.display().to_string(),
        preparation: prepared.preparation(),
        preparation_ms,
        file_bytes,
        config,
        files: vec![args.out.display().to_string()],
    };
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&table(&report))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::Success)
}

fn prepare(map: &SearchMap) -> Result<Prepared, CliError> {
    let bar = progress_bar();
    let prepared = Prepared::build_with_progress(map, |PrepareProgress { done, total, .. }| {
        bar.set_length(total);
        bar.set_position(done);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    prepared.map_err(|error| CliError::new(Kind::Config, error).field("MAP"))
}

/// On a terminal only.
fn progress_bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    match ProgressStyle::with_template("{bar:30} {percent} %, {elapsed}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn table(report: &PrepareReport) -> String {
    let Preparation { corner_cells, edges, label_entries, memory_bytes, .. } = report.preparation;
    let megabytes = |bytes: f64| quantity(Some(bytes / 1e6), 3, "MB");
    facts([
        ("file", megabytes(report.file_bytes as f64)),
        ("memory", megabytes(memory_bytes as f64)),
        ("time", quantity(Some(report.preparation_ms), 1, "ms")),
        ("corner cells", corner_cells.to_string()),
        ("edges", edges.to_string()),
        ("label entries", label_entries.to_string()),
    ])
}
