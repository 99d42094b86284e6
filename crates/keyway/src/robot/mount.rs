//! The mounting pose of a sensor on a robot.

use crate::ConfigError;
use crate::geometry::Pose;
use serde::{Deserialize, Serialize};

/// Pose of a sensor in the frame of its robot: x ahead, y to the left, the centre of rotation at
/// (0, 0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Mount {
    /// Distance ahead of the centre of rotation \[m\], from -1000 to 1000.
    pub x_m: f64,
    /// Distance to the left of the centre of rotation \[m\], from -1000 to 1000.
    pub y_m: f64,
    /// Direction of the centre of the field of view \[deg\], counter-clockwise from straight
    /// ahead, from -360 to 360.
    pub yaw_deg: f64,
}

impl Mount {
    /// At the centre of rotation, facing ahead.
    pub const CENTRE: Self = Self { x_m: 0.0, y_m: 0.0, yaw_deg: 0.0 };

    /// Pose of the sensor in the robot's frame.
    pub fn pose(self) -> Pose {
        Pose::new(self.x_m, self.y_m, self.yaw_deg.to_radians())
    }

    pub(super) fn is_centre(&self) -> bool {
        *self == Self::CENTRE
    }

    pub(super) fn validate(self) -> Result<(), ConfigError> {
        let length = (1000.0, "a length from -1000 to 1000 m");
        let checks = [
            ("x_m", self.x_m, length),
            ("y_m", self.y_m, length),
            ("yaw_deg", self.yaw_deg, (360.0, "an angle from -360 to 360")),
        ];
        let unusable =
            checks.into_iter().find(|(_, value, (most, _))| !(-most..=*most).contains(value));
        match unusable {
            Some((field, value, (_, expected))) => {
                Err(ConfigError::must_be(field, expected, value))
            }
            None => Ok(()),
        }
    }
}
