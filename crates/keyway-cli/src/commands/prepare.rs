//! `keyway prepare`: prepares a map, so that paths on it are found in microseconds.

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
use keyway::plan::{Preparation, PreparationEstimate, PrepareError, PrepareProgress, Prepared};
use keyway_lab::measure::wall_clock;
use keyway_lab::table::{facts, paragraph, quantity};
use serde::Serialize;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Duration above which a preparation is announced \[s\].
const LONG_S: f64 = 5.0;

/// `keyway.prepare/2`.
#[derive(Serialize)]
struct PrepareReport {
    schema: &'static str,
    map: String,
    map_digest: String,
    /// `None` if it was not needed.
    estimate: Option<Estimate>,
    /// `None` if it does not pay off.
    preparation: Option<Made>,
    config: LayerConfig,
    /// The written files.
    files: Vec<String>,
}

/// Estimated cost of the preparation.
#[derive(Serialize)]
struct Estimate {
    #[serde(flatten)]
    estimate: PreparationEstimate,
    pays_from_paths: Option<f64>,
}

/// Measured cost of the preparation.
#[derive(Serialize)]
struct Made {
    #[serde(flatten)]
    preparation: Preparation,
    preparation_ms: f64,
    file_bytes: u64,
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
    let estimate = estimate(&map, args)?;
    let pays = estimate.as_ref().is_none_or(|estimate| estimate.pays(args));
    let preparation = if pays { Some(prepare(&map, &args.out)?) } else { None };
    let files = preparation.iter().map(|_| args.out.display().to_string());
    let report = PrepareReport {
        schema: "keyway.prepare/2",
        map: args.map.path.display().to_string(),
        map_digest: loaded.digest,
        files: files.collect(),
        estimate,
        preparation,
        config,
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

/// Estimates the cost if the decision to prepare depends on it, or a user watches the terminal.
fn estimate(map: &SearchMap, args: &PrepareArgs) -> Result<Option<Estimate>, CliError> {
    let is_watched = std::io::stderr().is_terminal();
    if args.if_it_pays.is_none() && !is_watched {
        return Ok(None);
    }
    let estimate = Prepared::estimate(map, wall_clock()).map_err(refused)?;
    let estimate = Estimate { pays_from_paths: estimate.pays_from_paths(), estimate };
    if is_watched && estimate.pays(args) && estimate.estimate.time_s > LONG_S {
        eprintln!("{}", estimate.in_words());
    }
    Ok(Some(estimate))
}

fn prepare(map: &SearchMap, out: &Path) -> Result<Made, CliError> {
    let bar = progress_bar();
    let begin = Instant::now();
    let prepared = Prepared::build_with_progress(map, |PrepareProgress { done, total, .. }| {
        bar.set_length(total);
        bar.set_position(done);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    let prepared = prepared.map_err(refused)?;
    let preparation_ms = begin.elapsed().as_secs_f64() * 1e3;
    let file_bytes =
        prepared.save(out).map_err(|error| CliError::new(Kind::Output, error).field("--out"))?;
    Ok(Made { preparation: prepared.preparation(), preparation_ms, file_bytes })
}

fn refused(error: PrepareError) -> CliError {
    CliError::new(Kind::Config, error).field("MAP")
}

/// A progress bar, on a terminal only.
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

impl Estimate {
    /// True if the preparation takes less time than planning the expected number of paths.
    fn pays(&self, args: &PrepareArgs) -> bool {
        let paths = args.if_it_pays.map(|paths| paths as f64);
        paths.zip(self.pays_from_paths).is_none_or(|(paths, from)| paths >= from)
    }

    fn in_words(&self) -> String {
        let PreparationEstimate { time_s, memory_bytes, peak_bytes, .. } = self.estimate;
        let [kept, peak] = [memory_bytes, peak_bytes].map(|bytes| bytes as f64 / 1e6);
        let time = match time_s {
            ..1.0 => format!("{:.0} ms", time_s * 1e3),
            _ => format!("{time_s:.0} s"),
        };
        let costs = format!(
            "the preparation takes about {time} and {kept:.1} MB of memory (peak: {peak:.1} MB)"
        );
        match self.estimate.jps_s.zip(self.pays_from_paths) {
            Some((jps_s, paths)) => format!(
                "{costs}; jps finds a path in {:.3} ms, so the preparation cannot pay for fewer than {paths:.0} paths",
                jps_s * 1e3,
            ),
            None => costs,
        }
    }
}

fn megabytes(bytes: u64) -> String {
    quantity(Some(bytes as f64 / 1e6), 3, "MB")
}

fn table(report: &PrepareReport) -> String {
    match (&report.preparation, &report.estimate) {
        (Some(made), _) => {
            let Preparation { corner_cells, edges, label_entries, memory_bytes, .. } =
                made.preparation;
            facts([
                ("file", megabytes(made.file_bytes)),
                ("memory", megabytes(memory_bytes as u64)),
                ("time", quantity(Some(made.preparation_ms), 1, "ms")),
                ("corner cells", corner_cells.to_string()),
                ("edges", edges.to_string()),
                ("label entries", label_entries.to_string()),
            ])
        }
        (None, Some(estimate)) => paragraph(&format!("not prepared: {}", estimate.in_words())),
        (None, None) => String::new(),
    }
}
