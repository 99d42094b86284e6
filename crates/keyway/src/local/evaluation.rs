//! The evaluation of candidates \[You2021, eq. (9), (10)\]: each term divided by its sum over all
//! candidates, then weighted.

use super::{Share, Shares};
use crate::geometry::Velocity;
use std::borrow::Cow;

/// An admissible candidate with the raw values of its terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<const TERMS: usize> {
    pub(super) velocity: Velocity,
    pub(super) raw: [f64; TERMS],
}

/// Names and weights of the terms, in the order of [`Candidate::raw`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighing<const TERMS: usize> {
    pub(super) names: [&'static str; TERMS],
    pub(super) weights: [f64; TERMS],
}

/// The best candidate and its score, and that of the second best.
#[derive(Clone, Debug)]
pub(super) struct Ranking {
    pub(super) command: Velocity,
    pub(super) chosen: Shares,
    pub(super) runner_up: Option<Shares>,
}

impl<const TERMS: usize> Weighing<TERMS> {
    /// Ranks the candidates; ties go to the earlier one. `None` when there is none.
    ///
    /// A term whose sum over the candidates is 0 contributes 0.
    pub(super) fn rank(&self, candidates: &[Candidate<TERMS>]) -> Option<Ranking> {
        let mut sums = [0.0; TERMS];
        for candidate in candidates {
            for (sum, raw) in sums.iter_mut().zip(candidate.raw) {
                *sum += raw;
            }
        }
        let mut best: Option<(usize, f64)> = None;
        let mut second: Option<(usize, f64)> = None;
        for (index, candidate) in candidates.iter().enumerate() {
            let total: f64 = self.weighted(candidate, &sums).iter().sum();
            if best.is_none_or(|(_, top)| total > top) {
                (best, second) = (Some((index, total)), best);
            } else if second.is_none_or(|(_, next)| total > next) {
                second = Some((index, total));
            }
        }
        let shares = |(index, _): (usize, f64)| self.shares(&candidates[index], &sums);
        best.map(|best| Ranking {
            command: candidates[best.0].velocity,
            chosen: shares(best),
            runner_up: second.map(shares),
        })
    }

    fn weighted(&self, candidate: &Candidate<TERMS>, sums: &[f64; TERMS]) -> [f64; TERMS] {
        std::array::from_fn(|i| {
            if sums[i] > 0.0 { self.weights[i] * candidate.raw[i] / sums[i] } else { 0.0 }
        })
    }

    fn shares(&self, candidate: &Candidate<TERMS>, sums: &[f64; TERMS]) -> Shares {
        let weighted = self.weighted(candidate, sums);
        let share = |i: usize| Share {
            term: Cow::Borrowed(self.names[i]),
            raw: candidate.raw[i],
            weighted: weighted[i],
        };
        (0..TERMS).map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_9_and_10_by_hand() {
        let weighing =
            Weighing { names: ["heading", "distance", "speed"], weights: [0.08, 0.2, 0.1] };
        let candidate = |v, raw| Candidate { velocity: Velocity::new(v, 0.0), raw };
        let candidates = [candidate(0.1, [3.0, 1.0, 0.0]), candidate(0.2, [1.0, 4.0, 0.0])];
        let Ranking { command, chosen, runner_up } = weighing.rank(&candidates).unwrap();
        // Heading 3/4 and 1/4, distance 1/5 and 4/5; the speeds' sum is 0, so they add nothing.
        // 0.08 * 0.25 + 0.2 * 0.8 = 0.18 beats 0.08 * 0.75 + 0.2 * 0.2 = 0.10.
        assert_eq!(command.v, 0.2);
        assert!((chosen.total() - 0.18).abs() < 1e-12);
        let (distance, speed) = (chosen.term("distance").unwrap(), chosen.term("speed").unwrap());
        assert_eq!((distance.raw, speed.weighted), (4.0, 0.0));
        assert!((distance.weighted - 0.16).abs() < 1e-12);
        assert!((runner_up.unwrap().total() - 0.10).abs() < 1e-12);
        assert!(weighing.rank(&[]).is_none());
        // Of equals the first.
        let twice = [candidate(0.3, [1.0, 1.0, 1.0]), candidate(0.4, [1.0, 1.0, 1.0])];
        assert_eq!(weighing.rank(&twice).unwrap().command.v, 0.3);
    }
}
