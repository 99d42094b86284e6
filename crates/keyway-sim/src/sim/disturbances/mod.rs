//! Disturbances of a simulated robot: a delayed, noisy or partly blind sensor; delayed, weak or
//! inexact motors; and localisation errors.
//!
//! Disturbances change only the controller's inputs and the response of the motors. Contact,
//! clearance, arrival and the record of a run ([`Run`](super::Run)) follow the true motion.
//!
//! Each kind of noise of each robot draws from its own stream, so a change of one kind leaves the
//! numbers of the others unchanged. Deviations are normal and clipped to three standard
//! deviations. Clipping makes the actual standard deviation 0.9975 times the requested one.

mod actuation;
mod gaussian;
mod localisation;
mod sensing;

pub(super) use actuation::Actuation;
pub(super) use localisation::{Localisation, TrueState};
pub(super) use sensing::Sensing;

use keyway::ConfigError;
use keyway::robot::{CycleCount, Robot};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Disturbances of a robot; by default none. Random numbers follow from `seed` and the robot's
/// index among the participants, so several robots with equal disturbances are disturbed
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Disturbances {
    /// Seed of the random numbers: the same seed gives the same run.
    pub seed: u64,
    /// Errors of the sensor.
    pub sensor: SensorFaults,
    /// Errors of the motors.
    pub actuation: ActuationFaults,
    /// Errors of the robot's estimated pose and velocity.
    pub localisation: LocalisationFaults,
}

/// Errors of the range sensors. They apply to each sensor, with random numbers of its own.
///
/// The range r of a beam that hits something is measured as r + e. The standard deviation of e is
/// the root of `range_m`² + (`range_relative` r)², and e is drawn anew for each beam and scan.
/// The result is clamped to the interval from 0, which carries no information, to the sensor's
/// range. A beam that hits nothing has no error.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SensorFaults {
    /// Standard deviation of every range \[m\], from 0 to 100.
    pub range_m: f64,
    /// Standard deviation as a share of the range, from 0 to 0.3.
    pub range_relative: f64,
    /// Share of the beams that return nothing, from 0 to 1, chosen independently for each beam
    /// and scan. These beams are NaN, which carries no information: neither an obstacle nor free
    /// space.
    pub dropped_beams: f64,
    /// Share of the scans that are lost, from 0 to 1, chosen independently. As on a real robot,
    /// the controller still runs in every cycle. It then gets no scan instead of an old one,
    /// which would show obstacles at wrong positions.
    pub dropped_scans: f64,
    /// Share of the scans that are replaced by the previous scan as if it were new, from 0 to 1,
    /// chosen independently. It shows obstacles where they were relative to the robot.
    pub repeated_scans: f64,
    /// True if the last scan is repeated as if it were new in every cycle until the next one, as
    /// by a driver that publishes faster than the sensor scans.
    pub held_scans: bool,
    /// Time from a scan to the first cycle in which the controller can get it \[s\], from 0 to
    /// 10. The controller gets the latest scan that has arrived, once, with its stamp. Before the
    /// first arrival it gets none.
    pub delay_s: f64,
    /// Time by which the stamps of scans are late \[s\], from 0 to `delay_s`. With all of the
    /// delay, a scan appears to have been taken at its arrival.
    pub stamp_late_s: f64,
    /// Time from one scan to the next \[s\], from 0.001 to 60; 0 for the period of the robot's
    /// description ([`RangeSensor::period_s`](keyway::robot::RangeSensor::period_s)).
    pub period_s: f64,
    /// Blind sectors of the sensor, each from one bearing counter-clockwise to another \[deg\],
    /// from -360 to 360, with 0 straight ahead of the sensor: a dirty window, or a mast. Their
    /// beams are NaN.
    pub blind_deg: Vec<[f64; 2]>,
    /// Indices of the sensors that fail completely.
    pub lost: Vec<usize>,
}

/// Errors of the motors and wheels. The robot still keeps its limits of speed and acceleration,
/// and comes to a stop when commanded to stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ActuationFaults {
    /// Delay from a command to its effect that is not in the robot's description \[s\], from 0 to
    /// 10. It adds to the known delay
    /// ([`Robot::actuation_delay_s`](keyway::robot::Robot::actuation_delay_s)). A command issued
    /// at the time t changes the velocity from t + `delay_s` on, for one cycle, as it would from
    /// t on without a delay. So the same commands give the same velocities `delay_s` later, even
    /// if the delay is not a whole number of cycles. The robot is stationary until the first
    /// command takes effect. It has arrived only when no pending command moves it.
    pub delay_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3. The robot executes (1 +
    /// e) times the command within its limits; e is drawn anew in every cycle. The speed can fall
    /// below a limit but not exceed it. So a robot driven at a limit is slower on average, and
    /// brakes less hard on average at full braking.
    pub v_relative: f64,
    /// Standard deviation of the turn rate as a share of it, from 0 to 0.3.
    pub omega_relative: f64,
    /// Time constant of the drive \[s\], from 0 to 10. With 0 the wheels follow the velocity w
    /// that the command and the limits allow. Otherwise their velocity u is a first-order lag
    /// behind it: in each cycle of length T, u' = u + (1 - exp(-T / `lag_s`)) (w - u). Below
    /// 0.001 m/s and 0.001 rad/s the wheels stop when w is 0.
    pub lag_s: f64,
    /// Dead band of the speed \[m/s\], from 0 to 100: a command whose magnitude is below it acts
    /// as 0.
    pub dead_band_mps: f64,
    /// Dead band of the turn rate \[rad/s\], from 0 to 100.
    pub dead_band_radps: f64,
    /// Share of the wheels' speed that is lost to slip, from 0 to 0.9. Odometry reports the
    /// velocity of the wheels.
    pub v_slip: f64,
    /// Share of the turn rate that is lost to slip, from 0 to 0.9. Skid-steered robots lose much
    /// of it.
    pub omega_slip: f64,
}

/// Errors of a robot's estimated pose and velocity.
///
/// Localisation errors drift slowly. Errors of position and heading are stationary Gauss-Markov
/// processes: two errors that are t apart have the correlation exp(-t / `correlation_s`). The
/// errors of x, y and heading are independent, and the first pose already has one. Errors of the
/// velocity are drawn anew in every cycle; the reported velocity of a stationary robot is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LocalisationFaults {
    /// Standard deviation of each coordinate of the position \[m\], from 0 to 100.
    pub position_m: f64,
    /// Standard deviation of the heading \[rad\], from 0 to pi.
    pub heading_rad: f64,
    /// Correlation time of the errors of position and heading \[s\], from 0 to 1000000. With 0
    /// they are drawn anew in every cycle, so the pose jitters; a few seconds or more resemble a
    /// robot that matches scans with a map.
    pub correlation_s: f64,
    /// Standard deviation of the speed as a share of it, from 0 to 0.3.
    pub v_relative: f64,
    /// Standard deviation of the turn rate as a share of it, from 0 to 0.3.
    pub omega_relative: f64,
    /// Error of the position per driven distance, from 0 to 0.3: after d metres the position is
    /// off by `drift` d. Its direction in the world frame is drawn once.
    pub drift: f64,
    /// Error of the heading per driven distance \[rad/m\], from 0 to 1. Its sign is drawn once.
    pub heading_drift_radpm: f64,
    /// Largest distance of a jump of the position \[m\], from 0 to 100. The pose jumps once in
    /// each interval of `jump_every_s`, at a random time, and is correct again `jump_for_s`
    /// later, within the same interval. Distance, direction and turn are drawn anew for each
    /// jump, from uniform distributions.
    pub jump_m: f64,
    /// Largest turn of a jump to either side \[rad\], from 0 to pi.
    pub jump_rad: f64,
    /// Length of the intervals with one jump each \[s\], from 0 to 1000000 and at least
    /// `jump_for_s`; with jumps, at least 0.001.
    pub jump_every_s: f64,
    /// Duration of a jump \[s\], from 0 to `jump_every_s`; if both are equal, the pose is always
    /// off.
    pub jump_for_s: f64,
    /// Time from a pose and its velocity to the first cycle in which they are reported to the
    /// controller \[s\], from 0 to 10. Their stamp is reported, too. Until then the controller
    /// gets those of the start.
    pub delay_s: f64,
    /// Time by which the stamps of poses are late \[s\], from 0 to `delay_s`. With all of the
    /// delay, a pose appears to be current.
    pub stamp_late_s: f64,
    /// True if the reported velocity is always 0, as by odometry without wheel encoders.
    pub velocity_is_zero: bool,
}

impl Disturbances {
    /// True if nothing is disturbed, whatever the seed.
    pub fn is_none(&self) -> bool {
        self.sensor.is_none() && self.actuation.is_none() && self.localisation.is_none()
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field, with its valid values. Relative
    /// deviations are at most 0.3, so that three of them cannot change the sign.
    pub fn validate(&self) -> Result<(), ConfigError> {
        self.sensor.validate().map_err(|error| error.within("sensor"))?;
        self.actuation.validate().map_err(|error| error.within("actuation"))?;
        self.localisation.validate().map_err(|error| error.within("localisation"))
    }
}

impl Disturbances {
    /// Checks every value, including those that depend on the robot.
    ///
    /// # Errors
    /// Those of [`Self::validate`]. Also fails for the index of a sensor that the robot does not
    /// have, and for a delay of scans that keeps more ranges pending than a simulation may hold.
    pub fn validate_for(&self, robot: &Robot) -> Result<(), ConfigError> {
        /// About a gigabyte.
        const MOST_RANGES: f64 = 1e8;
        self.validate()?;
        let count = robot.sensors.len();
        if let Some(&lost) = self.sensor.lost.iter().find(|&&lost| lost >= count) {
            let expected = format!("indices below {count}, the number of the robot's sensors");
            return Err(ConfigError::must_be("sensor.lost", &expected, lost as f64));
        }
        let beams: u32 = robot.sensors.iter().map(|sensor| sensor.beams).max().unwrap_or(0);
        let under_way = self.sensor.delay_s / robot.cycle_s * f64::from(beams);
        if under_way <= MOST_RANGES {
            return Ok(());
        }
        let expected = "a time in which at most 100000000 ranges are pending";
        Err(ConfigError::must_be("sensor.delay_s", expected, self.sensor.delay_s))
    }
}

/// Largest value of a field, and its description for an error.
type Most = (f64, &'static str);

const LENGTH: Most = (100.0, "a length from 0 to 100 m");
const RELATIVE: Most = (0.3, "a share from 0 to 0.3");
const SHARE: Most = (1.0, "a share from 0 to 1");
const DELAY: Most = (10.0, "a time from 0 to 10 s");
const LONG_TIME: Most = (1e6, "a time from 0 to 1000000 s");
const ANGLE: Most = (PI, "an angle from 0 to pi");
const BAND: Most = (100.0, "a number from 0 to 100");
const SLIP: Most = (0.9, "a share from 0 to 0.9");

/// Returns an error for the first value that is not between 0 and its maximum.
fn check<const N: usize>(checks: [(&'static str, f64, Most); N]) -> Result<(), ConfigError> {
    let is_unusable = |(_, value, (most, _)): &(_, f64, Most)| !(0.0..=*most).contains(value);
    match checks.into_iter().find(is_unusable) {
        Some((field, value, (_, expected))) => Err(ConfigError::must_be(field, expected, value)),
        None => Ok(()),
    }
}

/// Returns an error for stamps in the future.
fn check_stamps(stamp_late_s: f64, delay_s: f64) -> Result<(), ConfigError> {
    if (0.0..=delay_s).contains(&stamp_late_s) {
        return Ok(());
    }
    Err(ConfigError::must_be("stamp_late_s", "a time from 0 to `delay_s`", stamp_late_s))
}

impl SensorFaults {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }

    fn validate(&self) -> Result<(), ConfigError> {
        check([
            ("range_m", self.range_m, LENGTH),
            ("range_relative", self.range_relative, RELATIVE),
            ("dropped_beams", self.dropped_beams, SHARE),
            ("dropped_scans", self.dropped_scans, SHARE),
            ("repeated_scans", self.repeated_scans, SHARE),
            ("delay_s", self.delay_s, DELAY),
        ])?;
        check_stamps(self.stamp_late_s, self.delay_s)?;
        if self.period_s != 0.0 && !(1e-3..=60.0).contains(&self.period_s) {
            let expected = "0, or a time from 0.001 to 60 s";
            return Err(ConfigError::must_be("period_s", expected, self.period_s));
        }
        let mut bearings = self.blind_deg.iter().flatten();
        match bearings.find(|bearing_deg| !(-360.0..=360.0).contains(*bearing_deg)) {
            Some(&deg) => Err(ConfigError::must_be("blind_deg", "angles from -360 to 360", deg)),
            None => Ok(()),
        }
    }
}

impl ActuationFaults {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }

    fn validate(&self) -> Result<(), ConfigError> {
        check([
            ("delay_s", self.delay_s, DELAY),
            ("v_relative", self.v_relative, RELATIVE),
            ("omega_relative", self.omega_relative, RELATIVE),
            ("lag_s", self.lag_s, DELAY),
            ("dead_band_mps", self.dead_band_mps, BAND),
            ("dead_band_radps", self.dead_band_radps, BAND),
            ("v_slip", self.v_slip, SLIP),
            ("omega_slip", self.omega_slip, SLIP),
        ])
    }
}

impl LocalisationFaults {
    fn is_none(&self) -> bool {
        let without_sizes =
            Self { correlation_s: 0.0, jump_every_s: 0.0, jump_for_s: 0.0, ..*self };
        without_sizes == Self::default()
    }

    /// True if the pose jumps.
    fn jumps(&self) -> bool {
        self.jump_m > 0.0 || self.jump_rad > 0.0
    }

    fn validate(&self) -> Result<(), ConfigError> {
        check([
            ("position_m", self.position_m, LENGTH),
            ("heading_rad", self.heading_rad, ANGLE),
            ("correlation_s", self.correlation_s, LONG_TIME),
            ("v_relative", self.v_relative, RELATIVE),
            ("omega_relative", self.omega_relative, RELATIVE),
            ("drift", self.drift, RELATIVE),
            (
                "heading_drift_radpm",
                self.heading_drift_radpm,
                (1.0, "an angle per metre from 0 to 1"),
            ),
            ("jump_m", self.jump_m, LENGTH),
            ("jump_rad", self.jump_rad, ANGLE),
            ("jump_every_s", self.jump_every_s, LONG_TIME),
            ("jump_for_s", self.jump_for_s, LONG_TIME),
            ("delay_s", self.delay_s, DELAY),
        ])?;
        check_stamps(self.stamp_late_s, self.delay_s)?;
        if self.jumps() && self.jump_every_s < 1e-3 {
            let expected = "a time of at least 0.001 s if the pose jumps (`jump_m`, `jump_rad`)";
            return Err(ConfigError::must_be("jump_every_s", expected, self.jump_every_s));
        }
        if self.jump_for_s > self.jump_every_s {
            let expected = "a time from 0 to `jump_every_s`";
            return Err(ConfigError::must_be("jump_for_s", expected, self.jump_for_s));
        }
        Ok(())
    }
}

/// Seed, robot and sensor of a random number stream.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) seed: u64,
    /// Index of the robot among the participants.
    pub(super) robot: usize,
    /// Index of the sensor on the robot.
    pub(super) sensor: usize,
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
    RepeatedScan = 10,
    Drift = 11,
    Jump = 12,
    Glimpse = 13,
}

/// Delay in whole cycles, rounded up: a late value waits for the next cycle.
fn cycles_late(delay_s: f64, cycle_s: f64) -> usize {
    let CycleCount { whole, part, .. } = CycleCount::of(delay_s, cycle_s);
    whole + usize::from(part > 0.0)
}

impl Source {
    fn stream(self, kind: Kind) -> keyway::random::Random {
        let names = [self.robot as u64, kind as u64, self.sensor as u64];
        // The first sensor has the numbers of a robot with one sensor.
        let names = if self.sensor == 0 { &names[..2] } else { &names[..] };
        keyway::random::Random::stream(self.seed, names)
    }
}

#[cfg(test)]
mod tests;
