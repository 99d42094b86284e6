//! Runs of an episode.

use super::driver::{Ended, Entry, run_all};
use super::task::Task;
use super::{Episode, EpisodeError, EpisodeObserver, EpisodeReport};
use crate::report::Clock;
use keyway::navigate::FittedStack;

/// Options of a run that are not part of its episode.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Clock that measures times; `None`: times are not measured.
    pub clock: Clock<'a>,
    /// Number of threads over which the decisions of a cycle are spread. The reports are the same
    /// for any number.
    pub threads: usize,
    /// Replaces parts of a robot's stack by the caller's own ([`FittedStack::with_local`],
    /// [`FittedStack::with_guide`]), by the robot's index. The report does not name them: its
    /// `inputs` contain the stack, and
    /// [`EpisodeRobot::stack_name`](super::EpisodeRobot::stack_name).
    pub exchange: Option<&'a dyn Fn(usize, FittedStack) -> FittedStack>,
}

impl Default for RunOptions<'_> {
    /// No clock, one thread, the stacks without replacements.
    fn default() -> Self {
        Self { clock: None, threads: 1, exchange: None }
    }
}

/// Runs an episode. Equal episodes give equal reports; times are not measured.
///
/// # Errors
/// Returns an error if the episode cannot be run. A missing route, a collision and a timeout are
/// results.
pub fn run_episode(episode: &Episode) -> Result<EpisodeReport, EpisodeError> {
    watch_episode(episode, RunOptions::default(), &mut [(); 0])
}

/// Runs an episode with an observer for each robot, in their order; robots beyond the last observer
/// are not observed.
///
/// # Errors
/// Those of [`run_episode`].
pub fn watch_episode<O: EpisodeObserver>(
    episode: &Episode,
    options: RunOptions<'_>,
    observers: &mut [O],
) -> Result<EpisodeReport, EpisodeError> {
    episode.check()?;
    let RunOptions { clock, threads, exchange } = options;
    let mut nobody = vec![(); episode.robots.len()];
    let observers = observers.iter_mut().map(|observer| observer as &mut dyn EpisodeObserver);
    let others = nobody.iter_mut().map(|nobody| nobody as &mut dyn EpisodeObserver);
    let others = others.skip(observers.len());
    let mut entries = Vec::with_capacity(episode.robots.len());
    for (index, observer) in (0..episode.robots.len()).zip(observers.chain(others)) {
        let task = Task::new(episode, index);
        let stack = task.fit()?;
        let stack = match exchange {
            Some(exchange) => exchange(index, stack),
            None => stack,
        };
        entries.push(Entry { task, stack, observer });
    }
    let (reports, clearances_m): (Vec<_>, Vec<_>) = run_all(entries, clock, threads)?
        .into_iter()
        .map(|Ended { report, min_robot_clearance_m }| (report, min_robot_clearance_m))
        .unzip();
    let min_robot_clearance_m = clearances_m.into_iter().flatten().reduce(f64::min);
    Ok(EpisodeReport::of(reports, min_robot_clearance_m))
}
