//! Times of all smoothers on paths through the bundled house, with no clearance and with that of a
//! robot. `cargo bench -p keyway --bench smooth`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use keyway::geometry::PlannedLine;
use keyway::map::formats::read_map;
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};
use keyway::smooth::SmootherConfig;
use std::hint::black_box;
use std::path::Path;

const CLEARANCES_M: [f64; 2] = [0.0, 0.3];

/// Number of paths that are smoothed.
const PATHS: usize = 20;

/// The house for a robot, and paths between free cells all over it.
fn house(clearance_m: f64) -> (SearchMap, Vec<PlannedLine>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../keyway-cli/scenes/small_house.yaml");
    let grid = read_map(&file, None).unwrap().grid;
    let map = SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap();
    let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
    let planner = PlannerConfig::by_name("jps").unwrap().build(&map).unwrap();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let line = |k: usize| {
        let (start, goal) = (free[k * 7919 % free.len()], free[k * 104_729 % free.len()]);
        let query = Query::new(start, goal);
        planner.plan_into(&map, &query, &mut workspace, None, &mut plan).ok()?;
        let centre = |cell| map.frame().world_from_cell(cell);
        Some(plan.line(&map, centre(start), centre(goal)))
    };
    let lines: Vec<PlannedLine> = (1..1000).filter_map(line).take(PATHS).collect();
    assert_eq!(lines.len(), PATHS);
    (map, lines)
}

fn smoothers(criterion: &mut Criterion) {
    for clearance_m in CLEARANCES_M {
        let (map, lines) = house(clearance_m);
        let clearance = map.clearance();
        let mut group = criterion.benchmark_group(format!("smooth/{PATHS} paths, {clearance_m} m"));
        for name in SmootherConfig::NAMES {
            let smoother = SmootherConfig::by_name(name).unwrap().build().unwrap();
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                bencher.iter(|| {
                    let smooth = |line| smoother.smooth(black_box(line), &clearance, clearance_m);
                    lines.iter().map(|line| smooth(line).path.length_m()).sum::<f64>()
                });
            });
        }
    }
}

criterion_group!(benches, smoothers);
criterion_main!(benches);
