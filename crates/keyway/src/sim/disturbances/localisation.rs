//! Where a robot takes itself to be.

use super::gaussian::{Gaussian, cut};
use super::{Kind, LocalisationNoise, Source};
use crate::geometry::{Pose, Velocity};

/// The errors of a robot's localisation and odometry.
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
    /// `None` for a robot that knows all exactly.
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

    /// What the controller is told in the next cycle, for what is true.
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

/// An error with mean 0 and standard deviation 1 that drifts: a stationary Gauss-Markov process in time steps.
///
/// e' = q e + sqrt(1 - q²) n with a normal n and the correlation q of two errors one step apart. Then the variance
/// stays q² + (1 - q²) = 1, and errors k steps apart have the correlation q^k.
#[derive(Clone, Debug)]
struct Drift {
    gaussian: Gaussian,
    /// The correlation of two errors one cycle apart.
    kept: f64,
    error: Option<f64>,
}

impl Drift {
    fn new(source: Source, kind: Kind, cycle_s: f64, correlation_s: f64) -> Self {
        let kept = libm::exp(-cycle_s / correlation_s);
        Self { gaussian: Gaussian::new(source, kind), kept, error: None }
    }

    /// The next error, cut. The process itself is not, so cutting leaves the correlation as it is.
    fn next(&mut self) -> f64 {
        let fresh = self.gaussian.next();
        let kept = self.kept;
        let error =
            self.error.map_or(fresh, |error| kept * error + (1.0 - kept * kept).sqrt() * fresh);
        self.error = Some(error);
        cut(error)
    }
}
