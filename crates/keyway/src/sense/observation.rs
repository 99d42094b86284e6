//! Measurements of a robot in one cycle.

use super::{Ranges, RangesRef, Scan, SensorPoints};
use crate::geometry::{Pose, Velocity};
use crate::robot::{Mount, Robot};

/// Measurements of a robot: its pose and velocity at a time, and the scans and points that have
/// arrived since the last observation.
///
/// All stamps are of the same clock, of any epoch. They are times of measurement, not of arrival.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// Time of the pose and the velocity \[s\].
    pub stamp_s: f64,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Velocity.
    pub velocity: Velocity,
    /// Scans, in the order in which they were made; empty if none has arrived.
    pub scans: &'a [SensorScan<'a>],
    /// Points of other sensors, in the order in which they were measured; empty if none have
    /// arrived.
    pub points: &'a [SensorPoints<'a>],
}

impl<'a> Observation<'a> {
    /// Measurements of a robot with lidars only: its pose and velocity at a time \[s\], and
    /// scans.
    pub const fn new(
        stamp_s: f64,
        pose: Pose,
        velocity: Velocity,
        scans: &'a [SensorScan<'a>],
    ) -> Self {
        Self { stamp_s, pose, velocity, scans, points: &[] }
    }

    /// The same, with points of other sensors.
    #[must_use]
    pub const fn with_points(self, points: &'a [SensorPoints<'a>]) -> Self {
        Self { points, ..self }
    }
}

/// A scan, and the sensor that made it.
#[derive(Clone, Copy, Debug)]
pub struct SensorScan<'a> {
    /// Time of the scan \[s\].
    pub stamp_s: f64,
    /// Index of the sensor among those of the robot
    /// ([`Robot::sensors`](crate::robot::Robot::sensors)).
    pub sensor: usize,
    /// Pose of the sensor in the robot's frame.
    pub mount: Pose,
    /// The scan.
    pub scan: Scan<RangesRef<'a>>,
}

impl<'a> SensorScan<'a> {
    /// A scan of the robot's sensor of this index, made at a time \[s\]; an index that is too
    /// large means the last sensor.
    pub fn of<R: Ranges>(robot: &Robot, sensor: usize, stamp_s: f64, scan: &'a Scan<R>) -> Self {
        let sensor = sensor.min(robot.sensors.len().saturating_sub(1));
        let mount = robot.sensors.get(sensor).map_or(Mount::CENTRE, |sensor| sensor.mount);
        Self { stamp_s, sensor, mount: mount.pose(), scan: scan.borrowed() }
    }

    /// A scan of the first sensor, made at a time \[s\], at the centre of rotation and facing
    /// forward.
    pub fn centred<R: Ranges>(stamp_s: f64, scan: &'a Scan<R>) -> Self {
        Self { stamp_s, sensor: 0, mount: Pose::default(), scan: scan.borrowed() }
    }
}
