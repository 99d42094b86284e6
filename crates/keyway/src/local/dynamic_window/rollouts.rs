//! The rollouts of all candidates, in the order of the lattice: slowest speed first.
//!
//! Only two numbers are kept for each, because moving more of them takes longer than recomputing
//! them if nothing is near: the distance, and the alignment with the guide point. The pose of
//! that alignment follows from the turn rate's [`Judged`] and the speed, for the few callers that
//! need it.

use super::motion::Judged;
use super::rollout::Rollout;
use super::window::Lattice;
use crate::geometry::{Point, Velocity};
use crate::local::terms::heading;

/// The two distances of a candidate \[m\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Distances {
    /// Distance within which it must be able to stop, eq. (7).
    pub(super) stopping_m: f64,
    /// Distance in its evaluation.
    pub(super) evaluated_m: f64,
}

/// The rollouts of all candidates.
#[derive(Debug, Default)]
pub(super) struct Rollouts {
    /// [`Rollout::distance_m`], or [`Self::REFUSED`].
    distances_m: Vec<f64>,
    /// [`Distances::stopping_m`]; empty if it is the same.
    stopping_m: Vec<f64>,
    /// [`Rollout::heading`]; undefined for refused candidates.
    headings: Vec<f64>,
    /// For each turn rate, the poses at which its candidates are compared with the guide point.
    judged: Vec<Judged>,
    /// Memory for the headings of one turn rate.
    column: Vec<f64>,
}

impl Rollouts {
    /// Distance of a candidate that is refused; takes half the space of an `Option`.
    const REFUSED: f64 = f64::NEG_INFINITY;

    /// All candidates of a lattice at the same distance; turn rates are to be added.
    pub(super) fn reset(&mut self, lattice: &Lattice, distance_m: f64) {
        self.distances_m.clear();
        self.distances_m.resize(lattice.len(), distance_m);
        self.headings.resize(lattice.len(), 0.0);
        self.judged.clear();
    }

    /// Refuses all candidates of a lattice.
    pub(super) fn refuse_all(&mut self, lattice: &Lattice) {
        self.reset(lattice, Self::REFUSED);
        self.judged.resize(lattice.turn_rates_radps().len(), Judged::default());
    }

    /// Makes both distances the same from now on.
    pub(super) fn forget_stopping_distances(&mut self) {
        self.stopping_m.clear();
    }

    /// Keeps the distances of these rollouts as those of eq. (7), for the next ones.
    pub(super) fn keep_as_stopping_distances(&mut self) {
        std::mem::swap(&mut self.stopping_m, &mut self.distances_m);
    }

    /// Both distances of a candidate, given that of its evaluation.
    #[inline]
    pub(super) fn distances(&self, index: usize, evaluated_m: f64) -> Distances {
        let stopping_m = self.stopping_m.get(index).copied().unwrap_or(evaluated_m);
        Distances { stopping_m, evaluated_m }
    }

    /// Adds the poses at which the next turn rate's candidates are compared with the guide point.
    pub(super) fn push(&mut self, judged: Judged) {
        self.judged.push(judged);
    }

    /// Compares the candidates of the turn rate added last with the guide point, all speeds in one
    /// loop.
    pub(super) fn compare(&mut self, lattice: &Lattice, guide: Point) {
        let (speeds_mps, columns) = (lattice.speeds_mps(), lattice.turn_rates_radps().len());
        let column = self.judged.len() - 1;
        let judged = self.judged[column];
        self.column.resize(speeds_mps.len(), 0.0);
        for (heading, v_mps) in self.column.iter_mut().zip(speeds_mps) {
            *heading = heading::raw(judged.at(*v_mps), guide);
        }
        for (row, heading) in self.headings.chunks_exact_mut(columns).zip(&self.column) {
            row[column] = *heading;
        }
    }

    /// Sets the distance of a candidate with the turn rate added last; `None` refuses it.
    pub(super) fn set(&mut self, lattice: &Lattice, row: usize, distance_m: Option<f64>) {
        let index = row * lattice.turn_rates_radps().len() + self.judged.len() - 1;
        self.distances_m[index] = distance_m.unwrap_or(Self::REFUSED);
    }

    /// Number of candidates that are not refused, among the speeds that satisfy a condition.
    pub(super) fn count(&self, lattice: &Lattice, is_asked: impl Fn(f64) -> bool) -> u32 {
        let rows = self.distances_m.chunks_exact(lattice.turn_rates_radps().len().max(1));
        let asked = lattice.speeds_mps().iter().zip(rows).filter(|(v_mps, _)| is_asked(**v_mps));
        asked
            .flat_map(|(_, row)| row)
            .map(|&distance_m| u32::from(distance_m > Self::REFUSED))
            .sum()
    }

    /// Applies a rule to all candidates that are not refused. The rule returns the distance that
    /// counts; `None` refuses.
    pub(super) fn retain(
        &mut self,
        lattice: &Lattice,
        mut rule: impl FnMut(Velocity, Distances) -> Option<f64>,
    ) {
        for (index, velocity) in lattice.candidates().enumerate() {
            let distance_m = self.distances_m[index];
            if distance_m > Self::REFUSED {
                let distances_m = self.distances(index, distance_m);
                self.distances_m[index] = rule(velocity, distances_m).unwrap_or(Self::REFUSED);
            }
        }
    }

    /// All candidates, refused ones with `None`.
    #[inline]
    pub(super) fn all<'a>(
        &'a self,
        lattice: &'a Lattice,
    ) -> impl Iterator<Item = (Velocity, Option<Rollout>)> + Clone + 'a {
        let turn_rates = lattice.turn_rates_radps();
        let columns = turn_rates.len().max(1);
        let rows = self.distances_m.chunks_exact(columns).zip(self.headings.chunks_exact(columns));
        lattice.speeds_mps().iter().zip(rows).flat_map(move |(&v, (distances_m, headings))| {
            let values = distances_m.iter().zip(headings);
            let columns = turn_rates.iter().zip(&self.judged);
            values.zip(columns).map(move |((&distance_m, &heading), (&omega, judged))| {
                let rollout = || Rollout { judged: judged.at(v), heading, distance_m };
                (Velocity::new(v, omega), (distance_m > Self::REFUSED).then(rollout))
            })
        })
    }

    /// The candidates that are not refused.
    #[inline]
    pub(super) fn admissible<'a>(
        &'a self,
        lattice: &'a Lattice,
    ) -> impl Iterator<Item = (Velocity, Rollout)> + Clone + 'a {
        self.all(lattice).filter_map(|(velocity, rollout)| Some((velocity, rollout?)))
    }
}
