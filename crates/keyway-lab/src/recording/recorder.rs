//! Writes a flight recording.

use super::RecordingError;
use super::flight::{OBSERVATION, RecordedObservation, RecordedStep, SNAPSHOT, STEP};
use super::ros::{
    BASE, CommandMessage, GridMessage, MAP, OdometryMessage, PathMessage, PointsMessage,
    PoseMessage, RosMessage, ScanMessage, TransformMessage, encoded, sensor_frame,
};
use keyway::geometry::Pose;
use keyway::map::OccupancyGrid;
use keyway::navigate::{Goal, Navigator, Step};
use keyway::sense::Observation;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// Records the observations and decisions of a navigator.
///
/// Call [`Self::begin`] before the navigator's first observation, then report each observation,
/// each step, and every other change ([`Self::changed`]): goals, maps, limits.
///
/// The file always holds everything except about the last second: an unfinished recording, as
/// after a loss of power, is readable up to that point. Viewers show stamps before 0 as 0.
pub struct FlightRecorder<W: Write + Seek> {
    writer: Writer<W>,
    channels: BTreeMap<String, u16>,
    sequence: u32,
    /// Time of the last observation \[s\].
    stamp_s: f64,
    /// Time of the last message that is in the file \[s\].
    written_s: f64,
    map: Option<OccupancyGrid>,
    route: Option<(u32, u32)>,
    goal: Option<Goal>,
}

impl<W: Write + Seek> FlightRecorder<W> {
    /// Time between two writes \[s\].
    const FLUSH_S: f64 = 1.0;

    /// Records into a new file, or into memory.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if the header cannot be written.
    pub fn new(file: W) -> Result<Self, RecordingError> {
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("keyway ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4));
        let writer = options.create(file)?;
        Ok(Self {
            writer,
            channels: BTreeMap::new(),
            sequence: 0,
            stamp_s: 0.0,
            written_s: f64::NEG_INFINITY,
            map: None,
            route: None,
            goal: None,
        })
    }

    /// Records the map, the poses of the sensors, and the state of the navigator at this time
    /// \[s\].
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn begin(&mut self, stamp_s: f64, navigator: &Navigator) -> Result<(), RecordingError> {
        self.stamp_s = stamp_s;
        let sensors = navigator.stack().robot().sensors.iter().enumerate();
        let frames = sensors.map(|(sensor, it)| (sensor_frame(sensor), it.mount.pose()));
        self.ros("/tf_static", &TransformMessage::new(stamp_s, BASE, frames))?;
        self.changed(navigator)
    }

    /// Records the navigator after a change of its goal, map or limits.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn changed(&mut self, navigator: &Navigator) -> Result<(), RecordingError> {
        self.cbor(SNAPSHOT, &navigator.snapshot())?;
        if self.map.as_ref() != Some(navigator.map()) {
            self.map = Some(navigator.map().clone());
            self.ros("/map", &GridMessage::new(self.stamp_s, navigator.map()))?;
        }
        self.show_route(navigator)?;
        self.flush()
    }

    /// Records an observation that the navigator was given, including one that it refuses.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn observed(&mut self, observation: &Observation<'_>) -> Result<(), RecordingError> {
        let Observation { stamp_s, pose, velocity, scans, points } = *observation;
        self.stamp_s = stamp_s;
        self.cbor(OBSERVATION, &RecordedObservation::of(observation))?;
        let robot = [(BASE.to_owned(), pose)];
        self.ros("/tf", &TransformMessage::new(stamp_s, MAP, robot))?;
        self.ros("/odom", &OdometryMessage::new(stamp_s, pose, velocity))?;
        for one in scans {
            self.ros(&topic_of("/scan", one.sensor), &ScanMessage::from(one))?;
        }
        for one in points {
            self.ros(&topic_of("/points", one.sensor), &PointsMessage::from(one))?;
        }
        Ok(())
    }

    /// Records a decision, and the route if it has changed.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn stepped(&mut self, step: &Step, navigator: &Navigator) -> Result<(), RecordingError> {
        self.show_route(navigator)?;
        self.ros("/cmd_vel", &CommandMessage::new(self.stamp_s, step.command()))?;
        let step = RecordedStep::of(step);
        // Plain data: this cannot fail.
        let text = serde_json::to_vec(&step).unwrap_or_default();
        let schema = || (RecordedStep::SCHEMA, "jsonschema", STEP_SCHEMA);
        let channel = self.channel(STEP, "json", Some(schema()))?;
        self.write(channel, &text)?;
        let is_due = (self.stamp_s - self.written_s).abs() >= Self::FLUSH_S;
        if is_due { self.flush() } else { Ok(()) }
    }

    /// Writes everything recorded so far to the file.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        self.written_s = self.stamp_s;
        Ok(self.writer.flush()?)
    }

    /// Completes the recording, and returns the file.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it cannot be written.
    pub fn finish(mut self) -> Result<W, RecordingError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner())
    }

    fn show_route(&mut self, navigator: &Navigator) -> Result<(), RecordingError> {
        let goal = navigator.goal();
        if self.goal != goal {
            self.goal = goal;
            if let Some(Goal { position, heading_rad }) = goal {
                let pose = Pose::new(position.x, position.y, heading_rad.unwrap_or_default());
                self.ros("/goal_pose", &PoseMessage::new(self.stamp_s, pose))?;
            }
        }
        let route = (navigator.routes_planned(), navigator.ways_taken());
        if self.route == Some(route) {
            return Ok(());
        }
        self.route = Some(route);
        let points = navigator.route().map_or(&[][..], |route| route.smoothed.points());
        self.ros("/plan", &PathMessage::new(self.stamp_s, points))
    }

    fn ros<M: RosMessage>(&mut self, topic: &str, message: &M) -> Result<(), RecordingError> {
        let schema = (M::NAME, "ros2msg", M::DEFINITION);
        let channel = self.channel(topic, "cdr", Some(schema))?;
        let bytes = encoded(message).map_err(|error| not_encoded(topic, &error))?;
        self.write(channel, &bytes)
    }

    fn cbor<T: Serialize>(&mut self, topic: &str, value: &T) -> Result<(), RecordingError> {
        let channel = self.channel(topic, "cbor", None)?;
        let mut bytes = Vec::new();
        ciborium::into_writer(value, &mut bytes).map_err(|error| not_encoded(topic, &error))?;
        self.write(channel, &bytes)
    }

    fn channel(
        &mut self,
        topic: &str,
        encoding: &str,
        schema: Option<(&str, &str, &str)>,
    ) -> Result<u16, RecordingError> {
        if let Some(&channel) = self.channels.get(topic) {
            return Ok(channel);
        }
        let schema = match schema {
            Some((name, encoding, text)) => {
                self.writer.add_schema(name, encoding, text.as_bytes())?
            }
            None => 0,
        };
        let channel = self.writer.add_channel(schema, topic, encoding, &BTreeMap::new())?;
        self.channels.insert(topic.to_owned(), channel);
        Ok(channel)
    }

    fn write(&mut self, channel_id: u16, bytes: &[u8]) -> Result<(), RecordingError> {
        let log_time = (self.stamp_s * 1e9).round() as u64;
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, bytes)?)
    }
}

/// Topic of a sensor; the first one has no number.
fn topic_of(kind: &str, sensor: usize) -> String {
    if sensor == 0 { kind.to_owned() } else { format!("{kind}_{sensor}") }
}

/// JSON schema of `keyway.step/1`.
const STEP_SCHEMA: &str = r#"{"type":"object","properties":{"schema":{"type":"string"},"status":{"type":"string"},"v_mps":{"type":"number"},"omega_radps":{"type":"number"},"kind":{"type":["integer","null"]},"why":{"type":["string","null"]}}}"#;

fn not_encoded(topic: &str, reason: &dyn std::fmt::Display) -> RecordingError {
    RecordingError::Encode { topic: topic.to_owned(), reason: reason.to_string() }
}
