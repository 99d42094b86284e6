//! Times of the global planners on three kinds of maps: open ground with large obstacles, rooms
//! with doors, random clutter. `cargo bench -p keyway` compares with the last run.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use keyway::geometry::Pose;
use keyway::map::{Cell, CellState, Edit, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{GlobalPlanner, Jps, Plan, PlannerConfig};
use keyway::search::{CornerRule, Query, Sight, Workspace};
use std::hint::black_box;

const SIDE: i32 = 512;

/// Deterministic numbers below a limit (a multiplicative congruential generator).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: i32) -> i32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((self.0 >> 33) % limit as u64) as i32
    }
}

fn map(is_occupied: impl FnMut(Cell) -> bool) -> SearchMap {
    let mut is_occupied = is_occupied;
    let frame = GridFrame::new(SIDE as u64, SIDE as u64, 1.0, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| {
        if is_occupied(cell) { CellState::Occupied } else { CellState::Free }
    });
    SearchMap::new(&grid, LayerConfig::default()).unwrap()
}

fn maps() -> [(&'static str, SearchMap); 3] {
    let mut numbers = Numbers(1);
    let blocks: Vec<(i32, i32, i32)> = (0..60)
        .map(|_| (numbers.below(SIDE), numbers.below(SIDE), 10 + numbers.below(40)))
        .collect();
    let blocks = map(|cell| {
        blocks
            .iter()
            .any(|&(x, y, side)| (x..x + side).contains(&cell.x) && (y..y + side).contains(&cell.y))
    });
    let rooms = map(|Cell { x, y }| {
        let door = |a: i32, b: i32| (a / 16 * 7 + b / 16 * 5) % 13 + 2;
        (x % 16 == 0 && y % 16 != door(x, y)) || (y % 16 == 0 && x % 16 != door(y, x))
    });
    let mut numbers = Numbers(2);
    let clutter = map(|_| numbers.below(100) < 20);
    [("blocks", blocks), ("rooms", rooms), ("clutter", clutter)]
}

/// Pairs of cells with a path between them.
fn queries(map: &SearchMap) -> Vec<Query> {
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let mut numbers = Numbers(3);
    let mut cell = || Cell::new(numbers.below(SIDE), numbers.below(SIDE));
    std::iter::repeat_with(|| Query::new(cell(), cell()))
        .filter(|query| Jps.plan_into(map, query, &mut workspace, None, &mut plan).is_ok())
        .take(20)
        .collect()
}

/// Twenty queries at a time.
fn planners(criterion: &mut Criterion) {
    for (name, map) in maps() {
        let queries = queries(&map);
        let mut group = criterion.benchmark_group(name);
        let planners = [
            "jps",
            "bidirectional-optimal",
            "astar",
            "dijkstra",
            "prepared",
            "theta-star",
            "lazy-theta-star",
        ];
        for planner in planners {
            if (name, planner) == ("clutter", "prepared") {
                // Preparing clutter takes a minute.
                continue;
            }
            let built = PlannerConfig::by_name(planner).unwrap().build(&map).unwrap();
            let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
            group.bench_function(BenchmarkId::from_parameter(planner), |bencher| {
                bencher.iter(|| {
                    for query in &queries {
                        built.plan_into(&map, query, &mut workspace, None, &mut plan).unwrap();
                        black_box(&plan);
                    }
                });
            });
        }
    }
}

/// Lines of sight between the ends of all queries, each with each: 400 at a time.
fn sight(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sight");
    let open = map(|_| false);
    let [(_, blocks), ..] = maps();
    for (name, map) in [("open", open), ("blocks", blocks)] {
        let queries = queries(&map);
        let sight = Sight::new(&map, CornerRule::Forbid);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let pairs = queries.iter().flat_map(|a| queries.iter().map(|b| (a.start, b.goal)));
                pairs.filter(|&(a, b)| sight.is_free(black_box(a), b)).count()
            });
        });
    }
}

/// The edits of a scan: 720 cells around a position, one on each ray, become occupied and free
/// again, for robots of 8 and 40 cells on a large map.
fn edits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("edits of a scan");
    let frame = GridFrame::new(2000, 2000, 1.0, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let mut numbers = Numbers(4);
    let cells: Vec<Cell> = (0..720)
        .map(|ray| {
            let (far, turn) = (f64::from(20 + numbers.below(180)), f64::from(ray).to_radians());
            Cell::new(1000 + (far * turn.cos()) as i32, 1000 + (far * turn.sin()) as i32)
        })
        .collect();
    let [set, clear] = [CellState::Occupied, CellState::Free]
        .map(|state| cells.iter().map(|&cell| Edit { cell, state }).collect::<Vec<_>>());
    for clearance_m in [8.0, 40.0] {
        let config = LayerConfig { clearance_m, ..LayerConfig::default() };
        let mut map = SearchMap::new(&grid, config).unwrap();
        group.bench_function(BenchmarkId::from_parameter(clearance_m), |bencher| {
            bencher.iter(|| {
                map.apply(&set);
                map.apply(&clear);
            });
        });
    }
}

/// Costs of a map: all layers, component labels, one edit and its reversal.
fn layers(criterion: &mut Criterion) {
    let [_, (_, rooms), _] = maps();
    let grid = OccupancyGrid::from_fn(*rooms.frame(), |cell| {
        if rooms.is_free(cell) { CellState::Free } else { CellState::Occupied }
    });
    let mut group = criterion.benchmark_group("layers");
    group.bench_function("build", |bencher| {
        bencher.iter(|| SearchMap::new(black_box(&grid), LayerConfig::default()).unwrap());
    });
    let mut map = rooms;
    let cell = Cell::new(SIDE / 2 + 3, SIDE / 2 + 5);
    group.bench_function("edit", |bencher| {
        bencher.iter(|| {
            for state in [CellState::Occupied, CellState::Free] {
                map.apply(&[Edit { cell, state }]);
            }
        });
    });
    group.bench_function("components after an edit", |bencher| {
        bencher.iter(|| {
            for state in [CellState::Occupied, CellState::Free] {
                map.apply(&[Edit { cell, state }]);
                black_box(map.components(keyway::map::Connectivity::Four));
            }
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = planners, sight, edits, layers
}
criterion_main!(benches);
