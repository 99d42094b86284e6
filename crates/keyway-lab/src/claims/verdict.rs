//! Rule for the verdicts on figures and on claims.
//!
//! A figure is a statement about one measure. It *holds*, *does not hold* or *cannot be decided*,
//! by the 95 % interval of the measurements over the family of maps:
//!
//! - *Lower*, *higher*: it holds if the whole interval of the mean change lies on that side of
//!   zero and the mean is at least half of the published change, if there is one. It does not
//!   hold if the whole interval lies on the other side, or is less than half of the published
//!   change.
//! - *The same*: it holds if the whole interval lies within the tolerance of the figure, and does
//!   not hold if the whole interval lies outside. *Not higher*: the same, but lower values also
//!   hold.
//! - *Always* (a bound that is kept, a path that is found): it holds if that is true on
//!   significantly more than nine maps in ten (\[Wilson1927\]), and does not hold if it is true
//!   on significantly fewer. One odd map in a hundred therefore does not refute a paper, and ten
//!   maps do not prove it.
//! - Otherwise it cannot be decided.
//!
//! Times are reported and not judged: they depend on the clock, the machine and the effort put
//! into each implementation.
//!
//! A claim holds if all of its judged figures hold. If none of them holds, the claim does not
//! hold, or is undecided if no figure contradicts the paper. Otherwise it is mixed, and the
//! counts give the details. A figure that could not be measured leaves the claim without a
//! verdict: missing data supports neither side.

use super::claim::{Direction, Expected, Figure};
use keyway_sim::metrics::statistics::{Confidence, Rate};
use serde::Serialize;

/// Share of maps above which a statement counts as always true.
const NEARLY_ALWAYS: f64 = 0.9;

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

/// Verdict on a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FigureVerdict {
    /// The measurement agrees with the paper.
    Holds,
    /// The measurement contradicts the paper.
    DoesNotHold,
    /// The measurement is compatible with both.
    Undecided,
    /// The figure is a time.
    NotJudged,
    /// There is no evidence, or evidence of another kind.
    NotMeasured,
}

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All figures hold.
    Holds,
    /// Some figures hold, but not all.
    Mixed,
    /// No figure holds, and at least one does not hold.
    DoesNotHold,
    /// No figure can be decided.
    Undecided,
    /// All figures are times.
    NotJudged,
    /// There is no evidence for one of the figures.
    NotMeasured,
}

/// Numbers of the figures with each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct FigureCounts {
    /// Figures that hold.
    pub holds: usize,
    /// Figures that do not hold.
    pub does_not_hold: usize,
    /// Figures that cannot be decided.
    pub undecided: usize,
    /// Figures that are times.
    pub not_judged: usize,
    /// Figures that could not be measured.
    pub not_measured: usize,
}

impl FigureVerdict {
    /// Judges a figure.
    pub fn of(figure: &Figure, evidence: Evidence) -> Self {
        if figure.measure.is_timed() {
            return Self::NotJudged;
        }
        match (figure.expected, evidence) {
            (Expected::Change { direction, .. }, Evidence::Change { mean, low, high }) => {
                let half = figure.published_effect().map_or(0.0, |effect| 0.5 * effect.abs());
                Self::of_change(direction, half, [mean, low, high])
            }
            (Expected::Always(_), Evidence::Kept(rate)) => {
                rate.interval(Confidence::USUAL).map_or(Self::NotMeasured, |share| {
                    Self::by(share.low > NEARLY_ALWAYS, share.high < NEARLY_ALWAYS)
                })
            }
            _ => Self::NotMeasured,
        }
    }

    /// Judges a change; `half` is half of the published one, 0 if none was published.
    fn of_change(direction: Direction, half: f64, [mean, low, high]: [f64; 3]) -> Self {
        match direction {
            Direction::Higher => Self::by(low > 0.0 && mean >= half, high <= 0.0 || high < half),
            Direction::Lower => Self::of_change(Direction::Higher, half, [-mean, -high, -low]),
            Direction::Same { within } => {
                Self::by(low >= -within && high <= within, low > within || high < -within)
            }
            Direction::NotHigher { beyond } => Self::by(high <= beyond, low > beyond),
        }
    }

    const fn by(holds: bool, does_not_hold: bool) -> Self {
        match (holds, does_not_hold) {
            (true, _) => Self::Holds,
            (false, true) => Self::DoesNotHold,
            (false, false) => Self::Undecided,
        }
    }
}

impl FigureCounts {
    /// Counts the verdicts on figures.
    pub fn of(verdicts: impl IntoIterator<Item = FigureVerdict>) -> Self {
        let mut counts = Self::default();
        for verdict in verdicts {
            let count = match verdict {
                FigureVerdict::Holds => &mut counts.holds,
                FigureVerdict::DoesNotHold => &mut counts.does_not_hold,
                FigureVerdict::Undecided => &mut counts.undecided,
                FigureVerdict::NotJudged => &mut counts.not_judged,
                FigureVerdict::NotMeasured => &mut counts.not_measured,
            };
            *count += 1;
        }
        counts
    }

    /// The verdict on a claim with these figures.
    pub const fn verdict(self) -> Verdict {
        match self {
            Self { not_measured: 1.., .. } => Verdict::NotMeasured,
            Self { holds: 1.., does_not_hold: 0, undecided: 0, .. } => Verdict::Holds,
            Self { holds: 1.., .. } => Verdict::Mixed,
            Self { does_not_hold: 1.., .. } => Verdict::DoesNotHold,
            Self { undecided: 1.., .. } => Verdict::Undecided,
            Self { not_judged: 1.., .. } => Verdict::NotJudged,
            _ => Verdict::NotMeasured,
        }
    }
}

impl std::fmt::Display for FigureVerdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
            Self::Undecided => "undecided",
            Self::NotJudged => "a time",
            Self::NotMeasured => "not measured",
        })
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::Mixed => "mixed",
            Self::DoesNotHold => "does not hold",
            Self::Undecided => "undecided",
            Self::NotJudged => "only times",
            Self::NotMeasured => "not measured",
        })
    }
}

/// Writes, for example, `4 hold, 1 does not, 2 undecided`; empty without a judged figure.
impl std::fmt::Display for FigureCounts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers = [
            (self.holds, "holds", "hold"),
            (self.does_not_hold, "does not", "do not"),
            (self.undecided, "undecided", "undecided"),
        ];
        let parts = numbers.into_iter().filter(|(count, ..)| *count > 0);
        let words = parts
            .map(|(count, one, more)| format!("{count} {}", if count == 1 { one } else { more }));
        f.write_str(&words.collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::{Bound, Measure};
    use FigureVerdict::{DoesNotHold, Holds, NotJudged, NotMeasured, Undecided};

    /// Half as many: a change of -0.5.
    const HALVED: Figure = Figure::lower(Measure::Expanded, "new", "old", Some([8.0, 4.0]));
    const LONGER: Figure = Figure::higher(Measure::Length, "new", "old", None);
    const SAME: Figure = Figure::same(Measure::Length, "new", "old", 0.25, Some([4.0, 4.0]));
    const KEPT: Figure = Figure::always(Measure::Clearance, "new", Bound::AtLeast(0.5));

    #[track_caller]
    fn change(figure: Figure, [mean, low, high]: [f64; 3], verdict: FigureVerdict) {
        let evidence = Evidence::Change { mean, low, high };
        assert_eq!(FigureVerdict::of(&figure, evidence), verdict, "{figure:?} {evidence:?}");
    }

    #[test]
    fn against_a_published_change() {
        change(HALVED, [-0.4, -0.5, -0.3], Holds);
        change(HALVED, [-0.25, -0.5, -0.125], Holds); // exactly half
        change(HALVED, [-0.249, -0.5, -0.125], Undecided);
        change(HALVED, [-0.2, -0.24, -0.125], DoesNotHold); // certainly less than half
        change(HALVED, [-0.4, -0.9, 0.0], Undecided); // touches zero
        change(HALVED, [0.4, 0.3, 0.5], DoesNotHold); // opposite direction
        change(HALVED, [0.0, 0.0, 0.0], DoesNotHold);
    }

    #[test]
    fn by_sign_where_nothing_was_published() {
        change(LONGER, [1e-9, 1e-12, 1.0], Holds);
        change(LONGER, [0.1, 0.0, 1.0], Undecided);
        change(LONGER, [-0.1, -0.2, -0.05], DoesNotHold);
        change(LONGER, [-0.1, -0.2, 0.0], DoesNotHold); // nowhere longer
    }

    #[test]
    fn the_same_and_not_higher() {
        change(SAME, [0.1, -0.25, 0.25], Holds); // both ends included
        change(SAME, [0.1, 0.05, 0.26], Undecided);
        change(SAME, [0.4, 0.26, 0.5], DoesNotHold);
        change(SAME, [-0.4, -0.5, -0.26], DoesNotHold);
        let figure = Figure::not_higher(Measure::RunTime, "new", "old", 0.25);
        change(figure, [0.1, -0.25, 0.25], Holds);
        change(figure, [-0.6, -0.7, -0.5], Holds);
        change(figure, [0.1, 0.05, 0.26], Undecided);
        change(figure, [0.4, 0.26, 0.5], DoesNotHold);
    }

    #[test]
    fn nearly_always() {
        let kept = |successes, failures| {
            FigureVerdict::of(&KEPT, Evidence::Kept(Rate { successes, failures }))
        };
        // Wilson's intervals: 96.3 to 100, 90.2 to 98.4, 88.8 to 97.8, 76.7 to 90.7, 75.6 to 89.8
        // %.
        assert_eq!([kept(100, 0), kept(96, 4)], [Holds, Holds]);
        assert_eq!([kept(95, 5), kept(85, 15)], [Undecided, Undecided]);
        assert_eq!([kept(84, 16), kept(0, 100)], [DoesNotHold, DoesNotHold]);
        // Ten maps prove nothing, and no map is no evidence.
        assert_eq!([kept(10, 0), kept(0, 0)], [Undecided, NotMeasured]);
    }

    #[test]
    fn times_are_not_judged_and_missing_data_speaks_for_nobody() {
        let time = Figure::lower(Measure::SearchTime, "new", "old", None);
        let faster = Evidence::Change { mean: -0.5, low: -0.6, high: -0.4 };
        assert_eq!(FigureVerdict::of(&time, faster), NotJudged);
        assert_eq!(FigureVerdict::of(&time, Evidence::Missing), NotJudged);
        assert_eq!(FigureVerdict::of(&HALVED, Evidence::Missing), NotMeasured);
        // Evidence of another kind counts as none.
        let rate = Evidence::Kept(Rate { successes: 100, failures: 0 });
        assert_eq!(FigureVerdict::of(&HALVED, rate), NotMeasured);
        assert_eq!(FigureVerdict::of(&KEPT, faster), NotMeasured);
    }

    #[test]
    fn a_claim_from_its_figures() {
        let of = |figures: &[FigureVerdict]| {
            let counts = FigureCounts::of(figures.iter().copied());
            (counts.verdict(), counts.to_string())
        };
        assert_eq!(of(&[Holds, NotJudged, Holds]), (Verdict::Holds, "2 hold".to_owned()));
        let mixed = of(&[Holds, DoesNotHold, DoesNotHold, Undecided, NotJudged]);
        assert_eq!(mixed, (Verdict::Mixed, "1 holds, 2 do not, 1 undecided".to_owned()));
        assert_eq!(of(&[Holds, Undecided]).0, Verdict::Mixed);
        let against = of(&[DoesNotHold, Undecided]);
        assert_eq!(against, (Verdict::DoesNotHold, "1 does not, 1 undecided".to_owned()));
        assert_eq!(of(&[Undecided]).0, Verdict::Undecided);
        assert_eq!(of(&[NotJudged]), (Verdict::NotJudged, String::new()));
        assert_eq!([of(&[]).0, of(&[Holds, NotMeasured]).0], [Verdict::NotMeasured; 2]);
        assert_eq!(serde_json::to_value(Verdict::NotJudged).unwrap(), "not_judged");
    }
}
