//! From an episode to its report.

use super::driver::{Entry, run_all};
use super::{Episode, EpisodeError, EpisodeObserver, EpisodeReport};
use crate::report::{Clock, Inputs};
use keyway::navigate::FittedStack;

/// Runs an episode. Equal episodes give equal reports; times are not measured.
///
/// # Errors
/// When the episode cannot be run. No route, a collision or a timeout are results.
pub fn run_episode(episode: &Episode) -> Result<EpisodeReport, EpisodeError> {
    watch_episode(episode, None, &mut ())
}

/// Runs an episode with an observer, and measures times by the caller's clock.
///
/// # Errors
/// As for [`run_episode`].
pub fn watch_episode(
    episode: &Episode,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    run_with_parts(episode, |stack| stack, clock, observer)
}

/// Runs an episode with the caller's own local planner or guide: `exchange` puts them in the place
/// of those of its stack ([`FittedStack::with_local`], [`FittedStack::with_guide`]). The report
/// does not name them: its `inputs` contain the stack, and [`Episode::stack_name`].
///
/// # Errors
/// As for [`run_episode`].
pub fn run_with_parts(
    episode: &Episode,
    exchange: impl FnOnce(FittedStack) -> FittedStack,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    let task = episode.task();
    let entry = Entry { task, stack: exchange(task.fit()?), observer };
    let mut ended = run_all(vec![entry], clock, 1).map_err(|error| error.why)?;
    // One robot has one report.
    Ok(ended.swap_remove(0).report)
}

impl Episode {
    /// Returns all inputs of the result; `time_limit_s` is the limit of this run.
    pub fn inputs(&self, time_limit_s: Option<f64>) -> Inputs {
        self.task().inputs(time_limit_s)
    }
}
