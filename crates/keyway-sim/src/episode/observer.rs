//! Observation of a run: for progress, animations, logs.

use crate::sim::Run;
use keyway::navigate::{NavigateError, Navigator, Step};
use keyway::sense::Observation;

/// One control cycle: the robot's inputs and its decision.
#[derive(Clone, Copy)]
pub struct Cycle<'a> {
    /// Number of the cycle, from 0.
    pub index: u64,
    /// Simulated time at the beginning of the cycle \[s\].
    pub t_s: f64,
    /// Measurements of the robot: its pose and velocity with localisation errors, and its scans.
    pub observation: &'a Observation<'a>,
    /// Decision of the robot.
    pub step: &'a Step,
    /// The navigator after the decision: its route, its sensed obstacles, its target, the scores
    /// of the candidates.
    pub navigator: &'a Navigator,
}

/// Observer of a run. The default methods do nothing; `()` observes nothing. Observers of robots in
/// one world may be called in different threads, each by one thread at a time.
pub trait EpisodeObserver: Send {
    /// Reports that there is no route, so there is no run.
    fn no_route(&mut self, _why: &NavigateError) {}

    /// Reports that the robot has its first route and is about to drive.
    fn started(&mut self, _navigator: &Navigator) {}

    /// Reports the decision of a cycle.
    fn decided(&mut self, _cycle: &Cycle<'_>) {}

    /// True if the run is no longer needed. Called after each decision. If true, this run and all
    /// others in the same world are given up:
    /// [`SimError::GivenUp`](crate::sim::SimError::GivenUp).
    fn gives_up(&self) -> bool {
        false
    }

    /// Reports that the run has ended.
    fn ended(&mut self, _run: &Run, _navigator: &Navigator) {}
}

impl EpisodeObserver for () {}
