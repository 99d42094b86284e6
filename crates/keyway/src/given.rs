//! Numbers in error messages.

use std::fmt::{Display, Formatter, Result};

/// A number that was given, in few digits whatever its size: `0.1`, `-1`, `1e308`.
pub(crate) struct Given(pub(crate) f64);

impl Display for Given {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let size = self.0.abs();
        let is_short = size == 0.0 || !size.is_finite() || (1e-6..1e12).contains(&size);
        if is_short { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
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
}
