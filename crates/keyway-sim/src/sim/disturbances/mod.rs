//! Disturbances of a simulated robot: an inexact sensor, late and inexact motors, and errors of its
//! localisation.
//!
//! Disturbances change only the controller's inputs and the action of the motors. Contact,
//! clearance, arrival and the record of a run ([`Run`](super::Run)) follow the true motion.
//!
//! Every kind of noise of every robot draws from its own stream, so a change of one kind leaves the
//! numbers of the others unchanged. Deviations are normal and clipped to three standard deviations.
//! No error is ever larger, and the actual standard deviation is 0.9975 times the requested one.

mod actuation;
mod gaussian;
mod localisation;
mod sensing;

pub(super) use actuation::Actuation;
pub(super) use localisation::Localisation;
pub(super) use sensing::Sensing;

use keyway::ConfigError;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Disturbances of a robot; by default none. Random numbers follow from `seed` and the robot's
/// place among the participants, so several robots with equal disturbances are disturbed
/// differently.
///
/// ```
/// use keyway_sim::sim::Disturbances;
///
/// let mut disturbances = Disturbances { seed: 7, ..Disturbances::default() };
/// assert!(disturbances.is_none());
/// disturbances.sensor.range_m = 0.01;
/// disturbances.actuation.delay_s = 0.1;
/// assert!(!disturbances.is_none());
/// disturbances.actuation.v_relative = 5.0;
/// let error = disturbances.validate().unwrap_err();
/// assert_eq!(error.to_string(), "actuation.v_relative must be a share from 0 to 0.3, got 5");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Disturbances {
    /// Seed of the random numbers: the same seed gives the same run.
    pub seed: u64,
    /// Errors of the sensor.
    pub sensor: SensorNoise,
    /// Errors of the motors.
    pub actuation: ActuationNoise,
    /// Errors of the robot's estimated pose and velocity.
    pub localisation: LocalisationNoise,
}

/// Errors of a range sensor.
///
/// The range r of a beam that hits something is measured as r + e. The standard deviation of e is
/// the root of `range_m`² + (`range_relative` r)², and e is drawn anew for every beam and scan. The
/// result stays between 0, which carries no information, and the sensor's range. A beam that hits
/// nothing reports this without error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of every range \[m\], from 0 to 100.
    pub range_m: f64,
    /// Standard deviation as a share of the range, from 0 to 0.3.
    pub range_relative: f64,
    /// Share of the beams that return nothing, from 0 to 1, chosen independently for every beam and
    /// scan. These beams are NaN, which carries no information: neither an obstacle nor free
    /// ground.
    pub dropped_beams: f64,
    /// Share of the scans that are lost, from 0 to 1, chosen independently. The controller is
    /// called in every cycle, as on a real robot. Without a scan of that cycle, it gets one in
    /// which every beam is NaN, and not an old one, which would show obstacles in wrong places.
    pub dropped_scans: f64,
}

/// Errors of the motors. The robot still keeps its limits of speed and acceleration, and stands
/// when commanded to stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ActuationNoise {
    /// Delay from a command to its effect that the robot does not know \[s\], from 0 to 10. It adds
    /// to the known delay ([`Robot::actuation_delay_s`](keyway::robot::Robot::actuation_delay_s)).
    /// A command given at the time t changes the velocity from t + `delay_s` on, for one cycle, as
    /// it would from t on without a delay. So the same commands drive the same velocities `delay_s`
    /// later, whether or not the delay is a whole number of cycles. Before the first command takes
    /// effect, the robot stands. A robot has arrived only when no command that moves it is pending.
    pub delay_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3. The robot obeys (1 + e)
    /// times the command within its limits; e is drawn anew in every cycle. The speed can fall
    /// below a limit but not exceed it. So a robot driven at a limit is slower on average, and
    /// brakes less hard on average when commanded to brake as hard as it can.
    pub v_relative: f64,
    /// Standard deviation of the turn rate as a share of it, from 0 to 0.3.
    pub omega_relative: f64,
}

/// Errors of a robot's estimated pose and velocity.
///
/// Errors of real localisation drift: they change slowly. Errors of position and heading are
/// stationary Gauss-Markov processes: two errors that are t apart have the correlation
/// exp(-t / `correlation_s`). The errors of x, y and heading are independent. The first pose
/// already has an error. Errors of the velocity are drawn anew in every cycle; a standing robot is
/// told that it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LocalisationNoise {
    /// Standard deviation of each coordinate of the position \[m\], from 0 to 100.
    pub position_m: f64,
    /// Standard deviation of the heading \[rad\], from 0 to pi.
    pub heading_rad: f64,
    /// Correlation time of the errors of position and heading \[s\], from 0 to 1000000. With 0 they
    /// are drawn anew in every cycle, so the robot seems to jump to and fro; a few seconds or more
    /// resemble a robot that matches scans with a map.
    pub correlation_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3.
    pub v_relative: f64,
    /// Standard deviation of the turn rate as a share of it, from 0 to 0.3.
    pub omega_relative: f64,
}

impl Disturbances {
    /// True if nothing is disturbed, whatever the seed.
    pub fn is_none(&self) -> bool {
        self.sensor.is_none() && self.actuation.is_none() && self.localisation.is_none()
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used, with its valid values. Relative deviations are at
    /// most 0.3, so that three of them cannot change the sign.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let SensorNoise { range_m, range_relative, dropped_beams, dropped_scans } = self.sensor;
        let Self { actuation, localisation, .. } = self;
        let (length, relative) =
            ((100.0, "a length from 0 to 100 m"), (0.3, "a share from 0 to 0.3"));
        let share = (1.0, "a share from 0 to 1");
        let checks = [
            ("sensor.range_m", range_m, length),
            ("sensor.range_relative", range_relative, relative),
            ("sensor.dropped_beams", dropped_beams, share),
            ("sensor.dropped_scans", dropped_scans, share),
            ("actuation.delay_s", actuation.delay_s, (10.0, "a time from 0 to 10 s")),
            ("actuation.v_relative", actuation.v_relative, relative),
            ("actuation.omega_relative", actuation.omega_relative, relative),
            ("localisation.position_m", localisation.position_m, length),
            ("localisation.heading_rad", localisation.heading_rad, (PI, "an angle from 0 to pi")),
            (
                "localisation.correlation_s",
                localisation.correlation_s,
                (1e6, "a time from 0 to 1000000 s"),
            ),
            ("localisation.v_relative", localisation.v_relative, relative),
            ("localisation.omega_relative", localisation.omega_relative, relative),
        ];
        let is_unusable =
            |(_, value, (most, _)): &(_, f64, (f64, _))| !(0.0..=*most).contains(value);
        match checks.into_iter().find(is_unusable) {
            Some((path, value, (_, expected))) => Err(ConfigError::must_be(path, expected, value)),
            None => Ok(()),
        }
    }
}

impl SensorNoise {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl ActuationNoise {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl LocalisationNoise {
    fn is_none(&self) -> bool {
        Self { correlation_s: 0.0, ..*self } == Self::default()
    }
}

/// Seed and robot that random numbers are drawn for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) seed: u64,
    /// Place of the robot among the participants.
    pub(super) robot: usize,
}

/// Purpose of random numbers. The discriminants are part of the meaning of a seed.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Range = 0,
    DroppedBeam = 1,
    DroppedScan = 2,
    DrivenV = 3,
    DrivenOmega = 4,
    X = 5,
    Y = 6,
    Heading = 7,
    ToldV = 8,
    ToldOmega = 9,
}

impl Source {
    fn stream(self, kind: Kind) -> keyway::random::Random {
        keyway::random::Random::stream(self.seed, &[self.robot as u64, kind as u64])
    }
}

#[cfg(test)]
mod tests;
