//! What keeps a simulated robot from being ideal: an inexact sensor, late and inexact motors, a robot that does not
//! know exactly where it is.
//!
//! Only what the controller is told and what the motors do is disturbed. Contact, clearance, arrival and what is recorded
//! ([`Run`](super::Run)) are those of the true motion.
//!
//! Every kind of noise of every robot draws from a stream of its own, so one kind can be changed without any other drawing
//! other numbers. Deviations are normal and cut at three standard deviations: what would be beyond is set to
//! three. So nothing is ever off by more, and the standard deviation is 0.9975 times the one that was asked for.

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

/// What disturbs a robot; by default nothing. Random numbers are those of `seed` and of the robot's place among the
/// participants, so several robots may have equal disturbances and are disturbed differently.
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
    /// Which random numbers are drawn: the same seed gives the same run.
    pub seed: u64,
    /// What the sensor gets wrong.
    pub sensor: SensorNoise,
    /// What the motors get wrong.
    pub actuation: ActuationNoise,
    /// What the robot gets wrong about where it is and how it moves.
    pub localisation: LocalisationNoise,
}

/// What a range sensor gets wrong.
///
/// The range r of a beam that met something is measured as r + e, where the standard deviation of e is the root of
/// `range_m`² + (`range_relative` r)², anew for every beam and scan. It stays between 0, which says nothing, and the
/// sensor's range. A beam that met nothing says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of every range \[m\], from 0 to 100.
    pub range_m: f64,
    /// Standard deviation as a share of the range, from 0 to 0.3.
    pub range_relative: f64,
    /// Share of the beams that return nothing, from 0 to 1: any beam of any scan, independently. They are NaN,
    /// by which a scan says nothing: neither an obstacle nor free ground.
    pub dropped_beams: f64,
    /// Share of the scans that are lost, from 0 to 1: any of them, independently. The controller is asked in every
    /// cycle, as on a real robot; without a scan of that cycle it is given one in which every beam is NaN, and not an
    /// old one, which would show things where they are not.
    pub dropped_scans: f64,
}

/// What motors get wrong. Whatever it is, the robot keeps its limits of speed and acceleration, and stands when it is
/// told to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ActuationNoise {
    /// Time from a command to its effect \[s\], from 0 to 10, of which the robot does not know; it comes on top of the one that it
    /// does know ([`Robot::actuation_delay_s`](keyway::robot::Robot::actuation_delay_s)). A command that is given at the time t changes the velocity
    /// from t + `delay_s` on, for one cycle, as it would from t on without a delay: so the same commands drive the same
    /// velocities, `delay_s` later, whether that is a whole number of cycles or not. Before the first
    /// command has an effect, the robot stands. A robot has only arrived when no command that moves it is on its way.
    pub delay_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3. The robot obeys (1 + e) times the command, e anew
    /// in every cycle, as far as its limits allow. As it cannot be above a limit but below it, a robot that is driven at
    /// a limit is slower in the mean, and brakes less hard in the mean where it is told to brake as hard as it can.
    pub v_relative: f64,
    /// The same of the turn rate.
    pub omega_relative: f64,
}

/// What a robot gets wrong about where it is and how it moves.
///
/// Errors of real localisation drift: they stay alike for a while. Those of position and heading are stationary
/// Gauss-Markov processes: two errors that are t apart have the correlation exp(-t / `correlation_s`), and those of x, y and
/// heading do not depend on each other. The first pose has an error already. Errors of the velocity are drawn anew in
/// every cycle, and a robot that stands is told so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LocalisationNoise {
    /// Standard deviation of each coordinate of the position \[m\], from 0 to 100.
    pub position_m: f64,
    /// Standard deviation of the heading \[rad\], from 0 to pi.
    pub heading_rad: f64,
    /// How long errors of position and heading last \[s\], from 0 to 1000000. 0: they are drawn anew in every cycle, so
    /// that the robot seems to jump to and fro; a few seconds and more are like a robot that matches scans with a map.
    pub correlation_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3.
    pub v_relative: f64,
    /// Standard deviation of the turn rate as a share of it, from 0 to 0.3.
    pub omega_relative: f64,
}

impl Disturbances {
    /// Whether nothing is disturbed, whatever the seed.
    pub fn is_none(&self) -> bool {
        self.sensor.is_none() && self.actuation.is_none() && self.localisation.is_none()
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used, with the values that can. Relative deviations end at 0.3, as with three
    /// of them the sign must not change.
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

/// Whose random numbers are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) seed: u64,
    /// Place of the robot among the participants.
    pub(super) robot: usize,
}

/// What random numbers are drawn for. The numbers are part of what a seed means.
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
