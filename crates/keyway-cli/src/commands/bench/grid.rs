//! `keyway bench grid`: answers scenario files and tabulates times and mistakes.

use super::grid_file::bench_file;
use crate::args::{BenchGridArgs, Format, GRID_TERMS};
use crate::commands::{Done, print};
use crate::config::resolve;
use crate::error::CliError;
use crate::progress::Progress;
use keyway::files::{FieldValue, StackBase};
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_lab::bench::{
    FileResult, GridRequest, GridRow, Mistake, grid_table, mistakes_note, totals,
};
use keyway_sim::parallel::in_parallel;
use serde::Serialize;

#[derive(Serialize)]
struct GridReport {
    schema: &'static str,
    rows: Vec<GridRow>,
    /// Totals over all files for each planner, if there are several files.
    totals: Vec<GridRow>,
    /// The answers that count as mismatches or illegal paths.
    mistakes: Vec<Mistake>,
    repeat: u64,
    every: u64,
}

pub(crate) fn run(args: &BenchGridArgs) -> Result<Done, CliError> {
    let stacks = stacks(args)?;
    let request = GridRequest { stacks: &stacks, repeat: args.repeat };
    let progress = Progress::over_files(args.scenarios.len());
    let results = in_parallel(&args.scenarios, args.jobs as usize, |scenarios| {
        bench_file(scenarios, args, request, &progress)
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
            print(&grid_table(&[&report.rows[..], &report.totals].concat()))?;
            print(&format!("\n{GRID_TERMS}"))?;
            mistakes_note(&report.mistakes).map_or(Ok(()), |note| print(&note))?;
        }
    }
    Ok(Done::when(report.rows.iter().all(GridRow::is_sound)))
}

/// The stack of every named planner.
fn stacks(args: &BenchGridArgs) -> Result<Vec<Stack>, CliError> {
    let stack = |planner: Option<&String>| {
        let planner = FieldValue::if_given("planner", "planner.name", planner.cloned());
        let robot = Robot::small();
        resolve(
            StackBase::for_robot(&Stack::for_plans(&robot), &robot),
            &args.config,
            [planner],
            &args.planners,
        )
    };
    if args.planners.is_empty() {
        return Ok(vec![stack(None)?]);
    }
    args.planners.iter().map(|name| stack(Some(name))).collect()
}
