use super::*;
use crate::geometry::{Point, Polyline};
use crate::robot::RangeSensor;
use crate::sense::test_scan::{projected, scan_among};
use crate::sense::{Scan, SensorScan};
use proptest::prelude::*;
use std::f64::consts::PI;

const CELL_M: f64 = 0.05;

fn frame() -> GridFrame {
    GridFrame::new(200, 200, CELL_M, Pose::default()).unwrap()
}

fn open() -> BitGrid {
    BitGrid::new(200, 200, false)
}

/// Walls on a map without unknown cells.
fn walls(obstacles: &BitGrid) -> Walls<'_> {
    static KNOWN: std::sync::LazyLock<BitGrid> = std::sync::LazyLock::new(open);
    Walls { obstacles, unknown: &KNOWN }
}

fn at(seen: &SeenGround, x: f64, y: f64) -> bool {
    seen.cells().behind.unwrap().get(Cell::new((x / CELL_M) as i32, (y / CELL_M) as i32))
}

#[test]
fn the_blind_sector_is_unseen_until_it_is_looked_at() {
    let frame = frame();
    let robot = Robot::jackal();
    let mut seen = SeenGround::new(&frame, &robot, 0.0, SeenWanted::Behind).unwrap();
    let mut scan = Scan::of_nothing(&robot.sensors[0]);
    // A wall to the left, 0.5 m away.
    for beam in 0..scan.ranges_m.len() {
        let sin = libm::sin(scan.bearing_rad(beam));
        if sin > 0.1 {
            scan.ranges_m[beam] = 0.5 / sin;
        }
    }
    let mut look = |pose: Pose| {
        seen.update(&frame, &projected(&frame, pose, &scan), walls(&open()), 0.05);
        seen.clone()
    };
    let seen = look(Pose::new(5.0, 5.0, 0.0));
    // The sensor sees 135 degrees to each side; the box reaches 0.254 m back.
    assert!(at(&seen, 5.5, 5.0) && at(&seen, 5.0, 4.5) && at(&seen, 4.8, 5.0));
    assert!(!at(&seen, 4.6, 5.0) && !at(&seen, 4.6, 4.7) && at(&seen, 4.6, 4.4));
    assert!(at(&seen, 5.0, 5.4) && !at(&seen, 5.0, 5.6), "behind the wall");
    let seen = look(Pose::new(f64::NAN, 5.0, -1.5));
    assert!(!at(&seen, 4.6, 5.0));
    let seen = look(Pose::new(5.0, 5.0, -2.0));
    assert!(at(&seen, 4.6, 5.0), "it has turned");
}

#[test]
fn who_sees_all_around_or_does_not_back_up_needs_none() {
    let frame = GridFrame::new(9, 9, 0.05, Pose::default()).unwrap();
    assert!(SeenGround::new(&frame, &Robot::small(), 1.0, SeenWanted::Behind).is_none());
    let mut robot = Robot::jackal();
    robot.sensors[0].field_of_view_deg = 360.0;
    assert!(SeenGround::new(&frame, &robot, 1.0, SeenWanted::Behind).is_none());
}

/// Time for which the space 0.18 m behind a robot counts as free after the robot has turned away
/// from it.
fn free_s(walker_mps: f64, walls: Walls<'_>) -> f64 {
    let frame = frame();
    let robot = Robot::jackal();
    let scan = Scan::of_nothing(&robot.sensors[0]);
    let mut seen = SeenGround::new(&frame, &robot, walker_mps, SeenWanted::Behind).unwrap();
    let facing = |theta| Pose::new(5.0, 5.0, theta);
    seen.update(&frame, &projected(&frame, facing(PI), &scan), walls, 0.05);
    let cycles = (0..100).take_while(|_| {
        seen.update(&frame, &projected(&frame, facing(0.0), &scan), walls, 0.05);
        at(&seen, 4.57, 5.0)
    });
    0.05 * cycles.count() as f64
}

#[test]
fn seen_ground_is_walked_on() {
    // Space more than a walk of 1.27 s from the area in use counts as unobserved. A cell there
    // stays free until a pedestrian from outside could reach it within 0.27 s. Cells count as a
    // whole, and a fast pedestrian advances two per cycle.
    assert!(free_s(0.0, walls(&open())) > 4.9);
    let (fast_s, slow_s) = (free_s(1.5, walls(&open())), free_s(0.5, walls(&open())));
    assert!((0.4..1.3).contains(&fast_s), "{fast_s}");
    assert!((0.6..2.5).contains(&slow_s), "{slow_s}");
    // A room closed by walls, 1 m wide: no pedestrian enters.
    let mut room = open();
    for cell in 90..=110 {
        for wall in [90, 110] {
            room.set(Cell::new(cell, wall), true);
            room.set(Cell::new(wall, cell), true);
        }
    }
    assert!(free_s(1.5, walls(&room)) > 4.9);
    // With a door it is no better than open space, nor with a wall cell that is unknown.
    let mut unknown = open();
    unknown.set(Cell::new(90, 100), true);
    assert!(free_s(1.5, Walls { obstacles: &room, unknown: &unknown }) < 1.5);
    room.set(Cell::new(90, 100), false);
    assert!(free_s(1.5, walls(&room)) < 1.5);
}

#[test]
fn what_is_far_away_is_forgotten() {
    let frame = frame();
    let robot = Robot::jackal();
    let (all, mut nothing) =
        (Scan::of_nothing(&robot.sensors[0]), Scan::of_nothing(&robot.sensors[0]));
    nothing.ranges_m.fill(0.0);
    // Without pedestrians, observed cells stay observed.
    for (walker_mps, is_known) in [(0.0, true), (1e-6, false)] {
        let mut seen = SeenGround::new(&frame, &robot, walker_mps, SeenWanted::Behind).unwrap();
        for (x, scan) in [(2.0, &all), (8.0, &nothing), (2.0, &nothing)] {
            seen.update(
                &frame,
                &projected(&frame, Pose::new(x, 5.0, 0.0), scan),
                walls(&open()),
                0.0,
            );
        }
        assert_eq!(at(&seen, 2.5, 5.0), is_known);
    }
}

#[test]
fn an_update_allocates_nothing() {
    // Rows of many words.
    let frame = GridFrame::new(1000, 100, 0.01, Pose::default()).unwrap();
    let robot = Robot::jackal();
    let scan = Scan::of_nothing(&robot.sensors[0]);
    let mut seen = SeenGround::new(&frame, &robot, 1.5, SeenWanted::Behind).unwrap();
    let nothing = BitGrid::new(1000, 100, false);
    let walls = Walls { obstacles: &nothing, unknown: &nothing };
    let mut projected = ProjectedScan::default();
    let mut look = |x: f64| {
        projected.project(
            &frame,
            &robot.footprint,
            Pose::new(x, 0.5, x),
            &SensorScan::centred(0.0, &scan),
        );
        seen.update(&frame, &projected, walls, 0.05);
    };
    look(0.1);
    // More and more of them lie around the robot.
    for x in [1.0, 4.0, 5.0] {
        assert_eq!(allocation_counter::measure(|| look(x)).count_total, 0, "{x}");
    }
}

/// Route of a pedestrian, its radius, and the share of the maximum speed that it walks at.
type Walk = (Vec<(f64, f64)>, f64, f64);

fn walkers() -> impl Strategy<Value = Vec<Walk>> {
    let points = prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 1..4);
    prop::collection::vec((points, 0.1..0.4f64, 0.5..1.0f64), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The robot drives and turns at random and some scans are lost; pedestrians pass through
    /// each other. Ends when one touches the robot.
    #[test]
    fn nobody_comes_to_free_ground_in_time(
        walkers in walkers(), turns in prop::collection::vec((-1.0..1.0f64, -3.0..3.0f64, 1u32..3), 30), is_slow: bool,
    ) {
        const SPEED_MPS: f64 = 1.5;
        let centre = Point::new(5.0, 5.0);
        // Each one walks around its points in a loop.
        let discs_at = |now_s: f64| -> Vec<(Point, f64)> {
            let disc = |(points, radius_m, share): &Walk| {
                let points = points.iter().map(|&(x, y)| centre + Point::new(x, y));
                let mut around: Vec<Point> =
                    points.chain([centre + Point::new(3.0, 0.0)]).collect();
                around.push(around[0]);
                let around = Polyline::new(around);
                let along_m = (share * SPEED_MPS * now_s).rem_euclid(around.length_m());
                (around.at_length(along_m).unwrap(), *radius_m)
            };
            walkers.iter().map(disc).collect()
        };
        let robot = Robot { cycle_s: if is_slow { 0.1 } else { 0.05 }, ..Robot::jackal() };
        let frame = frame();
        let mut seen = SeenGround::new(&frame, &robot, SPEED_MPS, SeenWanted::Behind).unwrap();
        let (mut pose, mut now_s) = (Pose::new(5.0, 5.0, 0.0), 0.0);
        for (v, omega, cycles) in turns {
            let elapsed_s = f64::from(cycles) * robot.cycle_s;
            now_s += elapsed_s;
            pose = pose.after_arc(crate::geometry::Velocity::new(v, omega), elapsed_s);
            let scan = scan_among((&frame, &[]), &discs_at(now_s), pose, &robot.sensors[0]);
            seen.update(&frame, &projected(&frame, pose, &scan), walls(&open()), elapsed_s);
            let touch_m = robot.footprint.circumscribed_radius_m();
            if discs_at(now_s).iter().any(|(centre, radius_m)| centre.distance(pose.point()) < radius_m + touch_m) {
                break;
            }
            for later in 0..=4 {
                let then_s = now_s + 0.25 * f64::from(later) * (2.0 * robot.cycle_s + 0.5 / 3.0);
                for (centre, radius_m) in discs_at(then_s) {
                    for cell in frame.cells() {
                        let place = frame.world_from_grid(Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5));
                        let is_met = place.distance(centre) < radius_m - 1e-9;
                        prop_assert!(!is_met || !seen.cells().behind.unwrap().get(cell), "{cell:?} {then_s} {centre:?} {radius_m} {pose:?}");
                    }
                }
            }
        }
    }
}

/// One of several sensors may fail: it is not enough that they see all around together.
#[test]
fn only_a_single_sensor_that_sees_all_around_needs_no_seen_ground_behind() {
    let frame = GridFrame::new(9, 9, 1.0, Pose::default()).unwrap();
    let needs = |sensors: Vec<RangeSensor>| {
        let robot = Robot { sensors, ..Robot::jackal() };
        let seen = SeenGround::new(&frame, &robot, 0.0, SeenWanted::Behind);
        seen.is_some_and(|seen| seen.cells().behind.is_some())
    };
    let all_around = RangeSensor::new(9, 360.0, 5.0);
    assert!(!needs(vec![all_around.clone()]));
    assert!(needs(vec![RangeSensor::new(9, 270.0, 5.0)]));
    assert!(needs(vec![all_around.clone(), all_around]));
}
