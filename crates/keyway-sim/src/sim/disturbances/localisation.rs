//! Pose and velocity that a robot is told.

use super::gaussian::{Gaussian, cut};
use super::{Kind, LocalisationNoise, Source};
use keyway::geometry::{Pose, Velocity};

/// Errors of a robot's localisation and odometry.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Localisation {
    noise: LocalisationNoise,
    x: Drift,
    y: Drift,
    heading: Drift,
    v: Gaussian,
    omega: Gaussian,
}

impl Localisation {
    /// Returns the errors, or `None` for a robot that knows its state exactly.
    pub(in crate::sim) fn new(
        noise: LocalisationNoise,
        source: Source,
        cycle_s: f64,
    ) -> Option<Self> {
        let drift = |kind| Drift::new(source, kind, cycle_s, noise.correlation_s);
        let localisation = Self {
            noise,
            x: drift(Kind::X),
            y: drift(Kind::Y),
            heading: drift(Kind::Heading),
            v: Gaussian::new(source, Kind::ToldV),
            omega: Gaussian::new(source, Kind::ToldOmega),
        };
        (!noise.is_none()).then_some(localisation)
    }

    /// Pose and velocity that the controller is told in the next cycle, given the true ones.
    pub(in crate::sim) fn told(&mut self, pose: Pose, velocity: Velocity) -> (Pose, Velocity) {
        let LocalisationNoise { position_m, heading_rad, v_relative, omega_relative, .. } =
            self.noise;
        let told_pose = Pose::new(
            pose.x + position_m * self.x.next(),
            pose.y + position_m * self.y.next(),
            pose.theta + heading_rad * self.heading.next(),
        );
        let told_velocity = Velocity::new(
            velocity.v * (1.0 + v_relative * self.v.next_cut()),
            velocity.omega * (1.0 + omega_relative * self.omega.next_cut()),
        );
        (told_pose, told_velocity)
    }
}

/// A drifting error with mean 0 and standard deviation 1: a stationary Gauss-Markov process in
/// discrete time.
///
/// e' = q e + sqrt(1 - q²) n, where n is normal and q is the correlation of two errors one step
/// apart. The variance stays q² + (1 - q²) = 1, and errors k steps apart have the correlation q^k.
#[derive(Clone, Debug)]
struct Drift {
    gaussian: Gaussian,
    /// Correlation of two errors one cycle apart.
    kept: f64,
    error: Option<f64>,
}

impl Drift {
    fn new(source: Source, kind: Kind, cycle_s: f64, correlation_s: f64) -> Self {
        let kept = libm::exp(-cycle_s / correlation_s);
        Self { gaussian: Gaussian::new(source, kind), kept, error: None }
    }

    /// The next error, clipped. The process itself is not clipped, so its correlation does not
    /// change.
    fn next(&mut self) -> f64 {
        let fresh = self.gaussian.next();
        let kept = self.kept;
        let error =
            self.error.map_or(fresh, |error| kept * error + (1.0 - kept * kept).sqrt() * fresh);
        self.error = Some(error);
        cut(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: LocalisationNoise = LocalisationNoise {
        position_m: 0.0,
        heading_rad: 0.0,
        correlation_s: 0.0,
        v_relative: 0.0,
        omega_relative: 0.0,
    };

    fn localisation(noise: LocalisationNoise, robot: usize) -> Localisation {
        Localisation::new(noise, Source { seed: 6, robot }, 0.1).unwrap()
    }

    /// The errors of x, y and heading, in units of their standard deviations.
    fn errors(noise: LocalisationNoise, robot: usize, count: usize) -> Vec<[f64; 3]> {
        let mut localisation = localisation(noise, robot);
        let LocalisationNoise { position_m, heading_rad, .. } = noise;
        let mut next = || {
            let (Pose { x, y, theta }, _) =
                localisation.told(Pose::new(4.0, -2.0, 1.0), Velocity::ZERO);
            [(x - 4.0) / position_m, (y + 2.0) / position_m, (theta - 1.0) / heading_rad]
        };
        (0..count).map(|_| next()).collect()
    }

    fn mean(products: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = products.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
        sum / count
    }

    /// Checks mean, standard deviation and correlations of 100,000 errors that are drawn anew each
    /// time.
    #[test]
    fn errors_without_correlation_are_white() {
        let noise = LocalisationNoise { position_m: 0.05, heading_rad: 0.02, ..NONE };
        let all = errors(noise, 0, 100_000);
        // Four standard deviations of the mean of 100,000 errors.
        let tolerance = 4.0 / f64::sqrt(1e5);
        for part in 0..3 {
            assert!(mean(all.iter().map(|errors| errors[part])).abs() < tolerance);
            let variance = mean(all.iter().map(|errors| errors[part] * errors[part]));
            assert!((variance - 0.995).abs() < 2.0 * tolerance, "{variance}");
            assert!(all.iter().all(|errors| errors[part].abs() <= 3.0 + 1e-9));
            let next = mean(all.windows(2).map(|pair| pair[0][part] * pair[1][part]));
            assert!(next.abs() < tolerance, "{next}");
            let beside = mean(all.iter().map(|errors| errors[part] * errors[(part + 1) % 3]));
            assert!(beside.abs() < tolerance, "{beside}");
        }
    }

    /// Uses many robots, so that all means are of independent draws. From the first time on, the
    /// errors keep their standard deviation, and their correlation decays as defined.
    #[test]
    fn errors_drift_with_their_correlation_time() {
        const ROBOTS: usize = 20_000;
        let noise =
            LocalisationNoise { position_m: 0.05, heading_rad: 0.02, correlation_s: 0.5, ..NONE };
        let drifts: Vec<Vec<[f64; 3]>> =
            (0..ROBOTS).map(|robot| errors(noise, robot, 21)).collect();
        let tolerance = 4.0 / f64::sqrt(ROBOTS as f64);
        for part in 0..3 {
            for cycle in [0, 1, 5, 20] {
                let at = |drift: &Vec<[f64; 3]>| drift[cycle][part];
                let error = mean(drifts.iter().map(at));
                assert!(error.abs() < tolerance, "{cycle}: {error}");
                let variance = mean(drifts.iter().map(|drift| at(drift) * at(drift)));
                assert!((variance - 0.995).abs() < 1.5 * tolerance, "{cycle}: {variance}");
                let product = mean(drifts.iter().map(|drift| drift[0][part] * at(drift)));
                let expected = 0.995 * libm::exp(-0.1 * cycle as f64 / 0.5);
                assert!((product - expected).abs() < 1.5 * tolerance, "{cycle}: {product}");
            }
        }
    }

    #[test]
    fn velocities_are_off_by_a_share_of_themselves() {
        let mut localisation =
            localisation(LocalisationNoise { v_relative: 0.1, omega_relative: 0.2, ..NONE }, 0);
        let pose = Pose::new(4.0, -2.0, 1.0);
        let mut sums = [0.0; 4];
        for _ in 0..100_000 {
            let (told_pose, told) = localisation.told(pose, Velocity::new(0.5, -2.0));
            assert_eq!(told_pose, pose);
            let (v, omega) = (told.v / 0.5 - 1.0, told.omega / -2.0 - 1.0);
            assert!(v.abs() <= 0.3 + 1e-9 && omega.abs() <= 0.6 + 1e-9);
            for (sum, term) in sums.iter_mut().zip([v, v * v, omega * omega, v * omega]) {
                *sum += term / 1e5;
            }
        }
        // Four standard deviations of each mean.
        let [v, v_squared, omega_squared, product] = sums;
        assert!(v.abs() < 4.0 * 0.1 / f64::sqrt(1e5), "{v}");
        assert!((v_squared / 0.01 - 0.995).abs() < 4.0 * f64::sqrt(2e-5), "{v_squared}");
        assert!((omega_squared / 0.04 - 0.995).abs() < 4.0 * f64::sqrt(2e-5), "{omega_squared}");
        assert!(product.abs() < 4.0 * 0.02 / f64::sqrt(1e5), "{product}");
        // A standing robot is told that it stands.
        assert_eq!(localisation.told(pose, Velocity::ZERO), (pose, Velocity::ZERO));
    }
}
