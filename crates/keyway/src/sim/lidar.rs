//! What a range sensor measures in a world: exact ray casting.

use super::{Circle, WorldAt};
use crate::geometry::{Point, Pose};
use crate::map::RayCells;
use crate::robot::RangeSensor;
use crate::sense::Scan;
use std::f64::consts::{PI, TAU};

impl WorldAt<'_> {
    /// What a sensor at `pose` measures, without noise: for every beam the exact distance to the
    /// first square or circle, infinity when that is beyond the sensor's range; 0 inside an
    /// obstacle. Outside the map there are only circles.
    ///
    /// All around (360 degrees), beam 0 looks back (-180 degrees) and the others follow evenly; with
    /// a smaller field of view the first and the last beam look along its edges. A single beam
    /// looks straight ahead.
    ///
    /// A beam is a line without width: it passes between two squares that only share a corner, and
    /// along the border of two squares it sees the one that `map::ray` visits.
    ///
    /// Costs a few operations per cell that a beam passes, and per beam and circle within range.
    pub fn cast(&self, pose: Pose, sensor: &RangeSensor) -> Scan {
        let (angle_min_rad, angle_increment_rad) = beam_layout(sensor);
        let range_max_m = sensor.range_m;
        let mut scan = Scan { angle_min_rad, angle_increment_rad, range_max_m, ranges_m: vec![] };
        let point = pose.point();
        let in_range = |circle: &Circle| circle.distance(point) <= range_max_m;
        let circles: Vec<Circle> = self.circles().filter(in_range).collect();
        let ranges = (0..sensor.beams as usize).map(|beam| {
            let heading_rad = pose.theta + scan.bearing_rad(beam);
            let mut nearest = self.range_to_square(point, heading_rad, range_max_m);
            for circle in &circles {
                nearest = nearest.min(range_to_circle(point, heading_rad, circle));
            }
            if nearest <= range_max_m { nearest } else { f64::INFINITY }
        });
        scan.ranges_m = ranges.collect();
        scan
    }

    /// Distance along a beam to the first square, infinity when none is within `range_m` \[m\].
    fn range_to_square(&self, from: Point, heading_rad: f64, range_m: f64) -> f64 {
        let (frame, squares) = (self.world().frame(), self.world().squares());
        let (sin, cos) = libm::sincos(heading_rad - frame.origin().theta);
        let start = frame.grid_from_world(from);
        let length = range_m / frame.resolution_m();
        RayCells::new(frame, start, Point::new(cos, sin), length)
            .find(|passed| squares.get(passed.cell))
            .map_or(f64::INFINITY, |passed| passed.enter * frame.resolution_m())
    }
}

/// Bearing of the first beam and from one beam to the next \[rad\].
fn beam_layout(sensor: &RangeSensor) -> (f64, f64) {
    let beams = f64::from(sensor.beams);
    let field_rad = sensor.field_of_view_deg.to_radians();
    if sensor.beams <= 1 {
        (0.0, 0.0)
    } else if sensor.field_of_view_deg >= 360.0 {
        (-PI, TAU / beams)
    } else {
        (-0.5 * field_rad, field_rad / (beams - 1.0))
    }
}

/// Distance along a beam to a circle, infinity when it is missed \[m\].
fn range_to_circle(from: Point, heading_rad: f64, circle: &Circle) -> f64 {
    let (sin, cos) = libm::sincos(heading_rad);
    let direction = Point::new(cos, sin);
    let to_centre = circle.centre - from;
    let radius_sq = circle.radius_m * circle.radius_m;
    let outside = to_centre.norm_sq() - radius_sq;
    if outside <= 0.0 {
        return 0.0;
    }
    let ahead = to_centre.dot(direction);
    let aside = to_centre.cross(direction);
    let half_chord_sq = radius_sq - aside * aside;
    if ahead <= 0.0 || half_chord_sq < 0.0 {
        return f64::INFINITY;
    }
    // The smaller root as c / q: without the cancellation of `ahead - half_chord` near the circle.
    outside / (ahead + half_chord_sq.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Segment, Square};
    use crate::map::{BitGrid, GridFrame, OccupancyGrid};
    use crate::sim::World;
    use proptest::prelude::*;

    fn sensor(beams: u32, field_of_view_deg: f64, range_m: f64) -> RangeSensor {
        RangeSensor { beams, field_of_view_deg, range_m }
    }

    #[test]
    fn ranges_by_hand() {
        let known = OccupancyGrid::from_ascii(&["....#", ".....", "#...."]);
        let circle = Circle::standing(Point::new(2.5, 2.5), 0.25);
        let world = World::from_known(&known, vec![circle]).unwrap();
        let cast = |x, y, degrees: f64| {
            let pose = Pose::new(x, y, degrees.to_radians());
            world.at(0.0).cast(pose, &sensor(4, 360.0, 2.25)).ranges_m
        };
        // Beams look back, right, ahead, left.
        let ranges = cast(2.5, 0.5, 0.0);
        assert_eq!(ranges[..3], [1.5, f64::INFINITY, f64::INFINITY]);
        assert!((ranges[3] - 1.75).abs() < 1e-12);
        let turned = cast(2.5, 0.5, 90.0);
        assert!((turned[2] - 1.75).abs() < 1e-12 && (turned[3] - 1.5).abs() < 1e-12);
        assert_eq!(cast(0.5, 0.5, 20.0), [0.0; 4], "inside a square");
        assert_eq!(cast(2.4, 2.4, 20.0), [0.0; 4], "inside a circle");
        assert!((cast(6.5, 2.5, 180.0)[2] - 1.5).abs() < 1e-12, "from outside the map");
    }

    #[test]
    fn beam_layouts() {
        let known = OccupancyGrid::from_ascii(&["."]);
        let world = World::from_known(&known, vec![]).unwrap();
        let bearings = |beams, field_deg| {
            let scan = world.at(0.0).cast(Pose::default(), &sensor(beams, field_deg, 1.0));
            assert_eq!(scan.ranges_m.len(), beams as usize);
            (0..beams as usize).map(|i| scan.bearing_rad(i).to_degrees().round()).collect()
        };
        let all: Vec<f64> = bearings(4, 360.0);
        assert_eq!(all, [-180.0, -90.0, 0.0, 90.0]);
        let part: Vec<f64> = bearings(4, 270.0);
        assert_eq!(part, [-135.0, -45.0, 45.0, 135.0]);
        let one: Vec<f64> = bearings(1, 360.0);
        assert_eq!(one, [0.0]);
    }

    /// Entering distance of the ray into the closed square, by the distance along the ray at which
    /// sampled clearance to it vanishes: bisection on "the segment up to here meets it".
    fn square_by_bisection(start: Point, direction: Point, range: f64, square: Square) -> f64 {
        let meets = |length: f64| Segment::new(start, start + direction * length).meets(square);
        if !meets(range) {
            return f64::INFINITY;
        }
        let (mut low, mut high) = (0.0, range);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if meets(middle) { high = middle } else { low = middle }
        }
        high
    }

    /// First sample inside the circle, refined by bisection.
    fn circle_by_sampling(start: Point, direction: Point, range: f64, circle: &Circle) -> f64 {
        let inside = |t: f64| (start + direction * t).distance(circle.centre) <= circle.radius_m;
        let nearest = (circle.centre - start).dot(direction).clamp(0.0, range);
        if !inside(nearest) {
            return f64::INFINITY;
        }
        let (mut low, mut high) = (0.0, nearest);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if inside(middle) { high = middle } else { low = middle }
        }
        if inside(0.0) { 0.0 } else { high }
    }

    proptest! {
        #[test]
        fn agrees_with_brute_force(occupied in prop::collection::vec(prop::bool::weighted(0.08), 14 * 11),
                                   circles in prop::collection::vec((0.0..1.4f64, 0.0..1.1f64, 0.0..0.2f64), 0..4),
                                   yaw in -3.1..3.1f64, x in -0.3..1.7f64, y in -0.3..1.4f64,
                                   theta in -3.1..3.1f64, range in 0.2..2.0f64) {
            let frame = GridFrame::new(14, 11, 0.1, Pose::new(-3.0, 2.0, yaw)).unwrap();
            let world_point = |x: f64, y: f64| frame.world_from_grid(Point::new(x * 10.0, y * 10.0));
            let mut squares = BitGrid::new(14, 11, false);
            let cells: Vec<_> = frame.cells().zip(&occupied).filter(|c| *c.1).map(|c| c.0).collect();
            for &cell in &cells {
                squares.set(cell, true);
            }
            let circles: Vec<Circle> = circles.into_iter()
                .map(|(x, y, radius_m)| Circle::standing(world_point(x, y), radius_m)).collect();
            let world = World::new(frame, squares, circles.clone()).unwrap();
            let at = world_point(x, y);
            let scan = world.at(0.0).cast(Pose::new(at.x, at.y, theta), &sensor(24, 360.0, range));
            let start = frame.grid_from_world(at);
            for (i, &measured) in scan.ranges_m.iter().enumerate() {
                let heading = theta - PI + i as f64 * TAU / 24.0;
                let along = Point::new(libm::cos(heading), libm::sin(heading));
                // The grid's own direction, without subtracting angles.
                let ahead = frame.grid_from_world(at + along) - start;
                let by_squares = cells.iter().map(|cell| {
                    let corner = Point::new(f64::from(cell.x), f64::from(cell.y));
                    range * square_by_bisection(start, ahead * range, 1.0, Square { corner })
                });
                let by_circles = circles.iter().map(|c| circle_by_sampling(at, along, range, c));
                let expected = by_squares.chain(by_circles).fold(f64::INFINITY, f64::min);
                if expected.is_finite() {
                    prop_assert!((measured - expected).abs() < 1e-9, "{i}: {measured} {expected}");
                } else {
                    prop_assert_eq!(measured, f64::INFINITY);
                }
            }
        }
    }
}
