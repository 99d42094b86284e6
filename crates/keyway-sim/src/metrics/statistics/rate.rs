//! A rate with Wilson's score interval \[Wilson1927\].
//!
//! # Source
//! \[Wilson1927\]; \[Newcombe1998\] compares it with others and recommends it. The limits of the
//! interval are the rates p that are z standard deviations away from the observed rate:
//! |p̂ - p| = z sqrt(p (1 - p) / n). The interval stays within 0 to 1. It is also correct for 0 of
//! n and n of n, for which the usual p̂ ± z sqrt(p̂ (1 - p̂) / n) has no width.
//!
//! | paper | here |
//! |---|---|
//! | n | successes and failures together |
//! | p̂ | [`Rate::share`] |
//! | z | [`Confidence`], as standard deviations of a normal distribution |
//!
//! # Errors / cost
//! `None` without trials. A few operations.

use super::confidence::{Confidence, Interval};
use serde::{Deserialize, Serialize};

/// Numbers of successes and failures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rate {
    /// Number of successes.
    pub successes: u64,
    /// Number of failures.
    pub failures: u64,
}

impl Rate {
    /// Returns the rate of these outcomes.
    pub fn of(outcomes: impl IntoIterator<Item = bool>) -> Self {
        let mut rate = Self::default();
        for is_success in outcomes {
            if is_success { rate.successes += 1 } else { rate.failures += 1 }
        }
        rate
    }

    /// Successes over trials; `None` without trials.
    pub fn share(&self) -> Option<f64> {
        let trials = self.trials();
        (trials > 0.0).then(|| self.successes as f64 / trials)
    }

    /// Wilson's score interval; `None` without trials.
    pub fn interval(&self, confidence: Confidence) -> Option<Interval> {
        let (share, n, z) = (self.share()?, self.trials(), confidence.normal_quantile());
        let scale = 1.0 + z * z / n;
        let middle = (share + z * z / (2.0 * n)) / scale;
        let variance = share * (1.0 - share) / n + z * z / (4.0 * n * n);
        let half = z * variance.sqrt() / scale;
        // If all trials had the same outcome, that limit is exact except for rounding.
        let low = if self.successes == 0 { 0.0 } else { (middle - half).max(0.0) };
        let high = if self.failures == 0 { 1.0 } else { (middle + half).min(1.0) };
        Some(Interval { low, high, confidence })
    }

    fn trials(&self) -> f64 {
        self.successes as f64 + self.failures as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(successes: u64, trials: u64, confidence: f64) -> [f64; 2] {
        let rate = Rate { successes, failures: trials - successes };
        let interval = rate.interval(Confidence::new(confidence).unwrap()).unwrap();
        [interval.low, interval.high]
    }

    /// Table I of \[Newcombe1998\], method 3.
    #[test]
    fn published_values() {
        for (successes, trials, published) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            let rounded = interval(successes, trials, 0.95).map(|end| (end * 1e4).round() / 1e4);
            assert_eq!(rounded, published, "{successes} of {trials}");
        }
    }

    /// Checks the limits against their defining equation, solved by bisection.
    #[test]
    fn the_ends_are_as_far_as_the_confidence_says() {
        for (successes, trials, confidence) in
            [(3, 10, 0.95), (0, 7, 0.9), (7, 7, 0.99), (499, 1000, 0.5), (1, 1, 0.95)]
        {
            let (n, z) = (trials as f64, Confidence::new(confidence).unwrap().normal_quantile());
            let share = successes as f64 / n;
            let is_beyond = |p: f64| (share - p).abs() > z * (p * (1.0 - p) / n).sqrt();
            let end = |mut beyond: f64, mut within: f64| {
                for _ in 0..60 {
                    let middle = 0.5 * (beyond + within);
                    if is_beyond(middle) { beyond = middle } else { within = middle }
                }
                within
            };
            let [low, high] = interval(successes, trials, confidence);
            assert!((low - end(0.0, share)).abs() < 1e-9, "{successes} of {trials}: {low}");
            assert!((high - end(1.0, share)).abs() < 1e-9, "{successes} of {trials}: {high}");
        }
    }

    #[test]
    fn nothing_everything_and_no_trials() {
        let z = Confidence::USUAL.normal_quantile();
        for n in [1, 20, 300] {
            let high = z * z / (n as f64 + z * z);
            let [zero, end] = interval(0, n, 0.95);
            assert!(zero == 0.0 && (end - high).abs() < 1e-12, "{end}");
            let [end, one] = interval(n, n, 0.95);
            assert!(one == 1.0 && (end - (1.0 - high)).abs() < 1e-12, "{end}");
        }
        let none = Rate::of([]);
        assert_eq!((none.share(), none.interval(Confidence::USUAL)), (None, None));
        let rate = Rate::of([true, false, true]);
        assert_eq!(rate, Rate { successes: 2, failures: 1 });
    }
}
