//! Maps of a family that count.

use super::experiment::{Experiment, MapRow};
use super::method::MethodResult;
use super::reconstruction::Fitted;

/// Results of an experiment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Family {
    /// Maps on which every method that must succeed did so, in the order of their seeds.
    pub rows: Vec<MapRow>,
    /// Number of maps left out: those before the last row on which such a method failed.
    pub left_out: usize,
    /// Number of all these maps, counted or left out, on which each method succeeded.
    pub succeeded: Vec<usize>,
    /// Results on the scene.
    pub scene: Option<MapRow>,
    /// Maps that fit the published figures of the baselines.
    pub fitted: Fitted,
    /// Rows of these maps on which every method that must succeed did so.
    pub reconstructed: Vec<MapRow>,
}

impl Family {
    /// Adds the next map, in the order of the seeds, unless there are enough; returns true if more
    /// are wanted.
    pub fn take(&mut self, experiment: &Experiment, row: MapRow, wanted: usize) -> bool {
        if self.rows.len() < wanted {
            self.succeeded.resize(experiment.methods.len(), 0);
            for (count, outcome) in self.succeeded.iter_mut().zip(&row.outcomes) {
                *count += usize::from(outcome.as_ref().is_some_and(MethodResult::succeeded));
            }
            if row.counts(experiment) {
                self.rows.push(row);
            } else {
                self.left_out += 1;
            }
        }
        self.rows.len() < wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::Claim;

    #[test]
    fn maps_count_until_there_are_enough() {
        let experiment = Claim::named("S0-1")[0].experiment;
        let row = |seed| experiment.on_seed(seed, None).unwrap();
        let mut lost = row(1);
        lost.outcomes[0] = None;
        let mut family = Family::default();
        assert!(family.take(experiment, row(1), 2));
        assert!(family.take(experiment, lost.clone(), 2));
        assert!(!family.take(experiment, row(2), 2));
        // Later maps are neither counted nor left out.
        assert!(!family.take(experiment, row(3), 2));
        assert!(!family.take(experiment, lost, 2));
        assert_eq!((family.rows, family.left_out), (vec![row(1), row(2)], 1));
        assert_eq!(family.succeeded, [2, 3, 3, 3, 3, 3]);
    }
}
