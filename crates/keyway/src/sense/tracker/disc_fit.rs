//! Fit of a disc to hits of a range sensor, which show only its near side.
//!
//! # Source
//! The circle through hits is the algebraic least-squares fit of \[Kasa1976\]: linear, without a
//! start value, and exact for hits without noise, for any visible arc.
//!
//! # Uncertainty
//! A hit in the direction e from the centre, off by d along it, moves the radius and the centre
//! by r and c with r + e c = d in the least-squares sense. Errors of variance v thus give the
//! centre the covariance v S⁻¹, where S is the sum of (e - mean e) (e - mean e)ᵀ over all hits.
//! This holds to first order, for errors that are small compared with the depth of the arc, which
//! is r (1 - cos a) for the half angle a. For larger errors, the fit underestimates the circle.

use crate::geometry::{Disc, Point};

/// A disc and the uncertainty of its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    pub(super) disc: Disc,
    /// Twice the standard deviation of the centre along its least certain axis \[m\], to first
    /// order in the errors of the hits; never less than the error of a single hit.
    pub(super) off_m: f64,
    /// True if the hits lie on an arc; otherwise the disc is the smallest one around their ends,
    /// and the occluded part of the object may be as large.
    pub(super) is_round: bool,
}

/// Smallest half angle of the visible arc that determines the radius \[rad\].
const LEAST_HALF_ARC_RAD: f64 = 0.5;

/// Fits a disc to successive hits, seen from `sensor`.
pub(super) fn fit(hits: &[Point], sensor: Point, noise_m: f64, largest_m: f64) -> Option<Fit> {
    let blob = around(hits, noise_m)?;
    let round = circle(hits).filter(|disc| (0.0..=0.5 * largest_m).contains(&disc.radius_m));
    let Some(disc) = round else { return Some(blob) };
    let off_arc = |hit: &Point| (hit.distance(disc.centre) - disc.radius_m).abs();
    let worst_m = hits.iter().map(off_arc).fold(0.0, f64::max);
    let middle =
        hits.iter().fold(Point::default(), |sum, &hit| sum + hit) * (1.0 / hits.len() as f64);
    let half_arc_rad = half_arc_rad(hits, disc.centre, middle - disc.centre);
    let is_beyond = disc.centre.distance(sensor) > middle.distance(sensor);
    if worst_m > 2.0 * noise_m || half_arc_rad < LEAST_HALF_ARC_RAD || !is_beyond {
        return Some(blob);
    }
    let off_m = 2.0 * noise_m * DEVIATION / scatter(hits, disc.centre).sqrt();
    Some(Fit { disc, off_m: off_m.max(noise_m), is_round: true })
}

/// Standard deviation of an error that is uniform between -1 and 1.
const DEVIATION: f64 = 0.577_350_269_189_625_8;

/// Spread of the directions from a centre to the hits, along the axis on which they differ least:
/// the smaller eigenvalue of their scatter matrix.
fn scatter(hits: &[Point], centre: Point) -> f64 {
    let towards =
        |&hit: &Point| (hit - centre) * hit.distance(centre).max(f64::MIN_POSITIVE).recip();
    let sum = hits.iter().map(towards).fold(Point::default(), |sum, towards| sum + towards);
    let mean = sum * (1.0 / hits.len() as f64);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for off in hits.iter().map(|hit| towards(hit) - mean) {
        xx += off.x * off.x;
        xy += off.x * off.y;
        yy += off.y * off.y;
    }
    let apart = xx - yy;
    let larger = 0.5 * (xx + yy + (apart * apart + 4.0 * xy * xy).sqrt());
    // The product of the eigenvalues is the determinant.
    (xx * yy - xy * xy).max(0.0) / larger
}

/// Fits a disc of known radius to hits, given an expected centre: Gauss-Newton steps on the sum
/// of the squared distances to the circle and, with `weight`, the squared distance to the
/// expected centre.
pub(super) fn fit_of_radius(hits: &[Point], expected: Disc, weight: f64) -> Disc {
    const STEPS: u32 = 4;
    let mut centre = expected.centre;
    for _ in 0..STEPS {
        let prior = (expected.centre - centre) * weight;
        let (mut xx, mut xy, mut yy) = (weight, 0.0, weight);
        let mut right = prior;
        for &hit in hits {
            let apart = hit - centre;
            let apart_m = apart.norm();
            if apart_m <= 0.0 {
                continue;
            }
            let towards = apart * (1.0 / apart_m);
            xx += towards.x * towards.x;
            xy += towards.x * towards.y;
            yy += towards.y * towards.y;
            right = right + towards * (apart_m - expected.radius_m);
        }
        let determinant = xx * yy - xy * xy;
        if determinant <= 0.0 {
            break;
        }
        centre = centre
            + Point::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x)
                * (1.0 / determinant);
    }
    Disc { centre, ..expected }
}

/// The smallest disc around the midpoint of the first and the last hit that contains all hits.
fn around(hits: &[Point], noise_m: f64) -> Option<Fit> {
    let (&first, &last) = (hits.first()?, hits.last()?);
    let centre = first.lerp(last, 0.5);
    let radius_m = hits.iter().map(|hit| hit.distance(centre)).fold(0.0, f64::max);
    let disc = Disc { centre, radius_m };
    Some(Fit { disc, off_m: radius_m + noise_m, is_round: false })
}

/// The least-squares circle through three or more hits.
fn circle(hits: &[Point]) -> Option<Disc> {
    if hits.len() < 3 {
        return None;
    }
    let share = 1.0 / hits.len() as f64;
    let mean = hits.iter().fold(Point::default(), |sum, &hit| sum + hit) * share;
    let (mut uu, mut uv, mut vv, mut u, mut v) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &hit in hits {
        let off = hit - mean;
        let square = off.norm_sq();
        uu += off.x * off.x;
        uv += off.x * off.y;
        vv += off.y * off.y;
        u += 0.5 * off.x * square;
        v += 0.5 * off.y * square;
    }
    let determinant = uu * vv - uv * uv;
    if determinant <= 1e-9 * (uu + vv) * (uu + vv) {
        return None;
    }
    let off = Point::new(vv * u - uv * v, uu * v - uv * u) * (1.0 / determinant);
    let radius_m = (off.norm_sq() + (uu + vv) * share).sqrt();
    Some(Disc { centre: mean + off, radius_m })
}

/// Half of the arc that the hits cover, around the direction to their mean \[rad\].
fn half_arc_rad(hits: &[Point], centre: Point, middle: Point) -> f64 {
    let angle_rad = |hit: &Point| {
        let off = *hit - centre;
        libm::atan2(middle.cross(off), middle.dot(off))
    };
    let ends = hits.first().into_iter().chain(hits.last()).map(angle_rad);
    let (low, high) = ends.fold((0.0f64, 0.0f64), |(low, high), at| (low.min(at), high.max(at)));
    0.5 * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use proptest::prelude::*;

    /// Hits on the side of a disc that faces a sensor at the origin, between two shares of its
    /// half arc.
    fn seen(disc: Disc, from: f64, to: f64, count: usize) -> Vec<Point> {
        let towards = (-disc.centre).heading();
        let half_rad = libm::acos(disc.radius_m / disc.centre.norm());
        (0..count)
            .map(|i| {
                let share = from + (to - from) * i as f64 / (count - 1) as f64;
                let (sin, cos) = libm::sincos(towards + half_rad * share);
                disc.centre + Point::new(cos, sin) * disc.radius_m
            })
            .collect()
    }

    #[test]
    fn what_is_no_arc_is_a_blob() {
        let wall: Vec<Point> = (0..9).map(|i| Point::new(2.0, f64::from(i) * 0.05)).collect();
        let blob = fit(&wall, Point::default(), 0.02, 1.2).unwrap();
        assert!(!blob.is_round && (blob.disc.radius_m - 0.2).abs() < 1e-12);
        assert!((blob.off_m - 0.22).abs() < 1e-12);
        let one = fit(&wall[..1], Point::default(), 0.02, 1.2).unwrap();
        assert_eq!((one.disc.radius_m, one.off_m), (0.0, 0.02));
        assert_eq!(fit(&[], Point::default(), 0.02, 1.2), None);
        // The corner of a room opens towards the sensor.
        let inside = seen(Disc { centre: Point::new(2.0, 0.0), radius_m: 0.3 }, -0.9, 0.9, 9);
        assert!(!fit(&inside, Point::new(5.0, 0.0), 0.02, 1.2).unwrap().is_round);
    }

    /// Compared with errors drawn repeatedly; the axis from the centre to the middle of the arc
    /// is the least certain one.
    #[test]
    fn the_deviation_of_the_centre_is_that_of_many_draws() {
        const DRAWS: u32 = 4000;
        let mut random = Random::new(5);
        for (to, count, noise_m) in
            [(0.7, 5, 0.001), (0.7, 12, 0.001), (1.0, 9, 0.002), (1.9, 17, 0.005)]
        {
            let disc = Disc { centre: Point::new(2.5, 1.0), radius_m: 0.3 };
            let exact = seen(disc, 0.9 - to, 0.9, count);
            let told_m = 2.0 * noise_m * DEVIATION / scatter(&exact, disc.centre).sqrt();
            let mean =
                exact.iter().fold(Point::default(), |sum, &hit| sum + hit) * (1.0 / count as f64);
            let axis = (mean - disc.centre) * mean.distance(disc.centre).recip();
            let mut sum_sq = 0.0;
            for _ in 0..DRAWS {
                let noisy = |&hit: &Point| {
                    let off = noise_m * (2.0 * random.unit() - 1.0);
                    hit + (hit - disc.centre) * (off / disc.radius_m)
                };
                let noisy: Vec<Point> = exact.iter().map(noisy).collect();
                sum_sq += (circle(&noisy).unwrap().centre - disc.centre).dot(axis).powi(2);
            }
            let drawn_m = 2.0 * (sum_sq / f64::from(DRAWS)).sqrt();
            assert!((told_m / drawn_m - 1.0).abs() < 0.06, "{to} {count}: {told_m} {drawn_m}");
            let fitted = fit(&exact, Point::default(), noise_m, 1.2).unwrap();
            assert!(fitted.is_round && (fitted.off_m / told_m - 1.0).abs() < 1e-6, "{fitted:?}");
        }
    }

    proptest! {
        /// For any visible part of a disc, the fit is that disc. With errors that are small
        /// compared with the depth of the arc, its error is about what it reports.
        #[test]
        fn the_disc_behind_an_arc(x in 1.0..4.0f64, y in -2.0..2.0f64, radius_m in 0.05..0.5f64,
                                  from in -0.98..0.1f64, part in 0.4..0.85f64, count in 5usize..20,
                                  small in 0.001..0.1f64, noise in prop::collection::vec(-1.0..1.0f64, 20)) {
            let disc = Disc { centre: Point::new(x, y), radius_m };
            let exact = seen(disc, from, from + part, count);
            let half_rad = 0.5 * part * libm::acos(radius_m / disc.centre.norm());
            prop_assume!(half_rad > LEAST_HALF_ARC_RAD + 1e-6);
            let fitted = fit(&exact, Point::default(), 0.001, 1.2).unwrap();
            prop_assert!(fitted.is_round && fitted.disc.centre.distance(disc.centre) < 1e-6, "{fitted:?}");
            let noise_m = small * radius_m * (1.0 - libm::cos(half_rad));
            let noisy: Vec<Point> = exact.iter().zip(&noise).map(|(&hit, &off)| hit + hit * (noise_m * off / hit.norm())).collect();
            let fitted = fit(&noisy, Point::default(), noise_m, 1.2).unwrap();
            let off_m = fitted.disc.centre.distance(disc.centre);
            prop_assert!(!fitted.is_round || off_m <= 3.0 * fitted.off_m, "{off_m} {fitted:?}");
        }

        /// With a known radius, a part of the arc and a rough guess are enough.
        #[test]
        fn a_known_radius(x in 1.0..4.0f64, y in -2.0..2.0f64, radius_m in 0.1..0.5f64, off in (-0.1..0.1f64, -0.1..0.1f64)) {
            let disc = Disc { centre: Point::new(x, y), radius_m };
            let guess = Disc { centre: disc.centre + Point::new(off.0, off.1) * radius_m, radius_m };
            let fitted = fit_of_radius(&seen(disc, -0.5, 0.3, 6), guess, 1e-6);
            prop_assert!(fitted.centre.distance(disc.centre) < 1e-3, "{fitted:?}");
        }
    }
}
