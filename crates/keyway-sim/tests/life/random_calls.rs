//! Random sequences of all calls.

use super::robot_in_a_world::RobotInAWorld;
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::map::{Cell, CellState, Edit, GridFrame, OccupancyGrid};
use keyway::navigate::{Masks, SpeedMask};
use keyway::sense::{FieldOfView, Observation, Scan, SensorPoints, SensorScan};
use proptest::prelude::*;
use std::sync::Arc;

/// A call: its number, and two numbers for its arguments.
type Call = (u8, f64, f64);

/// A room of 6 m x 4 m with a pillar, in cells of 10 cm.
fn room() -> OccupancyGrid {
    let frame = GridFrame::new(60, 40, 0.1, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(59 - cell.x).min(39 - cell.y);
        let is_pillar = (28..32).contains(&cell.x) && (16..24).contains(&cell.y);
        if edge < 1 || is_pillar { CellState::Occupied } else { CellState::Free }
    })
}

/// A different map, at another origin, larger, and with another pillar; the robot still senses
/// the true room.
fn other_room(x: f64, y: f64) -> OccupancyGrid {
    let frame = GridFrame::new(80, 60, 0.1, Pose::new(-1.0, -1.0, 0.0)).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let is_pillar = frame.world_from_cell(cell).distance(Point::new(6.0 * x, 4.0 * y)) < 0.3;
        if is_pillar { CellState::Occupied } else { CellState::Free }
    })
}

fn call(life: &mut RobotInAWorld, (which, x, y): Call) {
    let place = Point::new(6.0 * x, 4.0 * y);
    let navigator = &mut life.navigator;
    // A refused call changes nothing.
    match which % 18 {
        0..=2 => drop(navigator.set_goal(place)),
        3 => drop(navigator.set_goals(&[Point::new(4.0 * y, 4.0 * x)], place)),
        4 => drop(navigator.follow(Polyline::new(vec![life.pose.point(), place]))),
        5 => navigator.cancel(),
        6 => drop(navigator.spin(12.0 * (x - 0.5), 10.0 * y)),
        7 => drop(navigator.drive_on_heading(3.0 * x, 10.0 * y)),
        8 => drop(navigator.back_up(x, 10.0 * y)),
        9 => drop(navigator.set_speed_limit((x > 0.2).then_some(y))),
        10 => {
            let cell = Cell::new((70.0 * x) as i32, (50.0 * y) as i32);
            let state = if x > y { CellState::Occupied } else { CellState::Free };
            let cells = (0..4).map(|i| Cell::new(cell.x + i % 2, cell.y + i / 2));
            let edits: Vec<Edit> = cells.map(|cell| Edit { cell, state }).collect();
            navigator.edit_map(&edits);
        }
        11 => {
            let map = if x > 0.5 { other_room(x, y) } else { room() };
            drop(navigator.set_map(&map));
        }
        12 => {
            let frame = GridFrame::new(2, 2, 0.5, Pose::new(place.x, place.y, 0.0)).unwrap();
            let keep_out = Some(Arc::new(OccupancyGrid::from_fn(frame, |_| CellState::Occupied)));
            let speed = SpeedMask::new(frame, vec![0.1 + y; 4]).ok();
            navigator.set_masks(Masks { keep_out: keep_out.filter(|_| x > 0.3), speed });
        }
        13 => navigator.relocate((life.told)(life.pose)),
        14 => {
            if let Ok(job) = navigator.plan_job(&[], place) {
                drop(navigator.accept(job.run()));
            }
        }
        15 => drop(navigator.plan(life.pose.point(), place)),
        16 => navigator.forget_sensed(),
        _ => drop(navigator.explain()),
    }
}

fn calls() -> impl Strategy<Value = Vec<(Call, u32)>> {
    let call = (any::<u8>(), 0.0..1.0f64, 0.0..1.0f64);
    prop::collection::vec((call, 0..25u32), 1..25)
}

fn posts() -> impl Strategy<Value = Vec<Disc>> {
    let post = (0.6..5.4f64, 0.6..3.4f64, 0.05..0.3f64);
    let discs = prop::collection::vec(post, 0..4);
    discs.prop_map(|posts| {
        let disc = |(x, y, radius_m)| Disc::new(Point::new(x, y), radius_m);
        // No post is at the robot's start.
        let away = |post: &Disc| post.centre.distance(Point::new(1.0, 1.0)) > post.radius_m + 0.3;
        posts.into_iter().map(disc).filter(away).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// With true poses and scans there is no contact, for any map.
    #[test]
    fn nothing_is_touched_whatever_is_called(calls in calls(), posts in posts()) {
        let mut life = RobotInAWorld::new(&room(), Pose::new(1.0, 1.0, 0.5));
        life.posts = posts;
        for (one, cycles) in calls {
            call(&mut life, one);
            for _ in 0..cycles {
                let step = life.cycle();
                let Velocity { v, omega, .. } = step.command();
                prop_assert!(v.is_finite() && omega.is_finite());
            }
        }
    }

    /// For any inputs, there is a decision within the limits.
    #[test]
    fn false_values_never_panic_and_commands_keep_the_limits(
        calls in calls(),
        told in prop::collection::vec((any_number(6.0), any_number(4.0), any_number(1.0), any_number(0.5), any_number(3.0)), 25),
        ahead_s in prop::collection::vec(prop_oneof![4 => -0.5..0.5f64, 1 => -5e9..5e9f64, 1 => any::<f64>()], 25),
    ) {
        let mut life = RobotInAWorld::new(&room(), Pose::new(1.0, 1.0, 0.5));
        let limits = life.robot.limits.clone();
        let mut stamp_s = 0.0;
        for (((one, cycles), &(x, y, v, theta, range_m)), ahead_s) in calls.into_iter().zip(&told).zip(ahead_s) {
            call(&mut life, one);
            // Time mostly increases.
            stamp_s += if cycles == 7 { ahead_s } else { 0.3 };
            for cycle in 0..cycles.min(8) {
                let ranges_m = vec![if cycle % 2 == 0 { range_m } else { f64::INFINITY }; 90];
                let scan = Scan { ranges_m, ..Scan::of_nothing(&life.robot.sensors[0]) };
                let mount = Pose { x: v, y: theta, theta: y };
                let sensor = cycle as usize % 3 / 2;
                let scans = [SensorScan { stamp_s: stamp_s + ahead_s, sensor, mount, scan: scan.borrowed() }];
                stamp_s += 0.1;
                let (pose, velocity) = (Pose { x, y, theta }, Velocity::new(v, theta));
                let clears = FieldOfView { from_rad: x, to_rad: y, range_min_m: v, range_max_m: range_m };
                let points = [SensorPoints {
                    stamp_s: stamp_s + ahead_s,
                    sensor: cycle as usize * 3,
                    mount,
                    points: &[Point { x, y }, Point { x: v, y: theta }],
                    clears: Some(clears).filter(|_| cycle % 2 == 0),
                }];
                let observation = Observation::new(stamp_s, pose, velocity, &scans);
                life.navigator.observe(&observation.with_points(&points));
                let Velocity { v, omega, .. } = life.navigator.step().command();
                prop_assert!((limits.v_min_mps..=limits.v_max_mps).contains(&v), "{v}");
                prop_assert!(omega.abs() <= limits.omega_max_radps, "{omega}");
            }
            if cycles == 3 {
                life.navigator.relocate(Pose { x, y, theta });
                life.navigator.restart_clock();
            }
            drop(life.navigator.set_goal(Point::new(x, y)));
            drop(life.navigator.spin(v, stamp_s));
            drop(life.navigator.plan(Point::new(x, y), Point::new(y, v)));
        }
    }
}

/// Mostly a plausible number.
fn any_number(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![6 => 0.0..most, 1 => any::<f64>(), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)]
}
