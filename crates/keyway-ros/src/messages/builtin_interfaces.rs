//! `builtin_interfaces`.

use serde::{Deserialize, Serialize};

/// A time since 1970, or since the start of a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Time {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
}

impl Time {
    /// The nearest representable time.
    pub(crate) fn of(stamp_s: f64) -> Self {
        let (sec, nanosec) = split(stamp_s);
        Self { sec, nanosec }
    }

    /// The time in seconds, accurate to a quarter of a microsecond in this century.
    pub(crate) fn stamp_s(self) -> f64 {
        f64::from(self.sec) + 1e-9 * f64::from(self.nanosec)
    }
}

/// A time difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Duration {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
}

impl Duration {
    /// The nearest representable duration.
    pub(crate) fn of(duration_s: f64) -> Self {
        let (sec, nanosec) = split(duration_s);
        Self { sec, nanosec }
    }

    /// The duration in seconds.
    pub(crate) fn duration_s(self) -> f64 {
        f64::from(self.sec) + 1e-9 * f64::from(self.nanosec)
    }
}

/// Whole seconds, and the remaining nanoseconds.
fn split(time_s: f64) -> (i32, u32) {
    let whole = time_s.floor();
    let nanosec = ((time_s - whole) * 1e9).round() as u32;
    if nanosec >= 1_000_000_000 { (whole as i32 + 1, 0) } else { (whole as i32, nanosec) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_are_those_of_ros() {
        assert_eq!(Time::of(1.25), Time { sec: 1, nanosec: 250_000_000 });
        assert_eq!(Time::of(-0.25), Time { sec: -1, nanosec: 750_000_000 });
        assert_eq!(Time::of(2.999_999_999_9), Time { sec: 3, nanosec: 0 });
        let before = Duration { sec: -1, nanosec: 750_000_000 };
        assert_eq!((Duration::of(-0.25), before.duration_s()), (before, -0.25));
        let now = Time { sec: 1_800_000_000, nanosec: 123_456_789 };
        assert!((Time::of(now.stamp_s()).nanosec).abs_diff(now.nanosec) < 250);
    }
}
