//! Observations and steps in full precision.

use keyway::geometry::{Point, Pose, Velocity};
use keyway::navigate::{Blocked, Step};
use keyway::sense::{FieldOfView, Observation, Scan, SensorPoints, SensorScan};
use serde::{Deserialize, Serialize};
use std::fmt;

pub(super) const STEP: &str = "/keyway/step";
pub(super) const OBSERVATION: &str = "/keyway/observation";
pub(super) const SNAPSHOT: &str = "/keyway/snapshot";

/// An observation that owns its data.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RecordedObservation {
    pub(super) stamp_s: f64,
    pose: Pose,
    velocity: Velocity,
    scans: Vec<RecordedScan>,
    points: Vec<RecordedPoints>,
}

#[derive(Debug, Serialize, Deserialize)]
struct RecordedScan {
    stamp_s: f64,
    sensor: usize,
    mount: Pose,
    angle_min_rad: f64,
    angle_increment_rad: f64,
    range_min_m: f64,
    range_max_m: f64,
    ranges_m: Vec<f64>,
}

#[derive(Debug, Serialize, Deserialize)]
struct RecordedPoints {
    stamp_s: f64,
    sensor: usize,
    mount: Pose,
    points: Vec<Point>,
    /// Field of view that the sensor clears: right and left edge \[rad\], nearest and farthest
    /// range \[m\].
    clears: Option<[f64; 4]>,
}

impl RecordedObservation {
    pub(super) fn of(observation: &Observation<'_>) -> Self {
        let Observation { stamp_s, pose, velocity, scans, points } = *observation;
        let scan = |one: &SensorScan<'_>| {
            let Scan { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, .. } =
                one.scan;
            let SensorScan { stamp_s, sensor, mount, .. } = *one;
            RecordedScan {
                stamp_s,
                sensor,
                mount,
                angle_min_rad,
                angle_increment_rad,
                range_min_m,
                range_max_m,
                ranges_m: one.scan.ranges_m.iter().collect(),
            }
        };
        let points_of = |one: &SensorPoints<'_>| RecordedPoints {
            stamp_s: one.stamp_s,
            sensor: one.sensor,
            mount: one.mount,
            points: one.points.to_vec(),
            clears: one
                .clears
                .map(|view| [view.from_rad, view.to_rad, view.range_min_m, view.range_max_m]),
        };
        Self {
            stamp_s,
            pose,
            velocity,
            scans: scans.iter().map(scan).collect(),
            points: points.iter().map(points_of).collect(),
        }
    }

    /// Passes the observation to `take`.
    pub(super) fn with<T>(&self, take: impl FnOnce(&Observation<'_>) -> T) -> T {
        let scans: Vec<SensorScan<'_>> = self.scans.iter().map(RecordedScan::borrowed).collect();
        let points: Vec<SensorPoints<'_>> =
            self.points.iter().map(RecordedPoints::borrowed).collect();
        let observation = Observation::new(self.stamp_s, self.pose, self.velocity, &scans);
        take(&observation.with_points(&points))
    }
}

impl RecordedScan {
    fn borrowed(&self) -> SensorScan<'_> {
        let Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, .. } = *self;
        let scan = Scan {
            angle_min_rad,
            angle_increment_rad,
            range_min_m,
            range_max_m,
            ranges_m: keyway::sense::RangesRef::F64(&self.ranges_m),
        };
        SensorScan { stamp_s: self.stamp_s, sensor: self.sensor, mount: self.mount, scan }
    }
}

impl RecordedPoints {
    fn borrowed(&self) -> SensorPoints<'_> {
        let clears = self.clears.map(|[from_rad, to_rad, range_min_m, range_max_m]| FieldOfView {
            from_rad,
            to_rad,
            range_min_m,
            range_max_m,
        });
        SensorPoints {
            stamp_s: self.stamp_s,
            sensor: self.sensor,
            mount: self.mount,
            points: &self.points,
            clears,
        }
    }
}

/// `keyway.step/1`: a decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedStep {
    /// Name and version of the format.
    schema: String,
    /// Status: `drive`, `arrived`, `idle` or `blocked`.
    pub status: String,
    /// Commanded forward speed \[m/s\].
    pub v_mps: f64,
    /// Commanded turn rate \[rad/s\].
    pub omega_radps: f64,
    /// Number of the reason ([`Blocked::kind`]) of a robot that is blocked.
    pub kind: Option<u16>,
    /// The reason, for display.
    pub why: Option<String>,
}

impl RecordedStep {
    pub(super) const SCHEMA: &str = "keyway.step/1";

    pub(super) fn of(step: &Step) -> Self {
        let Velocity { v, omega, .. } = step.command();
        let why = step.why();
        Self {
            schema: Self::SCHEMA.to_owned(),
            status: step.name().to_owned(),
            v_mps: v,
            omega_radps: omega,
            kind: why.map(Blocked::kind),
            why: why.map(ToString::to_string),
        }
    }

    /// True if both are the same to a robot; the wording of reasons may differ.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let said = |step: &Self| (step.v_mps.to_bits(), step.omega_radps.to_bits(), step.kind);
        said(self) == said(other) && self.status == other.status
    }
}

impl fmt::Display for RecordedStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} with {} m/s and {} rad/s", self.status, self.v_mps, self.omega_radps)?;
        self.why.as_ref().map_or(Ok(()), |why| write!(f, " ({why})"))
    }
}
