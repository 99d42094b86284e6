//! Normally distributed deviations from random bits.

use super::{Kind, Source};
use keyway::random::Random;
use std::f64::consts::TAU;

/// Largest deviation after clipping, in standard deviations.
const LARGEST: f64 = 3.0;

/// Independent deviations with mean 0 and standard deviation 1.
///
/// # Source
/// \[Box1958\], equation 1: for two uniform numbers u and w above 0 and up to 1, sqrt(-2 ln u)
/// cos(2 pi w) and sqrt(-2 ln u) sin(2 pi w) are independent and normal.
#[derive(Clone, Debug)]
pub(super) struct Gaussian {
    random: Random,
    /// Unused second deviation of a pair.
    spare: Option<f64>,
}

impl Gaussian {
    pub(super) fn new(source: Source, kind: Kind) -> Self {
        Self { random: source.stream(kind), spare: None }
    }

    /// Returns the next deviation.
    pub(super) fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.random.part())).sqrt();
        let (sin, cos) = libm::sincos(TAU * self.random.part());
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// Returns the next deviation, clipped to three standard deviations.
    pub(super) fn next_cut(&mut self) -> f64 {
        cut(self.next())
    }
}

/// Clips a deviation to three standard deviations.
pub(super) const fn cut(deviation: f64) -> f64 {
    deviation.clamp(-LARGEST, LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaussian(seed: u64) -> Gaussian {
        Gaussian::new(Source { seed, robot: 0, sensor: 0 }, Kind::Range)
    }

    /// Compares the shares of deviations up to a few values with the normal distribution.
    #[test]
    fn deviations_are_normal() {
        let mut gaussian = gaussian(1);
        let all: Vec<f64> = (0..100_000).map(|_| gaussian.next()).collect();
        for (value, expected) in
            [(-3.0, 0.001_35), (-2.0, 0.022_75), (-1.0, 0.158_66), (0.0, 0.5), (0.5, 0.691_46)]
        {
            let share = all.iter().filter(|&&deviation| deviation <= value).count() as f64 / 1e5;
            // Four standard deviations of a share.
            let tolerance = 4.0 * f64::sqrt(expected * (1.0 - expected) / 1e5);
            assert!((share - expected).abs() < tolerance, "{value}: {share}");
        }
        assert!(all.iter().any(|deviation| deviation.abs() > 4.0));
        // Neighbours are independent, within one pair and across two.
        let products = all.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / 1e5;
        assert!(products.abs() < 4.0 / f64::sqrt(1e5), "{products}");
    }

    #[test]
    fn cut_deviations_are_a_little_narrower() {
        let mut gaussian = gaussian(2);
        let all: Vec<f64> = (0..200_000).map(|_| gaussian.next_cut()).collect();
        let mean = all.iter().sum::<f64>() / 2e5;
        let variance = all.iter().map(|deviation| deviation * deviation).sum::<f64>() / 2e5;
        assert!(mean.abs() < 4.0 / f64::sqrt(2e5), "{mean}");
        // Clipping reduces the variance to 0.9950, a standard deviation of 0.9975. Its standard
        // error is 0.0032.
        assert!((variance - 0.9950).abs() < 4.0 * 0.0032, "{variance}");
        let largest = all.iter().copied().fold(0.0, f64::max);
        let smallest = all.iter().copied().fold(0.0, f64::min);
        assert_eq!((largest, smallest), (3.0, -3.0));
    }
}
