//! What a range sensor measures in a world: exact ray casting.

use super::{Circle, WorldAt};
use crate::geometry::{Point, Pose, Segment, outline};
use crate::map::RayCells;
use crate::robot::{Footprint, RangeSensor};
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
        self.cast_among(pose, sensor, std::iter::empty())
    }

    /// The same among other robots: each is seen as its footprint at its pose.
    pub(super) fn cast_among<'f>(
        &self,
        pose: Pose,
        sensor: &RangeSensor,
        robots: impl Iterator<Item = (&'f Footprint, Pose)>,
    ) -> Scan {
        let (angle_min_rad, angle_increment_rad) = beam_layout(sensor);
        let range_max_m = sensor.range_m;
        let mut scan = Scan { angle_min_rad, angle_increment_rad, range_max_m, ranges_m: vec![] };
        let point = pose.point();
        let mut shapes = Shapes::new(point, range_max_m);
        self.circles().for_each(|circle| shapes.add_circle(circle));
        robots.for_each(|(footprint, at)| shapes.add_footprint(footprint, at));
        let ranges = (0..sensor.beams as usize).map(|beam| {
            let heading_rad = pose.theta + scan.bearing_rad(beam);
            let to_square = self.range_to_square(point, heading_rad, range_max_m);
            let nearest = shapes.range(heading_rad, to_square);
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

/// What is within a sensor's range, apart from squares.
struct Shapes {
    from: Point,
    range_m: f64,
    circles: Vec<Circle>,
    /// Edges of polygons.
    edges: Vec<Segment>,
    /// Whether the sensor is inside a polygon.
    is_covered: bool,
}

impl Shapes {
    const fn new(from: Point, range_m: f64) -> Self {
        Self { from, range_m, circles: Vec::new(), edges: Vec::new(), is_covered: false }
    }

    fn add_circle(&mut self, circle: Circle) {
        if circle.distance(self.from) <= self.range_m {
            self.circles.push(circle);
        }
    }

    fn add_footprint(&mut self, footprint: &Footprint, pose: Pose) {
        match footprint {
            Footprint::Circle(disc) => {
                self.add_circle(Circle::standing(pose.point(), disc.radius_m()));
            }
            Footprint::Polygon(polygon) => {
                let (core, _) = footprint.core();
                let apart_m = core.distance_to_m(pose, self.from);
                self.is_covered |= apart_m <= 0.0;
                if apart_m <= self.range_m {
                    let vertices = polygon.vertices().iter();
                    self.edges.extend(outline(vertices.map(|&v| pose.world_from_body(v))));
                }
            }
        }
    }

    /// The smaller of `known_m` and the distance along a beam to the first shape \[m\].
    fn range(&self, heading_rad: f64, known_m: f64) -> f64 {
        if self.is_covered {
            return 0.0;
        }
        let to_circle = |circle| range_to_circle(self.from, heading_rad, circle);
        let nearest_m = self.circles.iter().map(to_circle).fold(known_m, f64::min);
        let to_edge = |edge| range_to_edge(self.from, heading_rad, edge);
        self.edges.iter().map(to_edge).fold(nearest_m, f64::min)
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

/// Distance along a beam to an edge of a polygon, infinity when it is missed \[m\]. An edge along the beam
/// counts as missed: its neighbours have the same ends. On which side of the beam a vertex lies does not
/// depend on the edge, so no beam slips through between two edges.
fn range_to_edge(from: Point, heading_rad: f64, edge: &Segment) -> f64 {
    let (sin, cos) = libm::sincos(heading_rad);
    let direction = Point::new(cos, sin);
    let (to_a, to_b) = (edge.a - from, edge.b - from);
    let (aside_a, aside_b) = (direction.cross(to_a), direction.cross(to_b));
    if aside_a == aside_b || aside_a.min(aside_b) > 0.0 || aside_a.max(aside_b) < 0.0 {
        return f64::INFINITY;
    }
    let ahead = direction.dot(to_a.lerp(to_b, aside_a / (aside_a - aside_b)));
    if ahead >= 0.0 { ahead } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Square;
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

        /// No place on a beam before its range is on another robot, and the one at its range is.
        #[test]
        fn other_robots_are_seen_as_their_footprints(
            radii in prop::collection::vec(0.1..0.6f64, 3..8), offset in (-0.5..0.5f64, -0.5..0.5f64),
            disc_m in 0.0..0.4f64, poses in prop::array::uniform3((-1.5..1.5f64, -1.5..1.5f64, -3.1..3.1f64)),
            range_m in 0.2..3.0f64,
        ) {
            let step = TAU / radii.len() as f64;
            let vertices = radii.iter().enumerate().map(|(i, &radius)| {
                let (sin, cos) = libm::sincos(step * i as f64);
                Point::new(offset.0 + radius * cos, offset.1 + radius * sin)
            }).collect();
            let footprints = [Footprint::polygon(vertices).unwrap(), Footprint::circle(disc_m).unwrap()];
            let [from, polygon_pose, disc_pose] = poses.map(|(x, y, theta)| Pose::new(x, y, theta));
            let robots = || footprints.iter().zip([polygon_pose, disc_pose]);
            let frame = GridFrame::new(10, 10, 1.0, Pose::new(-5.0, -5.0, 0.0)).unwrap();
            let world = World::from_known(&OccupancyGrid::all_free(frame), vec![]).unwrap();
            let scan = world.at(0.0).cast_among(from, &sensor(32, 360.0, range_m), robots());
            let gap_m = |point: Point| robots().map(|(footprint, pose)| {
                let (core, radius_m) = footprint.core();
                core.distance_to_m(pose, point) - radius_m
            }).fold(f64::INFINITY, f64::min);
            for (beam, &range) in scan.ranges_m.iter().enumerate() {
                let heading = from.theta + scan.bearing_rad(beam);
                let along = Point::new(libm::cos(heading), libm::sin(heading));
                let free_m = if range.is_finite() { range } else { range_m };
                let met = (0..200).map(|i| from.point() + along * (free_m * f64::from(i) / 200.0))
                    .find(|&point| gap_m(point) <= 0.0);
                prop_assert!(met.is_none() || range == 0.0, "{beam}: {range} {met:?}");
                if range.is_finite() {
                    let gap = gap_m(from.point() + along * range);
                    prop_assert!(gap < 1e-9, "{beam}: {range} {gap}");
                }
            }
        }
    }
}
