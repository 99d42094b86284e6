//! A motion given by positions and times.

use super::{unless_finite, unless_usable_speed};
use keyway::ConfigError;
use keyway::geometry::Point;
use serde::{Deserialize, Serialize};

/// Position of an obstacle at a time: `[t, x, y]` \[s, m, m\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "[f64; 3]"))]
pub struct KeyFrame {
    /// Time \[s\].
    pub t_s: f64,
    /// Position \[m\].
    pub position: Point,
}

/// A motion through key frames: in a straight line at constant speed from each to the next. The
/// obstacle is stationary before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyFrames {
    /// At least one, with increasing times.
    frames: Vec<KeyFrame>,
}

impl KeyFrames {
    /// Creates a motion through these positions at these times.
    ///
    /// # Errors
    /// Returns an error if there is no key frame, a number is not finite, times do not increase,
    /// or the speed between two key frames is higher than
    /// [`MovingObstacle::FASTEST_MPS`](super::MovingObstacle::FASTEST_MPS). Error paths begin
    /// with `key_frames`.
    pub fn new(frames: Vec<KeyFrame>) -> Result<Self, ConfigError> {
        unless_in_order("key_frames", &frames, 1)?;
        for (i, pair) in frames.windows(2).enumerate() {
            unless_usable_speed(&format!("key_frames[{}]", i + 1), speed_mps(pair))?;
        }
        Ok(Self { frames })
    }

    /// Creates a motion through key frames that are known to be valid.
    pub(in crate::sim) const fn in_order(frames: Vec<KeyFrame>) -> Self {
        Self { frames }
    }

    /// Adds a key frame that is later than the last.
    pub(super) fn push(&mut self, frame: KeyFrame) {
        self.frames.push(frame);
    }

    /// Key frames, in the order of their times.
    pub fn frames(&self) -> &[KeyFrame] {
        &self.frames
    }

    /// Position at a time \[m\]. Costs a binary search.
    pub fn position(&self, t_s: f64) -> Point {
        let after = self.frames.partition_point(|frame| frame.t_s <= t_s);
        match (self.frames[..after].last(), self.frames.get(after)) {
            (Some(from), Some(to)) => {
                from.position.lerp(to.position, (t_s - from.t_s) / (to.t_s - from.t_s))
            }
            (Some(only), None) | (None, Some(only)) => only.position,
            // There is at least one key frame.
            (None, None) => Point::default(),
        }
    }

    /// Highest speed at any time from `from_s` to `to_s` \[m/s\]; at a key frame, the higher of
    /// both sides.
    pub fn speed_bound_mps(&self, from_s: f64, to_s: f64) -> f64 {
        // From the segment that contains or ends at `from_s` to the one that contains or begins
        // at `to_s`.
        let first = self.frames.partition_point(|frame| frame.t_s < from_s).saturating_sub(1);
        let end = self.frames.partition_point(|frame| frame.t_s <= to_s) + 1;
        let stretch = &self.frames[first..end.min(self.frames.len())];
        stretch.windows(2).map(speed_mps).fold(0.0, f64::max)
    }
}

fn speed_mps(pair: &[KeyFrame]) -> f64 {
    pair[0].position.distance(pair[1].position) / (pair[1].t_s - pair[0].t_s)
}

/// Returns an error for fewer than `least` key frames, numbers that are not finite, and times that
/// do not increase.
pub(super) fn unless_in_order(
    path: &str,
    frames: &[KeyFrame],
    least: usize,
) -> Result<(), ConfigError> {
    if frames.len() < least {
        let expected =
            format!("must hold at least {least} key frame{}", if least > 1 { "s" } else { "" });
        return Err(ConfigError::new(path, expected));
    }
    for (i, &KeyFrame { t_s, position }) in frames.iter().enumerate() {
        let path = format!("{path}[{i}]");
        if !t_s.is_finite() {
            return Err(ConfigError::must_be(path + ".t_s", "a finite time", t_s));
        }
        unless_finite(&(path + ".position"), position)?;
    }
    for (i, pair) in frames.windows(2).enumerate() {
        if pair[1].t_s <= pair[0].t_s {
            let later = format!("later than the one before it, at {} s", pair[0].t_s);
            return Err(ConfigError::must_be(
                format!("{path}[{}].t_s", i + 1),
                &later,
                pair[1].t_s,
            ));
        }
    }
    Ok(())
}

impl From<[f64; 3]> for KeyFrame {
    fn from([t_s, x, y]: [f64; 3]) -> Self {
        Self { t_s, position: Point::new(x, y) }
    }
}

impl From<KeyFrame> for [f64; 3] {
    fn from(KeyFrame { t_s, position }: KeyFrame) -> Self {
        [t_s, position.x, position.y]
    }
}
