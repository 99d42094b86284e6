//! Arc length of a cubic: Gaussian quadrature on parts whose error is certified to be small.
//!
//! The length of the part from u = m - h to m + h is h times the integral of |D(z)| over z = -1..1,
//! where the derivative D(z) = d0 + d1 z + d2 z² has vectors as coefficients.
//!
//! # Proof of the error bound
//! Read as complex numbers, |D(z)|² is D(z) times its conjugate. Neither has a zero in the region
//! |d1| |z| + |d2| |z|² < |d0|, that is, in a disc of some radius R around the middle. There
//! |D(z)| has an analytic continuation f with |f| <= |d0| + |d1| R + |d2| R² = 2 |d0|. If R > 1,
//! the disc contains the ellipse with foci -1, 1 and half-axes R and sqrt(R² - 1), for which
//! rho = R + sqrt(R² - 1). So the coefficients of f in Chebyshev polynomials are
//! `a_k` <= 2 (2 |d0|) rho^-k (Trefethen, Approximation Theory and Approximation Practice,
//! theorem 8.1). Gauss's formula with N points is exact up to degree 2 N - 1 and for odd degrees,
//! and its error for a Chebyshev polynomial is at most 2 + 2 / (k² - 1) < 2.5. Sum:
//!
//! error <= 2.5 (4 |d0|) (rho^-2N + rho^-(2N + 2) + ..) = 10 |d0| rho^-2N / (1 - rho^-2).
//!
//! Halving makes d1 and d2 smaller, so R grows, except next to a standstill of the curve (a cusp)
//! or a near-standstill (a sharp bend). There the length itself soon drops below the allowed
//! error.

use super::{Cubic, Point};

/// Number of halvings after which a part is accepted without a bound. The tolerance stops far
/// earlier, at 36 halvings or so; this ends the recursion for coordinates that are not finite.
const MAX_HALVINGS: u32 = 64;

/// Number of points of the formula.
const POINTS: i32 = 10;

/// Nodes z > 0 of Gauss's formula with ten points, and their weights.
const NODES: [(f64, f64); 5] = [
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
];

/// Length between two parameters, `from` the smaller, with an error of at most `tolerance` and
/// rounding.
pub(super) fn length_between(cubic: &Cubic, from: f64, to: f64, tolerance: f64) -> f64 {
    refined(cubic, from, to, tolerance, if tolerance.is_finite() { MAX_HALVINGS } else { 0 })
}

fn refined(cubic: &Cubic, from: f64, to: f64, tolerance: f64, halvings: u32) -> f64 {
    let part = Part::new(cubic, from, to);
    if halvings == 0 || part.largest_error() <= tolerance {
        return part.gauss_length();
    }
    let middle = 0.5 * (from + to);
    refined(cubic, from, middle, 0.5 * tolerance, halvings - 1)
        + refined(cubic, middle, to, 0.5 * tolerance, halvings - 1)
}

/// A part of a cubic: half its range of the parameter, and the derivative over z = -1..1.
struct Part {
    half: f64,
    d: [Point; 3],
}

impl Part {
    fn new(cubic: &Cubic, from: f64, to: f64) -> Self {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let [a, b, c] = cubic.legs;
        let third_derivative = (a - b - b + c) * 6.0;
        let d = [
            cubic.derivative(middle),
            cubic.second_derivative(middle) * half,
            third_derivative * (0.5 * half * half),
        ];
        Self { half, d }
    }

    /// A certified upper bound of the error of [`Self::gauss_length`].
    fn largest_error(&self) -> f64 {
        let [d0, d1, d2] = self.d.map(Point::norm);
        // Upper bound of both the length and the formula's result.
        let longest = 2.0 * self.half * (d0 + d1 + d2);
        // The radius at which d1 R + d2 R² = d0; infinite for a constant speed.
        let radius = 2.0 * d0 / (d1 + (d1 * d1 + 4.0 * d0 * d2).sqrt());
        if radius.is_nan() || radius <= 1.0 {
            return longest;
        }
        let rho_sq = (radius + (radius * radius - 1.0).sqrt()).powi(2);
        let error = self.half * 10.0 * d0 / (rho_sq.powi(POINTS) * (1.0 - 1.0 / rho_sq));
        error.min(longest)
    }

    fn gauss_length(&self) -> f64 {
        let [d0, d1, d2] = self.d;
        let pair = |(z, weight): (f64, f64)| {
            let (even, odd) = (d0 + d2 * (z * z), d1 * z);
            weight * ((even - odd).norm() + (even + odd).norm())
        };
        self.half * NODES.map(pair).iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The parabola (u, q (u - at)²) as a cubic: a bend that is sharper for larger q.
    fn parabola(at: f64, q: f64) -> Cubic {
        let [a, b, c] =
            [[0.0, q * at * at], [0.5, q * at * (at - 1.0)], [1.0, q * (1.0 - at) * (1.0 - at)]]
                .map(Point::from);
        // A Bézier curve of degree 2, raised to degree 3.
        let third = 1.0 / 3.0;
        Cubic::bezier([a, a.lerp(b, 2.0 * third), c.lerp(b, 2.0 * third), c])
    }

    /// Length of the parabola in closed form: with t = 2 q (u - at), the integral of sqrt(1 + t²)
    /// is (t sqrt(1 + t²) + asinh t) / 2.
    fn parabola_length(at: f64, q: f64) -> f64 {
        let integral = |t: f64| 0.5 * (t * t.hypot(1.0) + t.asinh());
        (integral(2.0 * q * (1.0 - at)) - integral(-2.0 * q * at)) / (2.0 * q)
    }

    /// Number of evaluations of the formula for a whole curve.
    fn parts(cubic: &Cubic, from: f64, to: f64, tolerance: f64) -> u32 {
        if Part::new(cubic, from, to).largest_error() <= tolerance {
            return 1;
        }
        let middle = 0.5 * (from + to);
        parts(cubic, from, middle, 0.5 * tolerance) + parts(cubic, middle, to, 0.5 * tolerance)
    }

    #[test]
    fn the_formula_is_exact_up_to_degree_19() {
        for degree in 0..20 {
            let even = |z: f64, weight: f64| weight * (z.powi(degree) + (-z).powi(degree));
            let sum: f64 = NODES.iter().map(|&(z, weight)| even(z, weight)).sum();
            let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
            assert!((sum - exact).abs() < 1e-15, "z^{degree}: {sum} for {exact}");
        }
    }

    #[test]
    fn cusps_need_few_parts() {
        // D = (u - r)² k: a standstill at r, on one line; and a true cusp, D = ((u - r)², u - r).
        for r in [0.0, 0.1, 1.0 / 3.0, 0.5, 0.7, 1.0] {
            let square = [r * r, r * r - r, (1.0 - r) * (1.0 - r)];
            let linear = [-r, 0.5 - r, 1.0 - r];
            let halting =
                Cubic { start: Point::default(), legs: square.map(|x| Point::new(x, 0.0)) };
            let exact = r * r * r + (1.0 - r).powi(3);
            assert!((halting.length() - exact).abs() < 1e-12, "{r}");
            let cusp = Cubic {
                start: Point::default(),
                legs: [0, 1, 2].map(|i| Point::new(square[i], linear[i])),
            };
            // 3 times the integral of |u - r| sqrt(1 + (u - r)²): (1 + t²)^(3/2) - 1 at both ends.
            let side = |t: f64| (1.0 + t * t).powf(1.5) - 1.0;
            let exact = side(r) + side(1.0 - r);
            assert!((cusp.length() - exact).abs() < 1e-11, "{r}: {} for {exact}", cusp.length());
            let parts = parts(&cusp, 0.0, 1.0, 1e-11 * cusp.polygon_length());
            assert!(parts <= 80, "{r}: {parts}");
        }
    }

    #[test]
    fn numbers_that_are_none_end_at_once() {
        for x in [f64::NAN, f64::INFINITY, 1e300, 1e-320] {
            let cubic = Cubic {
                start: Point::default(),
                legs: [Point::new(x, 1.0), Point::new(0.0, x), Point::new(x, x)],
            };
            let length = cubic.length();
            assert!(length.is_nan() || length >= 0.0, "{length}");
        }
    }

    proptest! {
        #[test]
        fn sharp_bends_have_the_length_of_the_closed_form(at in -0.2..1.2f64, exponent in -3.0..9.0f64) {
            let q = 10f64.powf(exponent);
            let cubic = parabola(at, q);
            let (length, exact) = (cubic.length(), parabola_length(at, q));
            let tolerance = 1e-10 * cubic.polygon_length();
            prop_assert!((length - exact).abs() <= tolerance, "{length} for {exact}");
            prop_assert!(parts(&cubic, 0.0, 1.0, 0.1 * tolerance) <= 80);
        }
    }
}
