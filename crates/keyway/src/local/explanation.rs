//! Explanation of a decision: every candidate with its fate, and the changes that would free a
//! robot that cannot drive.

use super::Shares;
use crate::geometry::{Point, Pose, Velocity};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt::{Display, Formatter};

/// All candidates of one cycle; empty for a planner that does not choose between candidates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Point towards which the planner drives: the guide point of the scene, or one of its own;
    /// `None` for a planner that drives to no point.
    pub target: Option<Point>,
    /// All candidates, in the order in which they were tried.
    pub candidates: Vec<JudgedCandidate>,
    /// Index of the best one in `candidates`; `None` if none was admissible.
    pub chosen: Option<usize>,
    /// Index of the second best one.
    pub runner_up: Option<usize>,
    /// Changes that would let the robot drive, in the order in which they were tried. Empty while
    /// some candidate drives.
    pub remedies: Vec<Remedy>,
}

/// A velocity that was tried, with its fate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JudgedCandidate {
    /// The velocity.
    pub velocity: Velocity,
    /// Admissible or refused.
    pub fate: Fate,
    /// Predicted poses at equal intervals of time, the last one at the end of the prediction, or
    /// at the contact. The pose at which the command acts is not among them.
    pub poses: Vec<Pose>,
}

/// The fate of a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "fate", rename_all = "kebab-case")]
pub enum Fate {
    /// It could be chosen.
    Admissible {
        /// Each term's share of the score.
        shares: Shares,
        /// Their sum.
        score: f64,
    },
    /// A rule forbids it.
    Refused {
        /// Name of the rule.
        rule: Cow<'static, str>,
        /// Defect of such candidates, as in "touch something".
        because: Cow<'static, str>,
        /// Time for which the trajectory is shown to be free \[s\]; only for a candidate with a
        /// contact.
        free_for_s: Option<f64>,
    },
}

/// A change that may let the robot drive, and the result of a decision with that change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Remedy {
    /// The change and its size; if it does not help, the largest size that was tried.
    #[serde(flatten)]
    pub change: Change,
    /// True if some candidate drives after the change.
    pub frees: bool,
}

/// A change that may free a robot that cannot drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "change", rename_all = "kebab-case")]
pub enum Change {
    /// Wait: the robot brakes on its arc, or is stationary for a cycle if it is already.
    Wait {
        /// Duration \[s\].
        duration_s: f64,
    },
    /// Stop, then turn on the spot without contact.
    Turn {
        /// Angle, positive to the left \[rad\].
        by_rad: f64,
    },
    /// Stop, then back up: the planner's `window.backwards`, and the robot's `limits.v_min_mps`
    /// negative.
    BackUp {
        /// Value of `v_min_mps` \[m/s\].
        v_min_mps: f64,
    },
    /// A smaller safety margin: the planner's `window.safety_margin_m`.
    SafetyMargin {
        /// The largest value that helps, to a tenth of a millimetre \[m\].
        safety_margin_m: f64,
    },
    /// A smaller footprint ([`Footprint::smaller_by`](crate::robot::Footprint::smaller_by)).
    Footprint {
        /// Reduction, to a millimetre \[m\].
        smaller_by_m: f64,
    },
}

/// An admissible candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ScoredCandidate<'a> {
    /// Velocity of the candidate.
    pub velocity: Velocity,
    /// Shares of its score.
    pub shares: &'a Shares,
}

impl JudgedCandidate {
    /// Score of the candidate; `None` if it was refused.
    pub const fn score(&self) -> Option<f64> {
        match self.fate {
            Fate::Admissible { score, .. } => Some(score),
            Fate::Refused { .. } => None,
        }
    }
}

impl Explanation {
    /// The best candidate.
    pub fn chosen(&self) -> Option<ScoredCandidate<'_>> {
        self.admissible(self.chosen?)
    }

    /// The second best candidate.
    pub fn runner_up(&self) -> Option<ScoredCandidate<'_>> {
        self.admissible(self.runner_up?)
    }

    /// Chooses the best and the second best of the admissible candidates; ties go to the first.
    pub(super) fn rank(&mut self) {
        self.chosen = self.best(|_, _| true);
        self.runner_up = self.chosen.and_then(|chosen| self.best(|place, _| place != chosen));
    }

    /// The best of the admissible candidates that `counts` selects by index and score; ties go to
    /// the first.
    pub(super) fn best(&self, counts: impl Fn(usize, f64) -> bool) -> Option<usize> {
        let scores = self.candidates.iter().map(JudgedCandidate::score).enumerate();
        let admissible = scores.filter_map(|(place, score)| Some((place, score?)));
        let better =
            |best: (usize, f64), one: (usize, f64)| if one.1 > best.1 { one } else { best };
        let others = admissible.filter(|&(place, score)| counts(place, score));
        others.reduce(better).map(|(place, _)| place)
    }

    fn admissible(&self, index: usize) -> Option<ScoredCandidate<'_>> {
        let JudgedCandidate { velocity, fate, .. } = self.candidates.get(index)?;
        match fate {
            Fate::Admissible { shares, .. } => {
                Some(ScoredCandidate { velocity: *velocity, shares })
            }
            Fate::Refused { .. } => None,
        }
    }
}

/// As in "turning on the spot by 45 deg to the left would free it", or "... would not".
impl Display for Remedy {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { change, frees } = *self;
        match change {
            Change::Wait { duration_s } => write!(f, "waiting for {duration_s:.2} s"),
            Change::Turn { by_rad } if frees => {
                let side = if by_rad > 0.0 { "left" } else { "right" };
                let by_deg = by_rad.abs() * 180.0 / PI;
                write!(f, "turning on the spot by {by_deg:.0} deg to the {side}")
            }
            Change::Turn { .. } => write!(f, "turning on the spot"),
            Change::BackUp { v_min_mps } => {
                write!(
                    f,
                    "backing up (local.window.backwards, limits.v_min_mps of {v_min_mps:.3} m/s)"
                )
            }
            Change::SafetyMargin { safety_margin_m } => {
                write!(f, "a safety margin of {safety_margin_m:.4} m")
            }
            Change::Footprint { smaller_by_m } => {
                write!(f, "a footprint that is {smaller_by_m:.3} m smaller")
            }
        }?;
        write!(f, " {}", if frees { "would free it" } else { "would not free it" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remedies_in_words_and_as_data() {
        let turn = Remedy { change: Change::Turn { by_rad: -PI / 4.0 }, frees: true };
        let expected = "turning on the spot by 45 deg to the right would free it";
        assert_eq!(turn.to_string(), expected);
        let wait = Remedy { change: Change::Wait { duration_s: 0.1 }, frees: false };
        assert_eq!(wait.to_string(), "waiting for 0.10 s would not free it");
        let text = serde_json::to_string(&wait).unwrap();
        assert_eq!(text, r#"{"change":"wait","duration_s":0.1,"frees":false}"#);
        assert_eq!(serde_json::from_str::<Remedy>(&text).unwrap(), wait);
    }
}
