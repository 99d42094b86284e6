//! The shadow of a box with a rounded surrounding, as an eye sees it.

use super::stretches::{Span, Stretches};
use crate::geometry::Point;

/// What lies behind a convex shape for an eye: in the wedge of the two tangents, beyond the connection of
/// the points where they touch. That connection lies in the shape, and every straight way from the eye to
/// what is hidden crosses it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shadow {
    /// Half-planes that have all of it in common: a normal, and how far along it they begin.
    half_planes: [(Point, f64); 3],
}

impl Shadow {
    /// Everywhere: what an eye within the shape sees.
    const ALL: Self = Self { half_planes: [(Point::new(0.0, 0.0), 0.0); 3] };

    /// The shadow of all that is no farther from a box than a radius \[cells\].
    pub(super) fn of_box(span: Span, radius: f64, eye: Point) -> Self {
        let radius_sq = radius * radius;
        if span.distance_sq_to_point(eye) <= radius_sq {
            return Self::ALL;
        }
        let tangents = span.corners().map(|corner| {
            let to = corner - eye;
            let (length_sq, aside) = (to.norm_sq(), Point::new(-to.y, to.x) * radius);
            // Up to where the tangent touches the circle around the corner.
            let ahead = (length_sq - radius_sq).max(0.0).sqrt();
            let share = ahead / length_sq;
            [(to * ahead + aside) * share, (to * ahead - aside) * share]
        });
        // All of the shape is seen within half a turn.
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

    /// Whether all of a box is hidden.
    pub(super) fn hides(&self, places: Span) -> bool {
        let Span { low, high } = places;
        self.half_planes.iter().all(|&(normal, begin)| {
            let least =
                |normal: f64, low: f64, high: f64| normal * if normal > 0.0 { low } else { high };
            least(normal.x, low.x, high.x) + least(normal.y, low.y, high.y) >= begin
        })
    }

    /// The first hidden one of the points of a straight stretch of a line; the last one is hidden.
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
