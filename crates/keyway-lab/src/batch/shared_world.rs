//! The world of a scene and a seed, created once for all stacks that drive in it.
//!
//! Creating it takes time if the map is generated or obstacles are random. Runs in the same world
//! are consecutive, and the last one that needs the world removes it. Regardless of the length of
//! the batch, at most one more world exists than runs are in progress.

use keyway_sim::episode::Episode;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A world that is created when the first run requests it.
pub(super) struct SharedWorld {
    /// Position in the order in which worlds are driven.
    pub(super) number: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// Number of runs that still need the world.
    waiting: usize,
    made: Option<Arc<Episode>>,
}

impl SharedWorld {
    pub(super) fn new(number: usize) -> Self {
        Self { number, state: Mutex::default() }
    }

    /// Registers one more run that needs the world.
    pub(super) fn expect_run(&self) {
        self.state().waiting += 1;
    }

    /// Returns the world, with the stacks of the run that created it. Concurrent requests wait.
    pub(super) fn take<E>(
        &self,
        make: impl FnOnce() -> Result<Episode, E>,
    ) -> Result<Arc<Episode>, E> {
        let mut state = self.state();
        state.waiting = state.waiting.saturating_sub(1);
        let made = state.made.take();
        let world = made.map_or_else(|| make().map(Arc::new), Ok)?;
        state.made = (state.waiting > 0).then(|| Arc::clone(&world));
        Ok(world)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A thread that panicked left no partial state: the world exists, or it is created again.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::map::OccupancyGrid;

    #[test]
    fn it_is_made_once_and_let_go_by_the_last_run() {
        let world = SharedWorld::new(0);
        let mut times_made = 0;
        let mut take = || {
            let made = world.take(|| {
                times_made += 1;
                Ok::<_, ()>(Episode::of_robots(OccupancyGrid::from_ascii(&["."]), Vec::new()))
            });
            made.unwrap()
        };
        for _ in 0..3 {
            world.expect_run();
        }
        let first = take();
        drop(take());
        assert_eq!(Arc::strong_count(&first), 2);
        let last = take();
        assert!(Arc::ptr_eq(&first, &last));
        drop(last);
        assert_eq!(Arc::strong_count(&first), 1);
        assert_eq!(times_made, 1);
    }

    #[test]
    fn what_could_not_be_made_is_tried_again() {
        let world = SharedWorld::new(0);
        (0..2).for_each(|_| world.expect_run());
        assert_eq!(world.take(|| Err("no")), Err("no"));
        let made =
            || Ok::<_, &str>(Episode::of_robots(OccupancyGrid::from_ascii(&["."]), Vec::new()));
        assert!(world.take(made).is_ok());
    }
}
