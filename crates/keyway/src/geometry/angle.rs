//! Angles in radians, counter-clockwise.

use std::f64::consts::{PI, TAU};

/// Wraps an angle to (-pi, pi] \[rad\].
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

/// Converts an angle to degrees for files and messages. Returns the shortest number that reads
/// back as the same radians, so that 30 degrees stay 30; if no number does, the nearest.
pub fn degrees(angle_rad: f64) -> f64 {
    let nearest = angle_rad.to_degrees();
    let short = (nearest * 1e9).round() / 1e9;
    [short, nearest, nearest.next_up(), nearest.next_down()]
        .into_iter()
        .find(|degrees| degrees.to_radians() == angle_rad)
        .unwrap_or(nearest)
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

    #[test]
    fn short_degrees_stay_short() {
        for tenth in -3600..=3600 {
            let angle_deg = f64::from(tenth) / 10.0;
            assert_eq!(degrees(angle_deg.to_radians()), angle_deg);
        }
        assert!(degrees(f64::NAN).is_nan() && degrees(f64::INFINITY) == f64::INFINITY);
    }

    proptest! {
        #[test]
        fn degrees_read_as_the_same_radians(angle_deg in -1e6..1e6f64) {
            let angle_rad = angle_deg.to_radians();
            prop_assert_eq!(degrees(angle_rad).to_radians(), angle_rad);
        }

        #[test]
        fn same_direction_within_range(angle in -1e4..1e4f64) {
            let wrapped = wrap_angle(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!((libm::sin(wrapped) - libm::sin(angle)).abs() < 1e-9);
            prop_assert!((libm::cos(wrapped) - libm::cos(angle)).abs() < 1e-9);
        }
    }
}
