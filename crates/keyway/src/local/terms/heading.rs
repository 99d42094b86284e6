//! heading(v, omega) of \[You2021, eq. (9)\]: the alignment of the robot with the guide point, at
//! a predicted pose.

use crate::geometry::{Point, Pose};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

pub(in crate::local) const NAME: &str = "heading";

/// Pi less the absolute bearing of the guide point \[rad\]; in the paper, the pose is that at the
/// end of the trajectory.
///
/// The function has no branches, so that the compiler vectorizes it over several poses.
pub(in crate::local) fn raw(judged: Pose, guide: Point) -> f64 {
    let bearing_rad = direction_rad(guide - judged.point()) - judged.theta;
    PI - (bearing_rad - TAU * rounded(bearing_rad * (1.0 / TAU))).abs()
}

/// The nearest integer, for numbers below 2^51: next to a number this large, fractions are
/// rounded away.
fn rounded(number: f64) -> f64 {
    const LARGE: f64 = 6_755_399_441_055_744.0;
    number + LARGE - LARGE
}

/// The tangent of an eighth of half a turn.
const TAN_PI_8: f64 = 0.414_213_562_373_095;

/// Coefficients of (t - atan(t)) / t³ in t², for t up to 7/16, from FreeBSD's `s_atan.c`.
const ARC_TANGENT: [f64; 11] = [
    3.333_333_333_333_293e-1,
    -1.999_999_999_987_648_3e-1,
    1.428_571_427_250_346_6e-1,
    -1.111_111_040_546_235_6e-1,
    9.090_887_133_436_507e-2,
    -7.691_876_205_044_83e-2,
    6.661_073_137_387_531e-2,
    -5.833_570_133_790_573_5e-2,
    4.976_877_994_615_932_4e-2,
    -3.653_157_274_421_691_6e-2,
    1.628_582_011_536_578_2e-2,
];

/// The polynomial with these coefficients, split into even and odd powers, so that two sums are
/// computed at a time.
fn series(number: f64) -> f64 {
    let [a, b, c, d, e, f, g, h, i, j, k] = ARC_TANGENT;
    let square = number * number;
    let even = ((((k * square + i) * square + g) * square + e) * square + c) * square + a;
    let odd = (((j * square + h) * square + f) * square + d) * square + b;
    even + number * odd
}

/// The direction of a vector \[rad\], [`Point::heading`] up to rounding.
fn direction_rad(Point { x, y }: Point) -> f64 {
    let (ahead, aside) = (x.abs(), y.abs());
    let is_steep = ahead < aside;
    let (less, more) = if is_steep { (ahead, aside) } else { (aside, ahead) };
    // Around an eighth of a turn the tangent is taken from there.
    let is_oblique = less > TAN_PI_8 * more;
    let offset = if is_oblique { FRAC_PI_4 } else { 0.0 };
    let opposite = less - if is_oblique { more } else { 0.0 };
    let adjacent = more + if is_oblique { less } else { 0.0 };
    // The direction of a zero vector is 0.
    let tangent = opposite / if adjacent > 0.0 { adjacent } else { 1.0 };
    let squared = tangent * tangent;
    let acute = offset + (tangent - tangent * squared * series(squared));
    let from_axis = if is_steep { FRAC_PI_2 - acute } else { acute };
    let unsigned = if x < 0.0 { PI - from_axis } else { from_axis };
    unsigned.copysign(y)
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

    #[test]
    fn directions_are_those_of_the_library() {
        let is_same = |x: f64, y: f64| {
            let (direction, expected) = (direction_rad(Point::new(x, y)), libm::atan2(y, x));
            let error = (direction - expected).abs();
            assert!(
                error <= 4.0 * f64::EPSILON * expected.abs(),
                "{x} {y}: {direction} {expected}"
            );
        };
        for degree in 0..3600 {
            let (sin, cos) = libm::sincos(f64::from(degree) * 0.1_f64.to_radians());
            is_same(3.0 * cos, 3.0 * sin);
            is_same(1e-200 * cos, 1e-200 * sin);
        }
        for (x, y) in
            [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, -2.0), (1.0, 1.0), (-1e300, 1e-300)]
        {
            is_same(x, y);
        }
    }
}
