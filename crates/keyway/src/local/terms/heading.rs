//! heading(v, omega) of \[You2021, eq. (9)\]: how well the robot looks at the guide point, at a predicted pose.

use crate::geometry::{Point, Pose};
use std::f64::consts::PI;

pub(in crate::local) const NAME: &str = "heading";

/// Pi less the absolute bearing of the guide point \[rad\]; the pose is that at the end of the trajectory in the paper.
pub(in crate::local) fn raw(judged: Pose, guide: Point) -> f64 {
    PI - judged.bearing_to(guide).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_straight_at_the_guide_point() {
        let guide = Point::new(5.0, 15.0);
        assert!((raw(Pose::new(5.0, 10.0, PI / 2.0), guide) - PI).abs() < 1e-12);
        assert!((raw(Pose::new(5.0, 10.0, 0.0), guide) - PI / 2.0).abs() < 1e-12);
        assert!(raw(Pose::new(5.0, 10.0, -PI / 2.0), guide).abs() < 1e-12);
    }
}
