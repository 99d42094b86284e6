//! Exact costs of 8-connected paths.

use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::f64::consts::SQRT_2;
use std::ops::Add;

/// The cost of a path: its numbers of straight and diagonal steps, without rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Cost {
    /// Steps to one of the four side neighbours, each of length 1.
    pub straight: u64,
    /// Steps to one of the four corner neighbours, each of length sqrt(2).
    pub diagonal: u64,
}

impl Cost {
    /// Keys of a straight and a diagonal step in fixed point: neighbouring Pell numbers, whose
    /// ratio is the best approximation of sqrt(2) by fractions with denominators up to the larger
    /// one.
    ///
    /// Two costs that differ by (a, b) steps are ordered by a + b sqrt(2), their keys by a q + b p
    /// with p / q = `KEY_DIAGONAL` / `KEY_STRAIGHT`. Both have the same sign as long as |b| < q: a
    /// fraction -a / b between p / q and sqrt(2) would have a denominator of at least q. So **keys
    /// order exactly every pair of paths with fewer than 93,222,358 diagonal steps**. All shortest
    /// paths on maps of up to 13,600 x 13,600 cells are within this limit (a step into a penalised
    /// cell counts as many times as its penalty factor). Beyond it, paths whose lengths differ by
    /// less than 1e-8 cells may be misordered.
    pub const KEY_STRAIGHT: u64 = 93_222_358;
    /// See [`Self::KEY_STRAIGHT`].
    pub const KEY_DIAGONAL: u64 = 131_836_323;

    /// A cost of `straight` straight and `diagonal` diagonal steps.
    pub const fn new(straight: u64, diagonal: u64) -> Self {
        Self { straight, diagonal }
    }

    /// The octile distance between two cells: the cost of a shortest path without obstacles.
    pub const fn octile(dx: u32, dy: u32) -> Self {
        let (long, short) = if dx > dy { (dx, dy) } else { (dy, dx) };
        Self { straight: (long - short) as u64, diagonal: short as u64 }
    }

    /// Length \[cells\].
    pub fn cells(self) -> f64 {
        self.straight as f64 + self.diagonal as f64 * SQRT_2
    }

    /// The order-preserving fixed-point value used by searches, see [`Self::KEY_STRAIGHT`].
    pub const fn key(self) -> u64 {
        self.straight * Self::KEY_STRAIGHT + self.diagonal * Self::KEY_DIAGONAL
    }
}

impl Add for Cost {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.straight + other.straight, self.diagonal + other.diagonal)
    }
}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The exact order of the lengths, by integer arithmetic.
impl Ord for Cost {
    fn cmp(&self, other: &Self) -> Ordering {
        let a = i128::from(self.straight) - i128::from(other.straight);
        let b = i128::from(self.diagonal) - i128::from(other.diagonal);
        // The sign of a + b sqrt(2): where the signs differ, compare a^2 with 2 b^2.
        match (a.signum(), b.signum()) {
            (s, 0) | (0, s) => s.cmp(&0),
            (s, t) if s == t => s.cmp(&0),
            (s, _) if a * a > 2 * b * b => s.cmp(&0),
            (_, t) => t.cmp(&0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn octile_distance_by_hand() {
        assert_eq!(Cost::octile(5, 3), Cost::new(2, 3));
        assert_eq!(Cost::octile(3, 5), Cost::new(2, 3));
        assert!((Cost::new(8, 15).cells() - 29.213).abs() < 1e-3);
    }

    #[test]
    fn keys_are_neighbouring_pell_numbers() {
        let (p, q) = (i128::from(Cost::KEY_DIAGONAL), i128::from(Cost::KEY_STRAIGHT));
        assert_eq!(p * p - 2 * q * q, 1);
    }

    #[test]
    fn close_costs_are_ordered() {
        // 99 / 70 is just above sqrt(2), 41 / 29 just below.
        assert!(Cost::new(99, 0) > Cost::new(0, 70));
        assert!(Cost::new(41, 0) < Cost::new(0, 29));
        assert!(Cost::new(54_608_393, 0) < Cost::new(0, 38_613_965));
        assert!(Cost::new(54_608_393, 0).key() < Cost::new(0, 38_613_965).key());
    }

    proptest! {
        #[test]
        fn keys_keep_the_exact_order(a in 0u64..90_000_000, b in 0u64..90_000_000,
                                     c in 0u64..90_000_000, d in 0u64..90_000_000) {
            let (left, right) = (Cost::new(a, b), Cost::new(c, d));
            prop_assert_eq!(left.cmp(&right), left.key().cmp(&right.key()));
            // The hardest case: the number of straight steps nearest to the same length.
            let near = Cost::new((left.cells() - d as f64 * SQRT_2).max(0.0).round() as u64, d);
            prop_assert_eq!(left.cmp(&near), left.key().cmp(&near.key()));
        }
    }
}
