//! Report of one control cycle: `keyway.cycle/1`.

use super::Cycle;
use keyway::geometry::{Point, Velocity};
use keyway::guide::Guidance;
use keyway::local::{Explanation, Refusal, Rejections, Remedy, ScoredCandidate, Shares};
use keyway::navigate::Step;
use keyway::sense::{Mover, Observation};
use serde::Serialize;

/// `keyway.cycle/1`: the robot's pose, its decision, and the reasons.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CycleReport {
    /// Name and version of this format.
    pub schema: &'static str,
    /// Number of the cycle, from 0.
    pub cycle: u64,
    /// Simulated time at the beginning of the cycle \[s\].
    pub t_s: f64,
    /// Pose of the robot: `[x_m, y_m, yaw_rad]`.
    pub pose: [f64; 3],
    /// Velocity of the robot.
    pub velocity: Speeds,
    /// Point to which the guide directs the robot \[m\].
    pub guide_m: Point,
    /// Point towards which the local planner drives \[m\]: the guide's point, or one of its own;
    /// `None` if it drives to no point, or was not called.
    pub target_m: Option<Point>,
    /// Remaining path length \[m\].
    pub remaining_m: f64,
    /// Moving obstacles, as the robot estimates them.
    pub movers: Vec<Mover>,
    /// Areas in which moving obstacles walk to and fro and which the robot avoids: `[x, y,
    /// radius]` each \[m\].
    pub walked: Vec<[f64; 3]>,
    /// Action of the robot.
    pub step: StepName,
    /// Reason why the robot makes no progress, for human readers; `None` unless it is blocked.
    pub reason: Option<String>,
    /// Velocity command until the next cycle; `None` at the goal.
    pub command: Option<Speeds>,
    /// Reason why the stop rule changed the command; `None` if it did not.
    pub refusal: Option<Refusal>,
    /// Number of velocities tried; 0 if the local planner does not choose between candidates, or
    /// was not called.
    pub candidates: u32,
    /// Number of candidates with which the robot drives on.
    pub driving: u32,
    /// Reasons why the other candidates were rejected.
    pub rejected: Rejections,
    /// The best candidate; `None` if none was admissible.
    pub chosen: Option<Scored>,
    /// The second best candidate.
    pub runner_up: Option<Scored>,
    /// Remedies that were tried to free the robot; empty if a candidate drives.
    pub remedies: Vec<Remedy>,
}

/// A velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Speeds {
    /// Forward \[m/s\].
    pub v_mps: f64,
    /// Turn rate, counter-clockwise \[rad/s\].
    pub omega_radps: f64,
}

/// Action of a robot in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepName {
    /// The robot drives.
    Drive,
    /// The robot is at the goal.
    Arrived,
    /// No acceptable motion towards the goal.
    Blocked,
    /// The robot has no goal.
    Idle,
}

/// A candidate and its score.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scored {
    /// Velocity of the candidate.
    #[serde(flatten)]
    pub velocity: Speeds,
    /// Sum of the weighted shares.
    pub score: f64,
    /// Share of each term.
    pub shares: Shares,
}

impl CycleReport {
    /// Name and version of this format.
    pub const SCHEMA: &'static str = "keyway.cycle/1";

    /// Returns the report of a cycle, given the explanation of its decision
    /// ([`keyway::navigate::Navigator::explain`]).
    pub fn of(cycle: &Cycle<'_>, explanation: &Explanation) -> Self {
        let (step, command, reason) = match cycle.step {
            Step::Drive(command) => (StepName::Drive, Some(*command), None),
            Step::Arrived => (StepName::Arrived, None, None),
            Step::Idle => (StepName::Idle, None, None),
            Step::Blocked { command, why } => {
                (StepName::Blocked, Some(*command), Some(why.to_string()))
            }
        };
        let is_asked = !explanation.candidates.is_empty();
        let evaluation = is_asked.then(|| cycle.navigator.evaluation().clone());
        let evaluation = evaluation.unwrap_or_default();
        let here = Guidance { point: cycle.observation.pose.point(), remaining_m: 0.0 };
        let guidance = cycle.navigator.guidance().unwrap_or(here);
        let walked = cycle.navigator.gone_around().iter();
        let Observation { pose, velocity, .. } = *cycle.observation;
        Self {
            schema: Self::SCHEMA,
            cycle: cycle.index,
            t_s: cycle.t_s,
            pose: [pose.x, pose.y, pose.theta],
            velocity: velocity.into(),
            guide_m: guidance.point,
            target_m: explanation.target,
            remaining_m: guidance.remaining_m,
            movers: cycle.navigator.movers().to_vec(),
            walked: walked.map(|disc| [disc.centre.x, disc.centre.y, disc.radius_m]).collect(),
            step,
            reason,
            command: command.map(Speeds::from),
            refusal: cycle.navigator.refusal().copied(),
            candidates: evaluation.candidates,
            driving: evaluation.driving,
            rejected: evaluation.rejected,
            chosen: explanation.chosen().map(Scored::from),
            runner_up: explanation.runner_up().map(Scored::from),
            remedies: explanation.remedies.clone(),
        }
    }
}

impl From<Velocity> for Speeds {
    fn from(Velocity { v, omega, .. }: Velocity) -> Self {
        // -0 becomes 0.
        Self { v_mps: v + 0.0, omega_radps: omega + 0.0 }
    }
}

impl From<ScoredCandidate<'_>> for Scored {
    fn from(ScoredCandidate { velocity, shares, .. }: ScoredCandidate<'_>) -> Self {
        Self { velocity: velocity.into(), score: shares.total(), shares: shares.clone() }
    }
}
