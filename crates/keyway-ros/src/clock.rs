//! The clock of the node: system time, or simulated time.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// A clock that may be set, or simulated.
pub(crate) struct Clock {
    /// The last simulated time \[s\], once it was received; unused with system time.
    simulated_s: Option<f64>,
    is_simulated: bool,
    /// The last reading of the system time: by the monotonic clock, and by the clock that may be
    /// set \[s\].
    looked: Option<(Instant, f64)>,
    was_set: bool,
    /// Time of the last cycle in a simulation \[s\].
    cycle_s: Option<f64>,
}

impl Clock {
    /// The system clock is corrected continuously; a larger step than this is a jump \[s\].
    const JUMP_S: f64 = 0.5;

    pub(crate) const fn new(is_simulated: bool) -> Self {
        Self { simulated_s: None, is_simulated, looked: None, was_set: false, cycle_s: None }
    }

    /// Receives a simulated time \[s\].
    pub(crate) fn tell(&mut self, now_s: f64) {
        if self.simulated_s.is_some_and(|before_s| now_s < before_s) {
            (self.was_set, self.cycle_s) = (true, None);
        }
        self.simulated_s = Some(now_s);
    }

    /// The current time \[s\]; `None` before the first simulated time.
    pub(crate) fn now_s(&mut self) -> Option<f64> {
        if self.is_simulated {
            return self.simulated_s;
        }
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Some(self.look(Instant::now(), since.as_secs_f64()))
    }

    /// Records the system time of both clocks \[s\] and detects jumps.
    fn look(&mut self, steady: Instant, now_s: f64) -> f64 {
        if let Some((before, before_s)) = self.looked.replace((steady, now_s)) {
            let passed_s = steady.duration_since(before).as_secs_f64();
            self.was_set |= (now_s - before_s - passed_s).abs() > Self::JUMP_S;
        }
        now_s
    }

    /// True if the clock was set since the last call.
    pub(crate) fn take_restart(&mut self) -> bool {
        let _ = self.now_s();
        std::mem::take(&mut self.was_set)
    }

    /// The time of the next cycle \[s\]; `None` if it is not due yet in a simulation.
    pub(crate) fn next_cycle_s(&mut self, period_s: f64) -> Option<f64> {
        let now_s = self.now_s()?;
        if !self.is_simulated {
            return Some(now_s);
        }
        // Simulated time may arrive in steps of one cycle, up to rounding.
        let is_due = self.cycle_s.is_none_or(|last_s| now_s >= last_s + 0.99 * period_s);
        is_due.then(|| {
            self.cycle_s = Some(now_s);
            now_s
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_simulation_decides_when_cycles_are() {
        let mut clock = Clock::new(true);
        assert_eq!((clock.now_s(), clock.next_cycle_s(0.1)), (None, None));
        let mut cycles = Vec::new();
        for tick in 0..8 {
            clock.tell(0.05 * f64::from(tick));
            cycles.extend(clock.next_cycle_s(0.1).map(|_| tick));
        }
        assert_eq!(cycles, [0, 2, 4, 6]);
        assert!(!clock.take_restart());
        clock.tell(0.0);
        assert!(clock.take_restart() && !clock.take_restart());
        assert_eq!(clock.next_cycle_s(0.1), Some(0.0));
    }

    #[test]
    fn a_clock_that_is_set_is_noticed() {
        let mut clock = Clock::new(false);
        let begin = Instant::now();
        clock.look(begin, 1000.0);
        clock.look(begin + Duration::from_secs(3), 1003.2);
        assert!(!clock.was_set);
        clock.look(begin + Duration::from_secs(4), 1001.0);
        assert!(clock.was_set);
    }
}
