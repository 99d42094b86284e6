mod either_way;
mod possible;

use super::*;
use crate::geometry::{Point, Pose};
use crate::map::{BitGrid, CellState, Edit, GridFrame};
use crate::robot::{Footprint, Robot};
use crate::sense::test_scan::{projected, scan_among};
use crate::sense::{Scan, SensedLayer, SensorScan};

/// 12 m x 12 m around the origin, in cells of 5 cm, with the cells inside these boxes occupied.
fn map(boxes: &[[f64; 4]]) -> OccupancyGrid {
    let frame = GridFrame::new(240, 240, 0.05, Pose::new(-6.0, -6.0, 0.0)).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let at = frame.world_from_cell(cell);
        let holds = |[left, low, right, high]: &[f64; 4]| {
            (*left..*right).contains(&at.x) && (*low..*high).contains(&at.y)
        };
        if boxes.iter().any(holds) { CellState::Occupied } else { CellState::Free }
    })
}

/// The tracker and the sensed layer of a robot, updated together.
struct Drive {
    robot: Robot,
    known: OccupancyGrid,
    hidden: BitGrid,
    tracker: Tracker,
    layer: SensedLayer,
    edits: Vec<Edit>,
    cycle: u32,
}

impl Drive {
    fn new(known: OccupancyGrid, hidden: &[[f64; 4]]) -> Self {
        let robot = Robot::small();
        Self {
            hidden: map(hidden).occupied().clone(),
            tracker: Tracker::new(TrackerConfig::default()).unwrap(),
            layer: SensedLayer::new(known.frame()),
            edits: Vec::new(),
            cycle: 0,
            known,
            robot,
        }
    }

    fn scan(&self, pose: Pose, circles: &[(Point, f64)]) -> Scan {
        let squares = [self.known.occupied(), &self.hidden];
        scan_among((self.known.frame(), &squares), circles, pose, &self.robot.sensors[0])
    }

    fn step(&mut self, pose: Pose, circles: &[(Point, f64)]) -> &[Mover] {
        let scan = self.scan(pose, circles);
        self.step_with(pose, &scan)
    }

    fn step_with(&mut self, pose: Pose, scan: &Scan) -> &[Mover] {
        let scan = projected(self.known.frame(), pose, scan);
        self.tracker.update(&self.known, &scan, if self.cycle == 0 { 0.0 } else { 0.1 });
        let Self { layer, known, tracker, edits, .. } = self;
        layer.update(known, &scan, Some(tracker), edits);
        self.cycle += 1;
        self.tracker.movers()
    }
}

/// Back and forth beside the origin, with a constantly changing heading.
fn slalom(cycle: u32) -> Pose {
    let t_s = 0.1 * f64::from(cycle);
    Pose::new(-1.5 + 0.4 * t_s, 0.3 * libm::sin(0.8 * t_s), 0.5 * libm::cos(0.8 * t_s))
}

const RADIUS_M: f64 = 0.25;

/// Tracks pedestrians of one size and checks every estimate; returns the number of cycles until
/// each was found.
fn follow(
    drive: &mut Drive,
    pose: impl Fn(u32) -> Pose,
    walkers: &[(Point, Point)],
    cycles: u32,
) -> Vec<u32> {
    let mut found: Vec<Option<(u64, u32)>> = vec![None; walkers.len()];
    for cycle in 0..cycles {
        let t_s = 0.1 * f64::from(cycle);
        let truth: Vec<(Point, f64)> =
            walkers.iter().map(|&(at, velocity)| (at + velocity * t_s, RADIUS_M)).collect();
        for mover in drive.step(pose(cycle), &truth) {
            let near = |&at: &usize| mover.centre.distance(truth[at].0) < 0.3;
            let Some(walker) = (0..walkers.len()).find(near) else {
                panic!("nobody is at {mover:?}, cycle {cycle}");
            };
            let (id, _) = *found[walker].get_or_insert((mover.id, cycle));
            assert_eq!(id, mover.id, "cycle {cycle}");
            let off_m = mover.centre.distance(truth[walker].0);
            assert!(off_m <= mover.position_uncertainty_m, "cycle {cycle}: {off_m} {mover:?}");
            let off_mps = (mover.velocity_mps - walkers[walker].1).norm();
            assert!(
                off_mps <= mover.velocity_uncertainty_mps,
                "cycle {cycle}: {off_mps} {mover:?}"
            );
            if mover.age_s > 1.0 && mover.unseen_s == 0.0 {
                assert!(off_m < 0.02 && off_mps < 0.05, "cycle {cycle}: {off_m} {mover:?}");
                assert!((mover.radius_m - RADIUS_M).abs() < 0.01, "cycle {cycle}: {mover:?}");
            }
        }
    }
    found.into_iter().map(|found| found.expect("each walker is found").1).collect()
}

#[test]
fn walkers_are_found_and_leave_no_trail() {
    let (right, up) = (Point::new(1.0, 0.0), Point::new(0.0, 1.0));
    let still = |_| Pose::default();
    let alone = |pose: fn(u32) -> Pose, at: Point, velocity: Point, cycles| {
        let mut drive = Drive::new(map(&[]), &[]);
        let found = follow(&mut drive, pose, &[(at, velocity)], cycles)[0];
        assert_eq!(drive.layer.count(), 0, "a trail of {at:?} at {velocity:?}");
        found
    };
    // Across, away along a beam, and slowly.
    assert!(alone(still, Point::new(1.5, -2.5), up * 0.5, 60) <= 5);
    assert!(alone(still, Point::new(0.8, 0.1), right * 0.5, 40) <= 5);
    assert!(alone(still, Point::new(1.5, -0.3), up * 0.1, 40) <= 10);
    // Towards the robot, fast, and while it spins.
    let spinning = |cycle| Pose::new(0.0, 0.0, 0.15 * f64::from(cycle));
    assert!(alone(spinning, Point::new(3.0, 0.2), right * -0.5, 40) <= 5);
    assert!(alone(still, Point::new(1.5, -2.5), up * 1.7, 25) <= 4);
    let found = alone(slalom, Point::new(1.6, -1.5), up * 0.4 + right * -0.2, 50);
    assert!(found <= 8, "{found}");
}

/// A fast approaching obstacle occludes the cells that it marked before it was known to move, so
/// no beam clears them.
#[test]
fn no_trail_stays_in_the_shadow() {
    let mut drive = Drive::new(map(&[]), &[]);
    let mut marked = 0;
    for cycle in 0..14 {
        let at = Point::new(3.2 - 0.17 * f64::from(cycle), 0.0);
        let is_found = !drive.step(Pose::default(), &[(at, 0.12)]).is_empty();
        assert!(!is_found || drive.layer.count() == 0, "cycle {cycle}");
        marked += if is_found { 0 } else { drive.layer.count() };
    }
    assert!(marked > 0 && drive.tracker.movers().len() == 1);
}

#[test]
fn walkers_that_hide_behind_each_other_stay_themselves() {
    let up = Point::new(0.0, 0.5);
    let walkers = [(Point::new(1.2, -2.0), up), (Point::new(2.2, 2.0), -up)];
    let mut drive = Drive::new(map(&[]), &[]);
    follow(&mut drive, |_| Pose::default(), &walkers, 75);
    assert_eq!(drive.layer.count(), 0);
}

/// A thin wall occludes a pedestrian for 2 s. Its motion is predicted, and it is found again.
#[test]
fn a_walker_behind_a_wall_is_expected_behind_it() {
    let mut drive = Drive::new(map(&[[1.0, -0.35, 1.1, 0.35]]), &[]);
    let bounds = crate::sense::MoverBounds { speed_mps: 2.0, acceleration_mps2: Some(2.0) };
    let (mut unseen, mut last_m) = (0, 0.0);
    for cycle in 0..70 {
        let at = Point::new(1.7, -2.0 + 0.06 * f64::from(cycle));
        let movers = drive.step(Pose::default(), &[(at, RADIUS_M)]);
        if let Some(mover) = movers.first().filter(|mover| mover.unseen_s > 0.0) {
            unseen += 1;
            assert!(mover.position_uncertainty_m > last_m, "{mover:?}");
            assert!(mover.at(0.0, &bounds).centre.distance(at) < 0.1, "{mover:?}");
            last_m = mover.position_uncertainty_m;
        }
        assert!(movers.len() <= 1);
    }
    assert!(unseen >= 5, "{unseen}");
    assert_eq!(drive.tracker.movers().len(), 1);
}

/// A wall between the robot and a pedestrian that walks past behind it: occluded from about -0.2
/// to 0.2 m.
const HIDING: [f64; 4] = [0.9, -0.3, 1.0, 0.3];

#[test]
fn who_was_out_of_view_does_not_count_as_standing() {
    let mut drive = Drive::new(map(&[HIDING]), &[]);
    let (mut was_hidden, mut seen_again) = (false, 0);
    for cycle in 0..80 {
        let at = Point::new(1.5, -1.4 + 0.03 * f64::from(cycle));
        let movers = drive.step(Pose::default(), &[(at, RADIUS_M)]);
        let unseen_s = movers.first().map_or(0.0, |mover| mover.unseen_s);
        assert!(cycle < 10 || movers.len() == 1, "cycle {cycle}: {movers:?}");
        was_hidden |= unseen_s > 1.0;
        seen_again += u32::from(was_hidden && unseen_s == 0.0);
    }
    assert!(seen_again > 10, "{seen_again}");
}

/// Its centre is too uncertain to show that it has left, but beams have passed through its
/// present position.
#[test]
fn who_comes_out_from_behind_something_is_soon_seen_to_move() {
    // Cycles from the first scan that shows it until it may move, and until it moves.
    let cycles_until_found = |step_m: f64| {
        let mut drive = Drive::new(map(&[HIDING]), &[]);
        let (mut first_seen, mut may_move) = (None, None);
        for cycle in 0..60 {
            let way_m = step_m * f64::from(cycle);
            let at = Point::new(1.5 - 0.3 * way_m, way_m);
            let is_found = !drive.step(Pose::default(), &[(at, RADIUS_M)]).is_empty();
            if first_seen.is_none() && drive.layer.count() > 0 {
                first_seen = Some(cycle);
            }
            if may_move.is_none() && !drive.tracker.possible_movers().is_empty() {
                may_move = Some(cycle);
            }
            if is_found {
                return [may_move.unwrap(), cycle].map(|found| found - first_seen.unwrap());
            }
        }
        panic!("it is not found");
    };
    let [slow, fast] = [0.02, 0.04].map(cycles_until_found);
    assert!(slow[0] <= 7 && fast[0] <= 4, "{slow:?} {fast:?}");
    assert!(slow[1] <= 12 && fast[1] <= 7, "{slow:?} {fast:?}");
}

#[test]
fn who_turns_at_once_stays_a_mover() {
    for (speed_mps, lane_m) in [(0.4, 1.0), (0.9, 1.5), (1.4, 1.5), (1.9, 2.0)] {
        let mut drive = Drive::new(map(&[]), &[]);
        for cycle in 0..20 {
            let way_m = 0.1 * speed_mps * f64::from(cycle);
            // It turns around between two scans.
            let turn_m = 1.05 * speed_mps;
            let y_m = if way_m < turn_m { way_m } else { 2.0 * turn_m - way_m };
            let at = Point::new(lane_m, y_m - 0.5);
            let movers = drive.step(Pose::default(), &[(at, RADIUS_M)]);
            let covers = |mover: &Mover| mover.centre.distance(at) <= mover.position_uncertainty_m;
            let is_known = movers.iter().any(covers);
            assert!(cycle < 6 || is_known, "{speed_mps} m/s, cycle {cycle}: {at:?} {movers:?}");
            assert!(cycle < 6 || drive.layer.count() == 0, "{speed_mps} m/s, cycle {cycle}");
        }
    }
}

/// A pedestrian walks behind a wall. A stationary post at the position where it may emerge is
/// marked, even by a new layer.
#[test]
fn what_stands_where_a_mover_is_expected_is_marked() {
    let mut drive = Drive::new(map(&[[1.0, -0.35, 1.1, 0.35]]), &[]);
    let post = (Point::new(1.7, 0.75), 0.08);
    let walker = |cycle: u32| (Point::new(1.7, -2.0 + 0.06 * f64::from(cycle)), RADIUS_M);
    let hidden = (0..100).find(|&cycle| {
        let movers = drive.step(Pose::default(), &[walker(cycle), post]);
        movers.iter().any(|mover| mover.unseen_s > 0.4)
    });
    drive.layer = SensedLayer::new(drive.known.frame());
    let mover = drive.step(Pose::default(), &[walker(hidden.unwrap() + 1), post])[0];
    assert!(mover.unseen_s > 0.0, "{mover:?}");
    assert!(mover.now().centre.distance(post.0) < mover.now().radius_m, "{mover:?}");
    assert!(drive.layer.count() >= 2);
}

/// A robot that has turned away does not forget a stationary obstacle on the predicted path of a
/// pedestrian.
#[test]
fn where_a_mover_is_only_expected_nothing_is_forgotten() {
    let mut drive = Drive::new(map(&[]), &[]);
    drive.robot.sensors[0].field_of_view_deg = 180.0;
    let post = (Point::new(1.5, 0.0), 0.08);
    let at = |cycle: u32| Point::new(1.5, -2.2 + 0.06 * f64::from(cycle));
    for cycle in 0..22 {
        drive.step(Pose::default(), &[(at(cycle), RADIUS_M), post]);
    }
    let count = drive.layer.count();
    let away = Pose::new(0.0, 0.0, std::f64::consts::PI);
    let mut covered = false;
    for cycle in 22..40 {
        let movers = drive.step(away, &[(at(22), RADIUS_M), post]);
        covered |= movers.iter().any(|mover| mover.centre.distance(post.0) < mover.radius_m);
        assert_eq!(drive.layer.count(), count, "cycle {cycle}");
    }
    assert!(count >= 2 && covered);
}

/// Unmapped posts, boxes, a long wall, and a wall with a slot through which parts of another wall
/// come into view.
#[test]
fn what_stands_is_no_mover() {
    let posts: Vec<(Point, f64)> = (0..8)
        .map(|i| {
            let side = if i % 2 == 0 { 0.9 } else { -0.9 };
            (Point::new(-1.0 + 0.5 * f64::from(i), side), 0.05 + 0.04 * f64::from(i % 4))
        })
        .collect();
    let boxes = [[0.5, 0.6, 0.9, 1.0], [1.5, -1.2, 1.6, -0.6], [3.0, -2.0, 3.05, 2.0]];
    // The part that is visible behind the slot seems to move back and forth.
    let slot = [[-2.0, -0.8, -0.1, -0.7], [0.05, -0.8, 2.5, -0.7], [-3.0, -2.3, 3.0, -2.2]];
    let all = [(&boxes[..], &[][..]), (&[], &posts), (&boxes, &posts), (&slot, &[])];
    for (boxes, posts) in all {
        let mut drive = Drive::new(map(&[]), boxes);
        for cycle in 0..90 {
            drive.step(slalom(cycle), posts);
            let movers = drive.tracker.possible_movers();
            assert!(movers.is_empty(), "cycle {cycle}: {movers:?}");
        }
        assert!(drive.layer.count() > 40);
    }
}

/// From afar, the gaps between the posts are narrower than those between beams; from nearby,
/// beams pass through them.
#[test]
fn a_fence_of_posts_is_no_mover() {
    let diagonal = |i: i32| Point::new(0.15 * f64::from(i), 0.8 + 0.15 * f64::from(i % 2));
    let row = |i: i32| Point::new(0.23 * f64::from(i), 0.8);
    let turned = |i: i32| Point::new(0.16 * f64::from(i), 0.6 + 0.16 * f64::from(i));
    let fences: [&dyn Fn(i32) -> Point; 3] = [&diagonal, &row, &turned];
    for (number, fence) in fences.iter().enumerate() {
        for posts in 3..6 {
            let posts: Vec<_> = (0..posts).map(|i| (fence(i), 0.075)).collect();
            let mut drive = Drive::new(map(&[]), &[]);
            for cycle in 0..80 {
                drive.step(Pose::new(-2.5 + 0.05 * f64::from(cycle), 0.0, 0.0), &posts);
                let movers = drive.tracker.possible_movers();
                assert!(
                    movers.is_empty(),
                    "fence {number} of {}, cycle {cycle}: {movers:?}",
                    posts.len()
                );
            }
        }
    }
}

/// While a robot drives past, parts of stationary obstacles can look like one obstacle that grows
/// and moves.
#[test]
fn what_has_grown_wider_than_a_mover_is_none() {
    let mut drive = Drive::new(map(&[]), &[]);
    for cycle in 0..30 {
        let at = Point::new(-1.0 + 0.05 * f64::from(cycle), 2.0);
        drive.step(Pose::new(0.0, 0.0, 1.57), &[(at, 0.25)]);
    }
    let tracker = &mut drive.tracker;
    let mut left = |radius_m| {
        tracker.tracks[0].radius_m = radius_m;
        tracker.end_tracks();
        tracker.tracks.len()
    };
    assert_eq!((left(0.59), left(0.61)), (1, 0), "1.2 m");
}

#[test]
fn who_stops_stands_and_who_goes_on_moves_again() {
    let mut drive = Drive::new(map(&[]), &[]);
    let mut at = Point::new(1.5, -1.0);
    let mut go = |drive: &mut Drive, cycles: u32, velocity: Point| {
        for _ in 0..cycles {
            at = at + velocity * 0.1;
            drive.step(Pose::default(), &[(at, RADIUS_M)]);
        }
        (drive.tracker.movers().len(), drive.layer.count())
    };
    let up = Point::new(0.0, 0.5);
    assert_eq!(go(&mut drive, 20, up), (1, 0));
    assert_eq!(go(&mut drive, 15, Point::default()), (1, 0), "it may go on at any time");
    let (movers, cells) = go(&mut drive, 25, Point::default());
    assert!(movers == 0 && cells > 5, "{movers} {cells}");
    assert_eq!(go(&mut drive, 20, up), (1, 0), "and what it marked is gone");
}

/// Two discs that move as one are measured by their middle, which always stays uncertain.
#[test]
fn who_is_not_round_stands_again_too() {
    let mut drive = Drive::new(map(&[]), &[]);
    let (mut moved, mut stood) = (false, false);
    for cycle in 0..90 {
        let y_m = 0.08 * f64::from(cycle.min(30)) - 1.2;
        let pair = [1.6, 2.0].map(|x_m| (Point::new(x_m, y_m + x_m - 1.8), 0.18));
        let movers = drive.step(Pose::default(), &pair);
        moved |= cycle < 30 && !movers.is_empty();
        stood |= cycle > 60 && movers.is_empty();
        assert!(cycle < 75 || movers.is_empty(), "cycle {cycle}: {movers:?}");
    }
    assert!(moved && stood);
}

#[test]
fn what_splits_becomes_two() {
    let mut drive = Drive::new(map(&[]), &[]);
    for cycle in 0..30 {
        // Side by side as one obstacle, then apart.
        let apart_m = 0.15 + 0.03 * f64::from(cycle);
        let middle = Point::new(1.5, -0.9 + 0.05 * f64::from(cycle));
        let aside = Point::new(0.0, apart_m);
        drive.step(Pose::default(), &[(middle + aside, 0.15), (middle - aside, 0.15)]);
    }
    let mut places: Vec<Point> = drive.tracker.movers().iter().map(|mover| mover.centre).collect();
    places.sort_by(|a, b| a.y.total_cmp(&b.y));
    assert_eq!(places.len(), 2, "{places:?}");
    assert!(places[0].distance(Point::new(1.5, 0.55 - 1.02)) < 0.05, "{places:?}");
    assert!(places[1].distance(Point::new(1.5, 0.55 + 1.02)) < 0.05, "{places:?}");
}

#[test]
fn who_is_gone_is_forgotten() {
    let walk = |drive: &mut Drive| {
        for cycle in 0..20 {
            let at = Point::new(1.5, -1.0 + 0.05 * f64::from(cycle));
            drive.step(Pose::default(), &[(at, RADIUS_M)]);
        }
        assert_eq!(drive.tracker.movers().len(), 1);
    };
    let mut drive = Drive::new(map(&[]), &[]);
    walk(&mut drive);
    // Seen through.
    let left: Vec<usize> = (0..5).map(|_| drive.step(Pose::default(), &[]).len()).collect();
    assert_eq!((left[0], left[4]), (1, 0));
    // Out of view: the robot is elsewhere.
    let mut drive = Drive::new(map(&[]), &[]);
    walk(&mut drive);
    let left: Vec<usize> =
        (0..25).map(|_| drive.step(Pose::new(-5.5, 0.0, 0.0), &[]).len()).collect();
    assert_eq!((left[15], left[24]), (1, 0));
}

#[test]
fn bad_input_shows_nothing_and_bad_values_are_named() {
    let good = TrackerConfig::default();
    let path = |config| Tracker::new(config).unwrap_err().path;
    assert_eq!(path(TrackerConfig { gap_m: 0.0, ..good.clone() }), "gap_m");
    assert_eq!(path(TrackerConfig { explained_m: f64::NAN, ..good.clone() }), "explained_m");
    let known = map(&[]);
    let mut tracker = Tracker::new(good).unwrap();
    let ranges = [f64::NAN, -1.0, 0.0, f64::INFINITY, 1.0, 1.0, 1.0, 1e300];
    let scans =
        [(0.1, 3.5), (0.0, 3.5), (-0.1, 3.5), (f64::NAN, 3.5), (0.1, f64::NAN), (1e-300, 3.5)];
    for (angle_increment_rad, range_max_m) in scans {
        for pose in
            [Pose::default(), Pose { x: f64::NAN, ..Pose::default() }, Pose::new(1e300, 0.0, 0.0)]
        {
            for elapsed_s in [0.1, -1.0, f64::NAN, 1e300] {
                let scan = Scan {
                    angle_min_rad: -0.2,
                    angle_increment_rad,
                    range_min_m: 0.0,
                    range_max_m,
                    ranges_m: ranges.to_vec(),
                };
                for scan in [scan, Scan::default()] {
                    tracker.update(&known, &projected(known.frame(), pose, &scan), elapsed_s);
                }
                assert!(tracker.possible_movers().is_empty());
            }
        }
    }
}

#[test]
fn warm_it_allocates_nothing_and_nothing_is_random() {
    let run = |drive: &mut Drive| {
        let mut seen = Vec::new();
        for cycle in 0..60 {
            let at = Point::new(2.0, -1.5 + 0.05 * f64::from(cycle));
            seen.extend_from_slice(drive.step(slalom(cycle), &[(at, RADIUS_M)]));
        }
        seen
    };
    let boxes = [[0.5, 0.6, 0.9, 1.0], [1.5, -1.2, 1.6, -0.6]];
    let (mut one, mut two) = (Drive::new(map(&[]), &boxes), Drive::new(map(&[]), &boxes));
    let seen = run(&mut one);
    assert!(!seen.is_empty() && seen == run(&mut two));
    let scans: Vec<(Pose, Scan)> = (0..60)
        .map(|cycle| {
            let at = Point::new(2.0, -1.5 + 0.05 * f64::from(cycle));
            (slalom(cycle), one.scan(slalom(cycle), &[(at, RADIUS_M)]))
        })
        .collect();
    let Drive { tracker, layer, known, edits, .. } = &mut one;
    let mut projected = ProjectedScan::default();
    let mut again = || {
        allocation_counter::measure(|| {
            for (pose, scan) in &scans {
                projected.project(
                    known.frame(),
                    &Footprint::POINT,
                    *pose,
                    &SensorScan::centred(0.0, scan),
                );
                tracker.update(known, &projected, 0.1);
                layer.update(known, &projected, Some(tracker), edits);
            }
        })
    };
    again();
    assert_eq!(again().count_total, 0);
}
