//! Speed profile: a path and a robot's limits -> the fastest way to drive along it, and its time.
//!
//! At every place the square of the speed stays below a ceiling, which speed, turn rate and lateral
//! acceleration set there: v <= `v_max_mps`, |curvature| v <= `omega_max_radps`, |curvature| v² <=
//! `lateral_acceleration_mps2`. Along the path it grows by at most 2 a and falls by at most 2 b per
//! metre. One pass backward and one forward cut off what cannot be reached; no other profile is
//! faster anywhere.
//!
//! At a corner, where the heading jumps, the robot stops and turns on the spot, as fast as turn
//! rate, angular acceleration and deceleration allow. A reversal is a turn by pi: nothing is driven
//! backwards.
//!
//! # What the time is good for
//! It is a lower bound of the time of any run along this path under these limits: angular
//! acceleration is ignored on curves, turning towards the path's first heading takes no time, and
//! only a robot that leaves the path may be faster. Curvature is read at the samples; in between,
//! the ceiling of the squared speed is a straight line. For segments and arcs that is exact at any
//! spacing. For cubic curves the error of the time, to either side, shrinks with the square of the
//! spacing; at 1 cm it was about 1e-5 of the time on a spline with bends of half a metre. A bend
//! that is shorter than the spacing is not passed faster than its turn takes at the largest turn
//! rate.
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

/// Between two samples, a turn that exceeds what their curvatures explain by more than this \[rad\]
/// has a peak of curvature that both have missed.
const MISSED_TURN_RAD: f64 = 1e-6;

/// What a profile assumes besides the robot's limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SpeedProfileConfig {
    /// Largest acceleration to the side on curves \[m/s²\]; none: no such limit.
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
    /// Refuses a spacing at which a path has over a million samples, for whoever takes it from a
    /// user.
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

/// Why there is no profile.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SpeedProfileError {
    /// A value of the config or of the limits cannot be used.
    #[error("speed profile: {0}")]
    Config(#[from] ConfigError),
    /// The path bends, has a corner, or ends too soon for the speed at its beginning.
    #[error("the path can begin with at most {at_most_mps} m/s, got {start_mps} m/s")]
    StartTooFast {
        /// The speed asked for \[m/s\].
        start_mps: f64,
        /// The largest speed that is possible \[m/s\].
        at_most_mps: f64,
    },
    /// More samples than anybody wants: a mistake in the spacing.
    #[error("over a million samples of a path of {length_m:.3} m; choose at least {least_m:.6}")]
    TooFine {
        /// Length of the path \[m\].
        length_m: f64,
        /// The smallest spacing \[m\].
        least_m: f64,
    },
}

/// Samples of a profile, at most.
const MAX_SAMPLES: f64 = 1e6;

/// What keeps the robot from being faster at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedLimit {
    /// The largest speed.
    Speed,
    /// The largest turn rate, on a curve.
    TurnRate,
    /// The largest lateral acceleration, on a curve.
    LateralAcceleration,
    /// The acceleration since a slower place.
    Acceleration,
    /// The deceleration before a slower place.
    Deceleration,
    /// A stop to turn on the spot.
    Corner,
    /// The speed at the beginning.
    Start,
    /// The largest speed at the end.
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

/// A place on the path, and when and how fast the robot passes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SpeedSample {
    /// The place.
    #[serde(flatten)]
    pub at: PathSample,
    /// Time since the beginning \[s\].
    pub t_s: f64,
    /// Speed \[m/s\].
    pub v_mps: f64,
    /// What keeps the robot from being faster here.
    pub limit: SpeedLimit,
}

impl SpeedSample {
    /// Turn rate on the curve, positive to the left \[rad/s\]; 0 where the robot turns on the spot.
    pub fn omega_radps(&self) -> f64 {
        self.at.curvature_per_m * self.v_mps
    }
}

/// The fastest way to drive along a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SpeedProfile {
    /// Samples in order, joints of the path's pieces among them. The arc length grows from each to
    /// the next, except at a corner that needs a stop: that is listed twice, and the robot arrives
    /// at the time of the first and leaves at that of the second. At another joint heading and
    /// curvature are those of the piece that begins there.
    pub samples: Vec<SpeedSample>,
    /// Time for the whole path \[s\].
    pub time_s: f64,
    /// The part of it that is spent turning on the spot \[s\].
    pub turning_s: f64,
}

/// A bound of the squared speed at a place \[m²/s²\], and what sets it.
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
    /// The fastest way along `path` from `start_mps` to at most `end_mps`.
    ///
    /// # Errors
    /// When a value cannot be used, or the robot cannot slow down in time from `start_mps`.
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
                // Over no distance nothing is sped up: what limits the piece before does.
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
    /// number reads back as the same number.
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

/// What the path's curvature allows at each sample.
fn ceilings(samples: &[PathSample], limits: &Limits, config: &SpeedProfileConfig) -> Vec<Bound> {
    let mut curvatures: Vec<f64> = samples.iter().map(|s| s.curvature_per_m.abs()).collect();
    for (i, pair) in samples.windows(2).enumerate() {
        let driven_m = pair[1].s_m - pair[0].s_m;
        let turned_rad = driven_turn_rad(&pair[0], &pair[1]);
        let explained_rad = curvatures[i].max(curvatures[i + 1]) * driven_m;
        if turned_rad > explained_rad + MISSED_TURN_RAD {
            // A peak between the two: on average it is at least as sharp as this.
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
        // Never quite 0: the sharpest curve is passed at last.
        Bound { v_sq: bound.v_sq.max(f64::MIN_POSITIVE), ..bound }
    };
    curvatures.iter().map(ceiling).collect()
}

/// The largest squared speed at each sample that can be reached from the beginning, and from which
/// the robot can slow down for all that follows.
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
        // What a computed speed loses when it is squared and its root taken is not an excess.
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

/// The heading change over a distance between two samples \[rad\]; 0 at a joint, where nothing is
/// driven.
fn driven_turn_rad(before: &PathSample, after: &PathSample) -> f64 {
    if after.s_m == before.s_m {
        return 0.0;
    }
    wrap_angle(after.heading_rad - before.heading_rad).abs()
}

/// The heading jump at a joint that needs a stop \[rad\]; 0 where there is none.
fn corner_rad(before: &PathSample, after: &PathSample, config: &SpeedProfileConfig) -> f64 {
    let turn_rad = wrap_angle(after.heading_rad - before.heading_rad).abs();
    if after.s_m == before.s_m && turn_rad > config.smooth_turn_rad { turn_rad } else { 0.0 }
}

/// The shortest time for a distance between two samples \[s\]; `ends` are squared speed and ceiling
/// at either.
///
/// Over the distance, the squared speed under constant acceleration is a straight line, and so are
/// the ceiling and the squared speed under constant deceleration. The fastest is the lowest of the
/// three; where two of them cross, the acceleration changes.
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
    // Under constant acceleration the mean speed is that of the ends.
    let time_s = |pair: &[f64]| 2.0 * (pair[1] - pair[0]) / (speed_at(pair[0]) + speed_at(pair[1]));
    let times_s = places.windows(2).filter(|pair| pair[1] > pair[0]).map(time_s);
    times_s.fold(0.0, |sum, time_s| sum + time_s)
}

/// The shortest time to turn on the spot, from rest to rest \[s\].
fn turning_time_s(turn_rad: f64, limits: &Limits) -> f64 {
    let (up, down) = (limits.angular_acceleration_radps2, limits.angular_deceleration_radps2);
    // The turn rate at which speeding up and slowing down make up the whole turn.
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
