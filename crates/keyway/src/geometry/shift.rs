//! Corrections of a robot's estimated pose.

use super::{Point, Pose, wrap_angle};

/// The rigid transform (translation and rotation) that takes one pose to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    from: Pose,
    to: Pose,
}

impl Shift {
    pub(crate) const fn new(from: Pose, to: Pose) -> Self {
        Self { from, to }
    }

    /// Transforms a point.
    pub(crate) fn point(&self, point: Point) -> Point {
        self.to.world_from_body(self.from.body_from_world(point))
    }

    /// Rotates a vector.
    pub(crate) fn vector(&self, vector: Point) -> Point {
        let (sin, cos) = libm::sincos(self.turn_rad());
        Point::new(vector.x * cos - vector.y * sin, vector.x * sin + vector.y * cos)
    }

    /// Transforms a pose.
    pub(crate) fn pose(&self, pose: Pose) -> Pose {
        let Point { x, y } = self.point(pose.point());
        Pose::new(x, y, pose.theta + self.turn_rad())
    }

    fn turn_rad(&self) -> f64 {
        wrap_angle(self.to.theta - self.from.theta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn all_keeps_its_place_beside_the_robot() {
        let shift = Shift::new(Pose::new(1.0, 2.0, 0.0), Pose::new(5.0, 5.0, FRAC_PI_2));
        // A point 1 m ahead stays 1 m ahead, and a motion to the left of the robot stays one to
        // its left.
        assert!(shift.point(Point::new(2.0, 2.0)).distance(Point::new(5.0, 6.0)) < 1e-12);
        assert!(shift.vector(Point::new(0.0, 1.0)).distance(Point::new(-1.0, 0.0)) < 1e-12);
        let pose = shift.pose(Pose::new(1.0, 3.0, 3.0));
        assert!(pose.point().distance(Point::new(4.0, 5.0)) < 1e-12);
        assert!((wrap_angle(pose.theta - 3.0 - FRAC_PI_2)).abs() < 1e-12);
    }
}
