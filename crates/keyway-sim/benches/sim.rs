//! Times of the simulator: a scan, and a minute of simulated driving with a controller that decides
//! nothing. `cargo bench -p keyway --bench sim`.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::map::{Cell, CellState, GridFrame, OccupancyGrid};
use keyway::robot::Robot;
use keyway::sense::Observation;
use keyway_sim::sim::{
    Action, Control, Disturbances, MovingObstacle, ObstacleMotion, Participant, Run, RunRules,
    WayPoints, World, simulate,
};
use std::hint::black_box;

const SIDE_CELLS: u64 = 600;

/// 30 m x 30 m in cells of 5 cm.
fn frame() -> GridFrame {
    GridFrame::new(SIDE_CELLS, SIDE_CELLS, 0.05, Pose::default()).unwrap()
}

/// Rooms of 6 m with walls of 0.1 m, doors, and a table of 0.8 m in each; a hall of 12 m in the
/// middle.
fn rooms() -> OccupancyGrid {
    let is_wall = |Cell { x, y }: Cell| {
        let in_hall = (181..420).contains(&x) && (181..420).contains(&y);
        let (x, y) = (x % 120, y % 120);
        let is_table = (30..46).contains(&x) && (40..56).contains(&y);
        !in_hall && (is_table || (x < 2 && y < 100) || (y < 2 && x < 100))
    };
    OccupancyGrid::from_fn(frame(), |cell| {
        if is_wall(cell) { CellState::Occupied } else { CellState::Free }
    })
}

/// 150 cylinders all around an open place of 4 m.
fn cylinders() -> Vec<Disc> {
    let places = (0..).map(|i| {
        let i = f64::from(i);
        Point::new(1.0 + i * 17.3 % 28.0, 1.0 + i * 11.7 % 28.0)
    });
    let is_apart = |place: &Point| place.distance(Point::new(15.0, 15.0)) > 4.0;
    places.filter(is_apart).take(150).map(|place| Disc::new(place, 0.1)).collect()
}

/// 20 movers to and fro across the hall, none of which comes near the robot.
fn movers() -> Vec<MovingObstacle> {
    let mover = |i: u32| {
        let x = 1.0 + 0.5 * f64::from(i) + if i < 10 { 0.0 } else { 17.0 };
        let ends = vec![Point::new(x, 2.0), Point::new(x, 28.0)];
        let motion = WayPoints::around(ends, 0.5 + 0.05 * f64::from(i)).unwrap();
        MovingObstacle::new(0.25, ObstacleMotion::WayPoints(motion)).unwrap()
    };
    (0..20).map(mover).collect()
}

fn worlds() -> Vec<(&'static str, World)> {
    let empty = OccupancyGrid::all_free(frame());
    vec![
        ("empty", World::from_known(&empty, vec![]).unwrap()),
        ("rooms", World::from_known(&rooms(), vec![]).unwrap()),
        ("150 cylinders", World::from_known(&empty, cylinders()).unwrap()),
        ("20 movers", World::from_known(&empty, vec![]).unwrap().with_movers(movers())),
    ]
}

fn scans(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sim/scan");
    for (name, world) in worlds() {
        for (robot_name, robot) in [("small", Robot::small()), ("jackal", Robot::jackal())] {
            let mut turned = 0.0_f64;
            group.bench_function(BenchmarkId::new(name, robot_name), |bencher| {
                bencher.iter(|| {
                    turned += 0.1;
                    let pose = Pose::new(15.0 + turned.cos(), 15.0, turned);
                    black_box(world.at(0.0).cast(pose, &robot.sensors[0]))
                });
            });
        }
    }
}

/// A minute in a circle of 1.5 m at most, with one slow turn of the wheel after the other.
fn minute(world: &World, robot: &Robot) -> Run {
    let mut left_m = 1e6;
    let mut circling = |&Observation { scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        black_box(scan);
        left_m -= 1.0;
        let action = Action::Drive(Velocity::new(0.5, 0.4));
        Control { action, remaining_m: left_m, route: 1, turn_left_rad: 0.0 }
    };
    let (start, goal) = (Pose::new(15.0, 14.0, 0.0), Point::new(29.0, 29.0));
    let one = Participant {
        robot,
        start,
        goal,
        disturbances: Disturbances::default(),
        rules: RunRules { time_limit_s: 60.0, ..RunRules::default() },
        controller: &mut circling,
    };
    simulate(world, &mut [one]).unwrap().remove(0)
}

fn minutes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sim/minute");
    group.sample_size(10);
    for (name, world) in worlds() {
        for (robot_name, robot) in [("small", Robot::small()), ("jackal", Robot::jackal())] {
            assert_eq!(minute(&world, &robot).samples.last().unwrap().t_s, 60.0);
            group.bench_function(BenchmarkId::new(name, robot_name), |bencher| {
                bencher.iter(|| minute(&world, &robot));
            });
        }
    }
}

criterion_group!(benches, scans, minutes);
criterion_main!(benches);
