//! A value that changes linearly during a motion.

/// The values at the beginning and at the end of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) begin: f64,
    pub(crate) end: f64,
}

impl Line {
    pub(crate) const fn level(value: f64) -> Self {
        Self { begin: value, end: value }
    }

    /// Value at a fraction of the motion.
    pub(crate) fn at(self, fraction: f64) -> f64 {
        self.begin + (self.end - self.begin) * fraction
    }

    /// The line restricted to the part between two fractions.
    pub(crate) fn between(self, [from, to]: [f64; 2]) -> Self {
        Self { begin: self.at(from), end: self.at(to) }
    }

    pub(crate) fn least(self) -> f64 {
        if self.begin < self.end { self.begin } else { self.end }
    }

    pub(crate) fn most(self) -> f64 {
        if self.begin > self.end { self.begin } else { self.end }
    }

    pub(crate) fn middle(self) -> f64 {
        0.5 * (self.begin + self.end)
    }

    /// A line that is nowhere above either of two lines.
    pub(crate) fn below(self, other: Self) -> Self {
        Self { begin: self.begin.min(other.begin), end: self.end.min(other.end) }
    }
}
