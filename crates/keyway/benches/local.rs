//! Times of decisions of the dynamic window, with 1,056 candidates of 30 poses each: for a disc
//! and for a box, in open space, along a corridor and among scattered obstacles. Each iteration
//! decides once at each of 64 poses; the throughput is in candidates. `cargo bench -p keyway
//! --bench local`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use keyway::geometry::{Polyline, Pose, Velocity};
use keyway::local::{DriveMemory, Dwa, DwaConfig, LocalPlanner, Scene, Scratch};
use keyway::map::{CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use keyway::robot::Robot;

/// Cells along a side, of 0.05 m each.
const SIDE: i32 = 600;

fn field(is_occupied: impl Fn(i32, i32) -> bool) -> DistanceField {
    let frame = GridFrame::new(SIDE as u64, SIDE as u64, 0.05, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| {
        if is_occupied(cell.x, cell.y) { CellState::Occupied } else { CellState::Free }
    });
    DistanceField::new(&frame, grid.occupied(), &FieldConfig::default())
}

/// A corridor of 1.4 m; pillars of 0.1 m, on average one in a square of 0.8 m.
fn scenes() -> [(&'static str, DistanceField); 3] {
    let is_pillar = |x: i32, y: i32| {
        let mixed = (x / 2).wrapping_mul(73_856_093) ^ (y / 2).wrapping_mul(19_349_663);
        mixed.wrapping_mul(0x2545_f491_u32 as i32).rotate_right(15).trailing_zeros() >= 6
    };
    [
        ("open", field(|_, _| false)),
        ("corridor", field(|_, y| (y - 299).abs() > 14)),
        ("clutter", field(is_pillar)),
    ]
}

/// 32 speeds by 32 turn rates, a cycle and 29 steps: up to twice the time to stop.
fn planner(robot: Robot) -> Dwa {
    let mut config = DwaConfig::for_robot(&robot);
    config.window.v_step_mps /= 3.05;
    config.window.omega_step_radps /= 1.52;
    config.window.horizon_s = robot.cycle_s + 2.0 * robot.limits.stop_s();
    config.window.prediction_step_s = (config.window.horizon_s - robot.cycle_s) / 29.0;
    Dwa::new(config, robot).unwrap()
}

/// Collision-free poses along the middle of the map, with headings up to 0.3 rad to either side.
fn poses(robot: &Robot, field: &DistanceField) -> Vec<Pose> {
    let pose = |i: i32| {
        let i = f64::from(i);
        Pose::new(3.0 + i * 0.618 % 18.0, 15.0 + 0.1 * (i * 0.7).sin(), 0.3 * (i * 1.9).sin())
    };
    let margin_m = robot.safety_margin_or_default_m();
    let is_free =
        |pose: &Pose| robot.footprint.distance_m(*pose, &field.clearance(), 1.0) > margin_m;
    (0..1000).map(pose).filter(is_free).take(64).collect()
}

fn decisions(criterion: &mut Criterion) {
    for (shape, robot) in [("circle", Robot::small()), ("polygon", Robot::jackal())] {
        let mut group = criterion.benchmark_group(format!("local/{shape}"));
        let planner = planner(robot.clone());
        for (name, field) in &scenes() {
            let poses = poses(&robot, field);
            let mut scratch = Scratch::default();
            let velocity = Velocity::new(0.7 * robot.limits.v_max_mps, 0.1);
            let mut decide = |pose: Pose| {
                let guide = [pose.x + 3.0, 15.0].into();
                let path = &Polyline::default();
                let sensed = field.clearance().obstacles();
                let scene = Scene {
                    obstacles: field,
                    sensed,
                    seen: keyway::sense::SeenCells::ANYWHERE,
                    movers: &[],
                    walked: &[],
                    pose,
                    velocity,
                    guide,
                    path,
                    goal_heading_rad: None,
                    remaining_m: f64::INFINITY,
                    jerk_limited: None,
                };
                match planner.decide(&scene, &mut DriveMemory::default(), &mut scratch) {
                    Ok(decision) => decision.evaluation,
                    Err(why) => why.evaluation,
                }
            };
            let evaluations: Vec<_> = poses.iter().map(|&pose| decide(pose)).collect();
            let candidates: u32 = evaluations.iter().map(|one| one.candidates).sum();
            let contacts: u32 = evaluations.iter().map(|one| one.rejected.count("contact")).sum();
            let share = 100 * contacts / candidates;
            let name = format!("{name}, {} decisions, {share} % in contact", poses.len());
            group.throughput(Throughput::Elements(u64::from(candidates)));
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                bencher.iter(|| poses.iter().map(|&pose| decide(pose).driving).sum::<u32>());
            });
        }
    }
}

criterion_group!(benches, decisions);
criterion_main!(benches);
