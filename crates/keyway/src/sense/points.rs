//! Points that other sensors than lidars have met.

use crate::geometry::{Point, Pose};
use std::f64::consts::TAU;

/// Places at which a depth camera, a sonar or a bumper has met something: what it shows of a world
/// at the height of the robot, as points on the ground.
///
/// They mark cells that the robot must not touch, and clear others only where the sensor says that
/// it sees everything. They take no part in following what moves, and a robot that drives only on
/// ground that it has seen still needs its lidar for that.
#[derive(Clone, Copy, Debug)]
pub struct SensorPoints<'a> {
    /// Time at which they were measured \[s\].
    pub stamp_s: f64,
    /// Number of the sensor among those that give points, below [`Self::MOST_SENSORS`]: what one
    /// of them has met is cleared by itself alone.
    pub sensor: usize,
    /// Pose of the sensor in the robot's frame.
    pub mount: Pose,
    /// Places that it has met, in its own frame \[m\]. Those that are not finite say nothing, nor
    /// does the origin, which is what many drivers write where they have met nothing.
    pub points: &'a [Point],
    /// The ground in which it sees everything that stands, if there is such ground: what it had met
    /// there and meets no more has gone.
    pub clears: Option<FieldOfView>,
}

impl SensorPoints<'_> {
    /// Most sensors of a robot that give points.
    pub const MOST_SENSORS: usize = 8;
}

/// Ground in which a sensor sees everything that stands and is not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    /// Bearing of its right edge in the sensor's frame \[rad\]: 0 where the sensor looks,
    /// counter-clockwise.
    pub from_rad: f64,
    /// Bearing of its left edge \[rad\], at most a turn beyond the right one.
    pub to_rad: f64,
    /// The sensor is blind nearer than this \[m\].
    pub range_min_m: f64,
    /// As far as this it sees \[m\].
    pub range_max_m: f64,
}

impl FieldOfView {
    /// True if there is such ground.
    pub fn is_usable(&self) -> bool {
        let width_rad = self.to_rad - self.from_rad;
        let is_angle = self.from_rad.is_finite() && width_rad > 0.0 && width_rad <= TAU * 1.001;
        let is_range = self.range_min_m.is_finite() && self.range_max_m.is_finite();
        is_angle && is_range && self.range_max_m > self.range_min_m.max(0.0)
    }
}
