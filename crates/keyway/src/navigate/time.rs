//! Times in whole microseconds.

use serde::{Deserialize, Serialize};

/// A time by the clock of the observations, in whole microseconds. Differences of times are thus
/// identical to the last bit for any epoch of the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "i64", into = "i64")]
pub(super) struct Time {
    micros: i64,
}

impl TryFrom<i64> for Time {
    type Error = &'static str;

    fn try_from(micros: i64) -> Result<Self, &'static str> {
        let is_usable = (micros as f64).abs() <= 2e6 * Self::FARTHEST_S;
        if is_usable { Ok(Self { micros }) } else { Err("the time is beyond the supported range") }
    }
}

impl From<Time> for i64 {
    fn from(time: Time) -> Self {
        time.micros
    }
}

impl Time {
    /// Largest absolute time \[s\]: up to it, a microsecond is larger than the rounding error of
    /// a stamp.
    pub(super) const FARTHEST_S: f64 = 4e9;

    /// The time of a stamp \[s\]; `None` for one that is not finite or absurdly far away.
    pub(super) fn of_stamp(stamp_s: f64) -> Option<Self> {
        let is_usable = stamp_s.abs() <= Self::FARTHEST_S;
        is_usable.then(|| Self { micros: to_micros(stamp_s) })
    }

    /// Time since an earlier one \[s\]; negative since a later one.
    pub(super) const fn since_s(self, earlier: Self) -> f64 {
        (self.micros - earlier.micros) as f64 / 1e6
    }

    /// The time that is later by this duration.
    pub(super) fn after_s(self, duration_s: f64) -> Self {
        Self { micros: self.micros + to_micros(duration_s) }
    }

    /// The time as a stamp \[s\].
    pub(super) const fn stamp_s(self) -> f64 {
        self.micros as f64 / 1e6
    }
}

/// Saturates; 0 for NaN.
fn to_micros(duration_s: f64) -> i64 {
    (duration_s * 1e6).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_does_not_depend_on_when_the_clock_began() {
        for began_s in [0.0, 1.7e9, -3.0] {
            let times = (0..1000).map(|cycle| Time::of_stamp(began_s + f64::from(cycle) * 0.1));
            let times: Vec<Time> = times.map(Option::unwrap).collect();
            let passed = |pair: &[Time]| pair[1].since_s(pair[0]);
            assert!(times.windows(2).map(passed).all(|passed_s| passed_s == 0.1), "{began_s}");
            assert_eq!(times[0].after_s(0.25).since_s(times[0]), 0.25);
            assert_eq!(times[0].since_s(times[5]), -0.5);
        }
        for absurd in [f64::NAN, f64::INFINITY, 1e10] {
            assert_eq!(Time::of_stamp(absurd), None);
        }
        assert_eq!(Time::of_stamp(12.25).unwrap().stamp_s(), 12.25);
    }
}
