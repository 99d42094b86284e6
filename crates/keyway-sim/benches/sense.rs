//! Times of one scan and of one command: the tracker of movers, the sensed layer beside it, and the
//! stop rule. `cargo bench -p keyway-sim --bench sense`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::local::{Scratch, StopRule, StopRuleConfig, Surroundings};
use keyway::map::{BitGrid, Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use keyway::robot::Robot;
use keyway::sense::{Mover, ProjectedScan, Scan, SensedLayer, SensorScan, Tracker, TrackerConfig};
use keyway_sim::sim::{self, World};
use std::hint::black_box;

/// A hall of 20 m with walls that are known, and eight posts that are not.
fn hall() -> (OccupancyGrid, BitGrid) {
    let frame = GridFrame::new(400, 400, 0.05, Pose::default()).unwrap();
    let is_wall = |cell: Cell| {
        let edge = cell.x.min(cell.y).min(399 - cell.x).min(399 - cell.y);
        edge < 3 || (cell.x % 160 == 80 && cell.y % 100 < 60)
    };
    let known = OccupancyGrid::from_fn(frame, |cell| {
        if is_wall(cell) { CellState::Occupied } else { CellState::Free }
    });
    let mut posts = BitGrid::new(400, 400, false);
    for post in 0..8 {
        let (x, y) = (150 + post * 19 % 90, 160 + post * 31 % 80);
        (y..y + 4).for_each(|row| posts.fill_span(row, x, x + 3));
    }
    (known, posts)
}

/// Forty scans of a robot that drives among the posts while two people walk.
fn scans(robot: &Robot, known: &OccupancyGrid, posts: &BitGrid) -> Vec<(Pose, Scan)> {
    let walker = |x: f64, y: f64, vx: f64, vy: f64| {
        sim::MovingObstacle::straight(Point::new(x, y), 0.25, Point::new(vx, vy)).unwrap()
    };
    let walkers = vec![walker(11.0, 8.5, -0.2, 0.6), walker(8.6, 11.0, 0.3, -0.3)];
    let world = World::from_known(known, vec![]).unwrap().with_hidden(posts).unwrap();
    let world = world.with_movers(walkers);
    (0..40)
        .map(|cycle| {
            let t_s = robot.cycle_s * f64::from(cycle);
            let pose = Pose::new(9.0 + 0.3 * t_s, 9.5, 0.3 * t_s);
            (pose, world.at(t_s).cast(pose, &robot.sensors[0]))
        })
        .collect()
}

fn of_a_scan(criterion: &mut Criterion) {
    let (known, posts) = hall();
    for name in ["small", "jackal"] {
        let robot = Robot::by_name(name).unwrap();
        let scans = scans(&robot, &known, &posts);
        let config = TrackerConfig::default();
        let mut tracker = Tracker::new(config).unwrap();
        let mut projected = ProjectedScan::default();
        let beams = robot.sensors[0].beams;
        let mut group = criterion.benchmark_group("sense/40 scans");
        group.bench_function(BenchmarkId::new("tracker", beams), |bencher| {
            bencher.iter(|| {
                for (pose, scan) in &scans {
                    projected.project(
                        known.frame(),
                        &robot.footprint,
                        *pose,
                        &SensorScan::centred(0.0, black_box(scan)),
                    );
                    tracker.update(&known, &projected, robot.cycle_s);
                }
                tracker.movers().len()
            });
        });
        assert!(!tracker.movers().is_empty());
        let (mut layer, mut edits) = (SensedLayer::new(known.frame()), Vec::new());
        group.bench_function(BenchmarkId::new("layer beside it", beams), |bencher| {
            bencher.iter(|| {
                for (pose, scan) in &scans {
                    projected.project(
                        known.frame(),
                        &robot.footprint,
                        *pose,
                        &SensorScan::centred(0.0, black_box(scan)),
                    );
                    layer.update(&known, &projected, Some(&tracker), &mut edits);
                }
                layer.count()
            });
        });
    }
}

fn of_a_command(criterion: &mut Criterion) {
    let (known, _) = hall();
    let obstacles = DistanceField::new(known.frame(), known.occupied(), &FieldConfig::default());
    let movers = [Mover::standing(0, Point::new(10.0, 12.5), 0.25)];
    for name in ["small", "jackal"] {
        let robot = Robot::by_name(name).unwrap();
        let rule = StopRule::new(StopRuleConfig::for_robot(&robot), robot.clone()).unwrap();
        let velocity = Velocity::new(0.9 * robot.limits.v_max_mps, 0.1);
        let mut scratch = Scratch::default();
        // Far from everything, along a wall, and towards it.
        let places =
            [("open", 6.0, 10.0), ("along a wall", 3.65, 1.5), ("towards a wall", 3.6, 1.5)];
        for ((place, x, y), theta) in places.into_iter().zip([0.0, 1.55, 0.1]) {
            let pose = Pose::new(x, y, theta);
            let around = Surroundings {
                obstacles: &obstacles,
                seen: keyway::sense::SeenCells::ANYWHERE,
                movers: &movers,
                delay_s: 0.0,
                pose,
                velocity,
                jerk_limited: None,
            };
            let id = BenchmarkId::new(format!("sense/stop rule, {name}"), place);
            criterion.bench_with_input(id, &around, |bencher, around| {
                bencher.iter(|| rule.gate(black_box(around), velocity, &mut scratch));
            });
        }
    }
}

criterion_group!(benches, of_a_scan, of_a_command);
criterion_main!(benches);
