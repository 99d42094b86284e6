//! A smooth periodic motion through positions at given times.
//!
//! # Source
//! The moving obstacles of `DynaBARN` \[Nair2022\] are repeating animations of the Gazebo
//! simulator. Gazebo's `PoseAnimation` moves a model through key frames along a cardinal spline of
//! tension 0 \[Catmull1974\], which is transcribed here.
//!
//! | symbol | here |
//! |---|---|
//! | `p_i`, `t_i`: position and time of key frame `i`, of `0 .. n` | [`KeyFrame`] |
//! | `m_i`: tangent there | [`tangent`] |
//! | `u`: part of a segment, from 0 to 1 | `part` |
//!
//! Between two key frames the position is the cubic polynomial of
//! `u = (t - t_i) / (t_{i+1} - t_i)` with the positions `p_i`, `p_{i+1}` and the derivatives with
//! respect to `u`, `m_i` and `m_{i+1}`, at its ends:
//!
//! 1. `m_i = (p_{i+1} - p_{i-1}) / 2` at inner key frames,
//! 2. `m_0 = (p_1 - p_0) / 2` and `m_{n-1} = (p_{n-1} - p_{n-2}) / 2` at the ends,
//! 3. `m_0 = m_{n-1} = (p_1 - p_{n-2}) / 2` if the last position is the first one.
//!
//! The tangents do not depend on the times. So a segment has the velocity `m_i / (t_{i+1} - t_i)`
//! at its beginning and `m_{i+1} / (t_{i+1} - t_i)` at its end. At a key frame the direction is
//! continuous; the speed is continuous if the adjacent segments have equal durations.
//!
//! If two key frames are close in time and their neighbours are far away, the tangents are much
//! longer than the distance between the two: the obstacle darts out and back. Some obstacles of
//! `DynaBARN` do so, one at more than 70 m/s for 0.03 s.
//!
//! The velocity of a segment is a Bézier curve of degree 2, and so is the velocity of any part of
//! it. It stays within the triangle of its three control points, so the control point farthest
//! from 0 bounds the speed.
//!
//! # Cost
//! A position costs a binary search. A speed bound costs two, and a few operations per segment
//! between them.

use super::key_frames::{KeyFrame, unless_in_order};
use super::unless_faster;
use keyway::ConfigError;
use keyway::geometry::{Cubic, Point};

/// A smooth motion through key frames, repeated. After `duration_s` the obstacle jumps back to
/// the first position, unless the last position is the same. It is stationary at the last
/// position until then, and at the first position before the time of the first key frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    frames: Vec<KeyFrame>,
    duration_s: f64,
    /// Segments from each key frame to the next.
    stretches: Vec<Stretch>,
}

/// Segment from one key frame to the next.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    from_s: f64,
    to_s: f64,
    curve: Cubic,
}

impl Spline {
    /// Shortest lap \[s\].
    pub const SHORTEST_S: f64 = 0.1;

    /// Highest speed of a control point of the velocity \[m/s\]. It is higher than for other
    /// motions: if two key frames are much closer in time than the distance of their neighbours
    /// suggests, the curve darts to and fro between them.
    pub const FASTEST_MPS: f64 = 1000.0;

    /// A motion through these key frames that repeats every `duration_s`.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two key frames, a number is not finite, the first
    /// time is before 0, times do not increase, `duration_s` is less than the last time or than
    /// [`Self::SHORTEST_S`], or a control point of the velocity is faster than
    /// [`Self::FASTEST_MPS`]. Error paths begin with `spline` or `duration_s`.
    pub fn new(frames: Vec<KeyFrame>, duration_s: f64) -> Result<Self, ConfigError> {
        unless_in_order("spline", &frames, 2)?;
        let (first_s, last_s) = (frames[0].t_s, frames[frames.len() - 1].t_s);
        ConfigError::unless_not_negative("spline[0].t_s", first_s)?;
        let least_s = last_s.max(Self::SHORTEST_S);
        if !(duration_s >= least_s && duration_s.is_finite()) {
            let expected = format!(
                "at least {} s, and not less than the last time, {last_s} s",
                Self::SHORTEST_S
            );
            return Err(ConfigError::must_be("duration_s", &expected, duration_s));
        }
        let stretches: Vec<Stretch> =
            (0..frames.len() - 1).map(|i| Stretch::between(&frames, i)).collect();
        for (i, stretch) in stretches.iter().enumerate() {
            for velocity_mps in stretch.velocities_mps() {
                let path = format!("spline[{}]", i + 1);
                unless_faster(&path, velocity_mps.norm(), Self::FASTEST_MPS)?;
            }
        }
        Ok(Self { frames, duration_s, stretches })
    }

    /// Key frames of a lap, in the order of their times.
    pub fn frames(&self) -> &[KeyFrame] {
        &self.frames
    }

    /// Duration of a lap \[s\].
    pub const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Position at a time \[m\]; at the end of a lap, the first position of the next lap.
    pub fn position(&self, t_s: f64) -> Point {
        let lap = self.lap(t_s);
        self.position_in_lap(t_s - self.start_s(lap))
    }

    /// Position just before a time \[m\]; at the end of a lap, the last position of the lap.
    pub(super) fn position_before(&self, t_s: f64) -> Point {
        let lap = self.lap(t_s);
        if lap > 0.0 && t_s == self.start_s(lap) {
            return self.last().position;
        }
        self.position_in_lap(t_s - self.start_s(lap))
    }

    /// Time of the first jump after a time \[s\].
    pub(super) fn next_jump_s(&self, t_s: f64) -> Option<f64> {
        let jump_s = self.start_s(self.lap(t_s) + 1.0);
        // At very large times consecutive laps cannot be distinguished.
        (self.jumps() && jump_s > t_s).then_some(jump_s)
    }

    /// Time of the last jump that is not after a time \[s\].
    pub(super) fn last_jump_s(&self, t_s: f64) -> Option<f64> {
        let lap = self.lap(t_s);
        (self.jumps() && lap > 0.0).then(|| self.start_s(lap))
    }

    /// Upper bound of the speed at any time from `from_s` to `to_s` \[m/s\]; at a key frame, of
    /// both sides.
    pub(super) fn speed_bound_mps(&self, from_s: f64, to_s: f64) -> f64 {
        let (first, last) = (self.lap(from_s), self.lap(to_s));
        let (from_s, to_s) = (from_s - self.start_s(first), to_s - self.start_s(last));
        if first == last {
            self.bound_in_lap(from_s, to_s)
        } else if last == first + 1.0 {
            let before_mps = self.bound_in_lap(from_s, self.duration_s);
            before_mps.max(self.bound_in_lap(0.0, to_s))
        } else {
            self.bound_in_lap(0.0, self.duration_s)
        }
    }

    fn last(&self) -> &KeyFrame {
        &self.frames[self.frames.len() - 1]
    }

    /// True if the end of a lap is not the beginning of the next.
    fn jumps(&self) -> bool {
        self.frames[0].position != self.last().position
    }

    /// Start time of a lap \[s\]. It alone decides the lap of a time, so a jump has one instant.
    fn start_s(&self, lap: f64) -> f64 {
        lap * self.duration_s
    }

    /// Lap of a time: a whole number from 0; a time before 0 belongs to the first lap.
    fn lap(&self, t_s: f64) -> f64 {
        let lap = (t_s / self.duration_s).floor();
        // The quotient is rounded, by less than 1.
        let lap = if self.start_s(lap) > t_s { lap - 1.0 } else { lap };
        let lap = if self.start_s(lap + 1.0) <= t_s { lap + 1.0 } else { lap };
        lap.max(0.0)
    }

    fn position_in_lap(&self, t_s: f64) -> Point {
        let after = self.frames.partition_point(|frame| frame.t_s <= t_s);
        if after == 0 {
            return self.frames[0].position;
        }
        self.stretches.get(after - 1).map_or(self.last().position, |stretch| stretch.position(t_s))
    }

    fn bound_in_lap(&self, from_s: f64, to_s: f64) -> f64 {
        let first = self.stretches.partition_point(|stretch| stretch.to_s < from_s);
        let touched = self.stretches[first..].iter().take_while(|stretch| stretch.from_s <= to_s);
        touched.map(|stretch| stretch.speed_bound_mps(from_s, to_s)).fold(0.0, f64::max)
    }
}

impl Stretch {
    /// Segment after key frame `i`, from the tangents at its ends.
    fn between(frames: &[KeyFrame], i: usize) -> Self {
        let (from, to) = (frames[i], frames[i + 1]);
        // The derivative of a cubic Bézier curve at an end is three times the leg of its control
        // polygon there.
        let [first, last] = [i, i + 1].map(|i| tangent(frames, i) * (1.0 / 3.0));
        let middle = to.position - from.position - first - last;
        let curve = Cubic { start: from.position, legs: [first, middle, last] };
        Self { from_s: from.t_s, to_s: to.t_s, curve }
    }

    fn part(&self, t_s: f64) -> f64 {
        ((t_s - self.from_s) / (self.to_s - self.from_s)).clamp(0.0, 1.0)
    }

    fn position(&self, t_s: f64) -> Point {
        self.curve.at(self.part(t_s))
    }

    /// Control points of the velocity \[m/s\].
    fn velocities_mps(&self) -> [Point; 3] {
        self.curve.legs.map(|leg| leg * (3.0 / (self.to_s - self.from_s)))
    }

    /// Upper bound of the speed between two times \[m/s\]; times outside the segment do not
    /// count.
    fn speed_bound_mps(&self, from_s: f64, to_s: f64) -> f64 {
        let (from, to) = (self.part(from_s), self.part(to_s));
        let [a, b, c] = self.velocities_mps();
        // Control points of the part in between.
        let control_at = |s: f64, t: f64| a.lerp(b, s).lerp(b.lerp(c, s), t);
        let control = [control_at(from, from), control_at(from, to), control_at(to, to)];
        control.map(Point::norm).into_iter().fold(0.0, f64::max)
    }
}

/// Derivative at a key frame with respect to the part of a segment \[m\]: equations 1 to 3.
fn tangent(frames: &[KeyFrame], i: usize) -> Point {
    let last = frames.len() - 1;
    let is_closed = frames[0].position == frames[last].position;
    let (before, after) = match i {
        0 if is_closed => (last - 1, 1),
        _ if i == last && is_closed => (last - 1, 1),
        _ => (i.saturating_sub(1), (i + 1).min(last)),
    };
    (frames[after].position - frames[before].position) * 0.5
}

#[cfg(test)]
mod tests;
