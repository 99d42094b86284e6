//! Changes of the map, the pose and the masks.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Pose};
use keyway::map::{Cell, CellState, Edit, GridFrame, OccupancyGrid};
use keyway::navigate::{Blocked, Masks, SpeedMask, Step};
use std::sync::Arc;

/// True if the route leads through the door of the wall at this height \[m\].
fn leads_through(life: &RobotInAWorld, door_m: f64) -> bool {
    let route = &life.navigator.route().unwrap().smoothed;
    let door = Point::new(6.0, door_m);
    route.segments().any(|leg| leg.distance_sq_to_point(door) < 0.25)
}

/// Edits that turn one map into another one.
fn edits(from: &OccupancyGrid, to: &OccupancyGrid) -> Vec<Edit> {
    let edit = |cell| Edit { cell, state: to.state(cell).unwrap() };
    let differs = |cell: &Cell| from.state(*cell) != to.state(*cell);
    to.frame().cells().filter(differs).map(edit).collect()
}

#[test]
fn a_door_that_closes_and_one_that_opens() {
    let (both, upper) = (hall(wall_with_doors(&[2.0, 6.5])), hall(wall_with_doors(&[6.5])));
    let mut life = RobotInAWorld::new(&both, Pose::new(2.0, 3.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 3.0)).unwrap();
    assert!(leads_through(&life, 2.0));
    life.drive_for(2.0);
    life.truth = upper.clone();
    life.navigator.edit_map(&edits(&both, &upper));
    assert!(leads_through(&life, 6.5) && *life.navigator.map().occupied() == *upper.occupied());
    life.drive_for(2.0);
    life.truth = both.clone();
    life.navigator.edit_map(&edits(&upper, &both));
    assert!(leads_through(&life, 2.0), "the shorter way again");
    life.arrive();
}

/// The resulting map is the same, edited cell by cell or replaced, whatever was sensed.
#[test]
fn edits_are_as_good_as_another_map() {
    let (both, upper) = (hall(wall_with_doors(&[2.0, 6.5])), hall(wall_with_doors(&[6.5])));
    let drive = |change: fn(&mut RobotInAWorld, &OccupancyGrid, &OccupancyGrid)| {
        let mut life = RobotInAWorld::new(&both, Pose::new(4.0, 2.5, 0.0));
        // The obstacle is in the door, and is sensed there before the map has it.
        life.posts = vec![Disc::new(Point::new(6.0, 2.0), 0.3)];
        life.navigator.set_goal(Point::new(10.0, 3.0)).unwrap();
        life.drive_for(1.5);
        assert!(life.navigator.sensed().count_ones() > 0);
        life.truth = upper.clone();
        change(&mut life, &both, &upper);
        let poses: Vec<Pose> = (0..100).map(|_| (life.cycle(), life.pose).1).collect();
        (poses, life.navigator.sensed().clone())
    };
    let (edited, sensed) = drive(|life, from, to| life.navigator.edit_map(&edits(from, to)));
    let (whole, also) = drive(|life, _, to| life.navigator.set_map(to).unwrap());
    assert_eq!((edited, sensed), (whole, also));
}

/// A growing map: its origin moves, and the goal is in the new part.
#[test]
fn a_map_that_grows() {
    let small = hall(|_| false);
    let frame = GridFrame::new(480, 320, 0.05, Pose::new(-6.0, -4.0, 0.0)).unwrap();
    let grown = OccupancyGrid::from_fn(frame, |cell| {
        let edge = cell.x.min(cell.y).min(479 - cell.x).min(319 - cell.y);
        if edge < 1 { CellState::Occupied } else { CellState::Free }
    });
    let mut life = RobotInAWorld::new(&small, Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.2), 0.3)];
    life.truth = grown.clone();
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(2.0);
    let far = Point::new(-4.0, -2.0);
    assert!(life.navigator.set_goal(far).is_err());
    let sensed = life.navigator.sensed().count_ones();
    life.navigator.set_map(&grown).unwrap();
    // The post keeps its position: each of its cells is 120 and 80 cells farther from the corner.
    let here = life.navigator.sensed().count_ones();
    assert!(sensed > 3 && here.abs_diff(sensed) <= 2, "{sensed} {here}");
    assert_eq!(life.navigator.goal().unwrap().position, Point::new(10.0, 4.0));
    life.drive_for(1.0);
    life.navigator.set_goal(far).unwrap();
    life.arrive();
}

/// The localisation is corrected by 0.3 m and 10 degrees: a post keeps its position relative to
/// the robot.
#[test]
fn what_was_sensed_keeps_its_place_beside_the_robot() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(5.0, 4.0), 0.2)];
    // The estimated pose is wrong.
    life.told = |pose| Pose::new(pose.x - 0.25, pose.y + 0.2, pose.theta + 0.17);
    life.drive_for(0.5);
    let middle = |life: &RobotInAWorld| {
        let frame = *life.truth.frame();
        let sensed = life.navigator.sensed();
        let cells: Vec<Point> = frame
            .cells()
            .filter(|&cell| sensed.get(cell))
            .map(|cell| frame.world_from_cell(cell))
            // The walls of the hall are sensed beside those of the map.
            .filter(|place| place.distance(Point::new(5.0, 4.0)) < 1.0)
            .collect();
        let sum = cells.iter().fold(Point::default(), |sum, &place| sum + place);
        (sum * (1.0 / cells.len() as f64), cells.len())
    };
    let (wrong, _) = middle(&life);
    assert!(wrong.distance(Point::new(4.8, 4.0)) > 0.2, "{wrong:?}");
    life.told = |pose| pose;
    life.navigator.relocate(life.pose);
    let (right, count) = middle(&life);
    // The visible face of the post.
    assert!(count >= 3 && right.distance(Point::new(4.8, 4.0)) < 0.06, "{right:?} {count}");
}

#[test]
fn a_speed_limit_holds_at_any_time() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(3.0);
    assert!(life.velocity.v > 0.45);
    life.navigator.set_speed_limit(Some(0.2)).unwrap();
    let before = life.velocity.v;
    life.cycle();
    let braked = life.robot.limits.deceleration_mps2 * life.robot.cycle_s;
    assert!(life.velocity.v >= before - braked - 1e-9, "no harder than it can");
    life.drive_for(1.0);
    for _ in 0..30 {
        life.cycle();
        assert!(life.velocity.v <= 0.2 + 1e-9 && life.velocity.v > 0.15, "{}", life.velocity.v);
    }
    for refused in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(life.navigator.set_speed_limit(Some(refused)).is_err());
    }
    life.navigator.set_speed_limit(None).unwrap();
    life.drive_for(2.0);
    assert!(life.velocity.v > 0.45);
    // The limit also applies to turns and acts.
    life.navigator.set_speed_limit(Some(0.05)).unwrap();
    life.navigator.drive_on_heading(0.3, 20.0).unwrap();
    life.drive_for(2.0);
    assert!(life.velocity.v <= 0.05 + 1e-9 && life.velocity.v > 0.0);
}

#[test]
fn masks_keep_it_out_and_slow_it_down() {
    let map = hall(wall_with_doors(&[2.0, 6.5]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 3.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 3.0)).unwrap();
    assert!(leads_through(&life, 2.0));
    // In cells of half a metre, with a separate origin.
    let frame = GridFrame::new(4, 4, 0.5, Pose::new(5.0, 1.0, 0.0)).unwrap();
    let keep_out = Some(Arc::new(OccupancyGrid::from_fn(frame, |_| CellState::Occupied)));
    let slow = GridFrame::new(2, 2, 2.0, Pose::new(4.0, 4.5, 0.0)).unwrap();
    let speed = Some(SpeedMask::new(slow, vec![0.15; 4]).unwrap());
    life.navigator.set_masks(Masks { keep_out, speed: speed.clone() });
    assert!(leads_through(&life, 6.5));
    assert_eq!(life.navigator.map().occupied(), map.occupied(), "the map itself is the same");
    let mut was_slow = false;
    while life.cycle() != Step::Arrived {
        let Point { x, y } = life.pose.point();
        let is_out = !(5.0..7.0).contains(&x) || !(1.0..3.0).contains(&y);
        assert!(is_out, "{:?}", life.pose);
        // A little way inside, the robot has slowed down.
        if (4.4..7.8).contains(&x) && y > 4.9 {
            assert!(life.velocity.v <= 0.15 + 1e-9, "{:?} {:?}", life.pose, life.velocity);
            was_slow = true;
        }
    }
    assert!(was_slow);
    life.navigator.set_goal(Point::new(2.0, 3.0)).unwrap();
    assert!(leads_through(&life, 6.5));
    life.navigator.set_masks(Masks { keep_out: None, speed });
    assert!(leads_through(&life, 2.0));
    life.arrive();
}

/// A mask that covers the route during the run: the robot stops before it.
#[test]
fn ground_to_keep_out_of_is_not_entered() {
    let mut life = RobotInAWorld::new(&hall(wall_with_doors(&[4.0])), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(3.0);
    let frame = GridFrame::new(1, 1, 2.0, Pose::new(5.0, 3.0, 0.0)).unwrap();
    let keep_out = Some(Arc::new(OccupancyGrid::from_fn(frame, |_| CellState::Occupied)));
    life.navigator.set_masks(Masks { keep_out, speed: None });
    let mut last = life.cycle();
    for _ in 0..200 {
        last = life.cycle();
        assert!(life.pose.x < 5.0 - life.robot.footprint.inscribed_radius_m());
    }
    assert!(matches!(last, Step::Blocked { why: Blocked::NoRoute(_), .. }), "{last:?}");
    assert!(life.navigator.set_goal(Point::new(10.0, 3.0)).is_err());
    life.navigator.set_masks(Masks::default());
    life.arrive();
}
