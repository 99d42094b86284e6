//! Speed profile: a path and a robot's limits -> the fastest traversal of the path, and its time.
//!
//! Along the path, the squared speed stays below a ceiling set by speed, turn rate and lateral
//! acceleration: v <= `v_max_mps`, |curvature| v <= `omega_max_radps`, |curvature| v² <=
//! `lateral_acceleration_mps2`. It grows by at most 2 a and falls by at most 2 b per metre, with
//! acceleration a and deceleration b. One backward and one forward pass cut off the speeds that
//! cannot be reached; no other profile is faster anywhere.
//!
//! At a corner, where the heading jumps, the robot stops and turns in place, as fast as turn
//! rate, angular acceleration and deceleration allow. A reversal is a turn by pi: nothing is driven
//! backwards. A turning radius is not considered: a car-like robot that cannot follow the path
//! takes longer, or leaves it.
//!
//! # Accuracy
//! The time is a lower bound for any run along this path under these limits: angular acceleration
//! is ignored on curves, and turning towards the path's first heading takes no time. Only a robot
//! that leaves the path may be faster.
//!
//! Curvature is evaluated at the samples; in between, the ceiling of the squared speed is linear.
//! That is exact at any spacing for segments and arcs. For cubic curves the error of the time, in
//! either direction, shrinks with the square of the spacing; at 1 cm it was about 1e-5 of the time
//! on a spline with bends of half a metre. A bend shorter than the spacing takes at least the time
//! of its turn at the largest turn rate.
//!
//! # Source
//! \[Bobrow1985\], for limits that do not depend on the speed; textbook material since.
//!
//! # Errors / cost
//! [`SpeedProfileError`]. A few operations per sample, besides the sampling.

use crate::ConfigError;
use crate::geometry::{Path, PathSample, wrap_angle};
use crate::robot::Limits;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use thiserror::Error;

/// A turn between two samples that exceeds the turn explained by their curvatures by more than
/// this \[rad\] has a curvature peak that both samples have missed.
const MISSED_TURN_RAD: f64 = 1e-6;

/// Parameters of a speed profile, besides the robot's limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SpeedProfileConfig {
    /// Largest lateral acceleration on curves \[m/s²\]; none: unlimited.
    pub lateral_acceleration_mps2: Option<f64>,
    /// Speed at the beginning \[m/s\].
    pub start_mps: f64,
    /// Largest speed at the end \[m/s\].
    pub end_mps: f64,
    /// Distance between samples \[m\].
    pub spacing_m: f64,
    /// Heading jumps up to this are driven through without a stop, as if there were none \[rad\].
    pub smooth_turn_rad: f64,
}

impl SpeedProfileConfig {
    /// Checks a spacing given by a user: it must not need more than a million samples for a path.
    ///
    /// # Errors
    /// [`SpeedProfileError::TooFine`].
    pub fn check_spacing(&self, path: &Path) -> Result<(), SpeedProfileError> {
        let length_m = path.length_m();
        if length_m / self.spacing_m > MAX_SAMPLES {
            return Err(SpeedProfileError::TooFine { length_m, least_m: length_m / MAX_SAMPLES });
        }
        Ok(())
    }
}

impl Default for SpeedProfileConfig {
    /// From rest to rest, one sample per centimetre, every corner a stop.
    fn default() -> Self {
        Self {
            lateral_acceleration_mps2: None,
            start_mps: 0.0,
            end_mps: 0.0,
            spacing_m: 0.01,
            smooth_turn_rad: 1e-6,
        }
    }
}

/// Reason why there is no profile.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SpeedProfileError {
    /// A value of the config or of the limits cannot be used.
    #[error("speed profile: {0}")]
    Config(#[from] ConfigError),
    /// The path bends, has a corner, or ends too soon for its start speed.
    #[error("the path can begin with at most {at_most_mps} m/s, got {start_mps} m/s")]
    StartTooFast {
        /// The requested start speed \[m/s\].
        start_mps: f64,
        /// The largest possible start speed \[m/s\].
        at_most_mps: f64,
    },
    /// The spacing needs too many samples, which is most likely a mistake.
    #[error(
        "the spacing gives over a million samples on a path of {length_m:.3} m; choose at \
         least {least_m:.6} m"
    )]
    TooFine {
        /// Length of the path \[m\].
        length_m: f64,
        /// The smallest spacing \[m\].
        least_m: f64,
    },
}

/// Maximum number of samples of a profile.
const MAX_SAMPLES: f64 = 1e6;

/// The constraint that limits the speed at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedLimit {
    /// The largest speed.
    Speed,
    /// The largest turn rate, on a curve.
    TurnRate,
    /// The largest lateral acceleration, on a curve.
    LateralAcceleration,
    /// The acceleration since a slower point.
    Acceleration,
    /// The deceleration before a slower point.
    Deceleration,
    /// A stop to turn in place.
    Corner,
    /// The start speed.
    Start,
    /// The largest speed at the end of the path.
    End,
}

impl SpeedLimit {
    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::TurnRate => "turn-rate",
            Self::LateralAcceleration => "lateral-acceleration",
            Self::Acceleration => "acceleration",
            Self::Deceleration => "deceleration",
            Self::Corner => "corner",
            Self::Start => "start",
            Self::End => "end",
        }
    }
}

/// A point on the path, with the time and the speed at which the robot passes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SpeedSample {
    /// The point on the path.
    #[serde(flatten)]
    pub at: PathSample,
    /// Time since the beginning \[s\].
    pub t_s: f64,
    /// Speed \[m/s\].
    pub v_mps: f64,
    /// The constraint that limits the speed here.
    pub limit: SpeedLimit,
}

impl SpeedSample {
    /// Turn rate on the curve, positive to the left \[rad/s\]; 0 at a turn in place.
    pub fn omega_radps(&self) -> f64 {
        self.at.curvature_per_m * self.v_mps
    }
}

/// The fastest traversal of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SpeedProfile {
    /// Samples in order, including the joints of the path's pieces. The arc length increases
    /// strictly, except at a corner that needs a stop: it is listed twice, with the times of
    /// arrival and departure. At any other joint, heading and curvature are those of the piece
    /// that begins there.
    pub samples: Vec<SpeedSample>,
    /// Time for the whole path \[s\].
    pub time_s: f64,
    /// The part of it that is spent turning in place \[s\].
    pub turning_s: f64,
}

/// An upper bound of the squared speed at a point \[m²/s²\], and the constraint that sets it.
#[derive(Clone, Copy)]
struct Bound {
    v_sq: f64,
    limit: SpeedLimit,
}

impl Bound {
    fn lower(self, v_sq: f64, limit: SpeedLimit) -> Self {
        if v_sq < self.v_sq { Self { v_sq, limit } } else { self }
    }
}

impl SpeedProfile {
    /// The fastest traversal of `path` from `start_mps` to at most `end_mps`.
    ///
    /// # Errors
    /// Returns [`SpeedProfileError`] if a value is invalid, or if the robot cannot slow down in
    /// time from `start_mps`.
    pub fn of_path(
        path: &Path,
        limits: &Limits,
        config: &SpeedProfileConfig,
    ) -> Result<Self, SpeedProfileError> {
        check(limits, config)?;
        let samples = path.samples_of_pieces(config.spacing_m);
        let ceilings = ceilings(&samples, limits, config);
        let bounds = reachable(&samples, &ceilings, limits, config)?;
        let mut profile = Self { samples: Vec::new(), time_s: 0.0, turning_s: 0.0 };
        for (i, &at) in samples.iter().enumerate() {
            let Bound { v_sq, mut limit } = bounds[i];
            if let Some(before) = i.checked_sub(1) {
                let turn_rad = corner_rad(&samples[before], &at, config);
                let is_joint = samples[before].s_m == at.s_m && turn_rad == 0.0;
                let arrival = if is_joint { profile.samples.pop() } else { None };
                // At a joint no distance is covered to accelerate over: the limit of the piece
                // before applies.
                if let Some(arrival) = arrival.filter(|_| limit == SpeedLimit::Acceleration) {
                    limit = arrival.limit;
                }
                let turning_s = turning_time_s(turn_rad, limits);
                let ends = [before, i].map(|k| (bounds[k].v_sq, ceilings[k].v_sq));
                let driving_s = driving_time_s(at.s_m - samples[before].s_m, ends, limits)
                    .max(driven_turn_rad(&samples[before], &at) / limits.omega_max_radps);
                profile.turning_s += turning_s;
                profile.time_s += turning_s + driving_s;
            }
            let v_mps = v_sq.sqrt();
            profile.samples.push(SpeedSample { at, t_s: profile.time_s, v_mps, limit });
        }
        Ok(profile)
    }

    /// The samples as comma-separated values: a header with units, then one line per sample. Every
    /// number is parsed back to exactly the same number.
    pub fn to_csv(&self) -> String {
        let mut text =
            String::from("s_m,x_m,y_m,heading_rad,curvature_per_m,t_s,v_mps,omega_radps,limit\n");
        for sample in &self.samples {
            let PathSample { s_m, x_m, y_m, heading_rad, curvature_per_m } = sample.at;
            let (t_s, v_mps, limit) = (sample.t_s, sample.v_mps, sample.limit.name());
            let omega_radps = sample.omega_radps();
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{s_m},{x_m},{y_m},{heading_rad},{curvature_per_m},{t_s},{v_mps},{omega_radps},{limit}"
            );
        }
        text
    }
}

/// The speed ceiling at each sample, from the path's curvature.
fn ceilings(samples: &[PathSample], limits: &Limits, config: &SpeedProfileConfig) -> Vec<Bound> {
    let mut curvatures: Vec<f64> = samples.iter().map(|s| s.curvature_per_m.abs()).collect();
    for (i, pair) in samples.windows(2).enumerate() {
        let driven_m = pair[1].s_m - pair[0].s_m;
        let turned_rad = driven_turn_rad(&pair[0], &pair[1]);
        let explained_rad = curvatures[i].max(curvatures[i + 1]) * driven_m;
        if turned_rad > explained_rad + MISSED_TURN_RAD {
            // A peak between the two samples: its curvature is at least the mean curvature.
            let mean = turned_rad / driven_m;
            curvatures[i] = curvatures[i].max(mean);
            curvatures[i + 1] = curvatures[i + 1].max(mean);
        }
    }
    let ceiling = |&curvature: &f64| {
        let turn_rate_sq = (limits.omega_max_radps / curvature).powi(2);
        let lateral_sq = config.lateral_acceleration_mps2.map_or(f64::INFINITY, |a| a / curvature);
        let bound = Bound { v_sq: limits.v_max_mps.powi(2), limit: SpeedLimit::Speed }
            .lower(turn_rate_sq, SpeedLimit::TurnRate)
            .lower(lateral_sq, SpeedLimit::LateralAcceleration);
        // Never exactly 0, so that even the sharpest curve is passed in finite time.
        Bound { v_sq: bound.v_sq.max(f64::MIN_POSITIVE), ..bound }
    };
    curvatures.iter().map(ceiling).collect()
}

/// The largest squared speed at each sample that can be reached from the start, and from which the
/// robot can still slow down for the rest of the path.
fn reachable(
    samples: &[PathSample],
    ceilings: &[Bound],
    limits: &Limits,
    config: &SpeedProfileConfig,
) -> Result<Vec<Bound>, SpeedProfileError> {
    let mut bounds = ceilings.to_vec();
    for (i, pair) in samples.windows(2).enumerate() {
        if corner_rad(&pair[0], &pair[1], config) > 0.0 {
            let stop = Bound { v_sq: 0.0, limit: SpeedLimit::Corner };
            (bounds[i], bounds[i + 1]) = (stop, stop);
        }
    }
    if let Some(last) = bounds.last_mut() {
        *last = last.lower(config.end_mps.powi(2), SpeedLimit::End);
    }
    let driven_m = |i: usize| samples[i + 1].s_m - samples[i].s_m;
    for i in (1..samples.len()).rev().map(|next| next - 1) {
        let v_sq = bounds[i + 1].v_sq + 2.0 * limits.deceleration_mps2 * driven_m(i);
        bounds[i] = bounds[i].lower(v_sq, SpeedLimit::Deceleration);
    }
    if let Some(first) = bounds.first_mut() {
        let (start_mps, at_most_mps) = (config.start_mps, first.v_sq.sqrt());
        // The rounding error of squaring a computed speed and taking its root is not an excess.
        if start_mps > at_most_mps * (1.0 + 1e-12) {
            return Err(SpeedProfileError::StartTooFast { start_mps, at_most_mps });
        }
        *first = first.lower(start_mps.powi(2), SpeedLimit::Start);
    }
    for i in 1..samples.len() {
        let v_sq = bounds[i - 1].v_sq + 2.0 * limits.acceleration_mps2 * driven_m(i - 1);
        bounds[i] = bounds[i].lower(v_sq, SpeedLimit::Acceleration);
    }
    Ok(bounds)
}

/// The heading change over the distance between two samples \[rad\]; 0 at a joint, where the
/// distance is 0.
fn driven_turn_rad(before: &PathSample, after: &PathSample) -> f64 {
    if after.s_m == before.s_m {
        return 0.0;
    }
    wrap_angle(after.heading_rad - before.heading_rad).abs()
}

/// The heading jump at a joint that needs a stop \[rad\]; 0 if it needs none.
fn corner_rad(before: &PathSample, after: &PathSample, config: &SpeedProfileConfig) -> f64 {
    let turn_rad = wrap_angle(after.heading_rad - before.heading_rad).abs();
    if after.s_m == before.s_m && turn_rad > config.smooth_turn_rad { turn_rad } else { 0.0 }
}

/// The shortest time for the distance between two samples \[s\]. `ends` are the squared speed and
/// its ceiling at either sample.
///
/// Over the distance, the squared speed is linear under constant acceleration and under constant
/// deceleration, and so is the ceiling. The fastest profile is the lowest of the three lines; the
/// acceleration changes where two of them cross.
fn driving_time_s(distance_m: f64, ends: [(f64, f64); 2], limits: &Limits) -> f64 {
    if distance_m <= 0.0 {
        return 0.0;
    }
    let [(from_sq, from_ceiling), (to_sq, to_ceiling)] = ends;
    let slope = (to_ceiling - from_ceiling) / distance_m;
    let (rise, fall) = (2.0 * limits.acceleration_mps2, -2.0 * limits.deceleration_mps2);
    // Value at the beginning, and slope.
    let lines = [(from_sq, rise), (from_ceiling, slope), (to_sq - fall * distance_m, fall)];
    let crossing = |i: usize, j: usize| (lines[j].0 - lines[i].0) / (lines[i].1 - lines[j].1);
    let mut places = [0.0, crossing(0, 1), crossing(1, 2), crossing(0, 2), distance_m]
        .map(|s: f64| if s > 0.0 && s < distance_m { s } else { 0.0 });
    places[4] = distance_m;
    places.sort_by(f64::total_cmp);
    let speed_at = |s: f64| {
        let v_sq =
            lines.iter().map(|(begin, slope)| begin + slope * s).fold(f64::INFINITY, f64::min);
        v_sq.max(0.0).sqrt()
    };
    // Under constant acceleration, the mean speed is the mean of the two end speeds.
    let time_s = |pair: &[f64]| 2.0 * (pair[1] - pair[0]) / (speed_at(pair[0]) + speed_at(pair[1]));
    let times_s = places.windows(2).filter(|pair| pair[1] > pair[0]).map(time_s);
    times_s.fold(0.0, |sum, time_s| sum + time_s)
}

/// The shortest time to turn in place, from rest to rest \[s\].
fn turning_time_s(turn_rad: f64, limits: &Limits) -> f64 {
    let (up, down) = (limits.angular_acceleration_radps2, limits.angular_deceleration_radps2);
    // The turn rate at which accelerating and decelerating make up the whole turn.
    let peak_radps = (2.0 * turn_rad * up * down / (up + down)).sqrt();
    let rate_radps = peak_radps.min(limits.omega_max_radps);
    let ramps_s = rate_radps / up + rate_radps / down;
    if rate_radps < peak_radps {
        let steady_rad = turn_rad - 0.5 * rate_radps * ramps_s;
        return ramps_s + steady_rad / rate_radps;
    }
    ramps_s
}

fn check(limits: &Limits, config: &SpeedProfileConfig) -> Result<(), ConfigError> {
    let positive = [
        ("limits.v_max_mps", limits.v_max_mps),
        ("limits.omega_max_radps", limits.omega_max_radps),
        ("limits.acceleration_mps2", limits.acceleration_mps2),
        ("limits.deceleration_mps2", limits.deceleration_mps2),
        ("limits.angular_acceleration_radps2", limits.angular_acceleration_radps2),
        ("limits.angular_deceleration_radps2", limits.angular_deceleration_radps2),
        ("lateral_acceleration_mps2", config.lateral_acceleration_mps2.unwrap_or(1.0)),
        ("spacing_m", config.spacing_m),
    ];
    for (path, value) in positive {
        ConfigError::unless_positive(path, value)?;
    }
    ConfigError::unless_not_negative("start_mps", config.start_mps)?;
    ConfigError::unless_not_negative("end_mps", config.end_mps)?;
    ConfigError::unless_not_negative("smooth_turn_rad", config.smooth_turn_rad)
}

#[cfg(test)]
#[path = "speed_profile_tests.rs"]
mod tests;
