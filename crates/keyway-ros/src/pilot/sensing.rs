//! Sensor data since the last cycle.

use super::clouds::Seen;
use super::waits::Waits;
use crate::messages::nav_msgs::Odometry;
use crate::messages::sensor_msgs::{LaserScan, PointCloud2};
use crate::messages::std_msgs::Header;
use crate::settings::{Frames, PointsTaken, Settings};
use crate::transforms::{TransformError, Transforms};
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::Navigator;
use keyway::sense::{Observation, Scan, SensorPoints, SensorScan};
use std::collections::VecDeque;

/// The latest odometry, and sensor data that the navigator has not observed yet.
pub(crate) struct Sensing {
    /// With its stamp \[s\].
    velocity: Option<(f64, Velocity)>,
    scans: Vec<Waiting<LaserScan>>,
    /// Point clouds, by sensor.
    clouds: Vec<Waiting<PointCloud2>>,
    pub(super) points_taken: PointsTaken,
    frames: Frames,
}

/// A message of a sensor.
trait Sensed {
    fn header(&self) -> &Header;
}

impl Sensed for LaserScan {
    fn header(&self) -> &Header {
        &self.header
    }
}

impl Sensed for PointCloud2 {
    fn header(&self) -> &Header {
        &self.header
    }
}

/// Queued messages of a sensor, the oldest first. Messages newer than the latest transform wait
/// for it.
struct Waiting<M> {
    messages: VecDeque<M>,
    most: usize,
    /// Stamp of the last received message \[s\].
    last_s: Option<f64>,
    /// Fault of the last message. It is kept until a message can be used, as the sensor is blind
    /// until then.
    fault: Option<Waits>,
}

impl<M: Sensed> Waiting<M> {
    /// Creates a queue with a maximum length; if it is full, the oldest message is dropped.
    fn new(most: usize) -> Self {
        Self { messages: VecDeque::new(), most, last_s: None, fault: None }
    }

    fn push(&mut self, message: M) {
        self.last_s = Some(message.header().stamp.stamp_s());
        self.messages.push_back(message);
        while self.messages.len() > self.most {
            self.messages.pop_front();
        }
    }

    fn clear(&mut self) {
        *self = Self::new(self.most);
    }

    /// Takes the oldest message, if its stamp is at most `until_s` \[s\] and the pose of its
    /// sensor at that time is known.
    fn pop(
        &mut self,
        until_s: f64,
        (transforms, base): (&Transforms, &str),
    ) -> Result<Option<M>, TransformError> {
        let Some(oldest) = self.messages.front() else { return Ok(None) };
        let until_s = until_s.min(transforms.latest_s(base, &oldest.header().frame_id)?);
        let is_due = oldest.header().stamp.stamp_s() <= until_s;
        Ok(if is_due { self.messages.pop_front() } else { None })
    }

    /// Processes all messages that are due. Messages from before the first transform are dropped.
    fn use_due<T>(
        &mut self,
        until_s: f64,
        (transforms, base): (&Transforms, &str),
        read: impl Fn(M) -> Result<T, Waits>,
    ) -> Vec<T> {
        let mut used = Vec::new();
        loop {
            match self.pop(until_s, (transforms, base)) {
                Ok(Some(message)) => match read(message) {
                    Ok(one) => {
                        self.fault = None;
                        used.push(one);
                    }
                    Err(Waits::Transform(TransformError::OutOfTime { .. })) => {}
                    Err(fault) => self.fault = Some(fault),
                },
                Ok(None) => return used,
                Err(error) => {
                    self.fault = Some(error.into());
                    return used;
                }
            }
        }
    }
}

/// A scan with the pose of its sensor in the robot's frame.
struct Placed {
    sensor: usize,
    stamp_s: f64,
    mount: Pose,
    scan: Scan<Vec<f32>>,
}

impl Sensing {
    pub(crate) fn new(settings: &Settings) -> Self {
        const MOST_SCANS: usize = 16;
        /// Clouds are large.
        const MOST_CLOUDS: usize = 4;
        let scans = settings.scan_topics.iter().map(|_| Waiting::new(MOST_SCANS));
        let clouds = settings.cloud_topics.iter().map(|_| Waiting::new(MOST_CLOUDS));
        Self {
            velocity: None,
            scans: scans.collect(),
            clouds: clouds.collect(),
            points_taken: settings.points_taken.clone(),
            frames: settings.frames.clone(),
        }
    }

    /// Stores a velocity, if it is valid.
    pub(crate) fn take_odometry(&mut self, message: &Odometry) {
        let velocity = Velocity::from(message.twist.twist);
        if velocity.v.is_finite() && velocity.omega.is_finite() {
            self.velocity = Some((message.header.stamp.stamp_s(), velocity));
        }
    }

    /// Queues a scan.
    pub(crate) fn take_scan(&mut self, sensor: usize, message: LaserScan) {
        if let Some(scans) = self.scans.get_mut(sensor) {
            scans.push(message);
        }
    }

    /// Queues a cloud.
    pub(crate) fn take_cloud(&mut self, sensor: usize, message: PointCloud2) {
        if let Some(clouds) = self.clouds.get_mut(sensor) {
            clouds.push(message);
        }
    }

    pub(super) fn restart_clock(&mut self) {
        self.velocity = None;
        self.scans.iter_mut().for_each(Waiting::clear);
        self.clouds.iter_mut().for_each(Waiting::clear);
    }

    /// The latest velocity, once there is odometry.
    pub(super) fn velocity(&self) -> Option<Velocity> {
        self.velocity.map(|(_, velocity)| velocity)
    }

    /// Passes a pose with its stamp \[s\], and the sensor data up to then, to the navigator.
    /// Returns an error if data is too old at the current time \[s\], or invalid.
    pub(super) fn observe(
        &mut self,
        navigator: &mut Navigator,
        (stamp_s, pose): (f64, Pose),
        transforms: &Transforms,
        (now_s, max_age_s): (f64, f64),
    ) -> Result<(), Waits> {
        let (told_s, velocity) = self.velocity.ok_or(Waits::Odometry)?;
        let Frames { map, base } = &self.frames;
        let mut placed = Vec::new();
        for (sensor, scans) in self.scans.iter_mut().enumerate() {
            placed.extend(scans.use_due(stamp_s, (transforms, base), |scan| {
                Placed::new(sensor, scan, (transforms, base))
            }));
        }
        let mut seen = Vec::new();
        for (sensor, clouds) in self.clouds.iter_mut().enumerate() {
            seen.extend(clouds.use_due(stamp_s, (transforms, base), |cloud| {
                let Header { stamp, frame_id } = &cloud.header;
                let at = |frame| transforms.at(frame, frame_id, stamp.stamp_s());
                let placements = [&at(base)?, &at(map)?];
                Ok(Seen::of(sensor, &cloud, placements, &self.points_taken)?)
            }));
        }
        seen.sort_by(|a, b| a.stamp_s.total_cmp(&b.stamp_s));
        let scans: Vec<SensorScan<'_>> = placed.iter().map(Placed::borrowed).collect();
        let points: Vec<SensorPoints<'_>> = seen.iter().map(Seen::borrowed).collect();
        let observation = Observation::new(stamp_s, pose, velocity, &scans);
        navigator.observe(&observation.with_points(&points));
        let age_s = now_s - told_s;
        if age_s > max_age_s {
            return Err(Waits::NewOdometry { age_s });
        }
        // By such a clock, the current pose is long outdated.
        if age_s < -max_age_s {
            return Err(Waits::Ahead { ahead_s: -age_s });
        }
        self.fault(now_s).map_or(Ok(()), Err)
    }

    /// The fault of a sensor, if there is one.
    fn fault(&self, now_s: f64) -> Option<Waits> {
        let of_scans = self.scans.iter().find_map(|scans| scans.fault.clone());
        let of_clouds = || self.clouds.iter().find_map(|clouds| clouds.fault.clone());
        of_scans.or_else(of_clouds).or_else(|| self.silence(now_s))
    }

    /// Reports a silent point cloud sensor. The navigator itself detects silent lidars.
    fn silence(&self, now_s: f64) -> Option<Waits> {
        let timeout_s = self.points_taken.timeout_s;
        let silent = |clouds: &Waiting<PointCloud2>| {
            timeout_s > 0.0 && clouds.last_s.is_none_or(|last_s| now_s - last_s > timeout_s)
        };
        let sensor = self.clouds.iter().position(silent)?;
        Some(Waits::Silent { cloud: sensor, after_s: timeout_s })
    }
}

impl Placed {
    /// Places a scan with the pose of its lidar on the robot.
    fn new(
        sensor: usize,
        message: LaserScan,
        (transforms, base): (&Transforms, &str),
    ) -> Result<Self, Waits> {
        let stamp_s = message.header.stamp.stamp_s();
        let placement = transforms.at(base, &message.header.frame_id, stamp_s)?;
        let (mount, mut scan) = (placement.on_ground(), Scan::from(message));
        scan.check()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transforms::Placement;

    /// A frame that moves on the robot, and whose transforms are less frequent than the scans.
    #[test]
    fn scans_wait_for_their_frame() {
        let mut transforms = Transforms::default();
        let tell = |transforms: &mut Transforms, stamp_s| {
            transforms.insert(["base", "scan"], (stamp_s, Placement::default()), false);
        };
        let mut waiting = Waiting::new(16);
        for tenth in 1..=9 {
            let header = Header::new(0.1 * f64::from(tenth), "scan");
            waiting.push(LaserScan { header, ..LaserScan::default() });
        }
        let mut due = |transforms: &Transforms, until_s| {
            let stamp_s = |scan: LaserScan| Ok(scan.header.stamp.stamp_s());
            let due = waiting.use_due(until_s, (transforms, "base"), stamp_s);
            (due.len(), waiting.fault.is_some())
        };
        assert_eq!(due(&transforms, 1.0), (0, true), "nobody knows its frame");
        tell(&mut transforms, 0.0);
        tell(&mut transforms, 0.45);
        assert_eq!(due(&transforms, 1.0), (4, false));
        assert_eq!(due(&transforms, 1.0), (0, false), "the others wait");
        tell(&mut transforms, 2.0);
        assert_eq!(due(&transforms, 0.65), (2, false), "no newer than the pose");
        assert_eq!(due(&transforms, 1.0), (3, false), "none was lost");
    }
}
