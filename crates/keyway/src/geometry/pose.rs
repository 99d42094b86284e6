//! Poses and body velocities.

use super::{Point, wrap_angle};
use serde::{Deserialize, Serialize};

/// Position \[m\] and heading \[rad, (-pi, pi\]\] in the world frame (ROS REP 103).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Right \[m\].
    pub x: f64,
    /// Up \[m\].
    pub y: f64,
    /// Heading, counter-clockwise from the x axis \[rad\].
    pub theta: f64,
}

impl Pose {
    /// The pose (x, y, theta); the heading is wrapped into (-pi, pi].
    pub fn new(x: f64, y: f64, theta: f64) -> Self {
        Self { x, y, theta: wrap_angle(theta) }
    }

    /// The position alone.
    pub const fn point(&self) -> Point {
        Point::new(self.x, self.y)
    }

    /// Transforms a pose from this pose's own frame (x ahead, y left) to the world frame.
    #[must_use]
    pub fn compose(&self, body: Self) -> Self {
        let Point { x, y } = self.world_from_body(body.point());
        Self::new(x, y, self.theta + body.theta)
    }

    /// Transforms a point from this pose's own frame (x ahead, y left) to the world frame.
    pub fn world_from_body(&self, body: Point) -> Point {
        let (sin, cos) = libm::sincos(self.theta);
        Point::new(self.x + cos * body.x - sin * body.y, self.y + sin * body.x + cos * body.y)
    }

    /// Transforms a world point to this pose's own frame \[m\].
    pub fn body_from_world(&self, world: Point) -> Point {
        let off = world - self.point();
        let (sin, cos) = libm::sincos(self.theta);
        Point::new(off.x * cos + off.y * sin, off.y * cos - off.x * sin)
    }

    /// Bearing of a world point from this pose: 0 straight ahead, positive to the left \[rad,
    /// (-pi, pi\]\].
    pub fn bearing_to(&self, target: Point) -> f64 {
        wrap_angle((target - self.point()).heading() - self.theta)
    }

    /// The pose after driving with a constant velocity for `duration_s`: an exact circular arc (a
    /// straight line for omega = 0).
    #[must_use]
    pub fn after_arc(&self, velocity: Velocity, duration_s: f64) -> Self {
        let turned = velocity.omega * duration_s;
        // The chord of the arc: length s sinc(turned / 2), with a direction half-way between the
        // two headings.
        let half = 0.5 * turned;
        let sinc = if half.abs() < 1e-6 { 1.0 - half * half / 6.0 } else { libm::sin(half) / half };
        let chord = velocity.v * duration_s * sinc;
        let (sin, cos) = libm::sincos(self.theta + half);
        Self::new(self.x + chord * cos, self.y + chord * sin, self.theta + turned)
    }

    /// The pose after driving for `duration_s` while the velocity changes linearly from `from` to
    /// `to`. The motion has no closed form; it is composed of [`Self::RAMP_ARCS`] arcs at their
    /// mean velocities.
    #[must_use]
    pub fn after_ramp(&self, from: Velocity, to: Velocity, duration_s: f64) -> Self {
        let arc_s = duration_s / f64::from(Self::RAMP_ARCS);
        let arcs = Self::ramp_arcs(from, to);
        arcs.fold(*self, |pose, velocity| pose.after_arc(velocity, arc_s))
    }

    /// The velocities of the arcs that approximate a linear change; all have the same duration.
    pub(crate) fn ramp_arcs(from: Velocity, to: Velocity) -> impl Iterator<Item = Velocity> {
        let count = f64::from(Self::RAMP_ARCS);
        (0..Self::RAMP_ARCS).map(move |i| from.lerp(to, (f64::from(i) + 0.5) / count))
    }

    /// Number of arcs that approximate a linear change of velocity: the position is then accurate
    /// to ten micrometres for a cycle of 0.1 s.
    pub const RAMP_ARCS: u32 = 4;
}

/// Body velocity of a wheeled robot. Created by [`Self::new`]; a drive that moves sideways will
/// add a component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Velocity {
    /// Forward speed \[m/s\].
    pub v: f64,
    /// Turn rate, counter-clockwise \[rad/s\].
    pub omega: f64,
}

impl Velocity {
    /// Zero velocity.
    pub const ZERO: Self = Self { v: 0.0, omega: 0.0 };

    /// Creates a velocity from forward speed \[m/s\] and turn rate \[rad/s\].
    pub const fn new(v: f64, omega: f64) -> Self {
        Self { v, omega }
    }

    /// Linear interpolation to `other` (`fraction` 0: this velocity, 1: the other).
    #[must_use]
    pub fn lerp(self, other: Self, fraction: f64) -> Self {
        Self::new(
            self.v + (other.v - self.v) * fraction,
            self.omega + (other.omega - self.omega) * fraction,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn quarter_circle() {
        let radius = 2.0;
        let end = Pose::default().after_arc(Velocity::new(radius * FRAC_PI_2, FRAC_PI_2), 1.0);
        assert!((end.x - radius).abs() < 1e-12 && (end.y - radius).abs() < 1e-12);
        assert!((end.theta - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn straight_line_and_turn_on_the_spot() {
        let start = Pose::new(1.0, 2.0, FRAC_PI_2);
        let ahead = start.after_arc(Velocity::new(0.5, 0.0), 2.0);
        assert!((ahead.x - 1.0).abs() < 1e-12 && (ahead.y - 3.0).abs() < 1e-12);
        let turned = start.after_arc(Velocity::new(0.0, 1.0), 0.5);
        assert_eq!((turned.x, turned.y), (1.0, 2.0));
        assert!((turned.theta - FRAC_PI_2 - 0.5).abs() < 1e-12);
    }

    #[test]
    fn ramp_agrees_with_a_fine_integration() {
        let (from, to) = (Velocity::new(0.5, -0.3), Velocity::new(0.45, 0.0));
        let start = Pose::new(1.0, 2.0, 0.7);
        let mut fine = start;
        for i in 0..10_000 {
            fine = fine.after_arc(from.lerp(to, (f64::from(i) + 0.5) / 1e4), 0.1 / 1e4);
        }
        let ramp = start.after_ramp(from, to, 0.1);
        assert!(ramp.point().distance(fine.point()) < 1e-5);
        assert!((ramp.theta - fine.theta).abs() < 1e-12);
    }

    #[test]
    fn bearing_is_positive_to_the_left() {
        let pose = Pose::new(1.0, 1.0, FRAC_PI_2);
        assert!((pose.bearing_to(Point::new(0.0, 1.0)) - FRAC_PI_2).abs() < 1e-12);
        assert!(pose.bearing_to(Point::new(1.0, 5.0)).abs() < 1e-12);
        let left = pose.world_from_body(Point::new(0.0, 1.0));
        assert!((left.x - 0.0).abs() < 1e-12 && (left.y - 1.0).abs() < 1e-12);
    }
}
