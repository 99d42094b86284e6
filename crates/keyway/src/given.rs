//! Numbers in error messages.

use std::fmt::{Display, Formatter, Result};

/// An input value, in few digits whatever its size: `0.1`, `-1`, `1e308`.
pub struct Given(pub f64);

impl Display for Given {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let size = self.0.abs();
        let is_short = size == 0.0 || !size.is_finite() || (1e-6..1e12).contains(&size);
        if is_short { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

/// A computed length \[m\]: rounded to the nearest micrometre, because further digits mean
/// nothing.
pub struct Computed(pub f64);

impl Display for Computed {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let rounded = (self.0 * 1e6).round() / 1e6;
        let is_usable = rounded.is_finite() && (rounded != 0.0 || self.0 == 0.0);
        Given(if is_usable { rounded } else { self.0 }).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let text = |number| Given(number).to_string();
        let short = [0.1, -1.0, 0.0, 1e308, -2.5e-300, f64::NAN, f64::NEG_INFINITY].map(text);
        assert_eq!(short, ["0.1", "-1", "0", "1e308", "-2.5e-300", "NaN", "-inf"]);
    }

    #[test]
    fn computed_lengths_end_at_a_micrometre() {
        let text = |length_m| Computed(length_m).to_string();
        let lengths = [0.1 + 0.2, 0.18, 0.149_644_660_940_672_63, -2.0, 0.0, 1e-9, 1e308];
        let expected = ["0.3", "0.18", "0.149645", "-2", "0", "1e-9", "1e308"];
        assert_eq!(lengths.map(text), expected);
    }
}
