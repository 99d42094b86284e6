//! The command of one cycle, and the evaluation behind it.

use crate::geometry::Velocity;
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt::{Display, Formatter};
use thiserror::Error;

/// The decision of a local planner.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The velocity command until the next cycle.
    pub command: Velocity,
    /// The evaluation behind the command.
    pub evaluation: Evaluation,
}

/// Statistics of the candidates of one cycle. A planner that does not choose between candidates
/// leaves it empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Number of evaluated velocities.
    pub candidates: u32,
    /// Number of candidates with which the robot drives on: admissible, with a speed other than
    /// 0, or, if whole trajectories are compared, leading elsewhere within the horizon.
    pub driving: u32,
    /// Refused candidates by rule: each rule of the planner, also those that refused none. No
    /// candidate counts twice.
    pub rejected: Rejections,
    /// True if the best trajectory comes near a moving obstacle and that is not forbidden: the
    /// robot waits for it, gives way, or drives beside it.
    pub near_mover: bool,
    /// Each term's share of the chosen candidate's score.
    pub chosen: Shares,
    /// The same for the second best.
    pub runner_up: Option<Shares>,
}

impl Evaluation {
    /// True if a moving obstacle delays the robot: the best trajectory comes near it, or no
    /// candidate drives and some were refused because of it ([`Rejections::MOVER`]). Then it is
    /// better to wait than to replan.
    pub fn waits_for_mover(&self) -> bool {
        self.near_mover || self.driving == 0 && self.rejected.count(Rejections::MOVER) > 0
    }
}

/// A rule of a local planner, and the number of candidates it refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rejection {
    /// Name of the rule.
    pub rule: Cow<'static, str>,
    /// Defect of the candidates, as in "7 candidates touch something".
    pub because: Cow<'static, str>,
    /// Number of refused candidates.
    pub count: u32,
}

/// The rules of a local planner with the candidates that each refused; up to [`Self::MOST`] of
/// them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rejections(ArrayVec<Rejection, { Self::MOST }>);

impl Rejections {
    /// The rule by which every planner refuses candidates that lead into a moving obstacle.
    pub const MOVER: &'static str = "mover";

    /// Upper limit of the rules of a planner.
    pub const MOST: usize = 8;

    /// No candidate refused, under rules given by name and reason. Rules beyond [`Self::MOST`]
    /// are left out.
    pub(crate) fn none_by(rules: &[(&'static str, &'static str)]) -> Self {
        let rejection = |&(rule, because): &(&'static str, &'static str)| Rejection {
            rule: Cow::Borrowed(rule),
            because: Cow::Borrowed(because),
            count: 0,
        };
        Self(rules.iter().take(Self::MOST).map(rejection).collect())
    }

    /// All rules in order.
    pub fn as_slice(&self) -> &[Rejection] {
        &self.0
    }

    /// Number of candidates that a rule refused.
    pub fn count(&self, rule: &str) -> u32 {
        self.0.iter().find(|one| one.rule == rule).map_or(0, |one| one.count)
    }

    /// Counts one more candidate for a rule.
    pub fn add(&mut self, rule: &str) {
        self.add_many(rule, 1);
    }

    /// Counts more candidates for a rule.
    pub(crate) fn add_many(&mut self, rule: &str, count: u32) {
        if let Some(one) = self.0.iter_mut().find(|one| one.rule == rule) {
            one.count += count;
        }
    }
}

impl Display for Rejections {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for (i, Rejection { because, count, .. }) in self.0.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            write!(f, "{comma}{count} {because}")?;
        }
        Ok(())
    }
}

/// One term of a candidate's score.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Name of the term.
    pub term: Cow<'static, str>,
    /// Value in its own unit, before normalisation.
    pub raw: f64,
    /// Contribution to the score: normalised, times its weight.
    pub weighted: f64,
}

/// The terms of a candidate's score; up to [`Self::MOST`] of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Shares(ArrayVec<Share, { Self::MOST }>);

impl Shares {
    /// Upper limit of the terms of a planner.
    pub const MOST: usize = 8;

    /// All terms in order.
    pub fn as_slice(&self) -> &[Share] {
        &self.0
    }

    /// The term of this name.
    pub fn term(&self, name: &str) -> Option<&Share> {
        self.0.iter().find(|share| share.term == name)
    }

    /// The score: the sum of all terms.
    pub fn total(&self) -> f64 {
        self.0.iter().map(|share| share.weighted).sum()
    }
}

/// Terms beyond [`Shares::MOST`] are left out.
impl FromIterator<Share> for Shares {
    fn from_iter<I: IntoIterator<Item = Share>>(shares: I) -> Self {
        Self(shares.into_iter().take(Self::MOST).collect())
    }
}

/// No candidate was admissible.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("none of {} candidates is admissible ({})", .evaluation.candidates, .evaluation.rejected)]
pub struct NoCommand {
    /// Statistics of the candidates.
    pub evaluation: Evaluation,
    /// Command to issue instead: brake along the present arc, or at standstill turn towards the
    /// guide point.
    pub fallback: Velocity,
}
