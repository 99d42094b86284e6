//! `keyway bench grid`: scenario files -> a table of times and mistakes.

use super::grid_file::{FileResult, bench_file};
use super::mistakes::{Mistake, note};
use super::tally::{Answer, GridRow, row};
use crate::args::{BenchGridArgs, Format, GRID_TERMS};
use crate::commands::{Done, print};
use crate::config::{FieldOption, resolve};
use crate::error::CliError;
use crate::progress::Progress;
use keyway::files::StackBase;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_lab::parallel::in_parallel;
use keyway_lab::table::{number, percent, range, rows};
use serde::Serialize;
use std::time::Duration;

#[derive(Serialize)]
struct GridReport {
    schema: &'static str,
    rows: Vec<GridRow>,
    /// One for each planner over all files, where there are several.
    totals: Vec<GridRow>,
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
    let mut results: Vec<FileResult> = results.into_iter().collect::<Result<_, CliError>>()?;
    let totals = if results.len() > 1 { totals(&stacks, &mut results) } else { Vec::new() };
    let (rows, mistakes): (Vec<_>, Vec<_>) =
        results.into_iter().map(|file| (file.rows, file.mistakes)).unzip();
    let report = GridReport {
        schema: "keyway.bench.grid/1",
        rows: rows.concat(),
        totals,
        mistakes: mistakes.concat(),
        repeat: args.repeat,
        every: args.every,
    };
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&table(&[&report.rows[..], &report.totals].concat()))?;
            print(&format!("\n{GRID_TERMS}"))?;
            note(&report.mistakes).map_or(Ok(()), |note| print(&note))?;
        }
    }
    let is_sound = |row: &GridRow| row.mismatches == 0 && row.illegal_paths == 0;
    Ok(Done::when(report.rows.iter().all(is_sound)))
}

/// A row for each planner over the answers of all files.
fn totals(stacks: &[Stack], files: &mut [FileResult]) -> Vec<GridRow> {
    let total = |(i, stack): (usize, &Stack)| {
        let answers: Vec<Answer> =
            files.iter_mut().flat_map(|file| std::mem::take(&mut file.answers[i])).collect();
        let of_planner = files.iter().map(|file| &file.rows[i]);
        let preparation_ms: f64 = of_planner.clone().map(|row| row.preprocessing_ms).sum();
        let memory_bytes = of_planner.map(|row| row.memory_bytes).max().unwrap_or_default();
        let preparation = Duration::from_secs_f64(preparation_ms / 1e3);
        let (name, is_optimal) = (stack.planner.name(), stack.planner.is_optimal());
        row(format!("all {}", files.len()), name, is_optimal, &answers, (preparation, memory_bytes))
    };
    stacks.iter().enumerate().map(total).collect()
}

/// The parameters of every planner that was named.
fn stacks(args: &BenchGridArgs) -> Result<Vec<Stack>, CliError> {
    let stack = |planner: Option<&String>| {
        let planner = FieldOption::new("--planner", "planner.name", planner.cloned());
        let robot = Robot::small();
        resolve(
            StackBase::for_robot(&Stack::for_plans(&robot), &robot),
            &args.config,
            [planner],
            &args.planner,
        )
    };
    if args.planner.is_empty() {
        return Ok(vec![stack(None)?]);
    }
    args.planner.iter().map(|name| stack(Some(name))).collect()
}

/// The range of a mean, in a line below it.
fn below(low: Option<f64>, high: Option<f64>, shown: fn(Option<f64>) -> String) -> String {
    let range = range(low, high, shown);
    if range.is_empty() { range } else { format!("\n{range}") }
}

fn table(grid_rows: &[GridRow]) -> String {
    let header = [
        "map",
        "planner",
        "solved",
        "mis-\nmatches",
        "illegal",
        "missed",
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
            number(row.median_us, 1),
            number(row.p99_us, 1),
            number(row.mean_cpu_us, 1) + &below(row.p5_cpu_us, row.p95_cpu_us, |us| number(us, 0)),
            number(row.mean_expanded, 0)
                + &below(row.p5_expanded, row.p95_expanded, |count| number(count, 0)),
            percent(row.mean_excess, 3)
                + &below(row.p5_excess, row.p95_excess, |share| percent(share, 1)),
            number(Some(row.preprocessing_ms), 2),
            number(Some(row.memory_bytes as f64 / 1e6), 1),
        ]
    };
    rows(&header, grid_rows.iter().map(cells).collect(), 2)
}
