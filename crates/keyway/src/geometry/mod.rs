//! Points, poses, angles, segments and polylines in the plane. Depends on nothing else here.

mod angle;
mod point;
mod polyline;
mod pose;
mod segment;

pub use angle::wrap_angle;
pub use point::Point;
pub use polyline::Polyline;
pub use pose::{Pose, Velocity};
pub use segment::{Segment, Square};
