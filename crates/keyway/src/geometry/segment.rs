//! Straight segments, and their distances to points and axis-parallel squares.

use super::Point;
use serde::{Deserialize, Serialize};

/// The straight line from `a` to `b`; a single point if they are equal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// First end.
    pub a: Point,
    /// Second end.
    pub b: Point,
}

/// An axis-parallel unit square, given by its lower-left corner: the shape of an obstacle cell in
/// grid coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Square {
    /// Lower-left corner.
    pub(crate) corner: Point,
}

/// The larger of two numbers, the second one if the first is NaN: one instruction, unlike
/// [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, the second one if the first is NaN.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Square {
    /// Squared distance from a point; 0 inside and on the border.
    pub(crate) fn distance_sq_to_point(self, point: Point) -> f64 {
        let beside = |low: f64, x: f64| larger(larger(low - x, x - low - 1.0), 0.0);
        let (dx, dy) = (beside(self.corner.x, point.x), beside(self.corner.y, point.y));
        dx * dx + dy * dy
    }

    /// The point of the square nearest to a point: the point itself if it lies inside.
    pub(crate) fn nearest_to(self, point: Point) -> Point {
        let Point { x, y } = self.corner;
        Point::new(point.x.clamp(x, x + 1.0), point.y.clamp(y, y + 1.0))
    }

    /// The four corners, counter-clockwise from the lower left.
    pub(crate) fn corners(self) -> [Point; 4] {
        let Point { x, y } = self.corner;
        [
            Point::new(x, y),
            Point::new(x + 1.0, y),
            Point::new(x + 1.0, y + 1.0),
            Point::new(x, y + 1.0),
        ]
    }
}

impl Segment {
    /// The segment from `a` to `b`.
    pub const fn new(a: Point, b: Point) -> Self {
        Self { a, b }
    }

    /// Length.
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }

    /// Fraction from `a` to `b` at which the segment is nearest to `point`.
    pub(crate) fn nearest_fraction(&self, point: Point) -> f64 {
        let along = self.b - self.a;
        let length_sq = along.norm_sq();
        if length_sq == 0.0 {
            return 0.0;
        }
        ((point - self.a).dot(along) / length_sq).clamp(0.0, 1.0)
    }

    /// Squared distance from a point to the nearest point of the segment.
    pub fn distance_sq_to_point(&self, point: Point) -> f64 {
        (self.a.lerp(self.b, self.nearest_fraction(point)) - point).norm_sq()
    }

    /// Squared distance to a square; 0 if the segment touches or enters it.
    ///
    /// Two convex shapes that do not meet are nearest at a corner of one of them. Among the
    /// square's corners this can only be the one nearest to the segment's line. Takes one division.
    pub(crate) fn distance_sq_to_square(&self, square: Square) -> f64 {
        let along = self.b - self.a;
        let low = square.corner - self.a;
        // Not computed from `low`, which may have been rounded.
        let high = square.corner + Point::new(1.0, 1.0) - self.a;
        let is_left = along.cross(low + Point::new(0.5, 0.5)) >= 0.0;
        let corner = Point::new(
            if (along.y > 0.0) == is_left { high.x } else { low.x },
            if (along.x > 0.0) == is_left { low.y } else { high.y },
        );
        // Distance of the corner from the line, times the segment's length; at most 0 if the line
        // meets the square.
        let off = if is_left { along.cross(corner) } else { -along.cross(corner) };
        let (ahead, length_sq) = (along.dot(corner), along.norm_sq());
        if off > 0.0 && ahead > 0.0 && ahead < length_sq {
            off * off / length_sq
        } else if off <= 0.0 && self.spans_meet(square) {
            0.0
        } else {
            smaller(square.distance_sq_to_point(self.a), square.distance_sq_to_point(self.b))
        }
    }

    /// True if the segment and the square have a column and a row in common.
    fn spans_meet(&self, square: Square) -> bool {
        let meet = |a: f64, b: f64, low: f64| a.max(b) >= low && a.min(b) <= low + 1.0;
        meet(self.a.x, self.b.x, square.corner.x) && meet(self.a.y, self.b.y, square.corner.y)
    }

    /// True if the segment touches or enters the closed square.
    pub(crate) fn meets(&self, square: Square) -> bool {
        self.inside_span(square).is_some_and(|(enter, leave)| enter <= leave)
    }

    /// True if the segment passes through the square's interior (touching its border is not
    /// enough).
    #[cfg(test)]
    pub(crate) fn crosses(&self, square: Square) -> bool {
        let inside = |p: Point| {
            p.x > square.corner.x
                && p.x < square.corner.x + 1.0
                && p.y > square.corner.y
                && p.y < square.corner.y + 1.0
        };
        match self.inside_span(square) {
            Some((enter, leave)) if enter <= leave => {
                inside(self.a.lerp(self.b, 0.5 * (enter + leave)))
            }
            _ => false,
        }
    }

    /// The interval of fractions inside the closed square (slab method); `None` if a slab is
    /// missed.
    fn inside_span(&self, square: Square) -> Option<(f64, f64)> {
        let along = self.b - self.a;
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (start, step, low) in
            [(self.a.x, along.x, square.corner.x), (self.a.y, along.y, square.corner.y)]
        {
            if step == 0.0 {
                if start < low || start > low + 1.0 {
                    return None;
                }
            } else {
                let (t0, t1) = ((low - start) / step, (low + 1.0 - start) / step);
                enter = enter.max(t0.min(t1));
                leave = leave.min(t0.max(t1));
            }
        }
        Some((enter, leave))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNIT: Square = Square { corner: Point::new(0.0, 0.0) };

    #[test]
    fn hand_worked_distances() {
        let away = Segment::new(Point::new(2.0, -1.0), Point::new(2.0, 3.0));
        assert_eq!(away.distance_sq_to_square(UNIT), 1.0);
        let through = Segment::new(Point::new(-1.0, 0.5), Point::new(2.0, 0.5));
        assert_eq!(through.distance_sq_to_square(UNIT), 0.0);
        // Past the corner (1, 1) on x + y = 3: distance 1 / sqrt(2).
        let past = Segment::new(Point::new(0.0, 3.0), Point::new(3.0, 0.0));
        assert!((past.distance_sq_to_square(UNIT) - 0.5).abs() < 1e-12);
        let point = Segment::new(Point::new(4.0, 5.0), Point::new(4.0, 5.0));
        assert_eq!(point.distance_sq_to_square(UNIT), 25.0);
        // Nearer to the edge x = 0 than the precision of a number near 1.
        let beside = Segment::new(Point::new(1e-16, -3.0), Point::new(1e-16, 3.0));
        let left = Square { corner: Point::new(-1.0, 0.0) };
        assert!(beside.distance_sq_to_square(left) <= 1e-31);
    }

    #[test]
    fn touching_is_meeting_but_not_crossing() {
        let corner = Segment::new(Point::new(0.0, 2.0), Point::new(2.0, 0.0));
        assert!(corner.meets(UNIT) && !corner.crosses(UNIT));
        let edge = Segment::new(Point::new(-1.0, 1.0), Point::new(2.0, 1.0));
        assert!(edge.meets(UNIT) && !edge.crosses(UNIT));
        let diagonal = Segment::new(Point::new(-1.0, -1.0), Point::new(2.0, 2.0));
        assert!(diagonal.crosses(UNIT));
    }

    proptest! {
        #[test]
        fn agrees_with_dense_sampling(ax in -3.0..4.0f64, ay in -3.0..4.0f64,
                                      bx in -3.0..4.0f64, by in -3.0..4.0f64) {
            let segment = Segment::new(Point::new(ax, ay), Point::new(bx, by));
            let sampled = (0..=2000)
                .map(|i| UNIT.distance_sq_to_point(segment.a.lerp(segment.b, f64::from(i) / 2000.0)))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            let exact = segment.distance_sq_to_square(UNIT).sqrt();
            prop_assert!(exact <= sampled + 1e-9 && sampled - exact <= segment.length() / 2000.0);
        }
    }
}
