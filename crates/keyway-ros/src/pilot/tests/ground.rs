//! Tests of map updates, masks and clouds, and of pictures.

use super::{MapError, Robot, room, settings, to};
use crate::messages::map_msgs::OccupancyGridUpdate;
use crate::messages::nav_msgs::OccupancyGrid;
use crate::messages::nav2_msgs::CostmapFilterInfo;
use crate::messages::sensor_msgs::{PointCloud2, PointField};
use crate::messages::std_msgs::Header;
use crate::messages::visualization_msgs::Marker;
use crate::pilot::Waits;
use crate::transforms::Placement;
use keyway::geometry::{Point, Pose};
use keyway::map::{Cell, CellState};

/// Updated cells of the map become occupied; cells of the update outside the map are ignored.
#[test]
fn parts_of_the_map_change() {
    let mut robot = Robot::new();
    let update = |x, width, data: &[i8]| OccupancyGridUpdate {
        x,
        y: 40,
        width,
        height: 1,
        data: data.to_vec(),
        ..OccupancyGridUpdate::default()
    };
    robot.pilot.take_update(&update(117, 5, &[100, -1, 0, 100, 100])).unwrap();
    let map = robot.pilot.navigator().unwrap().map();
    let state = |x| map.state(Cell::new(x, 40));
    let [occupied, unknown, free] = [CellState::Occupied, CellState::Unknown, CellState::Free];
    assert_eq!([117, 118, 119].map(state), [occupied, unknown, free].map(Some));
    let short = robot.pilot.take_update(&update(0, 5, &[100]));
    assert!(matches!(short, Err(MapError::Count { .. })), "{short:?}");
    robot.pilot.take_update(&update(i32::MAX, 2, &[100, 100])).unwrap();
}

/// A mask over the lower half of the room's right part.
fn mask(value: i8) -> OccupancyGrid {
    let mut mask = room();
    let width = mask.info.width as usize;
    for (index, cell) in mask.data.iter_mut().enumerate() {
        let (x, y) = (index % width, index / width);
        *cell = if (50..60).contains(&x) && y < 60 { value } else { 0 };
    }
    mask
}

fn filter(kind: u8, base: f32, multiplier: f32) -> CostmapFilterInfo {
    let filter_mask_topic = "mask".to_owned();
    CostmapFilterInfo { kind, filter_mask_topic, base, multiplier, ..CostmapFilterInfo::default() }
}

#[test]
fn it_keeps_out_of_what_a_mask_closes() {
    let mut robot = Robot::new();
    robot.pilot.take_mask(&filter(CostmapFilterInfo::KEEP_OUT, 0.0, 1.0), &mask(100)).unwrap();
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), robot.now_s).unwrap();
    let mut highest_m = 0.0_f64;
    for _ in 0..400 {
        robot.cycle();
        highest_m = highest_m.max(robot.pose.y);
        let pose = robot.pilot.pose.unwrap();
        let is_closed = (2.5..3.0).contains(&pose.x) && pose.y < 3.0;
        assert!(!is_closed, "{pose:?}");
    }
    assert!(highest_m > 3.0 && robot.pose.x > 3.0, "it came around: {:?}", robot.pose);
    let mut elsewhere = mask(100);
    elsewhere.header.frame_id = "odom".to_owned();
    let info = filter(CostmapFilterInfo::KEEP_OUT, 0.0, 1.0);
    assert!(matches!(robot.pilot.take_mask(&info, &elsewhere), Err(MapError::Frame(_))));
    let other = filter(7, 0.0, 1.0);
    assert!(matches!(robot.pilot.take_mask(&other, &mask(0)), Err(MapError::Frame(_))));
}

/// The limits are in percent of the full speed, and in metres per second by Nav2's formula.
#[test]
fn it_is_slow_where_a_mask_says_so() {
    let full_mps = settings().stack.robot().limits.v_max_mps;
    let percent = filter(CostmapFilterInfo::SPEED_PERCENT, 100.0, -1.0);
    let metres = filter(CostmapFilterInfo::SPEED, 0.0, 0.01);
    for (info, value, expected_mps) in [(percent, 60, 0.4 * full_mps), (metres, 10, 0.1)] {
        let mut robot = Robot::new();
        robot.pilot.take_mask(&info, &mask(value)).unwrap();
        robot.tell(robot.now_s);
        robot.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), robot.now_s).unwrap();
        let (mut inside_mps, mut before_mps) = (0.0_f64, 0.0_f64);
        for _ in 0..500 {
            let v = robot.cycle().command.v;
            let x = robot.pilot.pose.unwrap().x;
            // Half a cell is excluded at both ends.
            if (2.55..2.95).contains(&x) {
                inside_mps = inside_mps.max(v);
            }
            if x < 2.0 {
                before_mps = before_mps.max(v);
            }
        }
        assert!((inside_mps - expected_mps).abs() < 1e-2, "{inside_mps} {expected_mps}");
        assert!(before_mps > 0.9 * full_mps, "{before_mps}");
    }
}

/// A cloud of points in the frame of the robot.
pub(super) fn cloud(stamp_s: f64, points: &[[f32; 3]]) -> PointCloud2 {
    let field = |(name, offset): (&str, u32)| PointField {
        name: name.to_owned(),
        offset,
        datatype: PointField::FLOAT32,
        count: 1,
    };
    let width = points.len() as u32;
    PointCloud2 {
        header: Header::new(stamp_s, "camera"),
        height: 1,
        width,
        fields: [("x", 0), ("y", 4), ("z", 8)].map(field).to_vec(),
        point_step: 12,
        row_step: 12 * width,
        data: points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect(),
        ..PointCloud2::default()
    }
}

/// Lidars do not see a low obstacle ahead, a camera does.
#[test]
fn it_does_not_touch_what_a_camera_sees() {
    let mut robot = Robot::with(&[("cloud_topics", "[camera]")]);
    let camera = Placement::upright(Pose::new(0.1, 0.0, 0.0));
    robot.pilot.transforms.insert(["base_link", "camera"], (0.0, camera), true);
    let thing = Point::new(2.5, 2.0);
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(4.5, 2.0, 0.0)), robot.now_s).unwrap();
    let mut nearest_m = f64::INFINITY;
    for _ in 0..500 {
        let seen = robot.in_map().compose(Pose::new(0.1, 0.0, 0.0)).body_from_world(thing);
        let ahead = seen.x > 0.0 && seen.norm() < 2.5 && seen.heading().abs() < 0.8;
        // The ground at both edges of the field of view, and the obstacle.
        let mut points = vec![[2.2, 1.4, 0.0], [2.2, -1.4, 0.0], [0.4, 0.0, 0.0]];
        points.extend(ahead.then_some([seen.x as f32, seen.y as f32, 0.1]));
        robot.pilot.sensing.take_cloud(0, cloud(robot.now_s, &points));
        robot.cycle();
        nearest_m = nearest_m.min(robot.in_map().point().distance(thing));
    }
    let radius_m = settings().stack.robot().footprint.inscribed_radius_m();
    assert!(nearest_m > radius_m, "{nearest_m}");
    assert!(robot.in_map().point().distance(Point::new(4.5, 2.0)) < 0.2, "{:?}", robot.in_map());
}

#[test]
fn who_cannot_read_its_camera_stands() {
    let mut robot = Robot::with(&[("cloud_topics", "[camera]")]);
    robot.pilot.transforms.insert(["base_link", "camera"], (0.0, Placement::default()), true);
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(4.5, 2.0, 0.0)), robot.now_s).unwrap();
    let mut torn = cloud(robot.now_s, &[[2.0, 0.0, 0.5]]);
    torn.data.pop();
    robot.pilot.sensing.take_cloud(0, torn);
    for _ in 0..3 {
        assert!(matches!(robot.cycle().waits, Some(Waits::Cloud(_))));
    }
    robot.pilot.sensing.take_cloud(0, cloud(robot.now_s - 0.01, &[[2.0, 0.0, 0.0]]));
    assert_eq!(robot.cycle().waits, None);
}

#[test]
fn what_it_does_can_be_looked_at() {
    let mut robot = Robot::new();
    assert!(robot.pilot.footprint(1.0).is_none(), "nobody has said where it is");
    robot.tell(robot.now_s);
    robot.pilot.begin(to("map", Pose::new(5.0, 2.0, 0.0)), robot.now_s).unwrap();
    for _ in 0..20 {
        robot.cycle();
    }
    let pose = robot.pilot.pose.unwrap();
    let outline = robot.pilot.footprint(1.0).unwrap().polygon;
    let off_m = |x: f32, y: f32| pose.point().distance(Point::new(f64::from(x), f64::from(y)));
    let footprint = settings().stack.robot().footprint.clone();
    let (least_m, most_m) = (footprint.inscribed_radius_m(), footprint.circumscribed_radius_m());
    let is_beside = |off_m: f64| (least_m - 1e-6..=most_m + 1e-6).contains(&off_m);
    assert!(outline.points.iter().all(|corner| is_beside(off_m(corner.x, corner.y))));
    let course = robot.pilot.local_plan(1.0).unwrap();
    assert!(course.poses.len() > 10 && course.header.frame_id == "map");
    let first = course.poses[0].pose.position;
    assert!(pose.point().distance(Point::new(first.x, first.y)) < 0.1);
    let route = robot.pilot.route(1.0).unwrap();
    assert!((route.poses.last().unwrap().pose.position.x - 5.0).abs() < 0.1);
    let markers = robot.pilot.markers(1.0).unwrap().markers;
    assert_eq!(markers[0].action, Marker::DELETE_ALL);
    assert!(markers.iter().any(|marker| marker.namespace == "guide"));
    let fan = robot.pilot.fan(1.0).unwrap().markers;
    let points = |namespace: &str| {
        fan.iter().find(|marker| marker.namespace == namespace).unwrap().points.len()
    };
    assert!(points("admissible") > 100 && points("chosen") > 3);
    let lists = fan.iter().filter(|marker| marker.shape == Marker::LINE_LIST);
    assert!(lists.map(|marker| marker.points.len()).all(|points| points % 2 == 0));
}
