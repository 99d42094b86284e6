//! The evaluation of candidates \[You2021, eq. (9), (10)\]: each term divided by its sum over all
//! candidates, then weighted.

use crate::geometry::Velocity;
use crate::local::{Share, Shares};
use std::borrow::Cow;

/// An admissible candidate with the values of its terms.
#[derive(Clone, Copy, Debug)]
pub(in crate::local) struct Candidate<const TERMS: usize> {
    pub(in crate::local) velocity: Velocity,
    pub(in crate::local) values: [TermValue; TERMS],
}

/// The value of a term for one candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermValue {
    /// Value in the term's own unit, at least 0.
    pub raw: f64,
    /// Factor of the term's weight for this candidate: usually 1.
    pub factor: f64,
}

/// A term of an evaluation, by its name in reports and its weight. Nav2 calls it a critic.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    name: &'static str,
    weight: f64,
    is_cost: bool,
}

/// The terms of an evaluation, in the order in which their values are given.
///
/// A candidate's score is the sum over the terms of weight times factor times raw value, each
/// divided by the sum of that term's raw values over all candidates \[You2021, eq. (10)\].
#[derive(Clone, Copy, Debug)]
pub struct Weighing<const TERMS: usize>(pub [Term; TERMS]);

/// The best candidate and its score, and that of the second best.
#[derive(Clone, Debug)]
pub(super) struct Ranking {
    pub(super) command: Velocity,
    pub(super) chosen: Shares,
    pub(super) runner_up: Option<Shares>,
}

impl TermValue {
    /// A value with the factor 1.
    pub const fn of(raw: f64) -> Self {
        Self { raw, factor: 1.0 }
    }
}

impl Term {
    /// A term of which more is better.
    pub const fn of(name: &'static str, weight: f64) -> Self {
        Self { name, weight, is_cost: false }
    }

    /// A term of which less is better: the difference to the largest value of all candidates
    /// counts.
    pub const fn cost(name: &'static str, weight: f64) -> Self {
        Self { name, weight, is_cost: true }
    }
}

/// Reference values for the raw values of a term.
#[derive(Clone, Copy, Default)]
struct Scale {
    sum: f64,
    largest: f64,
}

impl<const TERMS: usize> Weighing<TERMS> {
    /// Ranks the candidates, which are iterated over twice; ties go to the earlier one. `None` if
    /// there is none.
    ///
    /// A term whose sum over the candidates is 0 contributes 0.
    #[inline]
    pub(super) fn rank(
        &self,
        candidates: impl Iterator<Item = Candidate<TERMS>> + Clone,
    ) -> Option<Ranking> {
        let scales = self.scales(candidates.clone());
        let mut best: Option<(Candidate<TERMS>, f64)> = None;
        let mut second: Option<(Candidate<TERMS>, f64)> = None;
        candidates.for_each(|candidate| {
            let total: f64 = self.weighted(&candidate, &scales).iter().sum();
            if second.is_none_or(|(_, next)| total > next) {
                second = Some((candidate, total));
                if best.is_none_or(|(_, top)| total > top) {
                    std::mem::swap(&mut best, &mut second);
                }
            }
        });
        let shares = |(candidate, _)| self.shares(&candidate, &scales);
        best.map(|best| Ranking {
            command: best.0.velocity,
            chosen: shares(best),
            runner_up: second.map(shares),
        })
    }

    /// The shares of each candidate.
    pub(super) fn all_shares(&self, candidates: &[Candidate<TERMS>]) -> Vec<Shares> {
        let scales = self.scales(candidates.iter().copied());
        candidates.iter().map(|candidate| self.shares(candidate, &scales)).collect()
    }

    #[inline]
    fn scales(&self, candidates: impl Iterator<Item = Candidate<TERMS>>) -> [Scale; TERMS] {
        let mut scales = [Scale::default(); TERMS];
        let mut count = 0;
        candidates.for_each(|candidate| {
            count += 1;
            for (scale, value) in scales.iter_mut().zip(candidate.values) {
                scale.sum += value.raw;
                // A single instruction; the library's maximum takes eight.
                scale.largest = if value.raw > scale.largest { value.raw } else { scale.largest };
            }
        });
        for (scale, term) in scales.iter_mut().zip(&self.0) {
            if term.is_cost {
                // The sum of the differences to the largest.
                scale.sum = f64::from(count) * scale.largest - scale.sum;
            }
        }
        scales
    }

    fn weighted(&self, candidate: &Candidate<TERMS>, scales: &[Scale; TERMS]) -> [f64; TERMS] {
        std::array::from_fn(|i| {
            let (Term { weight, is_cost, .. }, TermValue { raw, factor }) =
                (self.0[i], candidate.values[i]);
            let Scale { sum, largest } = scales[i];
            let value = if is_cost { largest - raw } else { raw };
            if sum > 0.0 { weight * factor * value / sum } else { 0.0 }
        })
    }

    fn shares(&self, candidate: &Candidate<TERMS>, scales: &[Scale; TERMS]) -> Shares {
        let weighted = self.weighted(candidate, scales);
        let share = |i: usize| Share {
            term: Cow::Borrowed(self.0[i].name),
            raw: candidate.values[i].raw,
            weighted: weighted[i],
        };
        (0..TERMS).map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate<const TERMS: usize>(v: f64, raw: [f64; TERMS]) -> Candidate<TERMS> {
        Candidate { velocity: Velocity::new(v, 0.0), values: raw.map(TermValue::of) }
    }

    #[test]
    fn equations_9_and_10_by_hand() {
        let weighing = Weighing([
            Term::of("heading", 0.08),
            Term::of("distance", 0.2),
            Term::of("speed", 0.1),
        ]);
        let candidates = [candidate(0.1, [3.0, 1.0, 0.0]), candidate(0.2, [1.0, 4.0, 0.0])];
        let Ranking { command, chosen, runner_up } =
            weighing.rank(candidates.iter().copied()).unwrap();
        // Heading 3/4 and 1/4, distance 1/5 and 4/5; the speeds' sum is 0, so they add nothing.
        // 0.08 * 0.25 + 0.2 * 0.8 = 0.18 beats 0.08 * 0.75 + 0.2 * 0.2 = 0.10.
        assert_eq!(command.v, 0.2);
        assert!((chosen.total() - 0.18).abs() < 1e-12);
        let (distance, speed) = (chosen.term("distance").unwrap(), chosen.term("speed").unwrap());
        assert_eq!((distance.raw, speed.weighted), (4.0, 0.0));
        assert!((distance.weighted - 0.16).abs() < 1e-12);
        assert!((runner_up.unwrap().total() - 0.10).abs() < 1e-12);
        assert!(weighing.rank([].into_iter()).is_none());
        // Ties go to the first.
        let twice = [candidate(0.3, [1.0, 1.0, 1.0]), candidate(0.4, [1.0, 1.0, 1.0])];
        assert_eq!(weighing.rank(twice.into_iter()).unwrap().command.v, 0.3);
    }

    #[test]
    fn of_a_cost_less_is_better() {
        let weighing = Weighing([Term::cost("target-distance", 0.5)]);
        let candidates = [candidate(0.1, [4.0]), candidate(0.2, [1.0]), candidate(0.3, [2.0])];
        let Ranking { command, chosen, runner_up } =
            weighing.rank(candidates.iter().copied()).unwrap();
        // 0, 3 and 2 below the largest: 3/5 of the weight.
        assert_eq!((command.v, chosen.term("target-distance").unwrap().raw), (0.2, 1.0));
        assert!((chosen.total() - 0.3).abs() < 1e-12);
        assert!((runner_up.unwrap().total() - 0.2).abs() < 1e-12);
    }

    #[test]
    fn factors_multiply_what_is_normalised() {
        let weighing = Weighing([Term::of("heading", 1.0)]);
        let mut candidates = [candidate(0.1, [3.0]), candidate(0.2, [1.0])];
        candidates[1].values[0].factor = 4.0;
        // 3/4, and four times 1/4.
        let Ranking { command, chosen, .. } = weighing.rank(candidates.iter().copied()).unwrap();
        assert_eq!((command.v, chosen.total()), (0.2, 1.0));
    }
}
