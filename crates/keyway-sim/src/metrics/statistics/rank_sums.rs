//! Sums of ranks with random signs \[Wilcoxon1945\].
//!
//! If neither of two methods is better, every difference is equally likely to be positive or
//! negative. So the sum of the positive ranks contains each rank with probability 1/2.
//!
//! Ranks are doubled because tied ranks are multiples of one half. The probabilities are built rank
//! by rank as sums of positive numbers, so hardly any precision is lost.
//!
//! # Errors / cost
//! At most 2^n sums for n ranks, and no more than the largest sum; the ranks 1 to 50 take 60,000
//! additions.

/// Distribution of a sum of doubled ranks.
pub(super) struct RankSums {
    /// Each sum and its probability, ascending.
    sums: Vec<(u64, f64)>,
}

impl RankSums {
    pub(super) fn of(doubled_ranks: impl IntoIterator<Item = u64>) -> Self {
        let mut sums = vec![(0, 1.0)];
        for rank in doubled_ranks {
            sums = with_rank(&sums, rank);
        }
        Self { sums }
    }

    /// Returns the probability of this sum or less.
    pub(super) fn at_most(&self, sum: u64) -> f64 {
        let small = self.sums.iter().take_while(|(one, _)| *one <= sum);
        small.map(|(_, probability)| probability).sum()
    }
}

/// Sums without and with the rank, each half as probable as before; equal sums are merged.
fn with_rank(sums: &[(u64, f64)], rank: u64) -> Vec<(u64, f64)> {
    let mut merged: Vec<(u64, f64)> = Vec::with_capacity(2 * sums.len());
    let mut left = sums.iter().map(|&(sum, probability)| (sum, 0.5 * probability)).peekable();
    let mut taken =
        sums.iter().map(|&(sum, probability)| (sum + rank, 0.5 * probability)).peekable();
    loop {
        let next = match (left.peek(), taken.peek()) {
            (Some(a), Some(b)) if a.0 <= b.0 => left.next(),
            (Some(_), None) => left.next(),
            _ => taken.next(),
        };
        let Some((sum, probability)) = next else { return merged };
        match merged.last_mut() {
            Some(last) if last.0 == sum => last.1 += probability,
            _ => merged.push((sum, probability)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The largest sums with a probability of at most 2.5 %, as tabulated in textbooks
    /// (\[Hollander1999\], table A.4).
    #[test]
    fn published_critical_values() {
        let table =
            [(6, 0), (8, 3), (10, 8), (12, 13), (15, 25), (20, 52), (25, 89), (30, 137), (50, 434)];
        for (n, critical) in table {
            let sums = RankSums::of((1..=n).map(|rank| 2 * rank));
            assert!(sums.at_most(2 * critical) <= 0.025, "{n}");
            assert!(sums.at_most(2 * (critical + 1)) > 0.025, "{n}");
        }
    }

    #[test]
    fn without_ranks_the_sum_is_0() {
        assert_eq!(RankSums::of([]).at_most(0), 1.0);
    }

    proptest! {
        /// Compares with all choices of signs.
        #[test]
        fn all_signs(ranks in prop::collection::vec(1u64..12, 0..11), sum in 0u64..80) {
            let sums = RankSums::of(ranks.iter().copied());
            let sum_of = |signs: &u32| -> u64 {
                let chosen = ranks.iter().enumerate().filter(|(i, _)| signs >> i & 1 == 1);
                chosen.map(|(_, rank)| rank).sum()
            };
            let all = 1u32 << ranks.len();
            let small = (0..all).filter(|signs| sum_of(signs) <= sum).count();
            prop_assert_eq!(sums.at_most(sum), small as f64 / f64::from(all));
        }
    }
}
