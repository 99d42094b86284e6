//! `keyway bench grid`: scenario files -> a table of times and mistakes.

use super::grid_file::{FileResult, bench_file};
use super::mistakes::{Mistake, note};
use super::parallel::in_parallel;
use super::tally::GridRow;
use crate::args::{BenchGridArgs, Format, GRID_TERMS};
use crate::commands::{Done, plan::plan_base, print};
use crate::config::{FieldOption, resolve};
use crate::error::CliError;
use crate::progress::Progress;
use crate::table::{number, rows};
use keyway::navigate::Stack;
use keyway::robot::Robot;
use serde::Serialize;

#[derive(Serialize)]
struct GridReport {
    schema: &'static str,
    rows: Vec<GridRow>,
    /// The answers that are counted as mismatches or illegal paths.
    mistakes: Vec<Mistake>,
    repeat: u64,
    every: u64,
}

pub(crate) fn run(args: &BenchGridArgs) -> Result<Done, CliError> {
    let stacks = stacks(args)?;
    let progress = Progress::over_files(args.scenarios.len());
    let results = in_parallel(&args.scenarios, args.jobs as usize, |scenarios| {
        bench_file(scenarios, args, &stacks, &progress)
    });
    drop(progress);
    let results: Vec<FileResult> = results.into_iter().collect::<Result<_, CliError>>()?;
    let (rows, mistakes): (Vec<_>, Vec<_>) =
        results.into_iter().map(|file| (file.rows, file.mistakes)).unzip();
    let report = GridReport {
        schema: "keyway.bench.grid/1",
        rows: rows.concat(),
        mistakes: mistakes.concat(),
        repeat: args.repeat,
        every: args.every,
    };
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&table(&report.rows))?;
            print(&format!("\n{GRID_TERMS}"))?;
            note(&report.mistakes).map_or(Ok(()), |note| print(&note))?;
        }
    }
    let is_sound = |row: &GridRow| row.mismatches == 0 && row.illegal_paths == 0;
    Ok(Done::when(report.rows.iter().all(is_sound)))
}

/// The parameters of every planner that was named.
fn stacks(args: &BenchGridArgs) -> Result<Vec<Stack>, CliError> {
    let stack = |planner: Option<&String>| {
        let planner = FieldOption::new("--planner", "planner.name", planner.cloned());
        let robot = Robot::small();
        resolve(&plan_base(&robot), &robot, &args.config, [planner], &args.planner)
    };
    if args.planner.is_empty() {
        return Ok(vec![stack(None)?]);
    }
    args.planner.iter().map(|name| stack(Some(name))).collect()
}

fn table(grid_rows: &[GridRow]) -> String {
    let header = [
        "map",
        "planner",
        "solved",
        "mis-\nmatches",
        "illegal",
        "missed",
        "mean\nus",
        "median\nus",
        "p99\nus",
        "cpu\nus",
        "ex-\npanded",
        "excess\n%",
        "prep\nms",
        "MB",
    ];
    let cells = |row: &GridRow| {
        vec![
            row.map.clone(),
            row.planner.to_owned(),
            format!("{}/{}", row.solved, row.queries),
            row.mismatches.to_string(),
            row.illegal_paths.to_string(),
            row.missed.to_string(),
            number(row.mean_us, 1),
            number(row.median_us, 1),
            number(row.p99_us, 1),
            number(row.mean_cpu_us, 1),
            number(row.mean_expanded, 0),
            number(row.mean_excess.map(|share| (share * 1e6).round() / 1e4 + 0.0), 3),
            number(Some(row.preprocessing_ms), 2),
            number(Some(row.memory_bytes as f64 / 1e6), 1),
        ]
    };
    rows(&header, grid_rows.iter().map(cells).collect(), 2)
}
