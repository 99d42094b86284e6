//! Cubic curves: Bézier pieces, and the pieces of a uniform cubic B-spline.

use super::{Point, Segment};
use serde::{Deserialize, Serialize};

/// Relative accuracy of lengths, as a share of the control polygon's length: a tenth of the
/// promised one, so that sums and differences of several lengths keep the promise, too.
const LENGTH_TOLERANCE: f64 = 1e-11;

/// Sine of an angle below which two directions count as parallel; the rest is rounding.
const PARALLEL_TOLERANCE: f64 = 1e-12;

/// Number of halvings after which a curvature limit counts as not certified.
const CURVATURE_HALVINGS: u32 = 20;

/// Share of the control polygon below which a derivative counts as a standstill (a cusp, or an
/// end with repeated control points).
const STANDSTILL_TOLERANCE: f64 = 1e-9;

/// A cubic curve from u = 0 to u = 1, kept as its first point and the three legs of its Bézier
/// control polygon. It lies in the convex hull of that polygon's four corners.
///
/// Legs are stored rather than corners because repeated control points then leave legs of exactly
/// 0, and the headings at such ends are exact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cubic {
    /// The point at u = 0.
    pub start: Point,
    /// Vectors from each corner of the control polygon to the next.
    pub legs: [Point; 3],
}

impl Cubic {
    /// The Bézier curve with these control points: it begins at the first and ends at the last.
    pub fn bezier(control: [Point; 4]) -> Self {
        let [a, b, c, d] = control;
        Self { start: a, legs: [b - a, c - b, d - c] }
    }

    /// The piece of a uniform cubic B-spline that these four successive control points span: row
    /// vector (1, u, u², u³) times
    /// 1/6 \[\[1,4,1,0\],\[-3,0,3,0\],\[3,-6,3,0\],\[-1,3,-3,1\]\] times the control points.
    ///
    /// Pieces over successive windows of a sequence of control points join with equal position, and
    /// with equal first and second derivative.
    pub(crate) fn uniform_b_spline(control: [Point; 4]) -> Self {
        let [a, b, c, d] = control;
        let (ab, bc, cd) = (b - a, c - b, d - c);
        // (a + 4 b + c) / 6, as a step from b: exact where the three are equal.
        let start = b + (bc - ab) * (1.0 / 6.0);
        Self { start, legs: [(ab + bc) * (1.0 / 6.0), bc * (1.0 / 3.0), (bc + cd) * (1.0 / 6.0)] }
    }

    /// The point at parameter `u`.
    pub fn at(&self, u: f64) -> Point {
        self.split(u)[0].end()
    }

    /// Last point.
    pub fn end(&self) -> Point {
        let [a, b, c] = self.legs;
        self.start + (a + b + c)
    }

    /// First derivative with respect to `u`.
    pub fn derivative(&self, u: f64) -> Point {
        let [a, b, c] = self.legs;
        let w = 1.0 - u;
        (a * (w * w) + b * (2.0 * u * w) + c * (u * u)) * 3.0
    }

    /// Second derivative with respect to `u`.
    pub fn second_derivative(&self, u: f64) -> Point {
        let [a, b, c] = self.legs;
        (b - a).lerp(c - b, u) * 6.0
    }

    /// Direction of travel at `u`, in (-pi, pi] \[rad\]. At a standstill it is the direction of
    /// leaving (first half) or arriving (second half); 0 for a single point.
    pub fn heading_at(&self, u: f64) -> f64 {
        let [a, b, c] = self.legs;
        let standstill = STANDSTILL_TOLERANCE * self.polygon_length();
        let first = self.derivative(u);
        if first.norm() > standstill {
            return first.heading();
        }
        let second = self.second_derivative(u);
        if second.norm() > standstill {
            return (second * if u < 0.5 { 1.0 } else { -1.0 }).heading();
        }
        (a - b - b + c).heading()
    }

    /// Curvature at `u`, positive to the left; 0 at a standstill (the heading may jump there).
    pub fn curvature_at(&self, u: f64) -> f64 {
        let (first, second) = (self.derivative(u), self.second_derivative(u));
        let speed = first.norm();
        let cross = first.cross(second);
        if cross.abs() <= PARALLEL_TOLERANCE * speed * second.norm() {
            return 0.0;
        }
        cross / (speed * speed * speed)
    }

    /// True if the curvature exceeds `limit` nowhere, to either side; `true` is certain. Also
    /// false if it comes within a millionth of the limit, or if the curve has a standstill in a
    /// bend.
    pub(crate) fn is_curvature_at_most(&self, limit: f64) -> bool {
        self.is_certainly_within(limit, CURVATURE_HALVINGS)
    }

    /// The curvature is 2/3 (w² a×b + u w a×c + u² b×c) / |w² a + 2 u w b + u² c|³ for the legs a,
    /// b, c and w = 1 - u. Over the whole curve the numerator is at most its largest coefficient,
    /// and the denominator at least what the shortest leg reaches along the chord.
    fn is_certainly_within(&self, limit: f64, halvings: u32) -> bool {
        let [a, b, c] = self.legs;
        let cross = a.cross(b).abs().max(0.5 * a.cross(c).abs()).max(b.cross(c).abs());
        let chord = a + b + c;
        let along = |leg: Point| leg.dot(chord) / chord.norm();
        let slowest = along(a).min(along(b)).min(along(c));
        if slowest >= 0.0 && 2.0 * cross <= 3.0 * limit * slowest * slowest * slowest {
            return true;
        }
        let is_beyond = |u: f64| self.curvature_at(u).abs() > limit;
        if halvings == 0 || is_beyond(0.0) || is_beyond(1.0) {
            return false;
        }
        let [before, after] = self.split(0.5);
        before.is_certainly_within(limit, halvings - 1)
            && after.is_certainly_within(limit, halvings - 1)
    }

    /// The parts before and after `u`.
    pub fn split(&self, u: f64) -> [Self; 2] {
        // De Casteljau's construction, on the legs.
        let [a, b, c] = self.legs;
        let (ab, bc) = (a.lerp(b, u), b.lerp(c, u));
        let tangent = ab.lerp(bc, u);
        let before = Self { start: self.start, legs: [a * u, ab * u, tangent * u] };
        let w = 1.0 - u;
        let after = Self { start: before.end(), legs: [tangent * w, bc * w, c * w] };
        [before, after]
    }

    /// The straight line from the first to the last point.
    pub fn chord(&self) -> Segment {
        Segment::new(self.start, self.end())
    }

    /// Upper bound of the distance of any point of the curve from the chord, and of any point of
    /// the chord from the curve.
    ///
    /// The distance from a segment is a convex function, so over the hull of the control polygon
    /// it is largest at a corner. As a point moves along the curve, its nearest point on the
    /// chord passes over all of it.
    pub(crate) fn deviation(&self) -> f64 {
        let [a, b, c] = self.legs;
        let (second, chord) = (a + b, a + b + c);
        let length_sq = chord.norm_sq();
        // For a chord so short that the squares below underflow, the distance from the start is
        // enough.
        if length_sq < 1e-100 {
            return a.norm_sq().max(second.norm_sq()).sqrt();
        }
        // Squared distance from the chord, times its squared length: one division for both.
        let scaled_sq = |corner: Point| {
            let (ahead, off) = (chord.dot(corner), chord.cross(corner));
            if ahead <= 0.0 {
                corner.norm_sq() * length_sq
            } else if ahead >= length_sq {
                (corner - chord).norm_sq() * length_sq
            } else {
                off * off
            }
        };
        (scaled_sq(a).max(scaled_sq(second)) / length_sq).sqrt()
    }

    /// Length of the control polygon, an upper bound of the curve's length.
    pub fn polygon_length(&self) -> f64 {
        self.legs.iter().fold(0.0, |sum, leg| sum + leg.norm())
    }

    /// Length, with a certified error of at most 1e-10 of the control polygon's length, even for
    /// sharp bends (10 to 1,600 evaluations of the speed).
    pub fn length(&self) -> f64 {
        self.length_between(0.0, 1.0)
    }

    /// Length between two parameters, `from` the smaller; the error is that of [`Self::length`].
    pub(crate) fn length_between(&self, from: f64, to: f64) -> f64 {
        super::cubic_length::length_between(
            self,
            from,
            to,
            LENGTH_TOLERANCE * self.polygon_length(),
        )
    }

    /// The parameter at which the curve has reached `length`; 0 or 1 beyond the ends. Newton's
    /// method, bracketed by bisection.
    pub(crate) fn parameter_at(&self, length: f64) -> f64 {
        let polygon = self.polygon_length();
        let (mut low, mut high) = (0.0, 1.0);
        if length.is_nan() || length <= 0.0 || polygon == 0.0 {
            return low;
        }
        let mut u = (length / polygon).min(1.0);
        for _ in 0..64 {
            let excess = self.length_between(0.0, u) - length;
            if excess.abs() <= LENGTH_TOLERANCE * polygon || (u == 1.0 && excess < 0.0) {
                break;
            }
            if excess > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - excess / self.derivative(u).norm();
            u = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn points(control: [[f64; 2]; 4]) -> [Point; 4] {
        control.map(Point::from)
    }

    /// The curve from the matrix of the B-spline, coefficient by coefficient.
    fn by_matrix([a, b, c, d]: [Point; 4], u: f64) -> Point {
        (a + b * 4.0 + c) * (1.0 / 6.0)
            + (c - a) * (u * 3.0 / 6.0)
            + (a * 3.0 - b * 6.0 + c * 3.0) * (u * u / 6.0)
            + (b * 3.0 - a - c * 3.0 + d) * (u * u * u / 6.0)
    }

    /// Certified bounds: every chord is shorter than its part of the curve, every control polygon
    /// longer.
    fn length_bounds(cubic: &Cubic, halvings: u32) -> (f64, f64) {
        if halvings == 0 {
            return (cubic.chord().length(), cubic.polygon_length());
        }
        let [before, after] = cubic.split(0.5);
        let (a, b) = (length_bounds(&before, halvings - 1), length_bounds(&after, halvings - 1));
        (a.0 + b.0, a.1 + b.1)
    }

    #[test]
    fn a_corner_of_a_spline_by_hand() {
        // Control points (0, 0), (6, 0), (6, 6), (0, 6). At u = 0: position (30, 6) / 6, derivative
        // (c - a) / 2 = (3, 3), second a - 2 b + c = (-6, 6), curvature 36 / (3 sqrt(2))^3. At u =
        // 1/2, by symmetry, x = (0 + 23 * 6 + 23 * 6 + 0) / 48 = 5.75, y = 3, heading up.
        let cubic = Cubic::uniform_b_spline(points([[0., 0.], [6., 0.], [6., 6.], [0., 6.]]));
        assert!(cubic.start.distance(Point::new(5.0, 1.0)) < 1e-12);
        assert!(cubic.end().distance(Point::new(5.0, 5.0)) < 1e-12);
        assert!(cubic.derivative(0.0).distance(Point::new(3.0, 3.0)) < 1e-12);
        assert!(cubic.second_derivative(0.0).distance(Point::new(-6.0, 6.0)) < 1e-12);
        assert!((cubic.curvature_at(0.0) - 36.0 / (54.0 * 2f64.sqrt())).abs() < 1e-12);
        assert!(cubic.at(0.5).distance(Point::new(5.75, 3.0)) < 1e-12);
        assert!((cubic.heading_at(0.5) - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn three_equal_control_points_make_an_end() {
        let [p, q] = [Point::new(0.1, 0.2), Point::new(1.3, 1.1)];
        let begin = Cubic::uniform_b_spline([p, p, p, q]);
        let end = Cubic::uniform_b_spline([p, q, q, q]);
        assert!(begin.start == p && end.end().distance(q) < 1e-15);
        let heading = (q - p).heading();
        for u in [0.0, 1e-6, 0.3, 1.0 - 1e-6, 1.0] {
            for piece in [begin, end] {
                assert!((piece.heading_at(u) - heading).abs() < 1e-9, "{u}");
                assert_eq!(piece.curvature_at(u), 0.0, "{u}");
            }
        }
        // From p to (5 p + q) / 6: a sixth of the distance, 1.5 m long.
        assert!((begin.length() - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_curve_that_goes_back_on_itself() {
        // Over 0, 4, -1, 3: x' = 3 (4 w² - 10 u w + 4 u²) = 3 (4 - 18 u + 18 u²) is 0 at u = 1/3
        // and 2/3, where x is 5/3 and 4/3. So it goes 5/3 ahead, 1/3 back, 5/3 ahead.
        let cubic = Cubic::bezier(points([[0., 0.], [4., 0.], [-1., 0.], [3., 0.]]));
        assert!((cubic.length() - 11.0 / 3.0).abs() < 1e-9);
        assert_eq!(
            (cubic.heading_at(0.2), cubic.heading_at(0.5), cubic.heading_at(0.9)),
            (0.0, PI, 0.0)
        );
        // Over 0, 3, 0, 3: x' = 9 (w - u)², a standstill half-way, but no motion backwards.
        let halting = Cubic::bezier(points([[0., 0.], [3., 0.], [0., 0.], [3., 0.]]));
        assert!((halting.length() - 3.0).abs() < 1e-12 && halting.heading_at(0.5) == 0.0);
        let point = Cubic::bezier([Point::new(1.0, 1.0); 4]);
        assert_eq!(
            (point.length(), point.heading_at(0.3), point.curvature_at(0.3)),
            (0.0, 0.0, 0.0)
        );
        assert_eq!((point.parameter_at(1.0), point.deviation()), (0.0, 0.0));
        // A loop that almost closes.
        let legs = [[1.0, 2e-162], [0.2, 0.0], [-1.2, 0.0]].map(Point::from);
        let closed = Cubic { start: Point::new(0.0, 0.0), legs };
        assert!(closed.deviation() >= 1.2);
    }

    prop_compose! {
        fn control()(c in prop::array::uniform4(prop::array::uniform2(-5.0..5.0f64))) -> [Point; 4] {
            points(c)
        }
    }

    proptest! {
        #[test]
        fn follows_the_matrix(control in control(), u in 0.0..1.0f64) {
            let cubic = Cubic::uniform_b_spline(control);
            prop_assert!(cubic.at(u).distance(by_matrix(control, u)) < 1e-12);
            let step = 1e-5;
            let slope = (cubic.at(u + step) - cubic.at(u - step)) * (0.5 / step);
            prop_assert!(cubic.derivative(u).distance(slope) < 1e-6);
            let bend = (cubic.derivative(u + step) - cubic.derivative(u - step)) * (0.5 / step);
            prop_assert!(cubic.second_derivative(u).distance(bend) < 1e-6);
        }

        #[test]
        fn curvature_limits_agree_with_sampling(control in control(), limit in 0.01..20.0f64) {
            let cubic = Cubic::uniform_b_spline(control);
            let largest = (0..=2000).map(|i| cubic.curvature_at(f64::from(i) / 2000.0).abs()).fold(0.0, f64::max);
            let is_within = cubic.is_curvature_at_most(limit);
            prop_assert!(!is_within || largest <= limit, "certified, but {largest}");
            // Samples miss a peak by little unless it is sharp.
            prop_assert!(is_within || largest > 0.9 * limit || largest > 50.0 || limit > 5.0, "refused, {largest}");
            prop_assert!(largest > 50.0 || cubic.is_curvature_at_most(1.1 * largest + 1e-6), "{largest}");
        }

        #[test]
        fn successive_pieces_join_smoothly(control in control(), next in prop::array::uniform2(-5.0..5.0f64)) {
            let [_, b, c, d] = control;
            let one = Cubic::uniform_b_spline(control);
            let two = Cubic::uniform_b_spline([b, c, d, next.into()]);
            prop_assert!(one.end().distance(two.start) < 1e-12);
            prop_assert!(one.derivative(1.0).distance(two.derivative(0.0)) < 1e-12);
            prop_assert!(one.second_derivative(1.0).distance(two.second_derivative(0.0)) < 1e-12);
        }

        #[test]
        fn length_is_within_certified_bounds(control in control(), u in 0.0..1.0f64) {
            let cubic = Cubic::bezier(control);
            let (at_least, at_most) = length_bounds(&cubic, 10);
            let length = cubic.length();
            prop_assert!(length >= at_least - 1e-8 && length <= at_most + 1e-8);
            let parts = cubic.length_between(0.0, u) + cubic.length_between(u, 1.0);
            prop_assert!((parts - length).abs() < 1e-8);
            let reached = cubic.length_between(0.0, cubic.parameter_at(u * length));
            prop_assert!((reached - u * length).abs() < 1e-8);
        }

        #[test]
        fn chord_and_curve_are_nowhere_farther_apart_than_the_deviation(control in control(), u in 0.0..1.0f64) {
            let cubic = Cubic::bezier(control);
            let deviation = cubic.deviation() + 1e-12;
            prop_assert!(cubic.chord().distance_sq_to_point(cubic.at(u)).sqrt() <= deviation);
            let on_chord = cubic.chord().a.lerp(cubic.chord().b, u);
            let nearest = (0..=2000).map(|i| cubic.at(f64::from(i) / 2000.0).distance(on_chord)).fold(f64::INFINITY, f64::min);
            prop_assert!(nearest <= deviation + cubic.polygon_length() * 3.0 / 2000.0);
        }

        #[test]
        fn both_parts_are_the_curve(control in control(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
            let cubic = Cubic::bezier(control);
            let [before, after] = cubic.split(u);
            prop_assert!(before.at(v).distance(cubic.at(u * v)) < 1e-12);
            prop_assert!(after.at(v).distance(cubic.at(u + (1.0 - u) * v)) < 1e-12);
        }
    }
}
