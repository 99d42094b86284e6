//! Points from sensors other than lidars.

use crate::geometry::{Point, Pose};
use std::f64::consts::TAU;

/// Points detected by a depth camera, a sonar or a bumper: obstacles at the height of the robot,
/// projected to the ground.
///
/// They mark cells that the robot must not touch, and clear others only within the field of view
/// that the sensor declares. They are not used for tracking, and a robot that drives only on
/// observed free space still needs its lidar for that.
#[derive(Clone, Copy, Debug)]
pub struct SensorPoints<'a> {
    /// Time of the measurement \[s\].
    pub stamp_s: f64,
    /// Index among the sensors that give points, below [`Self::MOST_SENSORS`]. Points of a sensor
    /// are cleared by that sensor alone.
    pub sensor: usize,
    /// Pose of the sensor in the robot's frame.
    pub mount: Pose,
    /// Detected points in the sensor's frame \[m\]. Points that are not finite are ignored, and
    /// so is the origin, which many drivers write for no detection.
    pub points: &'a [Point],
    /// Area in which the sensor sees every obstacle, if there is one: an earlier point there that
    /// is no longer detected is cleared.
    pub clears: Option<FieldOfView>,
}

impl SensorPoints<'_> {
    /// Maximum number of sensors that give points.
    pub const MOST_SENSORS: usize = 8;
}

/// Area in which a sensor sees every obstacle that is not occluded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    /// Bearing of the right edge in the sensor's frame \[rad\]: 0 is straight ahead,
    /// counter-clockwise.
    pub from_rad: f64,
    /// Bearing of the left edge \[rad\], at most one turn beyond the right one.
    pub to_rad: f64,
    /// Minimum range \[m\].
    pub range_min_m: f64,
    /// Maximum range \[m\].
    pub range_max_m: f64,
}

impl FieldOfView {
    /// True if the area is valid and not empty.
    pub fn is_usable(&self) -> bool {
        let width_rad = self.to_rad - self.from_rad;
        let is_angle = self.from_rad.is_finite() && width_rad > 0.0 && width_rad <= TAU * 1.001;
        let is_range = self.range_min_m.is_finite() && self.range_max_m.is_finite();
        is_angle && is_range && self.range_max_m > self.range_min_m.max(0.0)
    }
}
