//! A corner of a line -> two cubic curves that round it with continuous curvature, in closed form.
//!
//! The curves begin on either edge at the distance `cut` from the corner and meet on its bisector,
//! each the mirror image of the other. The control points of each curve lie on its edge at the
//! fractions 1, (b + c) and c of the cut from the corner, and the last one midway between its c
//! point and that of the other edge, with a : b : c = 130 : 221 : 289.
//!
//! With half the turn β and w = 1 - u, the first curve's curvature is
//!
//! κ(u) = 2/3 c sin β cos β u (a w + b u) / (((a w + 2 b u) w)² + 2 c q u² (a w + 2 b u) w + c² q
//! u⁴)^(3/2) / cut, q = cos² β:
//!
//! It is 0 at the edge (u = 0), because three control points are collinear, and 2/3 (b / c²) sin β
//! / (q cut) at the joint (u = 1), the same for both curves by symmetry. There its derivative is 0
//! if 6 b² = 4 b c + a c, which holds. In between it is monotonic: the derivative's sign is that
//! of w times a polynomial of degree 4 in u, linear in q, whose Bernstein coefficients are
//! positive for q = 0 and for q = 1 (a test computes them in integers), hence for every corner. So
//! the peak is at the joint.
//!
//! # Source
//! \[Yang2010\]: two mirrored cubic spirals per corner, after D. J. Walton and D. S. Meek.
//!
//! | paper | here |
//! |---|---|
//! | γ = 2 β, the turn | twice the angle of `sin_half`, `cos_half` |
//! | d, the cut | `cut_m` |
//! | g, h, k | `A`, `B`, `C cos β` times the cut |
//! | κ max | [`Corner::peak_curvature`] |
//!
//! # Where this differs from the paper
//! - The proportions g : h : k / cos β. The paper's follow from a number that is rounded to
//!   7.2364, at the edge of those with monotonic curvature: the largest curvature may be a little
//!   before the joint. The fractions here are inside that edge, so that the bound holds as it is
//!   written; it is 0.6 % larger.

use crate::geometry::{Cubic, Point};

/// Share of the cut from its beginning to the second control point.
const A: f64 = 130.0 / 640.0;
/// Share from the second control point to the third.
const B: f64 = 221.0 / 640.0;
/// Share from the third control point to the corner.
const C: f64 = 289.0 / 640.0;

/// The line counts as reversing if the cosine of half the turn is less than this (a turn of more
/// than 178.8 degrees).
const REVERSAL_COSINE: f64 = 0.01;

/// A corner of a line, and the curves that round it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Position \[m\].
    pub(super) at: Point,
    /// Unit vectors from the corner back along the line and onward along it.
    back: Point,
    ahead: Point,
    /// Sine and cosine of half the turn.
    sin_half: f64,
    cos_half: f64,
}

impl Corner {
    /// The corner at the second of three points of a line, each different from the one before.
    pub(super) fn new([from, at, to]: [Point; 3]) -> Self {
        // Points that are so close that their distance rounds to 0 have no direction.
        let unit = |v: Point| if v.norm() > 0.0 { v * (1.0 / v.norm()) } else { Point::default() };
        let (back, ahead) = (unit(from - at), unit(to - at));
        let (sin_half, cos_half) = (0.5 * (back + ahead).norm(), 0.5 * (ahead - back).norm());
        Self { at, back, ahead, sin_half, cos_half }
    }

    /// True if the line turns back on itself.
    pub(super) fn is_reversal(&self) -> bool {
        self.cos_half < REVERSAL_COSINE
    }

    /// The points at which the curves of this cut leave and rejoin the line.
    pub(super) fn ends(&self, cut_m: f64) -> [Point; 2] {
        [self.at + self.back * cut_m, self.at + self.ahead * cut_m]
    }

    /// The two curves.
    pub(super) fn curves(&self, cut_m: f64) -> [Cubic; 2] {
        let half_bridge = (self.ahead - self.back) * (0.5 * C * cut_m);
        let middle = self.at + (self.back + self.ahead) * (0.5 * C * cut_m);
        let [into, out] =
            [-self.back, self.ahead].map(|way| [way * (A * cut_m), way * (B * cut_m)]);
        [
            Cubic { start: self.ends(cut_m)[0], legs: [into[0], into[1], half_bridge] },
            Cubic { start: middle, legs: [half_bridge, out[1], out[0]] },
        ]
    }

    /// The largest curvature of the curves \[1/m\], at the point where they meet.
    pub(super) fn peak_curvature(&self, cut_m: f64) -> f64 {
        2.0 * B * self.sin_half / (3.0 * C * C * self.cos_half * self.cos_half * cut_m)
    }

    /// The shortest cut whose curves are nowhere sharper than a circle of this radius.
    pub(super) fn cut_for_radius(&self, radius_m: f64) -> f64 {
        // Slightly more, so that rounding does not make them sharper.
        self.peak_curvature(1.0) * radius_m * (1.0 + 1e-12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corner(turn_rad: f64) -> Corner {
        let (sin, cos) = (libm::sin(turn_rad), libm::cos(turn_rad));
        Corner::new([Point::new(-3.0, 0.0), Point::new(0.0, 0.0), Point::new(2.0 * cos, 2.0 * sin)])
    }

    #[test]
    fn a_right_angle_by_hand() {
        // To the left in (0, 0), cut 640: control points at x = -640, -510, -289, then half-way
        // from (-289, 0) to (0, 289). Peak: 2/3 * 221/640 / (289/640)^2 * sqrt(1/2) / (1/2) / 640 =
        // 2 * 221 / (3 * 289^2) * sqrt(2) = 442 sqrt(2) / 250563.
        let corner = corner(std::f64::consts::FRAC_PI_2);
        let [first, second] = corner.curves(640.0);
        let near = |a: Point, x: f64, y: f64| assert!(a.distance(Point::new(x, y)) < 1e-9, "{a:?}");
        near(first.start, -640.0, 0.0);
        near(first.start + first.legs[0], -510.0, 0.0);
        near(first.start + first.legs[0] + first.legs[1], -289.0, 0.0);
        near(first.end(), -144.5, 144.5);
        near(second.start, -144.5, 144.5);
        near(second.end(), 0.0, 640.0);
        let peak = 442.0 * 2f64.sqrt() / 250_563.0;
        assert!((corner.peak_curvature(640.0) - peak).abs() < 1e-12);
        assert!((first.curvature_at(1.0) - peak).abs() < 1e-12);
        assert!((corner.cut_for_radius(1.0 / peak) - 640.0).abs() < 1e-6);
    }

    /// The table of `docs/smoothers.md`: cut and depth for a radius of 1 m, of a circle and of
    /// these curves.
    #[test]
    fn cuts_and_depths_for_a_radius_of_1_m() {
        let expected = [
            (30.0, [0.268, 0.035], [0.313, 0.037]),
            (60.0, [0.577, 0.155], [0.753, 0.170]),
            (90.0, [1.000, 0.414], [1.597, 0.510]),
            (150.0, [3.732, 2.864], [16.279, 7.101]),
        ];
        for (turn_deg, circle, here) in expected {
            let turn_rad = f64::to_radians(turn_deg);
            let corner = corner(turn_rad);
            let cut_m = corner.cut_for_radius(1.0);
            let depth_m = corner.curves(cut_m)[0].end().distance(corner.at);
            let half = 0.5 * turn_rad;
            let of_circle = [libm::tan(half), 1.0 / libm::cos(half) - 1.0];
            for (value, rounded) in
                [of_circle, [cut_m, depth_m]].iter().flatten().zip(circle.iter().chain(&here))
            {
                assert!(
                    (value - rounded).abs() < 6e-4,
                    "{turn_deg} degrees: {value}, not {rounded}"
                );
            }
        }
    }

    #[test]
    fn points_without_a_distance_have_no_direction() {
        let tiny = Corner::new([[0.0, 0.0], [1e-200, 0.0], [1e-200, 1e-200]].map(Point::from));
        assert!(tiny.is_reversal(), "nothing is rounded");
        assert_eq!(tiny.ends(1.0), [tiny.at; 2]);
    }

    /// Product of polynomials by their coefficients, lowest first.
    fn times(p: &[i128], q: &[i128]) -> Vec<i128> {
        let mut product = vec![0; p.len() + q.len() - 1];
        for (i, a) in p.iter().enumerate() {
            for (j, b) in q.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        product
    }

    fn slope(p: &[i128]) -> Vec<i128> {
        p.iter().enumerate().skip(1).map(|(i, a)| a * i as i128).collect()
    }

    /// The proof that the curvature is monotonic up to the joint, for every turn.
    #[test]
    fn the_peak_is_at_the_joint() {
        let (a, b, c) = (130_i128, 221, 289);
        for q in [0, 1] {
            // Curvature is n / s^(3/2): n = u (a w + b u), p = (a w + 2 b u) w = a + (2 b - 2 a) u
            // + (a - 2 b) u².
            let n = [0, a, b - a];
            let p = [a, 2 * b - 2 * a, a - 2 * b];
            let mut s = times(&p, &p);
            for (i, k) in p.iter().enumerate() {
                s[i + 2] += 2 * c * q * k;
            }
            s[4] += c * c * q;
            // The derivative has the sign of 2 n' s - 3 n s'.
            let (rise, fall) = (times(&slope(&n), &s), times(&n, &slope(&s)));
            let f: Vec<i128> = rise.iter().zip(&fall).map(|(r, f)| 2 * r - 3 * f).collect();
            assert_eq!(f.iter().sum::<i128>(), 0, "no slope at the joint");
            // Divided by w = 1 - u: the sums of the first coefficients.
            let g: Vec<i128> = f
                .iter()
                .scan(0, |sum, k| {
                    *sum += k;
                    Some(*sum)
                })
                .take(5)
                .collect();
            // Bernstein coefficients of degree 4, times 12: row i holds 12 binomial(i, j) /
            // binomial(4, j).
            let rows: [[i128; 5]; 5] =
                [[12, 0, 0, 0, 0], [12, 3, 0, 0, 0], [12, 6, 2, 0, 0], [12, 9, 6, 3, 0], [12; 5]];
            for row in rows {
                let coefficient: i128 = row.iter().zip(&g).map(|(r, k)| r * k).sum();
                assert!(coefficient > 0, "{q}: {g:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn curvature_is_continuous_and_bounded(turn in 1e-4..3.1f64, cut_m in 0.01..5.0f64) {
            let corner = corner(turn);
            let [first, second] = corner.curves(cut_m);
            prop_assert!(first.end().distance(second.start) < 1e-12);
            prop_assert!(first.derivative(1.0).distance(second.derivative(0.0)) < 1e-12);
            let peak = corner.peak_curvature(cut_m);
            prop_assert!((first.curvature_at(1.0) / peak - 1.0).abs() < 1e-9);
            prop_assert!((second.curvature_at(0.0) / peak - 1.0).abs() < 1e-9);
            prop_assert_eq!((first.curvature_at(0.0), second.curvature_at(1.0)), (0.0, 0.0));
            for curve in [first, second] {
                for k in 0..=500 {
                    let curvature = curve.curvature_at(f64::from(k) / 500.0);
                    prop_assert!(curvature >= 0.0 && curvature <= peak * (1.0 + 1e-9));
                }
            }
            prop_assert!(first.length() + second.length() < 2.0 * cut_m);
            prop_assert!(corner.peak_curvature(corner.cut_for_radius(0.7)) <= 1.0 / 0.7);
        }
    }
}
