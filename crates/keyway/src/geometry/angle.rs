//! Angles in radians, counter-clockwise.

use std::f64::consts::{PI, TAU};

/// The same direction in (-pi, pi] \[rad\].
///
/// ```
/// use keyway::geometry::wrap_angle;
/// use std::f64::consts::PI;
/// assert_eq!(wrap_angle(-PI), PI);
/// assert!((wrap_angle(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-12);
/// ```
pub fn wrap_angle(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let turned = angle_rad - TAU * (angle_rad / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn keeps_what_is_inside() {
        for angle in [0.0, 1.0, -3.0, PI] {
            assert_eq!(wrap_angle(angle), angle);
        }
        assert_eq!(wrap_angle(-PI), PI);
        assert_eq!(wrap_angle(3.0 * PI), PI);
    }

    proptest! {
        #[test]
        fn same_direction_within_range(angle in -1e4..1e4f64) {
            let wrapped = wrap_angle(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!((libm::sin(wrapped) - libm::sin(angle)).abs() < 1e-9);
            prop_assert!((libm::cos(wrapped) - libm::cos(angle)).abs() < 1e-9);
        }
    }
}
