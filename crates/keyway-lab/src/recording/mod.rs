//! Flight recorder: everything that a navigator observed and decided, as an MCAP file.
//!
//! The file holds the messages of ROS 2 that Foxglove, Lichtblick and rosbag2 show:
//!
//! | topic | message |
//! |---|---|
//! | `/map` | `nav_msgs/msg/OccupancyGrid`, the known map, whenever it is another one |
//! | `/tf_static`, `/tf` | `tf2_msgs/msg/TFMessage`: sensors on the robot, and the robot in `map` |
//! | `/odom` | `nav_msgs/msg/Odometry`: pose and velocity as observed |
//! | `/scan`, `/scan_1`, ... | `sensor_msgs/msg/LaserScan` of each sensor |
//! | `/points`, `/points_1`, ... | `sensor_msgs/msg/PointCloud2` of each camera or bumper |
//! | `/goal_pose` | `geometry_msgs/msg/PoseStamped`, whenever it is another one |
//! | `/plan` | `nav_msgs/msg/Path`, whenever it is another one |
//! | `/cmd_vel` | `geometry_msgs/msg/TwistStamped`: the command |
//! | `/keyway/step` | `keyway.step/1` (JSON): the command in full precision, and the reason |
//! | `/keyway/observation` | what was observed in full precision (CBOR) |
//! | `/keyway/snapshot` | the navigator as a value (CBOR), at the beginning and after changes |
//!
//! From the last three [`decide_again`] makes every decision again.

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
