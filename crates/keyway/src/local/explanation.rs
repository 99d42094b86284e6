//! Why a local planner decides as it does: every candidate with its fate, and what would free a
//! robot that cannot drive.

use super::Shares;
use crate::geometry::{Point, Pose, Velocity};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt::{Display, Formatter};

/// All candidates of one cycle. A planner that does not choose between candidates has none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Point towards which the planner drives: the guide point of the scene, or one of its own;
    /// `None` for a planner that drives to no point.
    pub target: Option<Point>,
    /// All of them, in the order in which they were tried.
    pub candidates: Vec<JudgedCandidate>,
    /// The best one, as an index of `candidates`; `None` when none was admissible.
    pub chosen: Option<usize>,
    /// The second best one.
    pub runner_up: Option<usize>,
    /// What would let the robot drive, in the order in which it was tried. Empty while some
    /// candidate does.
    pub remedies: Vec<Remedy>,
}

/// A velocity that was tried, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JudgedCandidate {
    /// The velocity.
    pub velocity: Velocity,
    /// Admissible or refused.
    pub fate: Fate,
    /// Where it would lead: poses at equal intervals of time, the last one at the end of the
    /// prediction, or at the contact. The pose at which the command acts is not among them.
    pub poses: Vec<Pose>,
}

/// What became of a candidate.
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
        /// The rule's name.
        rule: Cow<'static, str>,
        /// What is wrong with such candidates, as in "touch something".
        because: Cow<'static, str>,
        /// How long the way is shown to be free \[s\]; only of a candidate that touches something.
        free_for_s: Option<f64>,
    },
}

/// A change that may let the robot drive, and whether it does: it was made, and decided again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Remedy {
    /// What was changed, and by how much. Where it does not help: by how much at most.
    #[serde(flatten)]
    pub change: Change,
    /// True if some candidate drives then.
    pub frees: bool,
}

/// Something that can be done about a robot that cannot drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "change", rename_all = "kebab-case")]
pub enum Change {
    /// To stand: the robot brakes on its arc, or stands for a cycle if it does already.
    Wait {
        /// How long that takes \[s\].
        duration_s: f64,
    },
    /// To stand, then to turn on the spot; nothing is touched on the way.
    Turn {
        /// By how much, positive to the left \[rad\].
        by_rad: f64,
    },
    /// To stand, then to back up: the planner's `window.backwards`, and the robot's
    /// `limits.v_min_mps` negative.
    BackUp {
        /// Its value \[m/s\].
        v_min_mps: f64,
    },
    /// A smaller safety margin: the planner's `window.safety_margin_m`.
    SafetyMargin {
        /// Its value, the largest that helps to a tenth of a millimetre \[m\].
        safety_margin_m: f64,
    },
    /// A smaller footprint ([`Footprint::smaller_by`](crate::robot::Footprint::smaller_by)).
    Footprint {
        /// By how much, to a millimetre \[m\].
        smaller_by_m: f64,
    },
}

/// An admissible candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ScoredCandidate<'a> {
    /// Its velocity.
    pub velocity: Velocity,
    /// The shares of its score.
    pub shares: &'a Shares,
}

impl JudgedCandidate {
    /// Its score; `None` when it was refused.
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

    /// Chooses the best and the second best of the admissible candidates; of equals the first.
    pub(super) fn rank(&mut self) {
        self.chosen = self.best(|_, _| true);
        self.runner_up = self.chosen.and_then(|chosen| self.best(|place, _| place != chosen));
    }

    /// The best admissible candidate of those that count, by place and score; of equals the first.
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
            Change::Wait { duration_s } => write!(f, "standing still for {duration_s:.2} s"),
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
        assert_eq!(wait.to_string(), "standing still for 0.10 s would not free it");
        let text = serde_json::to_string(&wait).unwrap();
        assert_eq!(text, r#"{"change":"wait","duration_s":0.1,"frees":false}"#);
        assert_eq!(serde_json::from_str::<Remedy>(&text).unwrap(), wait);
    }
}
