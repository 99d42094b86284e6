//! Directions of a sensor's beams.

use keyway::geometry::{Point, Pose};
use keyway::robot::RangeSensor;
use keyway::sense::Scan;
use std::f64::consts::{PI, TAU};

/// Margin for comparisons of bearings \[rad\]: far more than rounding, far less than the angle
/// between beams.
const MARGIN_RAD: f64 = 1e-6;

/// Beams of a sensor in its own frame, precomputed.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Beams {
    /// Pose of the sensor in the robot's frame.
    mount: Pose,
    angle_min_rad: f64,
    angle_increment_rad: f64,
    range_min_m: f64,
    range_max_m: f64,
    /// Unit vectors.
    directions: Vec<Point>,
}

impl Beams {
    pub(in crate::sim) fn of(sensor: &RangeSensor) -> Self {
        let Scan { angle_min_rad, angle_increment_rad, .. } = Scan::of_nothing(sensor);
        let RangeSensor { range_min_m, range_m: range_max_m, .. } = *sensor;
        let bearing = |beam| angle_min_rad + f64::from(beam) * angle_increment_rad;
        let directions = (0..sensor.beams).map(|beam| direction(bearing(beam))).collect();
        let mount = sensor.mount.pose();
        Self { mount, angle_min_rad, angle_increment_rad, range_min_m, range_max_m, directions }
    }

    /// Pose of the sensor in the robot's frame.
    pub(in crate::sim) const fn mount(&self) -> Pose {
        self.mount
    }

    /// Pose of the sensor of a robot at a pose.
    pub(super) fn pose_on(&self, robot: Pose) -> Pose {
        robot.compose(self.mount)
    }

    /// Returns a scan of these beams without measurements.
    pub(in crate::sim) fn scan(&self) -> Scan {
        let Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, .. } = *self;
        let ranges_m = vec![f64::INFINITY; self.directions.len()];
        Scan { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, ranges_m }
    }

    /// Directions of all beams of a sensor with the heading `theta` \[rad\].
    pub(super) fn directions(&self, theta: f64) -> impl Iterator<Item = Point> {
        let ahead = direction(theta);
        self.directions.iter().map(move |&beam| turned(beam, ahead))
    }

    /// Beams with bearings within `half_rad` of a bearing \[rad\], and possibly a few adjacent
    /// ones, with their directions for a robot with the heading `theta` \[rad\].
    pub(super) fn near(
        &self,
        bearing_rad: f64,
        half_rad: f64,
        theta: f64,
    ) -> impl Iterator<Item = (usize, Point)> {
        let ahead = direction(theta);
        let spans = self.spans_near(bearing_rad, half_rad + MARGIN_RAD).into_iter().flatten();
        spans.map(move |beam| (beam, turned(self.directions[beam], ahead)))
    }

    /// Index ranges of the beams from `bearing_rad - half_rad` on, and of the beams a whole turn
    /// before them.
    fn spans_near(&self, bearing_rad: f64, half_rad: f64) -> [std::ops::Range<usize>; 2] {
        let count = self.directions.len();
        if half_rad >= PI || self.angle_increment_rad == 0.0 {
            return [0..count, 0..0];
        }
        // Angles are measured from the first beam.
        let from_rad = (bearing_rad - half_rad - self.angle_min_rad).rem_euclid(TAU);
        let to_rad = from_rad + 2.0 * half_rad;
        let before = |angle_rad: f64| (angle_rad / self.angle_increment_rad).ceil() as usize;
        let end = |angle_rad: f64| {
            let last = (angle_rad / self.angle_increment_rad).floor();
            if last < 0.0 { 0 } else { (last as usize).saturating_add(1).min(count) }
        };
        let first_turn = 0..end(to_rad - TAU);
        [before(from_rad).max(first_turn.end)..end(to_rad), first_turn]
    }
}

fn direction(angle_rad: f64) -> Point {
    let (sin, cos) = libm::sincos(angle_rad);
    Point::new(cos, sin)
}

/// Direction of a beam of a robot that faces `ahead`.
fn turned(beam: Point, ahead: Point) -> Point {
    Point::new(ahead.x * beam.x - ahead.y * beam.y, ahead.y * beam.x + ahead.x * beam.y)
}
