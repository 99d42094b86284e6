//! One scan of a range sensor.

use super::{Ranges, RangesRef};
use crate::geometry::{Point, Pose};
use crate::robot::RangeSensor;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Ranges measured at one instant by a sensor, as in ROS `sensor_msgs/LaserScan`.
///
/// Beam i has the bearing `angle_min_rad + i * angle_increment_rad` (0 is straight ahead,
/// counter-clockwise): a sensor that rotates clockwise has a negative increment.
///
/// The ranges are owned or borrowed from a driver, in either precision ([`Ranges`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scan<R = Vec<f64>> {
    /// Bearing of the first beam \[rad\].
    pub angle_min_rad: f64,
    /// Bearing from one beam to the next \[rad\], negative for clockwise rotation.
    pub angle_increment_rad: f64,
    /// Minimum range \[m\]. Shorter ranges are discarded: the sensor is blind there or sees its
    /// own housing. 0 if it sees from its centre on.
    pub range_min_m: f64,
    /// Maximum range \[m\]. Longer ranges are discarded, except infinity: no return within this
    /// range.
    pub range_max_m: f64,
    /// Range of every beam \[m\]. As in ROS, values outside [`Self::range_min_m`] to
    /// [`Self::range_max_m`] are discarded, also NaN and 0; infinity means no return. A driver
    /// that writes another number for no return (0, or one beyond the range) must write infinity
    /// instead, or the sensor's free space stays unknown.
    pub ranges_m: R,
}

/// Reason why the beams of a scan are invalid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScanError {
    /// The scan has no beams.
    #[error("a scan has at least one beam")]
    NoBeams,
    /// The bearing of the first beam is out of range.
    #[error(
        "the bearing of the first beam must be a number from -2 pi to 2 pi, got {0}; is it in degrees?"
    )]
    FirstBearing(f64),
    /// The increment is zero or not finite.
    #[error("the angle from one beam to the next must be a number other than 0, got {0}")]
    Increment(f64),
    /// The beams span more than one turn.
    #[error(
        "{beams} beams with {increment_rad} rad from one to the next cover more than a full turn; \
         is the angle in degrees?"
    )]
    Turns {
        /// Number of beams.
        beams: usize,
        /// Angle between neighbouring beams \[rad\].
        increment_rad: f64,
    },
}

/// One turn, up to rounding; the first and the last beam may point the same way.
const ONE_TURN_RAD: f64 = TAU * 1.001;

/// The valid reading of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reading {
    /// Obstacle at this distance, free before it \[m\].
    Hit(f64),
    /// Free up to this distance \[m\].
    Free(f64),
}

impl Reading {
    /// Length of the beam that is free of obstacles \[m\].
    pub const fn free_m(self) -> f64 {
        match self {
            Self::Hit(range_m) | Self::Free(range_m) => range_m,
        }
    }
}

impl Scan {
    /// The scan of a sensor without any returns. All around (360 degrees), beam 0 points
    /// backwards (-180 degrees) and the others follow evenly; with a smaller field of view, the
    /// first and the last beam point along its edges. A single beam points straight ahead.
    pub fn of_nothing(sensor: &RangeSensor) -> Self {
        let count = f64::from(sensor.beams);
        let field_rad = sensor.field_of_view_deg.to_radians();
        let (angle_min_rad, angle_increment_rad) = if sensor.beams <= 1 {
            (0.0, 0.0)
        } else if sensor.field_of_view_deg >= 360.0 {
            (-PI, TAU / count)
        } else {
            (-0.5 * field_rad, field_rad / (count - 1.0))
        };
        let ranges_m = vec![f64::INFINITY; sensor.beams as usize];
        let RangeSensor { range_min_m, range_m: range_max_m, .. } = *sensor;
        Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, ranges_m }
    }
}

impl<R: Ranges> Scan<R> {
    /// The same scan with borrowed ranges.
    pub fn borrowed(&self) -> Scan<RangesRef<'_>> {
        let Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, .. } = *self;
        let ranges_m = self.ranges_m.as_ranges();
        Scan { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, ranges_m }
    }

    /// The same scan with owned ranges.
    pub fn owned(&self) -> Scan {
        let Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, .. } = *self;
        let ranges_m = self.ranges_m.as_ranges().iter().collect();
        Scan { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, ranges_m }
    }

    /// Number of beams.
    pub fn beams(&self) -> usize {
        self.ranges_m.as_ranges().len()
    }

    /// Checks that the bearings are plausible; angles in degrees, for example, are not.
    ///
    /// # Errors
    /// Returns [`ScanError`] without beams, or if the bearings are not finite, all the same, or
    /// span more than one turn.
    pub fn check(&self) -> Result<(), ScanError> {
        let (first_rad, increment_rad) = (self.angle_min_rad, self.angle_increment_rad);
        let beams = self.beams();
        if beams == 0 {
            return Err(ScanError::NoBeams);
        }
        if first_rad.is_nan() || first_rad.abs() > ONE_TURN_RAD {
            return Err(ScanError::FirstBearing(first_rad));
        }
        if beams > 1 && (increment_rad == 0.0 || !increment_rad.is_finite()) {
            return Err(ScanError::Increment(increment_rad));
        }
        let is_within_a_turn = beams == 1 || (beams - 1) as f64 * self.step_rad() <= ONE_TURN_RAD;
        if is_within_a_turn { Ok(()) } else { Err(ScanError::Turns { beams, increment_rad }) }
    }

    /// Bearing of a beam \[rad\], 0 straight ahead, counter-clockwise.
    pub fn bearing_rad(&self, beam: usize) -> f64 {
        self.angle_min_rad + beam as f64 * self.angle_increment_rad
    }

    /// Angle between two neighbouring beams \[rad\], regardless of the direction of rotation.
    const fn step_rad(&self) -> f64 {
        self.angle_increment_rad.abs()
    }

    /// True if no beam is valid.
    pub fn says_nothing(&self) -> bool {
        (0..self.beams()).all(|beam| self.reading(beam).is_none())
    }

    /// True if a beam hits something.
    pub(crate) fn has_hits(&self) -> bool {
        (0..self.beams()).any(|beam| matches!(self.reading(beam), Some(Reading::Hit(_))))
    }

    /// The reading of a beam; `None` if the beam does not exist or is invalid.
    pub fn reading(&self, beam: usize) -> Option<Reading> {
        let range_m = self.ranges_m.as_ranges().get(beam)?;
        if range_m == f64::INFINITY {
            let is_known = self.range_max_m > 0.0 && self.range_max_m.is_finite();
            return is_known.then_some(Reading::Free(self.range_max_m));
        }
        // A minimum range that is NaN excludes nothing, so that no obstacle is ignored because of
        // it.
        let is_too_near = range_m < self.range_min_m;
        let is_hit = range_m > 0.0 && range_m <= self.range_max_m && !is_too_near;
        is_hit.then_some(Reading::Hit(range_m))
    }

    /// The hit points of a sensor at `pose` \[m\], in the order of the beams.
    pub fn hits(&self, pose: Pose) -> impl Iterator<Item = Point> + '_ {
        (0..self.beams()).filter_map(move |beam| {
            let Some(Reading::Hit(range_m)) = self.reading(beam) else { return None };
            let (sin, cos) = libm::sincos(self.bearing_rad(beam));
            Some(pose.world_from_body(Point::new(range_m * cos, range_m * sin)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beams_look_somewhere_within_a_turn() {
        let check = |beams: usize, angle_min_rad, angle_increment_rad| {
            let ranges_m = vec![1.0; beams];
            Scan { angle_min_rad, angle_increment_rad, ranges_m, ..Scan::default() }.check()
        };
        for (beams, first_rad, increment_rad) in
            [(360, 0.0, TAU / 360.0), (361, PI, -TAU / 360.0), (1, 0.0, 0.0), (1, 0.0, f64::NAN)]
        {
            assert_eq!(check(beams, first_rad, increment_rad), Ok(()));
        }
        assert_eq!(check(0, 0.0, 0.1), Err(ScanError::NoBeams));
        assert_eq!(check(9, -180.0, 1.0), Err(ScanError::FirstBearing(-180.0)));
        assert!(matches!(check(9, f64::NAN, 1.0), Err(ScanError::FirstBearing(_))));
        assert_eq!(check(2, 0.0, 0.0), Err(ScanError::Increment(0.0)));
        assert_eq!(check(2, 0.0, f64::INFINITY), Err(ScanError::Increment(f64::INFINITY)));
        let degrees = ScanError::Turns { beams: 360, increment_rad: -1.0 };
        assert_eq!(check(360, 0.0, -1.0), Err(degrees));
    }

    #[test]
    fn ranges_mean_what_they_mean_in_ros() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let ranges_m = vec![0.1, 0.09, 0.0, -1.0, nan, -inf, 3.0, 3.01, 65.0, inf];
        let scan = Scan { range_min_m: 0.1, range_max_m: 3.0, ranges_m, ..Scan::default() };
        let readings: Vec<_> = (0..11).map(|beam| scan.reading(beam)).collect();
        let (hit, none) = (|range_m| Some(Reading::Hit(range_m)), None);
        let free = Some(Reading::Free(3.0));
        let expected = [hit(0.1), none, none, none, none, none, hit(3.0), none, none, free, none];
        assert_eq!(readings, expected);
        assert_eq!((Reading::Hit(1.0).free_m(), Reading::Free(3.0).free_m()), (1.0, 3.0));
        // A hit is not discarded for a range limit that is NaN or infinite; the length of free
        // space is then unknown.
        let blind = Scan { range_min_m: nan, ..scan.clone() };
        assert_eq!((blind.reading(0), blind.reading(9)), (hit(0.1), free));
        let endless = Scan { range_max_m: inf, ..scan };
        assert_eq!((endless.reading(8), endless.reading(9)), (hit(65.0), None));
    }

    #[test]
    fn hits_are_in_the_world_and_misses_are_not() {
        let scan = Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: std::f64::consts::FRAC_PI_2,
            range_min_m: 0.0,
            range_max_m: 3.0,
            ranges_m: vec![2.0, f64::INFINITY, 3.5, f64::NAN],
        };
        let pose = Pose::new(1.0, 1.0, std::f64::consts::FRAC_PI_2);
        let hits: Vec<Point> = scan.hits(pose).collect();
        assert_eq!(hits.len(), 1);
        assert!(hits[0].distance(Point::new(1.0, 3.0)) < 1e-12);
    }
}
