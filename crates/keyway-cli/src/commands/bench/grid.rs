//! `keyway bench grid`: scenario files -> a table of times and mistakes.

use super::raw_map::RawMap;
use super::tally::{Answer, GridRow, PathFound, row};
use crate::args::{BenchGridArgs, Format};
use crate::commands::{Done, plan::plan_base, print};
use crate::config::{FieldOption, resolve};
use crate::error::{CliError, Kind};
use crate::inputs::{load_map, read_text};
use crate::table::{number, rows};
use cpu_time::ThreadTime;
use indicatif::{ProgressBar, ProgressStyle};
use keyway::map::SearchMap;
use keyway::map::formats::{MapFormat, Scenario, read_scenarios_for};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan, PlanError};
use keyway::robot::Robot;
use keyway::search::{Query, SearchStatistics, Workspace};
use serde::Serialize;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

#[derive(Serialize)]
struct GridReport {
    schema: &'static str,
    rows: Vec<GridRow>,
}

pub(crate) fn run(args: &BenchGridArgs) -> Result<Done, CliError> {
    let stacks = stacks(args)?;
    let bar = progress_bar(args.scenarios.len());
    let rows = in_parallel(&args.scenarios, args.jobs as usize, |scenarios| {
        let rows = bench_file(scenarios, args, &stacks);
        bar.inc(1);
        rows
    });
    bar.finish_and_clear();
    let rows: Result<Vec<Vec<GridRow>>, CliError> = rows.into_iter().collect();
    let report = GridReport { schema: "keyway.bench.grid/1", rows: rows?.concat() };
    match args.format {
        Format::Json => crate::json::print(&report),
        Format::Table => print(&table(&report.rows)),
    }
    let is_sound = |row: &GridRow| row.mismatches == 0 && row.illegal_paths == 0;
    Ok(Done::when(report.rows.iter().all(is_sound)))
}

/// The parameters of every planner that was named.
fn stacks(args: &BenchGridArgs) -> Result<Vec<Stack>, CliError> {
    let stack = |planner: Option<&String>| {
        let planner = FieldOption::new("--planner", "planner.name", planner.cloned());
        resolve(&plan_base(), &Robot::small(), &args.config, [planner])
    };
    if args.planner.is_empty() {
        return Ok(vec![stack(None)?]);
    }
    args.planner.iter().map(|name| stack(Some(name))).collect()
}

/// On a terminal only, and not in the way of the report.
fn progress_bar(files: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() || files < 2 {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(files as u64);
    match ProgressStyle::with_template("{bar:30} {pos}/{len} files, {elapsed}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Maps every item with so many threads; results come in the order of the items.
fn in_parallel<T: Sync, R: Send>(
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::with_capacity(items.len()));
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while let Some((i, item)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    items.get(i).map(|item| (i, item))
                } {
                    let result = work(item);
                    // A poisoned lock holds results all the same.
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((i, result));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(i, _)| *i);
    results.into_iter().map(|(_, result)| result).collect()
}

fn bench_file(
    path: &Path,
    args: &BenchGridArgs,
    stacks: &[Stack],
) -> Result<Vec<GridRow>, CliError> {
    let map_path = map_of(path, args.map_dir.as_deref())?;
    let grid = load_map(&map_path, None)?.grid;
    let raw = RawMap::new(&read_text(&map_path, "FILE.scen")?);
    let scenarios = read_scenarios_for(path, grid.frame())
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?;
    let name = map_path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let bench = |stack: &Stack| {
        let begin = Instant::now();
        let map = SearchMap::new(&grid, stack.map.clone())
            .map_err(|error| CliError::new(Kind::Config, &error).field(error.field))?;
        let preprocessing = begin.elapsed();
        let mut workspace = Workspace::default();
        let planner = stack.planner.build();
        let mut answer_one = |s: &Scenario| answer(&*planner, &map, &raw, s, &mut workspace);
        let answers: Vec<Answer> = scenarios.iter().map(&mut answer_one).collect();
        let memory_bytes = map.memory_bytes() + workspace.memory_bytes();
        let is_optimal = stack.planner.is_optimal();
        let given = (preprocessing, memory_bytes);
        Ok(row(name.clone(), stack.planner.name(), is_optimal, &answers, given))
    };
    stacks.iter().map(bench).collect()
}

/// The map of a scenario file: beside it (or in the folder of maps) under the name that the file
/// gives, or under the scenario file's own name without `.scen`.
fn map_of(path: &Path, map_dir: Option<&Path>) -> Result<PathBuf, CliError> {
    let folder = map_dir.or(path.parent()).unwrap_or(Path::new(""));
    let named = keyway::map::formats::read_scenarios(path)
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?
        .first()
        .and_then(|scenario| Path::new(&scenario.map).file_name().map(|name| folder.join(name)));
    let own = folder.join(path.file_stem().unwrap_or_default());
    let candidates: Vec<PathBuf> = named
        .into_iter()
        .chain([own])
        .filter(|map| MapFormat::from_path(map) == Some(MapFormat::MovingAi))
        .collect();
    candidates.iter().find(|map| map.is_file()).cloned().ok_or_else(|| {
        let names: Vec<String> = candidates.iter().map(|map| map.display().to_string()).collect();
        let searched = if names.is_empty() { "a .map file".to_owned() } else { names.join(" or ") };
        let message = format!("{}: there is no map, expected {searched}", path.display());
        CliError::new(Kind::Input, message).field("FILE.scen")
    })
}

fn answer(
    planner: &dyn GlobalPlanner,
    map: &SearchMap,
    raw: &RawMap,
    scenario: &Scenario,
    workspace: &mut Workspace,
) -> Answer {
    let Scenario { start, goal, optimal_length, .. } = *scenario;
    let query = Query::new(start, goal);
    let mut plan = Plan::default();
    let (wall, cpu) = (Instant::now(), ThreadTime::try_now().ok());
    let result = planner.plan_into(map, &query, workspace, None, &mut plan);
    let cpu: Option<Duration> = cpu.and_then(|cpu| cpu.try_elapsed().ok());
    let wall = wall.elapsed();
    let statistics = match &result {
        Ok(()) => plan.statistics,
        Err(
            PlanError::NoPath { statistics } | PlanError::BudgetExhausted { statistics, .. },
        ) => *statistics,
        // A blocked end is told without a search.
        Err(_) => SearchStatistics::default(),
    };
    let judged = || match raw.legal_length(&plan.cells, start, goal) {
        Some(length_cells) => PathFound::Legal { length_cells },
        None => PathFound::Illegal,
    };
    let is_reachable = raw.is_passable(start)
        && raw.is_passable(goal)
        && (optimal_length > 0.0 || start == goal);
    Answer {
        wall,
        cpu,
        expanded: statistics.expanded,
        generated: statistics.generated,
        path: if result.is_ok() { judged() } else { PathFound::None },
        optimum: is_reachable.then_some(optimal_length),
    }
}

fn table(grid_rows: &[GridRow]) -> String {
    let header = [
        "map", "planner", "queries", "solved", "mismatches", "illegal", "mean us", "median us",
        "p99 us", "cpu us", "expanded", "excess", "prep ms", "MB",
    ];
    let cells = |row: &GridRow| {
        vec![
            row.map.clone(),
            row.planner.to_owned(),
            row.queries.to_string(),
            row.solved.to_string(),
            row.mismatches.to_string(),
            row.illegal_paths.to_string(),
            number(row.mean_us, 1),
            number(row.median_us, 1),
            number(row.p99_us, 1),
            number(row.mean_cpu_us, 1),
            number(row.mean_expanded, 0),
            number(row.mean_excess, 6),
            number(Some(row.preprocessing_ms), 2),
            number(Some(row.memory_bytes as f64 / 1e6), 1),
        ]
    };
    rows(&header, grid_rows.iter().map(cells).collect(), 2)
}
