//! Experiments on as many maps as are wanted, several at a time.

use crate::args::ReproduceArgs;
use crate::error::{CliError, Kind};
use crate::measure::wall_clock;
use crate::parallel::in_parallel;
use crate::progress::Progress;
use keyway::claims::{Experiment, Family};
use keyway::episode::EpisodeError;
use keyway::report::Clock;
use std::thread;

/// No more maps are tried than this many times as many as are wanted.
const TRIES: usize = 5;

/// An experiment and what came of it.
pub(super) struct Measured {
    pub(super) experiment: &'static Experiment,
    pub(super) family: Family,
}

pub(super) fn measure(
    experiments: &[&'static Experiment],
    args: &ReproduceArgs,
) -> Result<Vec<Measured>, CliError> {
    let progress = Progress::over_maps();
    let measure = |experiment: &&'static Experiment| {
        let family = family(experiment, args, &progress)?;
        Ok(Measured { experiment, family })
    };
    experiments.iter().map(measure).collect()
}

/// Maps are made in parallel and taken in the order of their seeds, so their number at a time changes nothing.
fn family(
    experiment: &'static Experiment,
    args: &ReproduceArgs,
    progress: &Progress,
) -> Result<Family, CliError> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or(processors, usize::from);
    let now = wall_clock();
    let clock: Clock<'_> = if args.no_times { None } else { Some(&now) };
    let mut family =
        Family { scene: experiment.on_scene(clock).map_err(unusable)?, ..Family::default() };
    let mut tried = 0;
    while family.rows.len() < args.maps && tried < TRIES * args.maps {
        let missing = args.maps - family.rows.len();
        let seeds: Vec<u64> =
            (tried..tried + missing).map(|i| args.seed.wrapping_add(i as u64)).collect();
        tried += missing;
        progress.expect(missing);
        let rows = in_parallel(&seeds, jobs, |&seed| {
            // Each thread reads a clock of its own.
            let now = wall_clock();
            let clock: Clock<'_> = if args.no_times { None } else { Some(&now) };
            let row = experiment.on_seed(seed, clock);
            progress.answered();
            row
        });
        for row in rows {
            family.take(experiment, row.map_err(unusable)?, args.maps);
        }
    }
    Ok(family)
}

/// A test makes every experiment, so this does not happen.
fn unusable(error: EpisodeError) -> CliError {
    CliError::new(Kind::Config, error)
}
