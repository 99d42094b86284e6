//! A random walk.

use super::key_frames::{KeyFrame, KeyFrames};
use super::{unless_finite, unless_usable_speed};
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// Parameters of a [`RandomWalk`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomWalkConfig {
    /// Position at time 0 \[m\].
    pub position: Point,
    /// Lower left and upper right corner of the rectangle that contains the centre \[m\].
    pub area: [Point; 2],
    /// Lowest and highest speed \[m/s\].
    pub speed_mps: [f64; 2],
    /// Shortest and longest duration of a leg \[s\].
    pub leg_s: [f64; 2],
    /// Seed of all choices; `None`: the seed of the scene, or 0 without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

/// A random walk in a rectangle, determined by a seed: straight for a while, then straight in
/// another direction at another speed. The obstacle is reflected when its centre reaches a side
/// of the rectangle.
///
/// Directions are uniformly distributed, and so are speeds and durations within their bounds.
/// After [`RandomWalkConfig::LEGS`] legs the choices repeat, but lead to other positions. The
/// obstacle is stationary before time 0.
///
/// ```
/// use keyway::geometry::Point;
/// use keyway_sim::sim::{RandomWalk, RandomWalkConfig};
///
/// let area = [Point::new(0.0, 0.0), Point::new(4.0, 3.0)];
/// let config = RandomWalkConfig {
///     position: Point::new(1.0, 1.0),
///     area,
///     speed_mps: [0.5, 1.0],
///     leg_s: [1.0, 5.0],
///     seed: Some(7),
/// };
/// let at = RandomWalk::new(config.clone())?.position(3600.0);
/// assert!((0.0..=4.0).contains(&at.x) && (0.0..=3.0).contains(&at.y));
/// assert_eq!(at, RandomWalk::new(config)?.position(3600.0));
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RandomWalk {
    config: RandomWalkConfig,
    /// One round of choices on an unbounded plane.
    unbounded: KeyFrames,
}

impl RandomWalkConfig {
    /// Number of legs until the choices repeat.
    pub const LEGS: usize = 1000;
    /// Shortest leg \[s\].
    pub const SHORTEST_LEG_S: f64 = 0.1;
    /// Longest leg \[s\].
    pub const LONGEST_LEG_S: f64 = 3600.0;

    /// Checks every value. Error paths name the field.
    fn validate(&self) -> Result<(), ConfigError> {
        let Self { position, area: [low, high], speed_mps, leg_s, .. } = self;
        unless_finite("position", *position)?;
        unless_finite("area[0]", *low)?;
        unless_finite("area[1]", *high)?;
        for (axis, at, low, high) in
            [(0, position.x, low.x, high.x), (1, position.y, low.y, high.y)]
        {
            if !(low < high && (high - low).is_finite()) {
                let more = format!("more than that of the other corner, {low}");
                return Err(ConfigError::must_be(format!("area[1][{axis}]"), &more, high));
            }
            if !(low..=high).contains(&at) {
                let within = format!("within the area, from {low} to {high}");
                return Err(ConfigError::must_be(format!("position[{axis}]"), &within, at));
            }
        }
        ConfigError::unless_not_negative("speed_mps[0]", speed_mps[0])?;
        unless_usable_speed("speed_mps[1]", speed_mps[1])?;
        ConfigError::unless_ordered("speed_mps", *speed_mps)?;
        for (i, value) in leg_s.iter().enumerate() {
            let (least, most) = (Self::SHORTEST_LEG_S, Self::LONGEST_LEG_S);
            if !(least..=most).contains(value) {
                let expected = format!("from {least} to {most} s");
                return Err(ConfigError::must_be(format!("leg_s[{i}]"), &expected, *value));
            }
        }
        ConfigError::unless_ordered("leg_s", *leg_s)
    }
}

impl RandomWalk {
    /// Creates the walk with these parameters.
    ///
    /// # Errors
    /// Returns an error if a value is invalid. Error paths name the field.
    pub fn new(config: RandomWalkConfig) -> Result<Self, ConfigError> {
        config.validate()?;
        let mut random = Random::new(config.seed.unwrap_or_default());
        let mut at = KeyFrame { t_s: 0.0, position: Point::default() };
        let mut frames = vec![at];
        for _ in 0..RandomWalkConfig::LEGS {
            let (sin, cos) = libm::sincos(random.between([0.0, std::f64::consts::TAU]));
            let speed_mps = random.between(config.speed_mps);
            let leg_s = random.between(config.leg_s);
            let position = at.position + Point::new(cos, sin) * (speed_mps * leg_s);
            at = KeyFrame { t_s: at.t_s + leg_s, position };
            frames.push(at);
        }
        Ok(Self { config, unbounded: KeyFrames::in_order(frames) })
    }

    /// Parameters of the walk.
    pub const fn config(&self) -> &RandomWalkConfig {
        &self.config
    }

    /// Position at a time \[m\]. Costs a binary search.
    pub fn position(&self, t_s: f64) -> Point {
        let (round, t_s) = self.round(t_s);
        let gone = self.last().position * round + self.unbounded.position(t_s);
        let RandomWalkConfig { position, area: [low, high], .. } = self.config;
        let at = position + gone;
        Point::new(reflected(at.x, low.x, high.x), reflected(at.y, low.y, high.y))
    }

    /// Highest speed at any time from `from_s` to `to_s` \[m/s\]; at a change, the higher of both
    /// sides.
    pub(super) fn speed_bound_mps(&self, from_s: f64, to_s: f64) -> f64 {
        let ((first, from_s), (last, to_s)) = (self.round(from_s), self.round(to_s));
        let bound = |from_s, to_s| self.unbounded.speed_bound_mps(from_s, to_s);
        if first == last {
            bound(from_s, to_s)
        } else {
            let whole_mps = if last > first + 1.0 { bound(0.0, self.last().t_s) } else { 0.0 };
            bound(from_s, self.last().t_s).max(bound(0.0, to_s)).max(whole_mps)
        }
    }

    fn last(&self) -> KeyFrame {
        let frames = self.unbounded.frames();
        frames[frames.len() - 1]
    }

    /// Round of choices at a time, from 0, and the time since its beginning \[s\].
    fn round(&self, t_s: f64) -> (f64, f64) {
        let round_s = self.last().t_s;
        let round = (t_s / round_s).floor().max(0.0);
        (round, (t_s - round * round_s).min(round_s))
    }
}

/// Returns a coordinate, reflected by two mirrors.
fn reflected(at: f64, low: f64, high: f64) -> f64 {
    let width = high - low;
    let gone = (at - low).rem_euclid(2.0 * width);
    (low + if gone > width { 2.0 * width - gone } else { gone }).clamp(low, high)
}

#[cfg(test)]
mod tests;
