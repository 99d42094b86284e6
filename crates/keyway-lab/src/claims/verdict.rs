//! Rule for the verdict on a claim: it holds, holds in part, or does not hold.
//!
//! The rule was written before anything was measured:
//!
//! - *Holds*: every figure changes in the published direction, the 95 % interval of its mean change
//!   over the family of maps excludes zero, and the mean is at least half of the published change.
//! - *Holds in part*: at least one figure changes in the published direction, with an interval that
//!   excludes zero.
//! - *Does not hold*: otherwise.
//!
//! If nothing comparable was published, half of the change is not required: the sign decides. Other
//! statements of the papers are read as follows:
//!
//! - *The same*: the whole interval lies within the tolerance of the figure; *not higher*: its
//!   upper end does. As there is no zero to exclude, such a figure alone makes no claim hold in
//!   part.
//! - *Always* (a bound that is kept, a path that is found): the figure agrees with the paper if it
//!   is true on every map; if it is true on more than half of the maps with 95 % certainty
//!   (\[Wilson1927\]), the claim holds in part.
//! - A figure that could not be measured leaves the claim without a verdict: missing data supports
//!   neither side.

use super::claim::{Direction, Expected, Figure};
use keyway_sim::metrics::statistics::{Confidence, Rate};
use serde::Serialize;

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All of the claim is confirmed.
    Holds,
    /// Part of the claim is confirmed.
    HoldsInPart,
    /// No part of the claim is confirmed.
    DoesNotHold,
    /// There is no evidence to judge the claim.
    NotMeasured,
}

/// Evidence for a figure over a family of maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evidence {
    /// Too little evidence for an interval.
    Missing,
    /// The mean change with its 95 % confidence interval.
    Change {
        /// The mean.
        mean: f64,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// Share of maps on which a bound is kept.
    Kept(Rate),
}

/// Judgement of a figure by the rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Judgement {
    /// True if the mean changes in the published direction; for a bound: if it is kept on every
    /// map.
    pub goes_that_way: bool,
    /// True if it changes in that direction with an interval that excludes zero; for a bound: one
    /// half.
    pub is_certain: bool,
    /// True if the mean change is at least half of the published one, if there is one.
    pub is_half: bool,
}

impl Judgement {
    /// Judges a figure; `None` if evidence is missing, or is of the wrong kind for the figure.
    pub fn of(figure: &Figure, evidence: Evidence) -> Option<Self> {
        match (figure.expected, evidence) {
            (Expected::Change { direction, .. }, Evidence::Change { mean, low, high }) => {
                Some(Self::of_change(figure, direction, [mean, low, high]))
            }
            (Expected::Always(_), Evidence::Kept(rate)) => {
                let low = rate.interval(Confidence::USUAL)?.low;
                Some(Self {
                    goes_that_way: rate.failures == 0,
                    is_certain: low > 0.5,
                    is_half: true,
                })
            }
            _ => None,
        }
    }

    fn of_change(figure: &Figure, direction: Direction, [mean, low, high]: [f64; 3]) -> Self {
        // For an increase the lower end decides, for a decrease the upper one.
        let (upwards, nearest) = match direction {
            Direction::Higher => (1.0, low),
            Direction::Lower => (-1.0, high),
            Direction::Same { within } => {
                let goes_that_way = low >= -within && high <= within;
                return Self { goes_that_way, is_certain: false, is_half: true };
            }
            Direction::NotHigher { beyond } => {
                return Self { goes_that_way: high <= beyond, is_certain: false, is_half: true };
            }
        };
        let half = figure.published_effect().map_or(0.0, |effect| 0.5 * effect.abs());
        Self {
            goes_that_way: upwards * mean > 0.0,
            is_certain: upwards * mean > 0.0 && upwards * nearest > 0.0,
            is_half: upwards * mean >= half,
        }
    }

    /// True if the figure confirms the whole claim.
    fn is_whole(self, figure: &Figure) -> bool {
        let has_no_zero = matches!(
            figure.expected,
            Expected::Change {
                direction: Direction::Same { .. } | Direction::NotHigher { .. },
                ..
            }
        );
        self.goes_that_way && (self.is_certain || has_no_zero) && self.is_half
    }
}

impl Verdict {
    /// Returns the verdict on a claim from its figures and their evidence.
    pub fn of(figures: &[(Figure, Evidence)]) -> Self {
        let judged: Option<Vec<_>> = figures
            .iter()
            .map(|(figure, evidence)| Some((figure, Judgement::of(figure, *evidence)?)))
            .collect();
        match judged {
            None => Self::NotMeasured,
            Some(all) if all.is_empty() => Self::NotMeasured,
            Some(all) if all.iter().all(|(figure, judged)| judged.is_whole(figure)) => Self::Holds,
            Some(all) if all.iter().any(|(_, judged)| judged.is_certain) => Self::HoldsInPart,
            Some(_) => Self::DoesNotHold,
        }
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::DoesNotHold => "does not hold",
            Self::NotMeasured => "not measured",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::{Bound, Measure};
    use Verdict::{DoesNotHold, Holds, HoldsInPart, NotMeasured};

    /// Half as many: a change of -0.5.
    const HALVED: Figure = Figure::lower(Measure::Expanded, "new", "old", Some([8.0, 4.0]));
    const LONGER: Figure = Figure::higher(Measure::Length, "new", "old", None);
    const SAME: Figure = Figure::same(Measure::Length, "new", "old", 0.25, Some([4.0, 4.0]));
    const KEPT: Figure = Figure::always(Measure::Clearance, "new", Bound::AtLeast(0.5));

    fn change(mean: f64, low: f64, high: f64) -> Evidence {
        Evidence::Change { mean, low, high }
    }

    fn kept(successes: u64, failures: u64) -> Evidence {
        Evidence::Kept(Rate { successes, failures })
    }

    #[track_caller]
    fn expect(figures: &[(Figure, Evidence)], verdict: Verdict) {
        assert_eq!(Verdict::of(figures), verdict, "{figures:?}");
    }

    #[test]
    fn a_single_figure() {
        expect(&[(HALVED, change(-0.4, -0.5, -0.3))], Holds);
        expect(&[(HALVED, change(-0.25, -0.5, -0.125))], Holds); // exactly half
        expect(&[(HALVED, change(-0.249, -0.5, -0.125))], HoldsInPart);
        expect(&[(HALVED, change(-0.4, -0.9, 0.0))], DoesNotHold); // touches zero
        expect(&[(HALVED, change(-0.4, -0.9, 0.1))], DoesNotHold);
        expect(&[(HALVED, change(0.4, 0.3, 0.5))], DoesNotHold); // the other way
        expect(&[(HALVED, change(0.0, 0.0, 0.0))], DoesNotHold);
    }

    #[test]
    fn by_sign_where_nothing_was_published() {
        expect(&[(LONGER, change(1e-9, 1e-12, 1.0))], Holds);
        expect(&[(LONGER, change(0.1, 0.0, 1.0))], DoesNotHold);
        expect(&[(LONGER, change(-0.1, -0.2, -0.05))], DoesNotHold);
    }

    #[test]
    fn several_figures() {
        let (good, weak) = (change(-0.4, -0.5, -0.3), change(-0.1, -0.2, -0.05));
        let up = change(0.1, 0.05, 0.2);
        expect(&[(HALVED, good), (LONGER, up)], Holds);
        expect(&[(HALVED, weak), (LONGER, up)], HoldsInPart);
        expect(&[(HALVED, change(0.3, 0.2, 0.4)), (LONGER, up)], HoldsInPart);
        expect(&[(HALVED, change(0.3, 0.2, 0.4)), (LONGER, weak)], DoesNotHold);
    }

    #[test]
    fn the_same_is_no_effect() {
        let good = (HALVED, change(-0.4, -0.5, -0.3));
        let wrong = (HALVED, change(0.4, 0.3, 0.5));
        expect(&[good, (SAME, change(0.1, -0.25, 0.25))], Holds); // both ends included
        expect(&[good, (SAME, change(0.1, 0.05, 0.26))], HoldsInPart);
        expect(&[wrong, (SAME, change(0.0, 0.0, 0.0))], DoesNotHold);
        expect(&[(SAME, change(0.0, -0.1, 0.1))], Holds);
        expect(&[(SAME, change(-0.1, -0.3, 0.1))], DoesNotHold);
    }

    #[test]
    fn not_higher_is_the_same_or_less() {
        let figure = Figure::not_higher(Measure::RunTime, "new", "old", 0.25);
        expect(&[(figure, change(0.1, -0.25, 0.25))], Holds);
        expect(&[(figure, change(-0.6, -0.7, -0.5))], Holds);
        expect(&[(figure, change(0.1, 0.05, 0.26))], DoesNotHold);
    }

    #[test]
    fn bounds_hold_on_every_map() {
        expect(&[(KEPT, kept(100, 0))], Holds);
        expect(&[(KEPT, kept(99, 1))], HoldsInPart);
        // Wilson's interval of 60 in 100 begins at 0.502, that of 59 at 0.492.
        expect(&[(KEPT, kept(60, 40))], HoldsInPart);
        expect(&[(KEPT, kept(59, 41))], DoesNotHold);
        expect(&[(KEPT, kept(0, 100))], DoesNotHold);
        // One map proves nothing: its interval begins at 0.21.
        expect(&[(KEPT, kept(1, 0))], DoesNotHold);
    }

    #[test]
    fn what_is_missing_speaks_for_nobody() {
        let good = (HALVED, change(-0.4, -0.5, -0.3));
        expect(&[], NotMeasured);
        expect(&[(HALVED, Evidence::Missing)], NotMeasured);
        expect(&[good, (LONGER, Evidence::Missing)], NotMeasured);
        expect(&[(KEPT, kept(0, 0))], NotMeasured);
        // Evidence of another kind counts as none.
        expect(&[(HALVED, kept(100, 0))], NotMeasured);
        expect(&[(KEPT, change(0.1, 0.1, 0.1))], NotMeasured);
    }

    #[test]
    fn words() {
        let words =
            [Holds, HoldsInPart, DoesNotHold, NotMeasured].map(|verdict| verdict.to_string());
        assert_eq!(words, ["holds", "holds in part", "does not hold", "not measured"]);
        assert_eq!(serde_json::to_value(HoldsInPart).unwrap(), "holds_in_part");
    }
}
