//! Measurements since the last cycle.

use super::clouds::{CloudError, Seen};
use super::waits::Waits;
use crate::messages::nav_msgs::Odometry;
use crate::messages::sensor_msgs::{LaserScan, PointCloud2};
use crate::messages::std_msgs::Header;
use crate::settings::{PointsTaken, Settings};
use crate::transforms::Transforms;
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::Navigator;
use keyway::sense::{Observation, Scan, SensorPoints, SensorScan};
use std::collections::VecDeque;

/// The latest odometry, and the scans that were not observed yet.
pub(crate) struct Sensing {
    velocity: Option<Velocity>,
    /// Scans of each lidar, the oldest first: those that are newer than the pose wait for one.
    scans: Vec<VecDeque<LaserScan>>,
    /// The same of sensors that give clouds.
    clouds: Vec<VecDeque<PointCloud2>>,
    /// The last cloud of a sensor, where it could not be read: until one can, nobody knows what is
    /// there.
    unreadable: Vec<Option<CloudError>>,
    pub(super) points_taken: PointsTaken,
}

/// A scan in the robot's frame.
struct Placed {
    sensor: usize,
    stamp_s: f64,
    mount: Pose,
    scan: Scan<Vec<f32>>,
}

impl Sensing {
    pub(crate) fn new(settings: &Settings) -> Self {
        Self {
            velocity: None,
            scans: vec![VecDeque::new(); settings.scan_topics.len()],
            clouds: vec![VecDeque::new(); settings.cloud_topics.len()],
            unreadable: vec![None; settings.cloud_topics.len()],
            points_taken: settings.points_taken.clone(),
        }
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

    /// Clouds of a sensor that wait at most: they are large.
    const MOST_CLOUDS: usize = 4;

    /// Takes in a cloud.
    pub(crate) fn take_cloud(&mut self, sensor: usize, message: PointCloud2) {
        if let Some(clouds) = self.clouds.get_mut(sensor) {
            clouds.push_back(message);
            while clouds.len() > Self::MOST_CLOUDS {
                clouds.pop_front();
            }
        }
    }

    pub(super) fn restart_clock(&mut self) {
        self.velocity = None;
        self.scans.iter_mut().for_each(VecDeque::clear);
        self.clouds.iter_mut().for_each(VecDeque::clear);
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
        let seen = self.take_seen(stamp_s, (transforms, base))?;
        let scans: Vec<SensorScan<'_>> = placed.iter().map(Placed::borrowed).collect();
        let points: Vec<SensorPoints<'_>> = seen.iter().map(Seen::borrowed).collect();
        let observation = Observation::new(stamp_s, pose, velocity, &scans);
        navigator.observe(&observation.with_points(&points));
        let unreadable = self.unreadable.iter().flatten().next();
        unreadable.map_or(Ok(()), |error| Err(error.clone().into()))
    }

    /// What the clouds until a time \[s\] show.
    fn take_seen(
        &mut self,
        stamp_s: f64,
        (transforms, base): (&Transforms, &str),
    ) -> Result<Vec<Seen>, Waits> {
        let mut seen = Vec::new();
        for (sensor, clouds) in self.clouds.iter_mut().enumerate() {
            let is_due = |cloud: &mut PointCloud2| cloud.header.stamp.stamp_s() <= stamp_s;
            while let Some(cloud) = clouds.pop_front_if(is_due) {
                let Header { stamp, frame_id } = &cloud.header;
                let placement = transforms.at(base, frame_id, stamp.stamp_s())?;
                let read = Seen::of(sensor, &cloud, &placement, &self.points_taken);
                self.unreadable[sensor] = read.as_ref().err().cloned();
                seen.extend(read);
            }
        }
        seen.sort_by(|a, b| a.stamp_s.total_cmp(&b.stamp_s));
        Ok(seen)
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
        let placement = transforms.at(base, &message.header.frame_id, stamp_s)?;
        let (mount, mut scan) = (placement.on_ground(), Scan::from(message));
        if placement.is_upside_down() {
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
