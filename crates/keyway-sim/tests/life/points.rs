//! Points of depth cameras, sonars and bumpers.

use super::robot_in_a_world::{CAMERA, RobotInAWorld, hall};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::navigate::{Navigator, Step};
use keyway::sense::{FieldOfView, Observation, SensorPoints};

const VIEW: FieldOfView =
    FieldOfView { from_rad: -0.75, to_rad: 0.75, range_min_m: 0.2, range_max_m: 3.0 };

fn with_a_low_post() -> RobotInAWorld {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.low_posts = vec![Disc::new(Point::new(5.0, 4.05), 0.25)];
    life
}

#[test]
fn a_robot_drives_around_what_only_its_camera_sees() {
    let mut life = with_a_low_post();
    life.camera = Some(VIEW);
    life.navigator.set_goal(Point::new(9.0, 4.0)).unwrap();
    let took_s = life.arrive();
    assert!(took_s < 18.0, "{took_s}");
}

/// Checks that the other test is effective.
#[test]
#[should_panic(expected = "Pose {")]
fn without_its_camera_it_would_touch_that() {
    let mut life = with_a_low_post();
    life.navigator.set_goal(Point::new(9.0, 4.0)).unwrap();
    life.arrive();
}

/// The lidar's beams pass over the post, and the camera detects that it is gone.
#[test]
fn the_camera_alone_clears_what_it_has_met() {
    let mut life = with_a_low_post();
    life.pose = Pose::new(3.5, 4.0, 0.0);
    life.camera = Some(VIEW);
    let sensed = |life: &RobotInAWorld| life.navigator.sensed().count_ones();
    life.observe();
    life.stamp_s += 0.1;
    let met = sensed(&life);
    assert!(met > 5, "{met}");
    let look = |life: &mut RobotInAWorld, turned_rad: f64, camera| {
        (life.pose.theta, life.camera) = (turned_rad, camera);
        // The robot has had time to turn.
        life.stamp_s += 2.0;
        for _ in 0..5 {
            life.observe();
            life.stamp_s += 0.1;
        }
        sensed(life)
    };
    life.low_posts.clear();
    assert_eq!(look(&mut life, 0.0, None), met, "the lidar sees nothing of it");
    assert_eq!(look(&mut life, 1.5, Some(VIEW)), met, "it looks elsewhere");
    let near = FieldOfView { range_max_m: 1.0, ..VIEW };
    assert_eq!(look(&mut life, 0.0, Some(near)), met, "it does not see as far");
    let blind = FieldOfView { range_min_m: 2.0, ..VIEW };
    assert_eq!(look(&mut life, 0.0, Some(blind)), met, "it is too near");
    assert_eq!(look(&mut life, 0.0, Some(VIEW)), 0);
}

/// A bumper only marks; its marks stay until they are cleared by a call.
#[test]
fn what_a_bumper_has_met_stays_until_it_is_forgotten() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(4.0, 4.0, 0.0));
    life.observe();
    let points = [Point::new(0.24, -0.05), Point::new(0.24, 0.0), Point::new(0.24, 0.05)];
    let sees = |stamp_s, sensor| SensorPoints {
        stamp_s,
        sensor,
        mount: Pose::default(),
        points: &points,
        clears: None,
    };
    let observe = |life: &mut RobotInAWorld, points: SensorPoints<'_>| {
        let (pose, velocity) = (life.pose, Velocity::ZERO);
        let observation = Observation::new(points.stamp_s, pose, velocity, &[]);
        life.navigator.observe(&observation.with_points(&[points]));
    };
    life.stamp_s = 0.1;
    observe(&mut life, SensorPoints { points: &[], ..sees(0.1, 0) });
    observe(&mut life, SensorPoints { mount: Pose::new(-0.2, 0.0, 0.0), ..sees(0.1, 1) });
    assert_eq!(life.navigator.sensed().count_ones(), 0, "these lie within the robot");
    observe(&mut life, SensorPoints { sensor: SensorPoints::MOST_SENSORS, ..sees(0.15, 0) });
    observe(&mut life, SensorPoints { stamp_s: 0.1, ..sees(0.1, 0) });
    assert_eq!(life.navigator.sensed().count_ones(), 0, "no such sensor, and no newer points");
    observe(&mut life, sees(0.2, 0));
    let met = life.navigator.sensed().count_ones();
    assert!((2..=4).contains(&met), "{met}");
    life.stamp_s = 0.3;
    life.navigator.set_goal(Point::new(8.0, 4.0)).unwrap();
    life.drive_for(2.0);
    assert!(life.navigator.sensed().count_ones() >= met);
    life.navigator.forget_sensed();
    assert_eq!(life.navigator.sensed().count_ones(), 0);
    life.arrive();
}

#[test]
fn points_are_put_where_the_robot_was_and_live_in_snapshots() {
    let mut life = with_a_low_post();
    life.camera = Some(VIEW);
    life.navigator.set_goal(Point::new(9.0, 4.0)).unwrap();
    let mut restored: Option<Navigator> = None;
    for _ in 0..160 {
        life.observe();
        let snapshot = life.navigator.snapshot();
        let mut bytes = Vec::new();
        ciborium::into_writer(&snapshot, &mut bytes).unwrap();
        let mut other = Navigator::restore(ciborium::from_reader(&bytes[..]).unwrap()).unwrap();
        let step = life.navigator.step();
        assert_eq!(other.step(), step);
        restored = Some(other);
        life.obey(step.command());
    }
    assert_eq!(restored.unwrap().step(), Step::Arrived);

    // Late points, of a robot that has driven on.
    let mut life = with_a_low_post();
    life.navigator.set_goal(Point::new(9.0, 6.0)).unwrap();
    life.drive_for(2.0);
    let (stamp_s, then) = (life.stamp_s, life.pose);
    life.drive_for(0.5);
    assert!(then.point().distance(life.pose.point()) > 0.1);
    let place = Point::new(1.5, 0.3);
    let (pose, velocity) = (life.pose, life.velocity);
    let late = SensorPoints { stamp_s, sensor: 3, mount: CAMERA, points: &[place], clears: None };
    life.navigator
        .observe(&Observation::new(life.stamp_s, pose, velocity, &[]).with_points(&[late]));
    let cell =
        life.navigator.map().frame().cell_from_world(then.compose(CAMERA).world_from_body(place));
    assert!(life.navigator.sensed().get(cell.unwrap()));
}
