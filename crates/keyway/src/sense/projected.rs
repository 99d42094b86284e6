//! A scan in the world frame: the reading and the end of each beam, computed once per cycle.

use super::layer::says_something;
use super::{FieldOfView, Ranges, Reading, Scan, SensorScan};
use crate::geometry::{Point, Pose, Shift, wrap_angle};
use crate::map::{Cell, GridFrame};
use crate::robot::Footprint;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// A scan made by a sensor of a robot at a pose on a grid. It is the common input of the tracker,
/// the sensed layer and the observed free space.
///
/// A beam that ends inside the footprint has hit the robot itself (a post of the housing, a
/// cable, a gripper) and is ignored.
///
/// Memory: 48 bytes per beam.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ProjectedScan {
    robot: Pose,
    pose: Pose,
    angle_min_rad: f64,
    angle_increment_rad: f64,
    range_max_m: f64,
    beams: Vec<Beam>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Beam {
    reading: Option<Reading>,
    hit: Option<Hit>,
}

/// The end of a beam at an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Hit {
    /// Position in the world frame \[m\].
    pub point: Point,
    /// The cell that it marks; `None` outside the map.
    pub cell: Option<Cell>,
}

/// Length along a beam by which a hit is advanced before its cell is looked up \[cells\]. Despite
/// rounding, a hit exactly on a square's face then marks the square behind the face, not the free
/// cell before it. A square that the beam crosses for less than this, or at a flatter angle than
/// rounding allows, may still be mistaken for its neighbour.
const HIT_ADVANCE_CELLS: f64 = 1e-6;

/// Tolerance for a point to lie on a beam, despite rounding \[beams\].
const ON_A_BEAM: f64 = 1e-6;

/// Tolerance for a beam to end at a point, despite rounding \[m\].
const AT_PLACE_M: f64 = 1e-6;

impl ProjectedScan {
    /// A scan made at `pose` (world frame) by a robot of this footprint with a sensor at its
    /// centre of rotation.
    pub fn new<R: Ranges>(
        frame: &GridFrame,
        footprint: &Footprint,
        pose: Pose,
        scan: &Scan<R>,
    ) -> Self {
        let mut projected = Self::default();
        projected.project(frame, footprint, pose, &SensorScan::centred(0.0, scan));
        projected
    }

    /// Replaces the scan by another one, made by a robot of this footprint at `robot` (world
    /// frame). Does not allocate unless the new scan is longer.
    pub fn project(
        &mut self,
        frame: &GridFrame,
        footprint: &Footprint,
        robot: Pose,
        &SensorScan { mount, scan, .. }: &SensorScan<'_>,
    ) {
        let pose = robot.compose(mount);
        let start = frame.grid_from_world(pose.point());
        let ahead_rad = pose.theta - frame.origin().theta;
        let beam = |number: usize| {
            let reading = scan.reading(number)?;
            let Reading::Hit(range_m) = reading else {
                return Some(Beam { reading: Some(reading), hit: None });
            };
            let bearing_rad = scan.bearing_rad(number);
            if is_own(footprint, mount, bearing_rad, range_m) {
                return None;
            }
            let (sin, cos) = libm::sincos(ahead_rad + bearing_rad);
            let direction = Point::new(cos, sin);
            let free = range_m / frame.resolution_m();
            let hit = (start.is_finite() && direction.is_finite()).then(|| Hit {
                point: frame.world_from_grid(start + direction * free),
                cell: frame.cell_from_grid(start + direction * (free + HIT_ADVANCE_CELLS)),
            });
            Some(Beam { reading: Some(reading), hit })
        };
        let nothing = Beam { reading: None, hit: None };
        self.beams.clear();
        self.beams.extend((0..scan.beams()).map(|number| beam(number).unwrap_or(nothing)));
        let Scan { angle_min_rad, angle_increment_rad, range_max_m, .. } = scan;
        (self.robot, self.pose, self.range_max_m) = (robot, pose, range_max_m);
        (self.angle_min_rad, self.angle_increment_rad) = (angle_min_rad, angle_increment_rad);
    }

    /// Moves the scan along with a correction of the robot's pose.
    pub(crate) fn shift(&mut self, frame: &GridFrame, shift: &Shift) {
        (self.robot, self.pose) = (shift.pose(self.robot), shift.pose(self.pose));
        let from = frame.grid_from_world(self.pose.point());
        for hit in self.beams.iter_mut().filter_map(|beam| beam.hit.as_mut()) {
            hit.point = shift.point(hit.point);
            let end = frame.grid_from_world(hit.point);
            let length = end.distance(from);
            let share = if length > 0.0 { 1.0 + HIT_ADVANCE_CELLS / length } else { 1.0 };
            hit.cell = frame.cell_from_grid(from + (end - from) * share);
        }
    }

    /// Becomes the view of a sensor at a pose (world frame) that has detected points (in its own
    /// frame): beams half a degree apart, each as long as the distance to the nearest point. A
    /// point occludes everything behind a disc of the width of a cell. Does not allocate unless
    /// there are more beams than before.
    pub(super) fn look_around(
        &mut self,
        pose: Pose,
        view: &FieldOfView,
        points: &[Point],
        cell_m: f64,
    ) {
        const STEP_RAD: f64 = PI / 360.0;
        let width_rad = view.to_rad - view.from_rad;
        let steps = (width_rad / STEP_RAD).ceil();
        let free = Reading::Free(view.range_max_m);
        self.beams.clear();
        self.beams.resize(steps as usize + 1, Beam { reading: Some(free), hit: None });
        (self.robot, self.pose, self.range_max_m) = (pose, pose, view.range_max_m);
        (self.angle_min_rad, self.angle_increment_rad) = (view.from_rad, width_rad / steps);
        for &point in points.iter().filter(|&&point| says_something(point)) {
            let (away_m, place) = (point.norm(), pose.world_from_body(point));
            // At least the two beams beside it, at any distance.
            let half_m = (0.5 * cell_m).max(away_m * self.step_rad());
            for beam in self.beams_towards(place, half_m) {
                let Some(beam) = self.beams.get_mut(beam) else { continue };
                let free_m = beam.reading.map_or(away_m, |before| before.free_m().min(away_m));
                beam.reading = Some(Reading::Hit(free_m));
            }
        }
    }

    /// Becomes a scan without beams, as if the sensor had made none.
    pub fn clear(&mut self, robot: Pose) {
        (self.robot, self.pose) = (robot, robot);
        self.beams.clear();
    }

    /// Copies another scan; does not allocate unless that is longer.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let mut beams = std::mem::take(&mut self.beams);
        beams.clone_from(&other.beams);
        let Self { robot, pose, angle_min_rad, angle_increment_rad, range_max_m, .. } = *other;
        *self = Self { robot, pose, angle_min_rad, angle_increment_rad, range_max_m, beams };
    }

    /// Pose of the robot at the time of the scan, in the world frame.
    pub const fn robot(&self) -> Pose {
        self.robot
    }

    /// Pose of the sensor at the time of the scan, in the world frame.
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Number of beams.
    pub const fn len(&self) -> usize {
        self.beams.len()
    }

    /// True for a scan without beams.
    pub const fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// True if no beam is valid.
    pub fn is_silent(&self) -> bool {
        self.beams.iter().all(|beam| beam.reading.is_none())
    }

    /// Length of a beam that is free of obstacles \[m\]; `None` if the beam does not exist or is
    /// invalid.
    pub fn free_m(&self, beam: usize) -> Option<f64> {
        self.beams.get(beam)?.reading.map(Reading::free_m)
    }

    /// The hit of a beam, if it has one.
    pub fn hit(&self, beam: usize) -> Option<Hit> {
        self.beams.get(beam)?.hit
    }

    /// All hits, each with the number of its beam.
    pub fn hits(&self) -> impl Iterator<Item = (usize, Hit)> + '_ {
        self.beams.iter().enumerate().filter_map(|(number, beam)| Some((number, beam.hit?)))
    }

    /// Collects the hits near a point, and samples between the hits of two neighbouring beams
    /// that are at most `joined_m` apart.
    pub(crate) fn note_places(
        &self,
        centre: Point,
        radius_m: f64,
        joined_m: f64,
        places: &mut Vec<Point>,
    ) {
        let count = self.beams.len();
        let is_turn = self.beams_of_a_turn().is_some();
        for (beam, Hit { point, .. }) in self.hits() {
            if point.distance(centre) > radius_m {
                continue;
            }
            places.push(point);
            let next = if beam + 1 < count { beam + 1 } else { 0 };
            let Some(next) = self.hit(next).filter(|_| next > 0 || is_turn) else { continue };
            let apart_m = next.point.distance(point);
            if apart_m <= joined_m {
                let parts = (apart_m / joined_m * Self::PLACES_JOINED).ceil();
                let part = |i: u32| point.lerp(next.point, f64::from(i) / parts);
                places.extend((1..parts as u32).map(part));
            }
        }
    }

    /// Number of intervals between two hits that are exactly `joined_m` apart.
    const PLACES_JOINED: f64 = 15.0;

    /// Direction of a beam in the world frame, of length 1.
    pub(super) fn direction(&self, beam: usize) -> Point {
        let bearing_rad = self.angle_min_rad + beam as f64 * self.angle_increment_rad;
        let (sin, cos) = libm::sincos(self.pose.theta + bearing_rad);
        Point::new(cos, sin)
    }

    /// Angle between two neighbouring beams \[rad\], regardless of the direction of rotation.
    pub(super) const fn step_rad(&self) -> f64 {
        self.angle_increment_rad.abs()
    }

    /// The number of beams per turn, if the sensor sees all around. The last beam may point the
    /// same way as the first one; the scan then has one beam more.
    fn beams_of_a_turn(&self) -> Option<f64> {
        let count = self.beams.len() as f64;
        let is_full_turn = self.step_rad() * (count + 0.5) >= TAU;
        is_full_turn.then(|| (TAU / self.step_rad()).round().min(count))
    }

    /// The fractional index of the beam towards a point: between two beams, or below 0 or beyond
    /// the last one outside the field of view. `None` if all beams have the same bearing or the
    /// point is not finite.
    pub(super) fn beam_towards(&self, place: Point) -> Option<f64> {
        let step_rad = self.angle_increment_rad;
        let is_usable = step_rad != 0.0 && place.is_finite();
        // Bearing from the middle beam, so that the seam is opposite to it.
        let half = 0.5 * (self.beams.len() as f64 - 1.0);
        let middle_rad = self.angle_min_rad + half * step_rad;
        let heading_rad = (place - self.pose.point()).heading();
        let from_middle_rad = wrap_angle(heading_rad - self.pose.theta - middle_rad);
        is_usable.then(|| half + from_middle_rad / step_rad)
    }

    /// The beams that intersect a disc, in order; all beams if the sensor is inside it.
    pub(super) fn beams_towards(
        &self,
        centre: Point,
        radius_m: f64,
    ) -> impl Iterator<Item = usize> + use<> {
        let (count, step_rad) = (self.beams.len(), self.step_rad());
        let distance_m = centre.distance(self.pose.point());
        let half_rad = if distance_m > radius_m { libm::asin(radius_m / distance_m) } else { PI };
        let middle = self.beam_towards(centre).unwrap_or(0.0);
        let low = (middle - half_rad / step_rad).ceil();
        let high = (middle + half_rad / step_rad).floor();
        let last = count as f64 - 1.0;
        // Also handles a NaN bearing.
        let looks = low <= high && count > 0;
        let turn = self.beams_of_a_turn();
        let (low, high) = match turn {
            _ if !looks => (0.0, -1.0),
            None => (low.max(0.0), high.min(last)),
            Some(turn) if high - low >= turn => (0.0, last),
            Some(_) => (low, high),
        };
        let turn = turn.unwrap_or(f64::INFINITY).max(1.0);
        (low as i64..=high as i64).map(move |beam| (beam as f64).rem_euclid(turn) as usize)
    }

    /// True if no obstacle of this width \[m\] is at a point: the beams to both sides continue
    /// beyond it, and one of them passes so close that it would have hit the obstacle.
    pub(crate) fn shows_free(&self, place: Point, width_m: f64) -> bool {
        let off = self.beam_towards(place).map_or(f64::NAN, |beam| beam - beam.round());
        let away_m = place.distance(self.pose.point());
        off.abs() * self.step_rad() * away_m <= 0.5 * width_m && self.sees_through(place)
    }

    /// True if the beams to both sides of a point continue beyond it.
    pub(crate) fn sees_through(&self, place: Point) -> bool {
        let away_m = place.distance(self.pose.point());
        if away_m.is_nan() || away_m > self.range_max_m {
            return false;
        }
        let Some(number) = self.beam_towards(place) else { return false };
        let nearest = number.round();
        let is_on_it = (number - nearest).abs() <= ON_A_BEAM;
        let beside = if is_on_it { [nearest; 2] } else { [number.floor(), number.ceil()] };
        let count = self.beams.len() as f64;
        beside.into_iter().all(|beam| {
            let beam = self.beams_of_a_turn().map_or(beam, |turn| beam.rem_euclid(turn));
            // A NaN index is no beam, either.
            let is_there = beam >= 0.0 && beam < count;
            let free_m = if is_there { self.free_m(beam as usize) } else { None };
            free_m.is_some_and(|free_m| free_m > away_m + AT_PLACE_M)
        })
    }
}

/// True if a beam of a sensor with this mount ends inside the footprint.
fn is_own(footprint: &Footprint, mount: Pose, bearing_rad: f64, range_m: f64) -> bool {
    range_m <= mount.point().norm() + footprint.circumscribed_radius_m() && {
        let (sin, cos) = libm::sincos(mount.theta + bearing_rad);
        footprint.covers(mount.point() + Point::new(cos, sin) * range_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Beams ahead, to the left, behind and to the right.
    fn scan(ranges_m: [f64; 4]) -> Scan {
        Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: FRAC_PI_2,
            range_min_m: 0.0,
            range_max_m: 3.0,
            ranges_m: ranges_m.to_vec(),
        }
    }

    fn frame() -> GridFrame {
        GridFrame::new(10, 10, 1.0, Pose::default()).unwrap()
    }

    #[test]
    fn what_is_inside_of_the_footprint_says_nothing() {
        let disc = Footprint::circle(0.2).unwrap();
        let rectangle = Footprint::rectangle(0.6, 0.3).unwrap();
        let scan = scan([0.19, 0.16, 0.25, f64::INFINITY]);
        for (footprint, own) in
            [(disc, [true, true, false, false]), (rectangle, [true, false, true, false])]
        {
            let seen = ProjectedScan::new(&frame(), &footprint, Pose::new(5.0, 5.0, 0.3), &scan);
            for (beam, own) in own.into_iter().enumerate() {
                let expected = if own { None } else { scan.reading(beam).map(Reading::free_m) };
                assert_eq!(seen.free_m(beam), expected, "{footprint} {beam}");
                assert_eq!(seen.hit(beam).is_some(), !own && beam < 3, "{footprint} {beam}");
            }
        }
        // A point robot has no body.
        let near = Scan { ranges_m: vec![1e-9; 4], ..scan };
        let seen = ProjectedScan::new(&frame(), &Footprint::POINT, Pose::default(), &near);
        assert!((0..4).all(|beam| seen.free_m(beam) == Some(1e-9)) && !seen.is_silent());
    }

    #[test]
    fn hits_on_a_grid_that_is_turned() {
        let frame = GridFrame::new(4, 6, 0.5, Pose::new(1.0, 2.0, FRAC_PI_2)).unwrap();
        let pose = Pose::new(0.0, 2.25, FRAC_PI_2);
        let seen = ProjectedScan::new(
            &frame,
            &Footprint::POINT,
            pose,
            &scan([1.3, 1.2, f64::NAN, f64::INFINITY]),
        );
        let hits: Vec<(usize, Hit)> = seen.hits().collect();
        let expected = [
            (0, Point::new(0.0, 3.55), Cell::new(3, 2)),
            (1, Point::new(-1.2, 2.25), Cell::new(0, 4)),
        ];
        assert_eq!(hits.len(), 2);
        for ((beam, hit), (expected_beam, point, cell)) in hits.into_iter().zip(expected) {
            assert!(hit.point.distance(point) < 1e-12, "{hit:?}");
            assert_eq!((beam, hit.cell), (expected_beam, Some(cell)));
        }
        assert_eq!((seen.free_m(2), seen.free_m(3), seen.free_m(4)), (None, Some(3.0), None));
        let nowhere = Pose { x: f64::NAN, ..pose };
        let lost = ProjectedScan::new(&frame, &Footprint::POINT, nowhere, &scan([1.0; 4]));
        assert_eq!((lost.hits().count(), lost.sees_through(Point::new(0.0, 0.0))), (0, false));
    }

    /// Across the seam of a full turn, and for a sensor that rotates the other way.
    #[test]
    fn a_place_is_seen_through_between_any_two_beams() {
        let seen =
            |scan: &Scan| ProjectedScan::new(&frame(), &Footprint::POINT, Pose::default(), scan);
        for sign in [1.0, -1.0] {
            for tenth in 0..3600 {
                let bearing = f64::from(tenth).to_radians() / 10.0 - PI;
                let scan = Scan {
                    angle_min_rad: -sign * PI,
                    angle_increment_rad: sign * 2f64.to_radians(),
                    range_min_m: 0.1,
                    range_max_m: 3.0,
                    ranges_m: vec![f64::INFINITY; 180],
                };
                let place = Point::new(2.0 * bearing.cos(), 2.0 * bearing.sin());
                assert!(seen(&scan).sees_through(place), "{bearing}");
                let near = Scan { ranges_m: vec![1.9; 180], ..scan };
                assert!(!seen(&near).sees_through(place), "{bearing}");
            }
        }
    }

    /// Beams 10 degrees apart: 0.35 m at a distance of 2 m.
    #[test]
    fn what_is_narrower_than_the_gap_between_two_beams_may_be_there() {
        let scan = Scan {
            angle_min_rad: -PI,
            angle_increment_rad: 10f64.to_radians(),
            range_min_m: 0.0,
            range_max_m: 3.0,
            ranges_m: vec![f64::INFINITY; 36],
        };
        let seen = ProjectedScan::new(&frame(), &Footprint::POINT, Pose::default(), &scan);
        let place = |deg: f64| Point::new(deg.to_radians().cos(), deg.to_radians().sin()) * 2.0;
        let shows = |deg: f64, width_m| seen.shows_free(place(deg), width_m);
        assert!(seen.sees_through(place(5.0)) && shows(0.0, 0.06) && shows(30.0, 0.06));
        assert!(!shows(5.0, 0.34) && shows(5.0, 0.36));
        // 3 cm beside a beam.
        assert!(shows(0.85, 0.06) && !shows(0.87, 0.06) && shows(-0.85, 0.06));
        assert!(!seen.shows_free(Point::new(f64::NAN, 0.0), 1.0));
    }

    /// 361 beams one degree apart: the first and the last point backwards.
    #[test]
    fn across_a_seam_that_two_beams_share() {
        let mut ranges_m = vec![f64::INFINITY; 361];
        let behind = |ranges_m: &[f64]| {
            let scan = Scan {
                angle_min_rad: -PI,
                angle_increment_rad: 1f64.to_radians(),
                range_min_m: 0.0,
                range_max_m: 3.0,
                ranges_m: ranges_m.to_vec(),
            };
            ProjectedScan::new(&frame(), &Footprint::POINT, Pose::default(), &scan)
        };
        let place = |deg: f64| Point::new(deg.to_radians().cos(), deg.to_radians().sin()) * 2.0;
        let beams: Vec<usize> = behind(&ranges_m).beams_towards(place(180.0), 0.06).collect();
        assert_eq!(beams, [359, 0, 1]);
        assert!([179.5, -179.5].iter().all(|&deg| behind(&ranges_m).sees_through(place(deg))));
        ranges_m[1] = 1.0;
        assert!(!behind(&ranges_m).sees_through(place(-179.5)));
        assert!(behind(&ranges_m).sees_through(place(179.5)));
    }
}
