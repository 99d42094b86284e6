//! The shadow that an inflated box casts for a viewpoint.

use super::stretches::{Span, Stretches};
use crate::geometry::Point;

/// The region behind a convex shape as seen from a viewpoint: the wedge between the two tangents,
/// beyond the segment that connects the tangent points. That segment lies in the shape, and every
/// line of sight to a hidden point crosses it.
#[derive(Clone, Copy, Debug)]
pub(super) struct HiddenRegion {
    /// Half-planes whose intersection is the region: a normal, and the offset along it.
    half_planes: [(Point, f64); 3],
}

impl HiddenRegion {
    /// The whole plane: the region for a viewpoint within the shape.
    const ALL: Self = Self { half_planes: [(Point::new(0.0, 0.0), 0.0); 3] };

    /// The shadow of all points within a radius of a box \[cells\].
    pub(super) fn of_box(span: Span, radius: f64, eye: Point) -> Self {
        let radius_sq = radius * radius;
        if span.distance_sq_to_point(eye) <= radius_sq {
            return Self::ALL;
        }
        let tangents = span.corners().map(|corner| {
            let to = corner - eye;
            let (length_sq, aside) = (to.norm_sq(), Point::new(-to.y, to.x) * radius);
            // Distance to the point at which the tangent touches the circle around the corner.
            let ahead = (length_sq - radius_sq).max(0.0).sqrt();
            let share = ahead / length_sq;
            [(to * ahead + aside) * share, (to * ahead - aside) * share]
        });
        // Seen from outside, the shape spans less than half a turn.
        let [mut left, mut right] = tangents[0];
        for [to_left, to_right] in &tangents[1..] {
            if left.cross(*to_left) > 0.0 {
                left = *to_left;
            }
            if right.cross(*to_right) < 0.0 {
                right = *to_right;
            }
        }
        let beyond = |way: Point, from: Point| {
            let normal = Point::new(-way.y, way.x);
            (normal, normal.dot(eye + from))
        };
        let begin = Point::default();
        Self {
            half_planes: [beyond(-left, begin), beyond(right, begin), beyond(right - left, left)],
        }
    }

    /// True if all of a box is hidden.
    pub(super) fn hides(&self, places: Span) -> bool {
        let Span { low, high } = places;
        self.half_planes.iter().all(|&(normal, begin)| {
            let least =
                |normal: f64, low: f64, high: f64| normal * if normal > 0.0 { low } else { high };
            least(normal.x, low.x, high.x) + least(normal.y, low.y, high.y) >= begin
        })
    }

    /// The first hidden point of those on a straight stretch of a line; the last one must be
    /// hidden.
    pub(super) fn first_hidden(&self, line: &Stretches<'_>, first: usize, last: usize) -> usize {
        let is_hidden = |at: usize| self.hides(Span::of_two(line.cell(at), line.cell(at)));
        if is_hidden(first) {
            return first;
        }
        let (mut seen, mut hidden) = (first, last);
        while hidden > seen + 1 {
            let middle = seen.midpoint(hidden);
            if is_hidden(middle) {
                hidden = middle;
            } else {
                seen = middle;
            }
        }
        hidden
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn behind_a_box_by_hand() {
        // From (0, 0) the box from (2, -1) to (3, 1) hides all between the rays through its
        // near corners, beyond x = 2.
        let shape = Span::of_two(Point::new(2.0, -1.0), Point::new(3.0, 1.0));
        let shadow = HiddenRegion::of_box(shape, 0.0, Point::default());
        let hides = |x: f64, y: f64| shadow.hides(Span::of_two(Point::new(x, y), Point::new(x, y)));
        assert!(hides(4.0, 1.9) && hides(4.0, -1.9) && hides(2.1, 0.0));
        assert!(!hides(4.0, 2.1) && !hides(4.0, -2.1) && !hides(1.9, 0.0) && !hides(-4.0, 0.0));
        let places = |top: f64| Span::of_two(Point::new(4.0, 0.0), Point::new(6.0, top));
        assert!(shadow.hides(places(1.9)) && !shadow.hides(places(2.1)));
        // For a viewpoint within the shape, everything is hidden.
        assert!(HiddenRegion::of_box(shape, 2.5, Point::default()).hides(places(9.0)));
    }

    proptest! {
        #[test]
        fn hidden_is_what_the_shape_stops(low in (-3.0..3.0f64, -3.0..3.0f64), size in (0.1..4.0f64, 0.1..4.0f64), radius in 0.0..2.0f64,
                                          eye in (-9.0..9.0f64, -9.0..9.0f64), place in (-9.0..9.0f64, -9.0..9.0f64),
                                          size_of_place in prop_oneof![Just(0.0), 0.0..3.0f64]) {
            let low = Point::new(low.0, low.1);
            let shape = Span::of_two(low, low + Point::new(size.0, size.1));
            let (eye, place) = (Point::new(eye.0, eye.1), Point::new(place.0, place.1));
            let places = Span::of_two(place, place + Point::new(size_of_place, size_of_place));
            let shadow = HiddenRegion::of_box(shape, radius, eye);
            let from_shape = |at: Point| shape.distance_sq_to_point(at).sqrt();
            // The distance of a connection, to 0.001.
            let nearest = |to: Point| (0..=20_000).map(|k| from_shape(eye.lerp(to, f64::from(k) / 2e4))).fold(f64::INFINITY, f64::min);
            if shadow.hides(places) {
                for corner in places.corners() {
                    prop_assert!(nearest(corner) <= radius + 1e-3);
                }
            } else if size_of_place == 0.0 && from_shape(place) > radius {
                prop_assert!(nearest(place) >= radius - 1e-9);
            }
        }
    }
}
