//! Measurements since the last cycle.

use super::waits::Waits;
use crate::messages::nav_msgs::Odometry;
use crate::messages::sensor_msgs::LaserScan;
use crate::transforms::{Placement, Transforms};
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::Navigator;
use keyway::sense::{Observation, Scan, SensorScan};
use std::collections::VecDeque;

/// The latest odometry, and the scans that were not observed yet.
pub(crate) struct Sensing {
    velocity: Option<Velocity>,
    /// Scans of each lidar, the oldest first: those that are newer than the pose wait for one.
    scans: Vec<VecDeque<LaserScan>>,
}

/// A scan in the robot's frame.
struct Placed {
    sensor: usize,
    stamp_s: f64,
    mount: Pose,
    scan: Scan<Vec<f32>>,
}

impl Sensing {
    pub(crate) fn new(sensors: usize) -> Self {
        Self { velocity: None, scans: vec![VecDeque::new(); sensors] }
    }

    pub(crate) fn take_odometry(&mut self, message: &Odometry) {
        self.velocity = Some(message.twist.twist.into());
    }

    /// Scans of a lidar that wait at most: of more, the oldest is forgotten.
    const MOST_WAITING: usize = 16;

    /// Takes in a scan.
    pub(crate) fn take_scan(&mut self, sensor: usize, message: LaserScan) {
        if let Some(scans) = self.scans.get_mut(sensor) {
            scans.push_back(message);
            while scans.len() > Self::MOST_WAITING {
                scans.pop_front();
            }
        }
    }

    pub(super) fn restart_clock(&mut self) {
        self.velocity = None;
        self.scans.iter_mut().for_each(VecDeque::clear);
    }

    /// The latest velocity, once there is odometry.
    pub(super) const fn velocity(&self) -> Option<Velocity> {
        self.velocity
    }

    /// Lets the navigator observe a pose, which was at a time \[s\], and what was sensed until then.
    pub(super) fn observe(
        &mut self,
        navigator: &mut Navigator,
        (stamp_s, pose): (f64, Pose),
        (transforms, base): (&Transforms, &str),
    ) -> Result<(), Waits> {
        let velocity = self.velocity.ok_or(Waits::Odometry)?;
        let mut placed = Vec::new();
        for (sensor, scans) in self.scans.iter_mut().enumerate() {
            let is_due = |scan: &mut LaserScan| scan.header.stamp.stamp_s() <= stamp_s;
            while let Some(message) = scans.pop_front_if(is_due) {
                placed.push(Placed::new(sensor, message, (transforms, base))?);
            }
        }
        let scans: Vec<SensorScan<'_>> = placed.iter().map(Placed::borrowed).collect();
        navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        Ok(())
    }
}

impl Placed {
    /// A scan where its lidar was on the robot.
    fn new(
        sensor: usize,
        message: LaserScan,
        (transforms, base): (&Transforms, &str),
    ) -> Result<Self, Waits> {
        let stamp_s = message.header.stamp.stamp_s();
        let Placement { pose: mount, is_flipped } =
            transforms.at(base, &message.header.frame_id, stamp_s)?;
        let mut scan = Scan::from(message);
        if is_flipped {
            scan.angle_min_rad = -scan.angle_min_rad;
            scan.angle_increment_rad = -scan.angle_increment_rad;
        }
        Ok(Self { sensor, stamp_s, mount, scan })
    }

    fn borrowed(&self) -> SensorScan<'_> {
        let &Self { sensor, stamp_s, mount, .. } = self;
        SensorScan { stamp_s, sensor, mount, scan: self.scan.borrowed() }
    }
}
