//! `geometry_msgs`.

use super::Named;
use super::std_msgs::Header;
use crate::transforms::Placement;
use keyway::geometry::{self, Velocity};
use serde::{Deserialize, Serialize};

/// A vector or a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Vector3 {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Quaternion {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
    pub(crate) w: f64,
}

impl Default for Quaternion {
    /// No rotation.
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

impl Quaternion {
    /// A rotation around the z axis.
    fn of_heading(heading_rad: f64) -> Self {
        let (z, w) = (0.5 * heading_rad).sin_cos();
        Self { x: 0.0, y: 0.0, z, w }
    }

    /// The angle around the z axis \[rad\], as ROS computes yaw; `None` for an invalid rotation,
    /// such as four zeros.
    #[cfg(test)]
    pub(crate) fn heading_rad(self) -> Option<f64> {
        Some(placement(Vector3::default(), self)?.on_ground().theta)
    }
}

/// A frame at this position; `None` if it is not finite or has an invalid rotation.
fn placement(position: Vector3, orientation: Quaternion) -> Option<Placement> {
    let (Vector3 { x, y, z }, turn) = (position, orientation);
    Placement::new([x, y, z], [turn.x, turn.y, turn.z, turn.w])
}

/// A position and a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pose {
    pub(crate) position: Vector3,
    pub(crate) orientation: Quaternion,
}

impl Pose {
    /// The pose on the ground; `None` if it is not finite or has an invalid rotation.
    pub(crate) fn on_ground(&self) -> Option<geometry::Pose> {
        Some(placement(self.position, self.orientation)?.on_ground())
    }
}

impl From<geometry::Pose> for Pose {
    fn from(pose: geometry::Pose) -> Self {
        let position = Vector3 { x: pose.x, y: pose.y, z: 0.0 };
        Self { position, orientation: Quaternion::of_heading(pose.theta) }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseStamped {
    pub(crate) header: Header,
    pub(crate) pose: Pose,
}

impl Named for PoseStamped {
    const NAME: (&'static str, &'static str) = ("geometry_msgs", "PoseStamped");
}

/// A pose set by a user, or estimated by a localisation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseWithCovarianceStamped {
    pub(crate) header: Header,
    pub(crate) pose: PoseWithCovariance,
}

impl Named for PoseWithCovarianceStamped {
    const NAME: (&'static str, &'static str) = ("geometry_msgs", "PoseWithCovarianceStamped");
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Point32 {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) z: f32,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Polygon {
    pub(crate) points: Vec<Point32>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PolygonStamped {
    pub(crate) header: Header,
    pub(crate) polygon: Polygon,
}

impl Named for PolygonStamped {
    const NAME: (&'static str, &'static str) = ("geometry_msgs", "PolygonStamped");
}

/// A 6 x 6 matrix; unused here.
pub(crate) type Covariance = [[f64; 6]; 6];

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseWithCovariance {
    pub(crate) pose: Pose,
    pub(crate) covariance: Covariance,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Twist {
    pub(crate) linear: Vector3,
    pub(crate) angular: Vector3,
}

impl Named for Twist {
    const NAME: (&'static str, &'static str) = ("geometry_msgs", "Twist");
}

impl From<Velocity> for Twist {
    fn from(velocity: Velocity) -> Self {
        Self {
            linear: Vector3 { x: velocity.v, ..Vector3::default() },
            angular: Vector3 { z: velocity.omega, ..Vector3::default() },
        }
    }
}

impl From<Twist> for Velocity {
    fn from(twist: Twist) -> Self {
        Self::new(twist.linear.x, twist.angular.z)
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TwistStamped {
    pub(crate) header: Header,
    pub(crate) twist: Twist,
}

impl Named for TwistStamped {
    const NAME: (&'static str, &'static str) = ("geometry_msgs", "TwistStamped");
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TwistWithCovariance {
    pub(crate) twist: Twist,
    pub(crate) covariance: Covariance,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Transform {
    pub(crate) translation: Vector3,
    pub(crate) rotation: Quaternion,
}

/// The pose of a frame in another one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TransformStamped {
    pub(crate) header: Header,
    pub(crate) child_frame_id: String,
    pub(crate) transform: Transform,
}

impl TransformStamped {
    /// The placement; `None` if it is not finite or has an invalid rotation.
    pub(crate) fn placement(&self) -> Option<Placement> {
        placement(self.transform.translation, self.transform.rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn headings_are_those_of_ros() {
        for heading_rad in [-3.0, -FRAC_PI_2, 0.0, 0.7, 3.0] {
            let found_rad = Quaternion::of_heading(heading_rad).heading_rad().unwrap();
            assert!((found_rad - heading_rad).abs() < 1e-12);
        }
        // Around the x axis first, as for a lidar mounted upside down: its heading stays.
        let upside_down = Quaternion { x: 1.0, y: 0.0, z: 0.0, w: 0.0 };
        assert_eq!(upside_down.heading_rad(), Some(0.0));
        let turned = Quaternion { x: 0.0, y: 1.0, z: 0.0, w: 0.0 };
        assert!((turned.heading_rad().unwrap().abs() - PI).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_rotation_has_no_heading() {
        let nothing = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };
        assert_eq!(nothing.heading_rad(), None);
        assert_eq!(Quaternion { w: f64::NAN, ..nothing }.heading_rad(), None);
        let far = Pose {
            position: Vector3 { x: f64::INFINITY, ..Vector3::default() },
            ..Pose::default()
        };
        assert_eq!(far.on_ground(), None);
    }
}
