//! Round numbers along an axis.

/// Tick values in a range, multiples of 1, 2, 2.5 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Distance between two ticks.
    pub step: f64,
    /// Number of decimals that writes every tick exactly.
    pub decimals: usize,
    /// The ticks within the range, ascending.
    pub values: Vec<f64>,
}

/// Returns the smallest and the largest finite value.
pub(crate) fn span(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let ends = values.into_iter().filter(|value| value.is_finite()).map(|value| (value, value));
    ends.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

/// Distances allowed between ticks, before the power of ten.
const MANTISSAS: [f64; 5] = [1.0, 2.0, 2.5, 5.0, 10.0];
/// Maximum number of ticks; more are a mistake.
const MAX_TICKS: f64 = 1000.0;
/// Maximum number of decimals of an axis label.
const MAX_DECIMALS: usize = 12;

/// Returns the smallest number of decimals that writes a step, which has at most two significant
/// digits.
fn decimals_of(step: f64) -> usize {
    let is_exact = |&decimals: &usize| {
        let scaled = step * 10f64.powi(decimals as i32);
        scaled.round() >= 1.0 && (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    (0..MAX_DECIMALS).find(is_exact).unwrap_or(MAX_DECIMALS)
}

impl Ticks {
    /// Creates the finest ticks in `low..=high` that make at most `max_intervals` intervals over
    /// the range. A range of length 0, or an invalid one, has at most one tick.
    pub fn new(low: f64, high: f64, max_intervals: usize) -> Self {
        let span = high - low;
        if !(span > 0.0 && span.is_finite()) {
            let values = if low.is_finite() { vec![low] } else { Vec::new() };
            return Self { step: 1.0, decimals: 0, values };
        }
        let rough = span / max_intervals.max(1) as f64;
        let power = 10f64.powi(rough.log10().floor() as i32);
        let fits = |mantissa: &f64| mantissa * power >= rough * (1.0 - 1e-9);
        let mantissa = MANTISSAS.into_iter().find(fits).unwrap_or(10.0);
        Self::with_step(low, high, mantissa * power)
    }

    /// Creates the multiples of a given step in `low..=high`; only the first number if the step
    /// is negligible compared with the numbers.
    pub fn with_step(low: f64, high: f64, step: f64) -> Self {
        let decimals = decimals_of(step);
        // Rounding must not lose a tick that lies exactly on an end.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let countable = last - first < MAX_TICKS && first.abs().max(last.abs()) < 1e12;
        if !countable {
            return Self { step, decimals, values: vec![low] };
        }
        let count = (last - first + 1.0).max(0.0) as usize;
        let values = (0..count).map(|i| (first + i as f64) * step).collect();
        Self { step, decimals, values }
    }

    /// Formats a tick, with a true minus sign.
    pub fn text(&self, value: f64) -> String {
        let text = format!("{value:.*}", self.decimals);
        let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
        if is_zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
    }

    /// Formats all ticks.
    pub fn texts(&self) -> Vec<String> {
        self.values.iter().map(|&value| self.text(value)).collect()
    }

    /// Rounds up to a multiple of the step.
    pub fn round_up(&self, value: f64) -> f64 {
        (value / self.step - 1e-9).ceil() * self.step
    }

    /// Rounds down to a multiple of the step.
    pub fn round_down(&self, value: f64) -> f64 {
        (value / self.step + 1e-9).floor() * self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn by_hand() {
        assert_eq!(Ticks::new(0.0, 10.0, 5).texts(), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(Ticks::new(-1.0, 1.0, 4).texts(), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(Ticks::new(0.0, 0.5, 5).texts(), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(Ticks::new(0.0, 10.0, 4).texts(), ["0.0", "2.5", "5.0", "7.5", "10.0"]);
        assert_eq!(Ticks::new(-7.3, 95.0, 5).texts(), ["0", "25", "50", "75"]);
        assert_eq!(Ticks::new(0.0, 0.9, 1).texts(), ["0"]);
        assert_eq!(Ticks::new(1990.0, 2010.0, 2).texts(), ["1990", "2000", "2010"]);
    }

    #[test]
    fn degenerate_ranges() {
        assert_eq!(Ticks::new(3.0, 3.0, 5).texts(), ["3"]);
        assert_eq!(Ticks::new(5.0, 3.0, 5).values, [5.0]);
        assert_eq!(Ticks::new(1e9, 1e9 + 1e-7, 5).values.len(), 1);
        assert!(Ticks::new(f64::NAN, 1.0, 5).values.is_empty());
        assert!(Ticks::new(0.0, 1.0, 0).values.len() <= 2);
        assert!(Ticks::new(0.0, f64::MAX, 5).values.len() <= 6);
        assert!(Ticks::new(0.0, f64::MIN_POSITIVE, 5).values.len() <= 6);
    }

    proptest! {
        #[test]
        fn few_round_and_inside(low in -1e4..1e4f64, span in 1e-3..1e5f64, n in 1usize..12) {
            let ticks = Ticks::new(low, low + span, n);
            prop_assert!(ticks.values.len() <= n + 1);
            // 1, 2, 2.5, 5: neighbouring steps are at most a factor 2 apart.
            prop_assert!(ticks.step < 2.0 * span / n as f64 * (1.0 + 1e-6));
            let slack = 1e-6 * ticks.step;
            for (value, text) in ticks.values.iter().zip(ticks.texts()) {
                prop_assert!(*value >= low - slack && *value <= low + span + slack);
                let back: f64 = text.replace('\u{2212}', "-").parse().unwrap();
                prop_assert!((back - value).abs() <= 1e-9 * (1.0 + value.abs()));
            }
        }
    }
}
