//! Experiments on the requested number of maps, in parallel.
//!
//! The result of a map is a pure function of the experiment, the map and the version of Keyway,
//! except for its times. Each finished map is therefore written to the journal at once, and a
//! known one is not measured again.

use super::ReproduceError;
use super::kept::{KeptLines, MapGroup, MapLine, digest_of};
use crate::claims::{Experiment, Family, Fitted, MapRow, Reconstruction};
use crate::measure::wall_clock;
use crate::progress::Progress;
use crate::results::Journal;
use keyway_sim::parallel::in_parallel;
use keyway_sim::report::Clock;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Maximum number of maps that are tried for each requested one.
const TRIES: usize = 8;

/// An experiment with its results.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The experiment.
    pub experiment: &'static Experiment,
    /// Its maps that count.
    pub family: Family,
    /// The results of all maps, including those that do not count.
    pub lines: Vec<MapLine>,
}

/// Parts that all experiments share.
pub(super) struct Work<'a> {
    /// Requested number of maps for each experiment.
    pub(super) maps: usize,
    /// Seed of the first map.
    pub(super) seed: u64,
    /// Number of maps that are measured in parallel.
    pub(super) jobs: usize,
    pub(super) has_times: bool,
    pub(super) kept: KeptLines,
    pub(super) journal: Mutex<&'a mut Journal<MapLine>>,
    pub(super) progress: &'a dyn Progress,
    pub(super) is_stopped: AtomicBool,
    /// Maps that fit, by the names of their reconstructions, which several experiments share.
    pub(super) fitted: BTreeMap<&'static str, Fitted>,
}

impl Work<'_> {
    pub(super) fn measure(
        &mut self,
        experiments: &[&'static Experiment],
    ) -> Result<Vec<Measured>, ReproduceError> {
        experiments.iter().map(|experiment| self.measure_one(experiment)).collect()
    }

    /// Maps are measured in parallel and taken in the order of their seeds, so the number of
    /// parallel maps does not affect the results.
    fn measure_one(&mut self, experiment: &'static Experiment) -> Result<Measured, ReproduceError> {
        let (mut family, mut lines) = (Family::default(), Vec::new());
        if experiment.scene.is_some() {
            let scene = self.lines(experiment, MapGroup::Scene, &[0])?;
            family.scene = scene.first().map(|line| line.row.clone());
            lines.extend(scene);
        }
        if let Ok(of) = experiment.reconstruction {
            family.fitted = self.fitted(of)?;
            let found = self.lines(experiment, MapGroup::Reconstruction, &family.fitted.seeds)?;
            let rows = found.iter().map(|line| line.row.clone());
            family.reconstructed = rows.filter(|row| row.counts(experiment)).collect();
            lines.extend(found);
        }
        let (wanted, mut tried) = (self.maps, 0);
        while family.rows.len() < wanted && tried < TRIES * wanted {
            let missing = wanted - family.rows.len();
            let seeds = tried..tried + missing;
            let seeds: Vec<u64> = seeds.map(|i| self.seed.wrapping_add(i as u64)).collect();
            tried += missing;
            let found = self.lines(experiment, MapGroup::Family, &seeds)?;
            for line in &found {
                family.take(experiment, line.row.clone(), wanted);
            }
            lines.extend(found);
        }
        Ok(Measured { experiment, family, lines })
    }

    /// Returns as many fitting maps as are measured of a family, and at most
    /// [`Reconstruction::KEPT`].
    fn fitted(&mut self, of: &'static Reconstruction) -> Result<Fitted, ReproduceError> {
        if let Some(fitted) = self.fitted.get(of.name) {
            return Ok(fitted.clone());
        }
        let fitted = of.find(self.maps.min(Reconstruction::KEPT))?;
        self.fitted.insert(of.name, fitted.clone());
        Ok(fitted)
    }

    /// Returns the results of the maps of these seeds, in their order.
    fn lines(
        &self,
        experiment: &'static Experiment,
        group: MapGroup,
        seeds: &[u64],
    ) -> Result<Vec<MapLine>, ReproduceError> {
        let digest = digest_of(experiment, group, self.has_times);
        let is_missing = |&seed: &u64| self.kept.get(&digest, seed).is_none();
        let missing: Vec<u64> = seeds.iter().copied().filter(is_missing).collect();
        self.progress.expect(missing.len());
        let made = in_parallel(&missing, self.jobs, |&seed| {
            if self.is_stopped.load(Ordering::Relaxed) {
                return Err(ReproduceError::Stopped);
            }
            let row = self.row(experiment, group, seed)?;
            let (experiment, digest) = (experiment.name.to_owned(), digest.clone());
            let line = MapLine { experiment, digest, group, seed, row };
            self.write_down(&line)?;
            Ok(line)
        });
        let mut made = made.into_iter();
        let line = |&seed: &u64| match self.kept.get(&digest, seed) {
            Some(line) => Some(Ok(line.clone())),
            None => made.next(),
        };
        seeds.iter().filter_map(line).collect()
    }

    /// Appends a finished map to the journal.
    fn write_down(&self, line: &MapLine) -> Result<(), ReproduceError> {
        // The journal behind a poisoned lock is still valid.
        let mut journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
        journal.append(line)?;
        if self.progress.answered().is_break() {
            self.is_stopped.store(true, Ordering::Relaxed);
            return Err(ReproduceError::Stopped);
        }
        Ok(())
    }

    fn row(
        &self,
        experiment: &'static Experiment,
        group: MapGroup,
        seed: u64,
    ) -> Result<MapRow, ReproduceError> {
        // Each thread reads its own clock.
        let now = wall_clock();
        let clock: Clock<'_> = if self.has_times { Some(&now) } else { None };
        let row = match group {
            MapGroup::Scene => experiment.on_scene(clock)?,
            MapGroup::Reconstruction => experiment.on_reconstruction(seed, clock)?,
            MapGroup::Family => Some(experiment.on_seed(seed, clock)?),
        };
        row.ok_or(ReproduceError::NoMap { experiment: experiment.name })
    }
}
