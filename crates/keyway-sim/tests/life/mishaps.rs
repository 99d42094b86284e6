//! Time gaps, foreign clocks and corrections at bad moments in long-running navigators.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity, wrap_angle};
use keyway::map::{CellState, Edit, GridFrame, OccupancyGrid};
use keyway::navigate::{Blocked, Doubt, Masks, NavigateError, Navigator, Stack, Step};
use keyway::robot::{RangeSensor, Robot};
use keyway::sense::{Observation, Scan, SensorScan};
use keyway_sim::sim::{MovingObstacle, World};
use std::sync::Arc;

/// Counts the sensed cells near a position.
fn sensed_near(life: &RobotInAWorld, place: Point, within_m: f64) -> usize {
    let (frame, sensed) = (*life.navigator.map().frame(), life.navigator.sensed());
    let cells = frame.cells().filter(|&cell| sensed.get(cell));
    cells.filter(|&cell| frame.world_from_cell(cell).distance(place) < within_m).count()
}

/// The robot has stopped during a gap in the observations: what it had sensed stays.
#[test]
fn a_gap_is_no_jump() {
    for gap_s in [0.5, 1.0, 10.0] {
        let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
        life.posts = vec![Disc::new(Point::new(6.0, 4.6), 0.2)];
        life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
        life.drive_for(3.0);
        let before = sensed_near(&life, Point::new(5.9, 4.6), 0.3);
        assert!(before > 2);
        (0..8).for_each(|_| life.obey(Velocity::ZERO));
        life.stamp_s += gap_s;
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &[]));
        let is_jump = |doubt: &Doubt| matches!(doubt, Doubt::PoseJumped { .. });
        assert!(!life.navigator.doubts().iter().any(is_jump), "{gap_s}");
        assert_eq!(sensed_near(&life, Point::new(5.9, 4.6), 0.3), before, "{gap_s}");
    }
}

/// A low lidar detects a box below the beams of the high one; their stamps differ, in either
/// order.
#[test]
fn one_lidar_does_not_erase_what_the_other_meets() {
    let mut robot = Robot::small();
    robot.sensors = vec![RangeSensor::new(360, 360.0, 5.0); 2];
    let map = hall(|_| false);
    let stack = Stack::keyway(&robot).fit(&robot).unwrap();
    let box_there = World::from_known(&map, vec![Disc::new(Point::new(5.0, 4.0), 0.2)]).unwrap();
    let nothing = World::from_known(&map, vec![]).unwrap();
    let pose = Pose::new(3.0, 4.0, 0.0);
    let low = box_there.at(0.0).cast(pose, &robot.sensors[0]);
    let high = nothing.at(0.0).cast(pose, &robot.sensors[1]);
    for high_is_first in [false, true] {
        let mut navigator = Navigator::new(&map, &stack).unwrap();
        for cycle in 0..10 {
            let stamp_s = 0.1 * f64::from(cycle);
            let (low_s, high_s) =
                (stamp_s - 0.02, stamp_s - if cycle % 2 == 0 { 0.004 } else { 0.06 });
            let mut scans =
                [SensorScan::of(&robot, 0, low_s, &low), SensorScan::of(&robot, 1, high_s, &high)];
            if high_is_first {
                scans.reverse();
            }
            navigator.observe(&Observation::new(stamp_s, pose, Velocity::ZERO, &scans));
            let sensed = navigator.sensed().count_ones();
            assert!(cycle == 0 || sensed > 2, "{high_is_first} {cycle} {sensed}");
        }
        // The box is removed, and the low lidar detects that.
        for cycle in 10..13 {
            let stamp_s = 0.1 * f64::from(cycle);
            let scans = [0, 1].map(|sensor| SensorScan::of(&robot, sensor, stamp_s, &high));
            navigator.observe(&Observation::new(stamp_s, pose, Velocity::ZERO, &scans));
        }
        assert_eq!(navigator.sensed().count_ones(), 0);
    }
}

fn keep_out(x: f64, y: f64, side_m: f64) -> Arc<OccupancyGrid> {
    let frame = GridFrame::new(1, 1, side_m, Pose::new(x, y, 0.0)).unwrap();
    Arc::new(OccupancyGrid::from_fn(frame, |_| CellState::Occupied))
}

/// A box and a pedestrian in a keep-out zone are sensed, and the box is still mapped after the
/// zone is removed.
#[test]
fn ground_to_keep_out_of_hides_nobody() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(5.0, 3.6), 0.2)];
    life.navigator.set_masks(Masks { keep_out: Some(keep_out(4.0, 3.0, 2.0)), speed: None });
    let world = World::from_known(&life.truth, life.posts.clone()).unwrap();
    let walker = MovingObstacle::straight(Point::new(4.6, 5.8), 0.25, Point::new(0.0, -0.6));
    let world = world.with_movers(vec![walker.unwrap()]);
    let mut followed = 0;
    for _ in 0..20 {
        let scan = world.at(life.stamp_s).cast(life.pose, &life.robot.sensors[0]);
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        life.navigator.step();
        followed += life.navigator.movers().len();
        life.obey(Velocity::ZERO);
    }
    assert!(followed > 10, "{followed}");
    let face = Point::new(4.8, 3.6);
    assert!(sensed_near(&life, face, 0.2) > 2);
    life.navigator.set_masks(Masks::default());
    let path = Polyline::new(vec![Point::new(2.0, 3.6), Point::new(6.0, 3.6)]);
    assert!(!life.navigator.is_path_valid(&path));
}

/// The lidar's driver uses another clock for its stamps.
#[test]
fn scans_from_the_future_are_none() {
    for ahead_s in [1.7e9, 3600.0, 0.6] {
        let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
        life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
        let scan = Scan::of_nothing(&life.robot.sensors[0]);
        let stamp_s = 5.0;
        let scans = [SensorScan::of(&life.robot, 0, stamp_s + ahead_s, &scan)];
        let (pose, velocity) = (life.pose, life.velocity);
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let step = life.navigator.step();
        assert!(
            matches!(step, Step::Blocked { why: Blocked::SensorSilent { .. }, .. }),
            "{step:?}"
        );
        assert_eq!(life.navigator.now_s(), Some(5.0));
        life.stamp_s = 5.1;
        assert!(matches!(life.cycle(), Step::Drive(_)), "with true stamps it drives");
    }
}

/// A correction of the pose is not motion of an act: the rest of the act stays.
#[test]
fn a_correction_does_not_shorten_an_act() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 4.0, 0.0));
    life.navigator.drive_on_heading(1.5, 60.0).unwrap();
    life.drive_for(3.0);
    life.observe();
    let driven_m = life.pose.x - 3.0;
    life.pose = Pose::new(5.0, 5.0, 0.4);
    life.navigator.relocate(life.pose);
    life.arrive();
    let more_m = life.pose.point().distance(Point::new(5.0, 5.0));
    assert!((driven_m + more_m - 1.5).abs() < 0.02, "{driven_m} {more_m}");
    life.navigator.spin(2.0, 60.0).unwrap();
    let from_rad = life.pose.theta;
    life.drive_for(2.0);
    life.observe();
    let turned_rad = wrap_angle(life.pose.theta - from_rad);
    life.pose = Pose::new(life.pose.x, life.pose.y, life.pose.theta + 1.0);
    life.navigator.relocate(life.pose);
    let again_rad = life.pose.theta;
    life.arrive();
    let more_rad = wrap_angle(life.pose.theta - again_rad);
    assert!((turned_rad + more_rad - 2.0).abs() < 0.02, "{turned_rad} {more_rad}");
    // An invalid pose does not count either.
    life.navigator.relocate(Pose { x: f64::NAN, ..life.pose });
    assert_eq!(life.cycle(), Step::Arrived);
}

/// Without steps for a while, an act still has all of its time.
#[test]
fn idle_time_is_not_that_of_an_act() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 4.0, 0.0));
    life.cycle();
    life.stamp_s += 100.0;
    life.observe();
    life.navigator.spin(0.5, 10.0).unwrap();
    life.arrive();
}

/// The size of a parked navigator that only observes does not grow.
#[test]
fn who_only_observes_does_not_grow() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 4.0, 0.0));
    let scan = |range_m: f64| Scan {
        ranges_m: vec![range_m; 360],
        ..Scan::of_nothing(&life.robot.sensors[0])
    };
    let scans = [scan(1.0), scan(1.5), scan(2.0)];
    let bytes = |navigator: &Navigator| {
        let mut bytes = Vec::new();
        ciborium::into_writer(&navigator.snapshot(), &mut bytes).unwrap();
        bytes.len()
    };
    let mut sizes = Vec::new();
    for cycle in 0..3000_usize {
        let stamp_s = 0.1 * cycle as f64;
        let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scans[cycle % 3])];
        let (pose, velocity) = (life.pose, life.velocity);
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        if cycle % 500 == 499 {
            sizes.push(bytes(&life.navigator));
        }
    }
    // A list of all changes would take several megabytes.
    assert!(sizes.iter().all(|&size| size < 500_000), "{sizes:?}");
}

#[test]
fn a_path_is_kept_where_nothing_is_in_the_way() {
    let map = hall(|_| false);
    let corners = [[2.0, 4.0], [4.0, 6.5], [8.0, 6.5], [10.0, 4.0]];
    let path = Polyline::new(corners.iter().map(|&corner| Point::from(corner)).collect());
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.8));
    life.navigator.follow(path.clone()).unwrap();
    life.drive_for(3.0);
    // A cell changes far away, and the localisation is corrected slightly.
    let far = map.frame().cell_near(Point::new(6.0, 1.0));
    life.navigator.edit_map(&[Edit { cell: far, state: CellState::Occupied }]);
    life.pose = Pose::new(life.pose.x + 0.05, life.pose.y, life.pose.theta);
    life.navigator.relocate(life.pose);
    let passes = |life: &RobotInAWorld, place: [f64; 2]| {
        let route = &life.navigator.route().unwrap().smoothed;
        route.segments().any(|leg| leg.distance_sq_to_point(Point::from(place)) < 0.01)
    };
    assert!(passes(&life, [6.0, 6.5]) && passes(&life, [8.0, 6.5]));
    // A wall across the path: the rest is replanned.
    let wall: Vec<Edit> = (100..159)
        .map(|y| Edit { cell: keyway::map::Cell::new(140, y), state: CellState::Occupied })
        .collect();
    life.navigator.edit_map(&wall);
    assert!(!passes(&life, [7.0, 6.5]));
    life.posts =
        (0..8).map(|i| Disc::new(Point::new(7.025, 5.2 + 0.35 * f64::from(i)), 0.2)).collect();
    life.arrive();
}

/// A closed path ends after the whole loop, and a path far away is refused.
#[test]
fn a_loop_is_driven_before_it_ends() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(3.0, 2.0, 0.0));
    let corners = [[3.0, 2.0], [9.0, 2.0], [9.0, 6.0], [3.0, 6.0], [3.0, 2.0]];
    let path = |corners: &[[f64; 2]]| {
        Polyline::new(corners.iter().map(|&corner| Point::from(corner)).collect())
    };
    life.navigator.follow(path(&corners)).unwrap();
    let took_s = life.arrive();
    // 20 m at 0.5 m/s, minus the parts cut at the corners.
    assert!(took_s > 25.0, "{took_s}");
    let refused = life.navigator.follow(path(&[[9.0, 6.0], [3.0, 6.0]])).unwrap_err();
    assert!(matches!(refused, NavigateError::PathFarAway { .. }), "{refused}");
    assert!(refused.to_string().contains("drive to its beginning first"), "{refused}");
}

/// A door closes during the search for a route.
#[test]
fn a_route_of_another_map_is_not_taken() {
    let (both, upper) = (hall(wall_with_doors(&[2.0, 6.5])), hall(wall_with_doors(&[6.5])));
    let mut life = RobotInAWorld::new(&both, Pose::new(2.0, 3.0, 0.0));
    let job = life.navigator.plan_job(&[], Point::new(10.0, 3.0)).unwrap();
    life.navigator.set_map(&upper).unwrap();
    life.truth = upper;
    life.navigator.accept(job.run()).unwrap();
    let route = &life.navigator.route().unwrap().smoothed;
    assert!(route.segments().all(|leg| leg.distance_sq_to_point(Point::new(6.0, 2.0)) > 1.0));
    life.arrive();
    let closed = hall(wall_with_doors(&[]));
    let job = life.navigator.plan_job(&[], Point::new(2.0, 3.0)).unwrap();
    life.navigator.set_map(&closed).unwrap();
    assert!(life.navigator.accept(job.run()).is_err());
}

#[test]
fn an_explanation_is_of_the_speed_limit() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.navigator.set_speed_limit(Some(0.12)).unwrap();
    life.drive_for(3.0);
    let explanation = life.navigator.explain();
    let fastest = explanation.candidates.iter().map(|it| it.velocity.v).fold(0.0, f64::max);
    assert!(!explanation.candidates.is_empty() && fastest <= 0.12 + 1e-9, "{fastest}");
    life.observe();
    assert!(life.navigator.explain().candidates.is_empty(), "something has changed since");
}

/// On open ground the trajectory leads straight on at the robot's full speed.
#[test]
fn a_course_is_that_of_the_last_decision() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    assert!(life.navigator.course().is_empty(), "nothing was decided yet");
    life.drive_for(3.0);
    let (course, pose) = (life.navigator.course(), life.pose);
    assert!(course[0].point().distance(pose.point()) < 0.1, "{:?} {pose:?}", course[0]);
    let length_m: f64 =
        course.windows(2).map(|ends| ends[0].point().distance(ends[1].point())).sum();
    let limits = &life.navigator.stack().robot().limits;
    assert!((0.5..=3.1).contains(&(length_m / limits.v_max_mps)), "{length_m}");
    assert!(course.iter().all(|pose| (pose.y - 4.0).abs() < 0.05), "{course:?}");
    life.observe();
    assert!(life.navigator.course().is_empty(), "something has changed since");
}

/// A restarted clock clears earlier doubts and replans the route from the current pose.
#[test]
fn a_clock_that_begins_anew_begins_anew() {
    let mut life =
        RobotInAWorld::new(&hall(wall_with_doors(&[2.0, 6.5])), Pose::new(2.0, 3.0, 0.0));
    life.stamp_s = 1000.0;
    life.navigator.set_goal(Point::new(10.0, 3.0)).unwrap();
    life.drive_for(3.0);
    life.pose = Pose::new(2.0, 3.5, 0.0);
    life.cycle();
    assert!(!life.navigator.doubts().is_empty());
    life.navigator.restart_clock();
    (life.stamp_s, life.pose) = (0.0, Pose::new(2.0, 6.5, 0.0));
    life.velocity = Velocity::ZERO;
    life.cycle();
    assert_eq!(life.navigator.doubts(), []);
    let begin = life.navigator.route().unwrap().smoothed.points()[0];
    assert!(begin.distance(Point::new(2.0, 6.5)) < 0.01, "{begin:?}");
    life.arrive();
}

#[test]
fn a_place_that_is_none_moves_nothing() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.6), 0.2)];
    life.observe();
    let before = life.navigator.sensed().clone();
    assert!(before.count_ones() > 2);
    life.navigator.relocate(Pose { x: f64::NAN, ..life.pose });
    life.navigator.relocate(life.pose);
    assert_eq!(*life.navigator.sensed(), before);
    assert!(Navigator::restore(life.navigator.snapshot()).is_ok());
}

/// A navigator that has refused an observation gives the same refusal after it is restored.
#[test]
fn a_refusal_is_restored() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(8.0, 4.0)).unwrap();
    life.drive_for(0.5);
    let pose = life.pose;
    let past = Observation::new(-3.0, pose, Velocity::ZERO, &[]);
    let nowhere = Pose { theta: f64::INFINITY, ..pose };
    let nowhere = Observation::new(life.stamp_s, nowhere, Velocity::ZERO, &[]);
    for refused in [past, nowhere] {
        life.navigator.observe(&refused);
        let mut twin = Navigator::restore(life.navigator.snapshot()).unwrap();
        let step = life.navigator.step();
        assert!(matches!(step, Step::Blocked { .. }));
        assert_eq!(twin.step(), step);
    }
}

/// A keep-out zone is not a wall: cells sensed in it are known when it is open again.
#[test]
fn what_was_sensed_on_forbidden_ground_is_restored() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.2)];
    let frame = GridFrame::new(1, 1, 1.0, Pose::new(3.5, 3.5, 0.0)).unwrap();
    let keep_out = Some(Arc::new(OccupancyGrid::from_fn(frame, |_| CellState::Occupied)));
    life.navigator.set_masks(Masks { keep_out, speed: None });
    life.observe();
    let before = life.navigator.sensed().clone();
    assert!(before.count_ones() > 2);
    let twin = Navigator::restore(life.navigator.snapshot()).unwrap();
    assert_eq!(*twin.sensed(), before);
}
