//! Circular arcs, and their distances to points and axis-parallel squares.

use super::{Point, Square, wrap_angle};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The four directions in which a circle is parallel to an axis.
const AXES: [Point; 4] =
    [Point::new(1.0, 0.0), Point::new(0.0, 1.0), Point::new(-1.0, 0.0), Point::new(0.0, -1.0)];

/// A circular arc of up to a full turn; a single point if radius or sweep is 0.
///
/// ```
/// use keyway::geometry::{Arc, Point};
/// use std::f64::consts::FRAC_PI_2;
/// // A left turn by 90 degrees: from (1, 0), heading up, to (0, 1), heading left.
/// let turn = Arc::new(Point::new(0.0, 0.0), 1.0, 0.0, FRAC_PI_2);
/// assert!(turn.end().distance(Point::new(0.0, 1.0)) < 1e-15);
/// assert_eq!(turn.heading_at(0.0), FRAC_PI_2);
/// assert_eq!(turn.curvature(), 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arc {
    /// Centre of the circle.
    pub centre: Point,
    /// Radius, not negative.
    pub radius: f64,
    /// Direction from the centre to the first point \[rad\].
    pub start_rad: f64,
    /// Angle from the first to the last point, seen from the centre \[rad\]: positive
    /// counter-clockwise, at most a full turn.
    pub sweep_rad: f64,
}

impl Arc {
    /// The arc that begins in direction `start_rad` from the centre and covers `sweep_rad`.
    pub const fn new(centre: Point, radius: f64, start_rad: f64, sweep_rad: f64) -> Self {
        Self { centre, radius, start_rad, sweep_rad }
    }

    /// Length.
    pub fn length(&self) -> f64 {
        self.radius * self.sweep_rad.abs()
    }

    /// The point at a `fraction` of the length (0 the first, 1 the last).
    pub fn at(&self, fraction: f64) -> Point {
        let (sin, cos) = libm::sincos(self.start_rad + self.sweep_rad * fraction);
        self.centre + Point::new(cos, sin) * self.radius
    }

    /// First point.
    pub fn start(&self) -> Point {
        self.at(0.0)
    }

    /// Last point.
    pub fn end(&self) -> Point {
        self.at(1.0)
    }

    /// Direction of travel at a `fraction` of the length, in (-pi, pi] \[rad\].
    pub fn heading_at(&self, fraction: f64) -> f64 {
        let radial = self.start_rad + self.sweep_rad * fraction;
        wrap_angle(radial + FRAC_PI_2.copysign(self.sweep_rad))
    }

    /// Curvature, positive to the left; infinite for a radius of 0.
    pub fn curvature(&self) -> f64 {
        (1.0 / self.radius).copysign(self.sweep_rad)
    }

    /// The part between two fractions of the length.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let start_rad = self.start_rad + self.sweep_rad * from;
        Self { start_rad, sweep_rad: self.sweep_rad * (to - from), ..*self }
    }

    /// The same arc in the opposite direction of travel.
    #[must_use]
    pub fn reversed(&self) -> Self {
        self.part(1.0, 0.0)
    }

    /// Largest distance from the arc to its chord; at least the radius from half a turn on.
    pub(crate) fn sagitta(&self) -> f64 {
        self.radius * (1.0 - libm::cos(0.5 * self.sweep_rad))
    }

    /// True if the arc has a point in this direction from the centre.
    pub fn covers(&self, direction: Point) -> bool {
        let ahead = (direction.heading() - self.start_rad) * 1f64.copysign(self.sweep_rad);
        ahead - TAU * (ahead / TAU).floor() <= self.sweep_rad.abs()
    }

    /// The ends, and the points at which the arc is parallel to an axis; its smallest and largest
    /// x and y are among them.
    pub(crate) fn extremes(&self) -> impl Iterator<Item = Point> {
        let arc = *self;
        let axes = AXES.into_iter().filter(move |&axis| arc.covers(axis));
        [arc.start(), arc.end()].into_iter().chain(axes.map(move |a| arc.centre + a * arc.radius))
    }

    /// Distance from a point to the nearest point of the arc.
    pub(crate) fn distance_to_point(&self, point: Point) -> f64 {
        let from_centre = point - self.centre;
        if self.covers(from_centre) {
            return (from_centre.norm() - self.radius).abs();
        }
        point.distance(self.start()).min(point.distance(self.end()))
    }

    /// Distance to a square; 0 if the arc touches or enters it. Exact up to rounding, which is
    /// about 1e-15 of the radius and the coordinates.
    ///
    /// If the two do not meet, the nearest points are a corner of the square, or an end of the
    /// arc, or a point of the arc at which it is parallel to one of the square's edges.
    pub(crate) fn distance_to_square(&self, square: Square) -> f64 {
        if self.meets(square) {
            return 0.0;
        }
        let from_arc = self.extremes().map(|p| square.distance_sq_to_point(p));
        let from_corners = square.corners().map(|corner| self.distance_to_point(corner));
        from_corners.into_iter().fold(from_arc.fold(f64::INFINITY, f64::min).sqrt(), f64::min)
    }

    /// True if the arc touches or enters the closed square.
    pub(crate) fn meets(&self, square: Square) -> bool {
        let begins_inside = square.distance_sq_to_point(self.start()) == 0.0;
        begins_inside || self.crosses_border(square)
    }

    /// True if a point of the arc lies on the square's border.
    fn crosses_border(&self, square: Square) -> bool {
        let Point { x, y } = square.corner - self.centre;
        let on_edge = |along: f64, low: f64, point: &dyn Fn(f64, f64) -> Point| {
            let half_chord = (self.radius * self.radius - along * along).sqrt();
            [-half_chord, half_chord].into_iter().any(|across| {
                // NaN, if the circle does not reach the line of the edge, is not inside.
                across >= low && across <= low + 1.0 && self.covers(point(along, across))
            })
        };
        [x, x + 1.0]
            .into_iter()
            .any(|edge| on_edge(edge, y, &|along, across| Point::new(along, across)))
            || [y, y + 1.0]
                .into_iter()
                .any(|edge| on_edge(edge, x, &|along, across| Point::new(across, along)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_4, PI};

    const UNIT: Square = Square { corner: Point::new(0.0, 0.0) };

    fn arc(centre: [f64; 2], radius: f64, start_rad: f64, sweep_rad: f64) -> Arc {
        Arc::new(centre.into(), radius, start_rad, sweep_rad)
    }

    #[test]
    fn a_right_turn_by_hand() {
        // Around (2, 0), from (0, 0) heading up to (2, 2) heading right: clockwise, length pi.
        let turn = arc([2.0, 0.0], 2.0, PI, -FRAC_PI_2);
        assert!(turn.start().norm() < 1e-15 && turn.end().distance(Point::new(2.0, 2.0)) < 1e-15);
        assert!((turn.heading_at(0.0) - FRAC_PI_2).abs() < 1e-15);
        assert!(turn.heading_at(1.0).abs() < 1e-15);
        assert_eq!((turn.length(), turn.curvature()), (PI, -0.5));
        assert!((turn.sagitta() - 2.0 * (1.0 - 0.5f64.sqrt())).abs() < 1e-15);
        let back = turn.reversed();
        assert!(back.start().distance(turn.end()) < 1e-15 && back.curvature() == 0.5);
        assert!((back.heading_at(0.0).abs() - PI).abs() < 1e-15);
        assert!(turn.part(0.0, 0.5).end().distance(turn.at(0.5)) < 1e-15);
    }

    #[test]
    fn what_is_nearest_by_hand() {
        // An edge: the whole circle around (3, 0.5) is nearest at (2, 0.5).
        assert_eq!(arc([3.0, 0.5], 1.0, 0.3, TAU).distance_to_square(UNIT), 1.0);
        // A corner, from outside: the circle around (4, 5) is 5 - 2 from (1, 1).
        assert_eq!(arc([4.0, 5.0], 2.0, 0.0, TAU).distance_to_square(UNIT), 3.0);
        // All corners, from inside: they are sqrt(1/2) from the centre.
        let around = arc([0.5, 0.5], 2.0, 0.0, TAU).distance_to_square(UNIT);
        assert!((around - (2.0 - 0.5f64.sqrt())).abs() < 1e-15);
        // An end: the far half of a circle around (3, 0.5) begins at (3, 1.5) and ends at (3,
        // -0.5).
        let far_half = arc([3.0, 0.5], 1.0, FRAC_PI_2, -PI).distance_to_square(UNIT);
        assert!((far_half - 4.25f64.sqrt()).abs() < 1e-12, "from (3, 1.5) to (1, 1)");
        // Inside, through, and a touch at (1, 0.5).
        assert_eq!(arc([0.5, 0.5], 0.1, 0.0, 1.0).distance_to_square(UNIT), 0.0);
        assert_eq!(arc([1.0, 1.0], 0.5, 0.0, TAU).distance_to_square(UNIT), 0.0);
        assert_eq!(arc([2.0, 0.5], 1.0, PI - 0.1, 0.2).distance_to_square(UNIT), 0.0);
        assert_eq!(arc([4.0, 5.0], 0.0, 0.0, 1.0).distance_to_square(UNIT), 5.0, "a point");
    }

    #[test]
    fn covered_directions() {
        let last_quarter = arc([0.0, 0.0], 1.0, -FRAC_PI_2, FRAC_PI_2);
        assert!(last_quarter.covers(Point::new(1.0, -1.0)) && !last_quarter.covers(AXES[1]));
        let past_pi = arc([0.0, 0.0], 1.0, 3.0 * FRAC_PI_4, FRAC_PI_2);
        assert!(past_pi.covers(AXES[2]) && past_pi.covers(Point::new(-1.0, -0.9)));
        assert!(!past_pi.covers(Point::new(-1.0, 1.1)));
        assert_eq!(past_pi.extremes().count(), 3);
    }

    proptest! {
        #[test]
        fn agrees_with_dense_sampling(x in -3.0..4.0f64, y in -3.0..4.0f64, radius in 0.0..4.0f64,
                                      start in -7.0..7.0f64, sweep in -TAU..TAU) {
            let arc = arc([x, y], radius, start, sweep);
            let steps = 2000;
            let sampled = (0..=steps)
                .map(|i| UNIT.distance_sq_to_point(arc.at(f64::from(i) / f64::from(steps))))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            let exact = arc.distance_to_square(UNIT);
            prop_assert!(exact <= sampled + 1e-12, "{exact} > {sampled}");
            prop_assert!(sampled - exact <= 0.5 * arc.length() / f64::from(steps) + 1e-12, "{exact} << {sampled}");
            prop_assert!((arc.reversed().distance_to_square(UNIT) - exact).abs() < 1e-12);
        }

        #[test]
        fn points_agree_with_dense_sampling(x in -3.0..3.0f64, y in -3.0..3.0f64, radius in 0.0..4.0f64,
                                            start in -7.0..7.0f64, sweep in -TAU..TAU) {
            let arc = arc([0.0, 0.0], radius, start, sweep);
            let point = Point::new(x, y);
            let sampled = (0..=2000).map(|i| arc.at(f64::from(i) / 2000.0).distance(point)).fold(f64::INFINITY, f64::min);
            let exact = arc.distance_to_point(point);
            prop_assert!(exact <= sampled + 1e-12 && sampled - exact <= arc.length() / 4000.0 + 1e-12);
        }
    }
}
