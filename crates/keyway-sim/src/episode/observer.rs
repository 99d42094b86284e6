//! Watching a run: for progress, animations, logs.

use crate::sim::Run;
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::{Controller, NavigateError, Step};
use keyway::sense::Scan;

/// One control cycle: what the robot knew, and what it decided.
#[derive(Clone, Copy)]
pub struct Cycle<'a> {
    /// Number of the cycle, from 0.
    pub index: u64,
    /// Simulated time at its beginning \[s\].
    pub t_s: f64,
    /// Where the robot takes itself to be: where it is, but for the errors of its localisation.
    pub pose: Pose,
    /// How it takes itself to move.
    pub velocity: Velocity,
    /// What it sees.
    pub scan: &'a Scan,
    /// What it decided.
    pub step: &'a Step,
    /// The controller after the decision: its route, what it has sensed, where it drives to, how the candidates fared.
    pub controller: &'a Controller,
}

/// Watcher of a run. Every method does nothing unless it is written; `()` watches nothing. Watchers of robots
/// in one world may be called in different threads, each by one at a time.
pub trait EpisodeObserver: Send {
    /// There is no route, so there is no run.
    fn no_route(&mut self, _why: &NavigateError) {}

    /// The robot has its first route and is about to drive.
    fn started(&mut self, _controller: &Controller) {}

    /// A cycle was decided.
    fn decided(&mut self, _cycle: &Cycle<'_>) {}

    /// Whether nobody waits for the run any more; asked after each decision. If so it is given up, and so are all runs in
    /// the same world: [`SimError::GivenUp`](crate::sim::SimError::GivenUp).
    fn gives_up(&self) -> bool {
        false
    }

    /// The run has ended.
    fn ended(&mut self, _run: &Run, _controller: &Controller) {}
}

impl EpisodeObserver for () {}
