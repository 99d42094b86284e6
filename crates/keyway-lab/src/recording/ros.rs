//! The ROS 2 messages that recordings use. Their fields are in the order of their definitions,
//! which determines their encoding; the definitions themselves follow.

use super::definitions::{header, pose, quaternion, separator, twist, vector3};
use cdr_encoding::to_vec;
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::{CellState, OccupancyGrid};
use keyway::sense::{SensorPoints, SensorScan};
use serde::Serialize;

/// A message with a definition.
pub(super) trait RosMessage: Serialize {
    /// Name of the message type.
    const NAME: &'static str;
    /// Definition of the type and of those in it, in the `ros2msg` format.
    const DEFINITION: &'static str;
}

/// Encodes the message for transport: little-endian CDR with its header.
pub(super) fn encoded<M: RosMessage>(message: &M) -> Result<Vec<u8>, cdr_encoding::Error> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(to_vec::<_, byteorder::LittleEndian>(message)?);
    Ok(bytes)
}

/// Frames of the map, of the robot, and of one of its sensors.
pub(super) const MAP: &str = "map";
pub(super) const BASE: &str = "base_link";

pub(super) fn sensor_frame(sensor: usize) -> String {
    if sensor == 0 { "base_scan".to_owned() } else { format!("base_scan_{sensor}") }
}

/// `builtin_interfaces/msg/Time`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Time {
    sec: i32,
    nanosec: u32,
}

impl Time {
    /// Converts a stamp \[s\] to the nearest ROS time.
    pub(super) fn of(stamp_s: f64) -> Self {
        let whole = stamp_s.floor();
        let nanosec = ((stamp_s - whole) * 1e9).round() as u32;
        let (sec, nanosec) =
            if nanosec >= 1_000_000_000 { (whole + 1.0, 0) } else { (whole, nanosec) };
        Self { sec: sec as i32, nanosec }
    }
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Header {
    stamp: Time,
    frame_id: String,
}

impl Header {
    pub(super) fn new(stamp_s: f64, frame: &str) -> Self {
        Self { stamp: Time::of(stamp_s), frame_id: frame.to_owned() }
    }
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Vector3 {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct RosPose {
    position: Vector3,
    orientation: Quaternion,
}

impl From<Pose> for RosPose {
    fn from(pose: Pose) -> Self {
        let (z, w) = (0.5 * pose.theta).sin_cos();
        Self {
            position: Vector3 { x: pose.x, y: pose.y, z: 0.0 },
            orientation: Quaternion { x: 0.0, y: 0.0, z, w },
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Twist {
    linear: Vector3,
    angular: Vector3,
}

impl From<Velocity> for Twist {
    fn from(velocity: Velocity) -> Self {
        Self {
            linear: Vector3 { x: velocity.v, ..Vector3::default() },
            angular: Vector3 { z: velocity.omega, ..Vector3::default() },
        }
    }
}

/// Covariance of a pose or a twist, 6 x 6; unknown, so all zero.
type Covariance = [[f64; 6]; 6];

#[derive(Debug, Serialize)]
pub(super) struct GridMessage {
    header: Header,
    map_load_time: Time,
    resolution: f32,
    width: u32,
    height: u32,
    origin: RosPose,
    data: Vec<i8>,
}

impl RosMessage for GridMessage {
    const NAME: &'static str = "nav_msgs/msg/OccupancyGrid";
    const DEFINITION: &'static str = concat!(
        "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data",
        header!(),
        separator!(),
        "nav_msgs/MapMetaData\nbuiltin_interfaces/Time map_load_time\nfloat32 resolution\n",
        "uint32 width\nuint32 height\ngeometry_msgs/Pose origin",
        pose!()
    );
}

impl GridMessage {
    pub(super) fn new(stamp_s: f64, map: &OccupancyGrid) -> Self {
        let frame = map.frame();
        let value = |cell| match map.state(cell) {
            Some(CellState::Free) => 0,
            Some(CellState::Occupied) => 100,
            _ => -1,
        };
        Self {
            header: Header::new(stamp_s, MAP),
            map_load_time: Time::of(stamp_s),
            resolution: frame.resolution_m() as f32,
            width: frame.width(),
            height: frame.height(),
            origin: frame.origin().into(),
            data: frame.cells().map(value).collect(),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct OdometryMessage {
    header: Header,
    child_frame_id: String,
    pose: RosPose,
    pose_covariance: Covariance,
    twist: Twist,
    twist_covariance: Covariance,
}

impl RosMessage for OdometryMessage {
    const NAME: &'static str = "nav_msgs/msg/Odometry";
    const DEFINITION: &'static str = concat!(
        "std_msgs/Header header\nstring child_frame_id\n",
        "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist",
        header!(),
        separator!(),
        "geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance",
        pose!(),
        separator!(),
        "geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance",
        twist!()
    );
}

impl OdometryMessage {
    pub(super) fn new(stamp_s: f64, pose: Pose, velocity: Velocity) -> Self {
        let nothing = [[0.0; 6]; 6];
        Self {
            header: Header::new(stamp_s, MAP),
            child_frame_id: BASE.to_owned(),
            pose: pose.into(),
            pose_covariance: nothing,
            twist: velocity.into(),
            twist_covariance: nothing,
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct ScanMessage {
    header: Header,
    angle_min: f32,
    angle_max: f32,
    angle_increment: f32,
    time_increment: f32,
    scan_time: f32,
    range_min: f32,
    range_max: f32,
    ranges: Vec<f32>,
    intensities: Vec<f32>,
}

impl RosMessage for ScanMessage {
    const NAME: &'static str = "sensor_msgs/msg/LaserScan";
    const DEFINITION: &'static str = concat!(
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n",
        "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n",
        "float32[] ranges\nfloat32[] intensities",
        header!()
    );
}

impl From<&SensorScan<'_>> for ScanMessage {
    fn from(one: &SensorScan<'_>) -> Self {
        let scan = one.scan;
        Self {
            header: Header::new(one.stamp_s, &sensor_frame(one.sensor)),
            angle_min: scan.angle_min_rad as f32,
            angle_max: scan.bearing_rad(scan.beams().saturating_sub(1)) as f32,
            angle_increment: scan.angle_increment_rad as f32,
            time_increment: 0.0,
            scan_time: 0.0,
            range_min: scan.range_min_m as f32,
            range_max: scan.range_max_m as f32,
            ranges: scan.ranges_m.iter().map(|range_m| range_m as f32).collect(),
            intensities: Vec::new(),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct PointsMessage {
    header: Header,
    height: u32,
    width: u32,
    fields: Vec<PointField>,
    is_bigendian: bool,
    point_step: u32,
    row_step: u32,
    data: Vec<u8>,
    is_dense: bool,
}

#[derive(Debug, Serialize)]
struct PointField {
    name: &'static str,
    offset: u32,
    datatype: u8,
    count: u32,
}

impl RosMessage for PointsMessage {
    const NAME: &'static str = "sensor_msgs/msg/PointCloud2";
    const DEFINITION: &'static str = concat!(
        "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n",
        "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
        header!(),
        separator!(),
        "sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 count"
    );
}

impl From<&SensorPoints<'_>> for PointsMessage {
    /// Converts the points to the frame of the robot, on the ground.
    fn from(one: &SensorPoints<'_>) -> Self {
        /// `sensor_msgs/PointField.FLOAT32`, and its size \[bytes\].
        const FLOAT32: (u8, u32) = (7, 4);
        let (datatype, size) = FLOAT32;
        let names = ["x", "y", "z"].into_iter().zip(0..);
        let field = |(name, index)| PointField { name, offset: index * size, datatype, count: 1 };
        let places = one.points.iter().map(|&point| one.mount.world_from_body(point));
        let numbers = places.flat_map(|place| [place.x as f32, place.y as f32, 0.0]);
        let (width, point_step) = (one.points.len() as u32, 3 * size);
        Self {
            header: Header::new(one.stamp_s, BASE),
            height: 1,
            width,
            fields: names.map(field).collect(),
            is_bigendian: false,
            point_step,
            row_step: width * point_step,
            data: numbers.flat_map(f32::to_le_bytes).collect(),
            is_dense: one.points.iter().all(|point| point.is_finite()),
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct PoseMessage {
    header: Header,
    pose: RosPose,
}

impl RosMessage for PoseMessage {
    const NAME: &'static str = "geometry_msgs/msg/PoseStamped";
    const DEFINITION: &'static str =
        concat!("std_msgs/Header header\ngeometry_msgs/Pose pose", header!(), pose!());
}

impl PoseMessage {
    pub(super) fn new(stamp_s: f64, pose: Pose) -> Self {
        Self { header: Header::new(stamp_s, MAP), pose: pose.into() }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct PathMessage {
    header: Header,
    poses: Vec<PoseMessage>,
}

impl RosMessage for PathMessage {
    const NAME: &'static str = "nav_msgs/msg/Path";
    const DEFINITION: &'static str = concat!(
        "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses",
        header!(),
        separator!(),
        "geometry_msgs/PoseStamped\nstd_msgs/Header header\ngeometry_msgs/Pose pose",
        pose!()
    );
}

impl PathMessage {
    /// Path through these points, each with the heading to the next one.
    pub(super) fn new(stamp_s: f64, points: &[Point]) -> Self {
        let heading_rad = |index: usize| {
            let next = points.get(index + 1).map(|next| (points[index], *next));
            let last = index.checked_sub(1).map(|before| (points[before], points[index]));
            next.or(last).map_or(0.0, |(from, to)| (to - from).heading())
        };
        let pose = |index: usize| Pose::new(points[index].x, points[index].y, heading_rad(index));
        let poses = (0..points.len()).map(|index| PoseMessage::new(stamp_s, pose(index)));
        Self { header: Header::new(stamp_s, MAP), poses: poses.collect() }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct CommandMessage {
    header: Header,
    twist: Twist,
}

impl RosMessage for CommandMessage {
    const NAME: &'static str = "geometry_msgs/msg/TwistStamped";
    const DEFINITION: &'static str =
        concat!("std_msgs/Header header\ngeometry_msgs/Twist twist", header!(), twist!());
}

impl CommandMessage {
    pub(super) fn new(stamp_s: f64, command: Velocity) -> Self {
        Self { header: Header::new(stamp_s, BASE), twist: command.into() }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct TransformMessage {
    transforms: Vec<Transform>,
}

#[derive(Debug, Serialize)]
struct Transform {
    header: Header,
    child_frame_id: String,
    translation: Vector3,
    rotation: Quaternion,
}

impl RosMessage for TransformMessage {
    const NAME: &'static str = "tf2_msgs/msg/TFMessage";
    const DEFINITION: &'static str = concat!(
        "geometry_msgs/TransformStamped[] transforms",
        separator!(),
        "geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n",
        "geometry_msgs/Transform transform",
        header!(),
        separator!(),
        "geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n",
        "geometry_msgs/Quaternion rotation",
        vector3!(),
        quaternion!()
    );
}

impl TransformMessage {
    /// Transforms of frames in their parent, each at a pose.
    pub(super) fn new(
        stamp_s: f64,
        parent: &str,
        children: impl IntoIterator<Item = (String, Pose)>,
    ) -> Self {
        let transform = |(child_frame_id, pose)| {
            let RosPose { position, orientation } = RosPose::from(pose);
            Transform {
                header: Header::new(stamp_s, parent),
                child_frame_id,
                translation: position,
                rotation: orientation,
            }
        };
        Self { transforms: children.into_iter().map(transform).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn stamps_are_those_of_ros() {
        assert_eq!(Time::of(1.25), Time { sec: 1, nanosec: 250_000_000 });
        assert_eq!(Time::of(-0.25), Time { sec: -1, nanosec: 750_000_000 });
        assert_eq!(Time::of(2.999_999_999_9), Time { sec: 3, nanosec: 0 });
    }

    /// Expected bytes by the rules of CDR: numbers are aligned to multiples of their size behind
    /// the header, and strings end with a zero that counts.
    #[test]
    fn a_message_by_hand() {
        let message = PoseMessage::new(1.5, Pose::new(2.0, 3.0, 0.0));
        let mut bytes = vec![0u8, 1, 0, 0];
        bytes.extend(1i32.to_le_bytes());
        bytes.extend(500_000_000u32.to_le_bytes());
        bytes.extend(4u32.to_le_bytes());
        bytes.extend(b"map\0");
        for number in [2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0f64] {
            bytes.extend(number.to_le_bytes());
        }
        assert_eq!(encoded(&message).unwrap(), bytes);
    }

    /// A camera 1 m ahead of the robot, facing left, with a point 2 m in front of it.
    #[test]
    fn points_lie_in_the_frame_of_the_robot() {
        let (mount, points) = (Pose::new(1.0, 0.0, FRAC_PI_2), [Point::new(2.0, 0.0)]);
        let points = SensorPoints { stamp_s: 0.0, sensor: 1, mount, points: &points, clears: None };
        let message = PointsMessage::from(&points);
        let number = |at: usize| f32::from_le_bytes(message.data[at..at + 4].try_into().unwrap());
        let offsets: Vec<u32> = message.fields.iter().map(|field| field.offset).collect();
        assert_eq!((message.data.len(), message.row_step, offsets), (12, 12, vec![0, 4, 8]));
        assert!((number(0) - 1.0).abs() < 1e-6 && (number(4) - 2.0).abs() < 1e-6);
        assert_eq!(number(8), 0.0);
    }
}
