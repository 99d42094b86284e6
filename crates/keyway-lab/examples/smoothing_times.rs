//! Run times of the smoothers: a table for `docs/lab/performance.md`, of paths of `jps` between
//! random free cells of the given maps. Times are wall-clock microseconds; for each path, the
//! fastest of several rounds counts.
//!
//! `cargo run --release -p keyway-lab --example smoothing_times -- PATHS_PER_MAP ROUNDS MAP...`

use keyway::geometry::PlannedLine;
use keyway::map::formats::read_map;
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};
use keyway::smooth::{KeyPointCandidates, KeyPointSmoothingConfig, SmootherConfig};
use keyway_sim::metrics::statistics::Sample;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const CLEARANCES_M: [f64; 3] = [0.0, 0.2, 0.3];

/// All smoothers with their defaults, and the key points chosen from all cells; with labels.
fn smoothers() -> Vec<(String, SmootherConfig)> {
    let named = |name: &&str| Some((format!("`{name}`"), SmootherConfig::by_name(name)?));
    let mut all: Vec<_> = SmootherConfig::NAMES.iter().filter_map(named).collect();
    let candidates = KeyPointCandidates::Cells;
    let cells = KeyPointSmoothingConfig { candidates, ..KeyPointSmoothingConfig::PAPER };
    all.push(("`key-points`, `candidates=cells`".to_owned(), SmootherConfig::KeyPoints(cells)));
    all
}

/// Paths on one map; fewer than requested if free cells are rarely connected.
fn lines(map: &SearchMap, paths: usize) -> Result<Vec<PlannedLine>, Box<dyn Error>> {
    let planner = PlannerConfig::by_name("jps").ok_or("no jps")?.build(map)?;
    let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let line = |k: usize| {
        let [start, goal] = [k * 7919, k * 104_729 + 31].map(|n| free[n % free.len()]);
        let query = Query::new(start, goal);
        planner.plan_into(map, &query, &mut workspace, None, &mut plan).ok()?;
        let centre = |cell| map.frame().world_from_cell(cell);
        Some(plan.line(map, centre(start), centre(goal)))
    };
    Ok((1..20 * paths).filter_map(line).take(paths).collect())
}

/// Measures, for each smoother, the time of each path on one map \[us\].
fn measure(map: &SearchMap, paths: usize, rounds: usize) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let lines = lines(map, paths)?;
    let smoothers: Vec<_> =
        smoothers().iter().map(|(_, one)| one.build()).collect::<Result<_, _>>()?;
    let mut times_us = vec![vec![f64::INFINITY; lines.len()]; smoothers.len()];
    let (clearance, clearance_m) = (map.clearance(), map.config().clearance_m);
    for _ in 0..rounds {
        for (smoother, times_us) in smoothers.iter().zip(&mut times_us) {
            for (line, time_us) in lines.iter().zip(times_us) {
                let begin = Instant::now();
                let done = smoother.smooth(line, &clearance, clearance_m);
                *time_us = time_us.min(begin.elapsed().as_secs_f64() * 1e6);
                drop(done);
            }
        }
    }
    Ok(times_us)
}

/// Mean, 95 % quantile and worst value.
fn text(times_us: &[f64]) -> String {
    let Ok(sample) = Sample::new(times_us.to_vec()) else { return "none".to_owned() };
    let [most, worst] = [0.95, 1.0].map(|share| sample.quantile(share));
    format!("{:.0} / {most:.0} / {worst:.0}", sample.mean())
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [paths, rounds, files @ ..] = &args[..] else {
        return Err("expected PATHS_PER_MAP ROUNDS MAP...".into());
    };
    let (paths, rounds) = (paths.parse()?, rounds.parse()?);
    let mut columns = Vec::new();
    for clearance_m in CLEARANCES_M {
        let mut pooled = vec![Vec::new(); smoothers().len()];
        for file in files {
            let config = LayerConfig { clearance_m, ..LayerConfig::default() };
            let map = SearchMap::new(&read_map(Path::new(file), None)?.grid, config)?;
            for (all, times_us) in pooled.iter_mut().zip(measure(&map, paths, rounds)?) {
                all.extend(times_us);
            }
        }
        columns.push(pooled);
    }
    let counts: Vec<String> = columns.iter().map(|column| column[0].len().to_string()).collect();
    println!("paths: {}", counts.join(", "));
    println!("| smoother | no clearance | 0.2 m | 0.3 m |\n|---|---|---|---|");
    for (i, (label, _)) in smoothers().iter().enumerate() {
        let cells: Vec<String> = columns.iter().map(|column| text(&column[i])).collect();
        println!("| {label} | {} |", cells.join(" | "));
    }
    Ok(())
}
