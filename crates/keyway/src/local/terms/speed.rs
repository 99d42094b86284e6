//! vel(v, omega) of \[You2021, eq. (9)\]: the candidate's speed.

use crate::geometry::Velocity;

pub(in crate::local) const NAME: &str = "speed";

/// Magnitude of the speed \[m/s\].
pub(in crate::local) const fn raw(candidate: Velocity) -> f64 {
    candidate.v.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backwards_counts_as_forwards() {
        assert_eq!(raw(Velocity::new(-0.5, 1.0)), 0.5);
    }
}
