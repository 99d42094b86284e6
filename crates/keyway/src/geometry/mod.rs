//! Geometry in the plane: points, poses, angles, segments, arcs, discs, cubic curves, and paths
//! composed of them. Has no dependencies within this crate.

mod angle;
mod arc;
mod cubic;
mod cubic_length;
mod disc;
mod outline;
mod path;
mod planned_line;
mod point;
mod polyline;
mod pose;
mod sample;
mod segment;
mod shift;

pub use angle::{degrees, wrap_angle};
pub use arc::Arc;
pub use cubic::Cubic;
pub use disc::Disc;
pub use outline::{holds_point, outline};
pub use path::{Path, PathError, PathPiece};
pub use planned_line::PlannedLine;
pub use point::Point;
pub use polyline::Polyline;
pub use pose::{Pose, Velocity};
pub use sample::PathSample;
pub use segment::Segment;
pub(crate) use segment::Square;
pub(crate) use shift::Shift;
