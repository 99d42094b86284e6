//! Flight recorder: writes everything that a navigator observes and decides to an MCAP file.
//!
//! The file holds the ROS 2 messages that Foxglove, Lichtblick and rosbag2 show:
//!
//! | topic | message |
//! |---|---|
//! | `/map` | `nav_msgs/msg/OccupancyGrid`: the known map, after every change |
//! | `/tf_static`, `/tf` | `tf2_msgs/msg/TFMessage`: sensors on the robot, and the robot in `map` |
//! | `/odom` | `nav_msgs/msg/Odometry`: pose and velocity as observed |
//! | `/scan`, `/scan_1`, ... | `sensor_msgs/msg/LaserScan` of each sensor |
//! | `/points`, `/points_1`, ... | `sensor_msgs/msg/PointCloud2` of each camera or bumper |
//! | `/goal_pose` | `geometry_msgs/msg/PoseStamped`, after every change |
//! | `/plan` | `nav_msgs/msg/Path`, after every change |
//! | `/cmd_vel` | `geometry_msgs/msg/TwistStamped`: the command |
//! | `/keyway/step` | `keyway.step/1` (JSON): the command in full precision, and the reason |
//! | `/keyway/observation` | the observation in full precision (CBOR) |
//! | `/keyway/snapshot` | the navigator as a value (CBOR), at the beginning and after changes |
//!
//! From the last three, [`decide_again`] repeats every decision.

mod again;
mod definitions;
mod error;
mod flight;
mod messages;
mod recorder;
mod ros;

pub use again::{Flight, decide_again};
pub use error::RecordingError;
pub use recorder::FlightRecorder;
