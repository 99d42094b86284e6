//! Chains of straight segments.

use super::{Point, Segment, wrap_angle};
use serde::{Deserialize, Serialize};

/// Angle \[rad\] below which a heading change is rounding, not a turn.
const COLLINEAR_TOLERANCE_RAD: f64 = 1e-9;

/// A chain of straight segments through its points \[m\]. May be empty or a single point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Polyline {
    points: Vec<Point>,
}

impl Polyline {
    /// The chain through the given points, in order.
    pub const fn new(points: Vec<Point>) -> Self {
        Self { points }
    }

    /// The points in order.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The segments in order; none for fewer than two points.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + Clone + '_ {
        self.points.windows(2).map(|pair| Segment::new(pair[0], pair[1]))
    }

    /// Sum of the segments' lengths \[m\].
    pub fn length_m(&self) -> f64 {
        self.segments().fold(0.0, |sum, s| sum + s.length())
    }

    /// The same line without repeated points and without points inside straight stretches. A
    /// reversal (a turn by pi) is a turn and stays.
    #[must_use]
    pub fn merged(&self) -> Self {
        let mut kept: Vec<Point> = Vec::with_capacity(self.points.len());
        for &point in &self.points {
            if kept.last() == Some(&point) {
                continue;
            }
            if let [.., before, last] = kept[..]
                && is_straight_on(last - before, point - last)
            {
                kept.pop();
            }
            kept.push(point);
        }
        Self::new(kept)
    }

    /// Heading changes at the interior points of the merged line, positive to the left \[rad\].
    pub fn turns_rad(&self) -> Vec<f64> {
        self.merged().points.windows(3).map(|p| turn_between(p[1] - p[0], p[2] - p[1])).collect()
    }

    /// Arc length of the point nearest to `position`, among those from arc length `from_m` on and
    /// at most `window_m` farther; `from_m` for a line without segments. With this window, a
    /// robot that follows a line never goes back along it, and does not jump where the line comes
    /// near itself.
    pub(crate) fn nearest_along(&self, position: Point, from_m: f64, window_m: f64) -> f64 {
        let (mut begin_m, mut best_m, mut best_sq) = (0.0, from_m, f64::INFINITY);
        for segment in self.segments() {
            let length_m = segment.length();
            let first = ((from_m - begin_m) / length_m).max(0.0);
            let last = ((from_m + window_m - begin_m) / length_m).min(1.0);
            if first <= last {
                let along = segment.b - segment.a;
                let nearest = (position - segment.a).dot(along) / along.norm_sq();
                let fraction = nearest.clamp(first, last);
                let distance_sq = (segment.a.lerp(segment.b, fraction) - position).norm_sq();
                if distance_sq < best_sq {
                    (best_m, best_sq) = (begin_m + fraction * length_m, distance_sq);
                }
            }
            begin_m += length_m;
            if begin_m > from_m + window_m {
                break;
            }
        }
        best_m
    }

    /// The point at arc length `s_m` from the beginning, clamped to the ends; `None` for an empty
    /// line.
    pub fn at_length(&self, s_m: f64) -> Option<Point> {
        let mut left = s_m.max(0.0);
        for segment in self.segments() {
            let length = segment.length();
            if left <= length && length > 0.0 {
                return Some(segment.a.lerp(segment.b, left / length));
            }
            left -= length;
        }
        self.points.last().copied()
    }
}

/// True if the heading changes by rounding only.
fn is_straight_on(before: Point, after: Point) -> bool {
    let (sine, limit) = (before.cross(after).abs(), COLLINEAR_TOLERANCE_RAD * before.dot(after));
    // Decides nearly all angles without trigonometry.
    if sine > 2.0 * limit {
        return false;
    }
    sine < 0.5 * limit || turn_between(before, after).abs() < COLLINEAR_TOLERANCE_RAD
}

/// The heading change from direction `before` to direction `after` \[rad\].
fn turn_between(before: Point, after: Point) -> f64 {
    wrap_angle(libm::atan2(before.cross(after), before.dot(after)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    fn line(points: &[[f64; 2]]) -> Polyline {
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    #[test]
    fn merges_collinear_and_repeated_points() {
        let merged = line(&[[0., 0.], [1., 1.], [1., 1.], [2., 2.], [3., 2.], [4., 2.]]).merged();
        assert_eq!(merged, line(&[[0., 0.], [2., 2.], [4., 2.]]));
        assert_eq!(line(&[[1., 1.], [1., 1.]]).merged(), line(&[[1., 1.]]));
        assert_eq!(line(&[]).merged(), line(&[]));
    }

    #[test]
    fn less_than_the_tolerance_is_straight_on() {
        for (turn_rad, is_straight) in [
            (0.0, true),
            (4e-10, true),
            (9.9e-10, true),
            (1.01e-9, false),
            (3e-9, false),
            (PI, false),
        ] {
            for turn_rad in [turn_rad, -turn_rad] {
                let (before, after) = (Point::new(3.0, 4.0), Point::new(0.3, 0.4));
                let (sin, cos) = (libm::sin(turn_rad), libm::cos(turn_rad));
                let after =
                    Point::new(cos * after.x - sin * after.y, sin * after.x + cos * after.y);
                assert_eq!(is_straight_on(before, after), is_straight, "{turn_rad}");
            }
        }
        assert!(
            is_straight_on(Point::new(1e-200, 0.0), Point::new(0.0, 1e-200)),
            "too short to tell"
        );
    }

    #[test]
    fn turns_by_hand() {
        let turns = line(&[[0., 0.], [1., 0.], [2., 0.], [2., 1.], [3., 2.]]).turns_rad();
        assert_eq!(turns.len(), 2);
        assert!((turns[0] - FRAC_PI_2).abs() < 1e-12 && (turns[1] + FRAC_PI_4).abs() < 1e-12);
        assert_eq!(line(&[[0., 0.], [1., 0.], [0., 0.]]).turns_rad(), vec![PI]);
    }

    #[test]
    fn arc_length_positions() {
        let path = line(&[[0., 0.], [3., 0.], [3., 4.]]);
        assert_eq!(path.length_m(), 7.0);
        assert_eq!(path.at_length(-1.0), Some(Point::new(0., 0.)));
        assert_eq!(path.at_length(5.0), Some(Point::new(3., 2.)));
        assert_eq!(path.at_length(99.0), Some(Point::new(3., 4.)));
        assert_eq!(line(&[]).at_length(1.0), None);
        assert!(line(&[[1., 1.]]).length_m().is_sign_positive(), "0, not -0");
    }

    proptest! {
        /// The projection is the nearest of many points of the window.
        #[test]
        fn nearest_along_is_the_nearest_of_the_window(points in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 2..6),
                at in (-2.0..2.0f64, -2.0..2.0f64), from in 0.0..4.0f64, window in 0.1..2.0f64) {
            let path = Polyline::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect());
            prop_assume!(from <= path.length_m());
            let at = Point::new(at.0, at.1);
            let covered = path.nearest_along(at, from, window);
            prop_assert!(covered >= from - 1e-9 && covered <= from + window + 1e-9);
            let distance = |s: f64| path.at_length(s).unwrap().distance(at);
            let sampled = (0..=400).map(|i| from + window * f64::from(i) / 400.0).map(distance).fold(f64::INFINITY, f64::min);
            prop_assert!(distance(covered) <= sampled + 1e-9, "{} at {covered}, {sampled}", distance(covered));
        }
    }
}
