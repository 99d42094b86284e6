//! Times of the distance field: a whole map on one and two threads, windows that a sensor changes,
//! and a footprint at many poses. `cargo bench -p keyway --bench field`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use keyway::geometry::{Point, Pose};
use keyway::map::{BitGrid, Cell, CellWindow, DistanceField, FieldConfig, GridFrame};
use keyway::robot::Footprint;
use std::hint::black_box;
use std::num::NonZeroUsize;

/// Rooms of 6 m with walls of 0.1 m, doors, and a table of 0.8 m in each.
fn rooms(side: i32) -> (GridFrame, BitGrid) {
    let frame = GridFrame::new(side as u64, side as u64, 0.05, Pose::default()).unwrap();
    let mut obstacles = BitGrid::new(side as u32, side as u32, false);
    for y in 0..side {
        for x in (0..side).step_by(120) {
            if y % 120 < 2 {
                obstacles.fill_span(y, x, x + 99);
            } else if y % 120 < 100 {
                obstacles.fill_span(y, x, x + 1);
            }
            if (40..56).contains(&(y % 120)) {
                let table = x + 30 + x / 120 * 7 % 40;
                obstacles.fill_span(y, table, table + 15);
            }
        }
    }
    (frame, obstacles)
}

fn whole_maps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("field/whole");
    group.sample_size(10);
    for (side, threads) in [(600, 1), (4096, 1), (4096, 2)] {
        let (frame, obstacles) = rooms(side);
        let threads = NonZeroUsize::new(threads);
        let config = FieldConfig { threads, ..FieldConfig::default() };
        let name = format!("{side} cells, {} threads", threads.unwrap());
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| DistanceField::new(&frame, black_box(&obstacles), &config));
        });
    }
}

/// A person 0.4 m wide walks 0.2 m within a window of 10 m.
fn windows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("field/window");
    for side in [600, 4096] {
        let (frame, obstacles) = rooms(side);
        let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let window = CellWindow { low: Cell::new(250, 250), high: Cell::new(449, 449) };
        let with_someone = |x: i32| {
            let mut obstacles = obstacles.clone();
            (310..318).for_each(|y| obstacles.fill_span(y, x, x + 7));
            obstacles
        };
        let places = [with_someone(320), with_someone(324)];
        let mut field = field;
        let mut step = 0;
        group.bench_function(BenchmarkId::new("someone walks", side), |bencher| {
            bencher.iter(|| {
                step += 1;
                field.update(&places[step % 2], window)
            });
        });
    }
}

fn footprints(criterion: &mut Criterion) {
    let (frame, obstacles) = rooms(600);
    let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
    let corners = [[0.4, 0.25], [-0.4, 0.25], [-0.4, -0.25], [0.4, -0.25]];
    let footprint = Footprint::polygon(corners.map(Point::from).to_vec()).unwrap();
    let poses: Vec<Pose> = (0..10_000)
        .map(|i| {
            let i = f64::from(i);
            Pose::new(1.0 + i * 0.618 % 28.0, 1.0 + i * 0.414 % 28.0, i * 0.1)
        })
        .collect();
    criterion.bench_function("field/footprint at 10000 poses", |bencher| {
        bencher.iter(|| poses.iter().filter(|&&pose| footprint.is_free(pose, &field)).count());
    });
}

criterion_group!(benches, whole_maps, windows, footprints);
criterion_main!(benches);
