//! The command of one cycle, and the evidence for it.

use crate::geometry::Velocity;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What a local planner decided.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The velocity to drive with until the next cycle.
    pub command: Velocity,
    /// Why this one.
    pub evaluation: Evaluation,
}

/// How the candidates of one cycle fared.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Velocities that were tried.
    pub candidates: u32,
    /// Those of them that let the robot drive on: admissible and faster than standing.
    pub driving: u32,
    /// Why the others were refused.
    pub rejected: Rejections,
    /// Each term's share of the chosen candidate's score.
    pub chosen: TermShares,
    /// The same of the second best.
    pub runner_up: Option<TermShares>,
}

/// Candidates refused, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rejections {
    /// The footprint would touch something or leave the map.
    pub contact: u32,
    /// v > sqrt(2 dist deceleration): it could not stop in time.
    pub cannot_stop: u32,
    /// |omega| > sqrt(2 dist angular deceleration): it could not stop turning in time.
    pub turns_too_fast: u32,
}

/// What each term adds to a score, weights included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TermShares {
    /// Alignment with the guide point.
    pub heading: f64,
    /// Distance to obstacles.
    pub distance: f64,
    /// Forward speed.
    pub speed: f64,
}

impl TermShares {
    /// The score: the sum of all terms.
    pub fn total(&self) -> f64 {
        self.heading + self.distance + self.speed
    }
}

/// No candidate was admissible.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "none of {} candidates is admissible ({} touch something, {} could not stop in time, {} turn too fast)",
    .evaluation.candidates, .evaluation.rejected.contact, .evaluation.rejected.cannot_stop,
    .evaluation.rejected.turns_too_fast
)]
pub struct NoCommand {
    /// How the candidates fared.
    pub evaluation: Evaluation,
    /// What to do instead: brake along the present arc, or at standstill turn towards the guide
    /// point.
    pub fallback: Velocity,
}
