//! From an episode to its report.

use super::driver::{Entry, run_all};
use super::{Episode, EpisodeError, EpisodeObserver, EpisodeReport};
use crate::report::{Clock, Inputs};
use keyway::navigate::{NavigateError, Parts};

/// Runs an episode. Equal episodes give equal reports; times are not measured.
///
/// # Errors
/// When the episode cannot be run. No route, a collision or a timeout are results.
pub fn run_episode(episode: &Episode) -> Result<EpisodeReport, EpisodeError> {
    watch_episode(episode, None, &mut ())
}

/// Runs an episode while somebody watches it, and measures times by the caller's clock.
///
/// # Errors
/// As for [`run_episode`].
pub fn watch_episode(
    episode: &Episode,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    let Episode { stack, robot, .. } = episode;
    let checked = stack.validate(robot).and_then(|()| Parts::of(stack, robot));
    run_with_parts(episode, checked.map_err(NavigateError::from)?, clock, observer)
}

/// Runs an episode with a local planner or a guide of one's own, in place of those of its stack. The report does not
/// know them: its `inputs` hold the stack, and what [`Episode::stack_name`] says.
///
/// # Errors
/// As for [`run_episode`].
pub fn run_with_parts(
    episode: &Episode,
    parts: Parts,
    clock: Clock<'_>,
    observer: &mut dyn EpisodeObserver,
) -> Result<EpisodeReport, EpisodeError> {
    let entry = Entry { task: episode.task(), parts, observer };
    let mut ended = run_all(vec![entry], clock, 1).map_err(|error| error.why)?;
    // One robot has one report.
    Ok(ended.swap_remove(0).report)
}

impl Episode {
    /// All that the result depends on; `time_limit_s` is the limit that is in force.
    pub fn inputs(&self, time_limit_s: Option<f64>) -> Inputs {
        self.task().inputs(time_limit_s)
    }
}
