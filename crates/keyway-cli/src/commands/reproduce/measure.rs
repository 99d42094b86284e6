//! Experiments on as many maps as are wanted, several at a time.
//!
//! What a map gives is a pure function of the experiment, the map and the version of this program, but for its times. So each
//! finished map is written down at once, and one that is known is not made again.

use super::known::{Group, Known, Line, digest_of};
use crate::args::ReproduceArgs;
use crate::error::{CliError, Kind};
use crate::progress::Progress;
use keyway_lab::claims::{Experiment, Family, Fitted, MapRow, Reconstruction};
use keyway_lab::measure::wall_clock;
use keyway_lab::results::Journal;
use keyway_sim::parallel::{in_parallel, processors};
use keyway_sim::report::Clock;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::{Mutex, PoisonError};

/// No more maps are tried than this many times as many as are wanted.
const TRIES: usize = 8;

/// An experiment and what came of it.
pub(super) struct Measured {
    pub(super) experiment: &'static Experiment,
    pub(super) family: Family,
    /// Every map, those that do not count, too.
    pub(super) lines: Vec<Line>,
}

/// What all experiments share.
pub(super) struct Work<'a> {
    args: &'a ReproduceArgs,
    progress: Progress,
    known: Known,
    journal: Mutex<&'a mut Journal<Line>>,
    /// Maps that fit, by the names of their reconstructions: several experiments have the same.
    fitted: BTreeMap<&'static str, Fitted>,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        args: &'a ReproduceArgs,
        known: Known,
        journal: &'a mut Journal<Line>,
    ) -> Self {
        let (progress, journal) = (Progress::over_maps(), Mutex::new(journal));
        Self { args, progress, known, journal, fitted: BTreeMap::new() }
    }

    pub(super) fn measure(
        mut self,
        experiments: &[&'static Experiment],
    ) -> Result<Vec<Measured>, CliError> {
        experiments.iter().map(|experiment| self.measure_one(experiment)).collect()
    }

    /// Maps are made in parallel and taken in the order of their seeds, so their number at a time changes nothing.
    fn measure_one(&mut self, experiment: &'static Experiment) -> Result<Measured, CliError> {
        let (mut family, mut lines) = (Family::default(), Vec::new());
        if experiment.scene.is_some() {
            let scene = self.rows(experiment, Group::Scene, &[0])?;
            family.scene = scene.first().map(|line| line.row.clone());
            lines.extend(scene);
        }
        if let Ok(of) = experiment.reconstruction {
            family.fitted = self.fitted(of)?;
            let found = self.rows(experiment, Group::Reconstruction, &family.fitted.seeds)?;
            let rows = found.iter().map(|line| line.row.clone());
            family.reconstructed = rows.filter(|row| row.counts(experiment)).collect();
            lines.extend(found);
        }
        let (wanted, mut tried) = (self.args.maps, 0);
        while family.rows.len() < wanted && tried < TRIES * wanted {
            let missing = wanted - family.rows.len();
            let seeds = tried..tried + missing;
            let seeds: Vec<u64> = seeds.map(|i| self.args.seed.wrapping_add(i as u64)).collect();
            tried += missing;
            let found = self.rows(experiment, Group::Family, &seeds)?;
            for line in &found {
                family.take(experiment, line.row.clone(), wanted);
            }
            lines.extend(found);
        }
        Ok(Measured { experiment, family, lines })
    }

    /// As many maps that fit as are measured at all, and no more than [`Reconstruction::KEPT`].
    fn fitted(&mut self, of: &'static Reconstruction) -> Result<Fitted, CliError> {
        if let Some(fitted) = self.fitted.get(of.name) {
            return Ok(fitted.clone());
        }
        let wanted = self.args.maps.min(Reconstruction::KEPT);
        let fitted = of.find(wanted).map_err(unusable)?;
        self.fitted.insert(of.name, fitted.clone());
        Ok(fitted)
    }

    /// What the maps of these seeds give, in their order.
    fn rows(
        &self,
        experiment: &'static Experiment,
        group: Group,
        seeds: &[u64],
    ) -> Result<Vec<Line>, CliError> {
        let digest = digest_of(experiment, group, !self.args.no_times);
        let missing: Vec<u64> =
            seeds.iter().copied().filter(|&seed| self.known.get(&digest, seed).is_none()).collect();
        self.progress.expect(missing.len());
        let jobs = self.args.jobs.unwrap_or_else(processors);
        let made = in_parallel(&missing, jobs, |&seed| {
            let row = self.row(experiment, group, seed)?;
            let name = experiment.name.to_owned();
            let line = Line { experiment: name, digest: digest.clone(), group, seed, row };
            // A poisoned lock holds the journal all the same.
            let mut journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
            journal.append(&line)?;
            self.progress.answered();
            Ok(line)
        });
        let mut made = made.into_iter();
        let line = |&seed: &u64| match self.known.get(&digest, seed) {
            Some(line) => Some(Ok(line.clone())),
            None => made.next(),
        };
        seeds.iter().filter_map(line).collect()
    }

    fn row(
        &self,
        experiment: &'static Experiment,
        group: Group,
        seed: u64,
    ) -> Result<MapRow, CliError> {
        // Each thread reads a clock of its own.
        let now = wall_clock();
        let clock: Clock<'_> = if self.args.no_times { None } else { Some(&now) };
        let row = match group {
            Group::Scene => experiment.on_scene(clock),
            Group::Reconstruction => experiment.on_reconstruction(seed, clock),
            Group::Family => experiment.on_seed(seed, clock).map(Some),
        };
        // An experiment is asked for what it has.
        row.map_err(unusable)?
            .ok_or_else(|| unusable(format!("{} has no such map", experiment.name)))
    }
}

/// A test makes every experiment, so this does not happen.
fn unusable(error: impl Display) -> CliError {
    CliError::new(Kind::Config, error)
}
