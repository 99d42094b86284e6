//! Ranges to circles and polygons.

use super::beams::Beams;
use crate::sim::{ElusiveObstacle, ElusiveShape};
use keyway::geometry::{Disc, Point, Pose, Segment, outline};
use keyway::random::Random;
use keyway::robot::Footprint;

/// Ranges of all beams, reduced shape by shape.
pub(super) struct Shapes<'a> {
    pub(super) beams: &'a Beams,
    pub(super) from: Point,
    /// Heading of the sensor \[rad\].
    pub(super) theta: f64,
    pub(super) range_max_m: f64,
    pub(super) ranges_m: &'a mut [f64],
}

impl Shapes<'_> {
    pub(super) fn add_disc(&mut self, circle: &Disc) {
        if circle.distance(self.from) > self.range_max_m {
            return;
        }
        if outside(self.from, circle) <= 0.0 {
            return self.ranges_m.fill(0.0);
        }
        let from = self.from;
        self.lower_near(circle.centre, circle.radius_m, |direction| {
            range_to_disc(from, direction, circle)
        });
    }

    pub(super) fn add_footprint(&mut self, footprint: &Footprint, pose: Pose) {
        let polygon = match footprint {
            Footprint::Circle(disc) => {
                return self.add_disc(&Disc::new(pose.point(), disc.radius_m()));
            }
            Footprint::Polygon(polygon) => polygon,
        };
        let (core, _) = footprint.core();
        let apart_m = core.distance_to_m(pose, self.from);
        if apart_m <= 0.0 {
            return self.ranges_m.fill(0.0);
        }
        if apart_m > self.range_max_m {
            return;
        }
        let from = self.from;
        let placed = polygon.vertices().iter().map(|&vertex| pose.world_from_body(vertex));
        for edge in outline(placed) {
            // An edge lies within the circle around it.
            let (middle, half_m) = (edge.a.lerp(edge.b, 0.5), 0.5 * edge.length());
            self.lower_near(middle, half_m, |direction| range_to_edge(from, direction, &edge));
        }
    }

    /// Adds an obstacle that only some of the beams on it detect.
    pub(super) fn add_elusive(&mut self, elusive: &ElusiveObstacle, glimpses: &mut Random) {
        let seen = elusive.presence().seen;
        if seen == 0.0 {
            return;
        }
        let behind_m = (seen < 1.0).then(|| self.ranges_m.to_vec());
        match elusive.shape() {
            ElusiveShape::Disc(disc) => self.add_disc(disc),
            ElusiveShape::Polygon(polygon) => {
                let (footprint, at) = polygon.placed();
                self.add_footprint(footprint, at);
            }
        }
        for (range_m, behind_m) in self.ranges_m.iter_mut().zip(behind_m.into_iter().flatten()) {
            if *range_m < behind_m && !glimpses.is_chosen(seen) {
                *range_m = behind_m;
            }
        }
    }

    /// Reduces the ranges of all beams that may hit a shape within a radius around a position.
    fn lower_near(&mut self, centre: Point, radius_m: f64, range_m: impl Fn(Point) -> f64) {
        let to_centre = centre - self.from;
        let sin = radius_m / to_centre.norm();
        // From inside, the shape covers every bearing.
        let half_rad = if sin < 1.0 { libm::asin(sin) } else { std::f64::consts::PI };
        let bearing_rad = to_centre.heading() - self.theta;
        for (beam, direction) in self.beams.near(bearing_rad, half_rad, self.theta) {
            let known_m = &mut self.ranges_m[beam];
            *known_m = known_m.min(range_m(direction));
        }
    }
}

/// Squared distance from a point to a circle's centre minus the squared radius \[m²\]; not positive
/// inside.
pub(super) fn outside(from: Point, circle: &Disc) -> f64 {
    (circle.centre - from).norm_sq() - circle.radius_m * circle.radius_m
}

/// Distance along a beam to a circle \[m\]; infinity if the beam misses it.
pub(super) fn range_to_disc(from: Point, direction: Point, circle: &Disc) -> f64 {
    let to_centre = circle.centre - from;
    let outside = outside(from, circle);
    if outside <= 0.0 {
        return 0.0;
    }
    let ahead = to_centre.dot(direction);
    let aside = to_centre.cross(direction);
    let half_chord_sq = circle.radius_m * circle.radius_m - aside * aside;
    if ahead <= 0.0 || half_chord_sq < 0.0 {
        return f64::INFINITY;
    }
    // The smaller root as c / q avoids the cancellation of `ahead - half_chord` near the circle.
    outside / (ahead + half_chord_sq.sqrt())
}

/// Distance along a beam to an edge of a polygon \[m\]; infinity if the beam misses it. An edge
/// along the beam counts as missed, because its neighbours share its ends. The side of the beam
/// on which a vertex lies does not depend on the edge, so no beam slips through between two
/// edges.
pub(super) fn range_to_edge(from: Point, direction: Point, edge: &Segment) -> f64 {
    let (to_a, to_b) = (edge.a - from, edge.b - from);
    let (aside_a, aside_b) = (direction.cross(to_a), direction.cross(to_b));
    if aside_a == aside_b || aside_a.min(aside_b) > 0.0 || aside_a.max(aside_b) < 0.0 {
        return f64::INFINITY;
    }
    let ahead = direction.dot(to_a.lerp(to_b, aside_a / (aside_a - aside_b)));
    if ahead >= 0.0 { ahead } else { f64::INFINITY }
}
