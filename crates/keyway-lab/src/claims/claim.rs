//! What a paper claims, as data.

use super::experiment::Experiment;
use super::measure::{Measure, Scale};
use serde::Serialize;

/// A claim of a paper, what it published, and how it is measured again.
#[derive(Debug)]
pub struct Claim {
    /// Such as `S0-1`; see [`Self::all`].
    pub id: &'static str,
    /// Key of the paper in docs/PAPERS.md.
    pub paper: &'static str,
    /// The claim in a sentence.
    pub statement: &'static str,
    /// What it says in detail; it holds when all of it does.
    pub figures: &'static [Figure],
    /// How it is measured.
    pub experiment: &'static Experiment,
}

/// One part of a claim: what one measure does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// What is measured ...
    pub measure: Measure,
    /// ... of this method of the experiment (of a driving claim, of this stack).
    pub of: &'static str,
    /// What the paper says of it.
    pub expected: Expected,
}

/// What a paper says of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// It differs from that of another method.
    Change {
        /// The other method.
        than: &'static str,
        /// How it differs.
        direction: Direction,
        /// Published values of the other method and of this one; `None` where the paper has no comparable figures.
        published: Option<[f64; 2]>,
    },
    /// It is within a bound on every map.
    Always(Bound),
}

/// How a measure differs from that of another method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// It is smaller.
    Lower,
    /// It is larger.
    Higher,
    /// It is the same, up to this change.
    Same {
        /// As [`Measure::scale`] has it.
        within: f64,
    },
    /// It is not larger, up to this change.
    NotHigher {
        /// As [`Measure::scale`] has it.
        beyond: f64,
    },
}

/// A bound, itself included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// At least this.
    AtLeast(f64),
    /// At most this.
    AtMost(f64),
}

/// How a claim is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Against published figures.
    Figures,
    /// By the sign alone: nothing comparable was published.
    Sign,
}

impl Claim {
    /// Whether anything comparable was published.
    pub fn rule(&self) -> Rule {
        let is_published = self.figures.iter().any(|figure| figure.published().is_some());
        if is_published { Rule::Figures } else { Rule::Sign }
    }
}

impl Figure {
    /// The measure of a method is smaller than that of another one.
    pub(super) const fn lower(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self::change(measure, [of, than], Direction::Lower, published)
    }

    /// It is larger.
    pub(super) const fn higher(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self::change(measure, [of, than], Direction::Higher, published)
    }

    /// It is the same.
    pub(super) const fn same(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        within: f64,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self::change(measure, [of, than], Direction::Same { within }, published)
    }

    /// It is hardly larger, if at all. Nothing was published of such a figure.
    pub(super) const fn not_higher(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        beyond: f64,
    ) -> Self {
        Self::change(measure, [of, than], Direction::NotHigher { beyond }, None)
    }

    const fn change(
        measure: Measure,
        [of, than]: [&'static str; 2],
        direction: Direction,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self { measure, of, expected: Expected::Change { than, direction, published } }
    }

    /// It is within a bound on every map.
    pub(super) const fn always(measure: Measure, of: &'static str, bound: Bound) -> Self {
        Self { measure, of, expected: Expected::Always(bound) }
    }

    /// Published values of the other method and of this one.
    pub const fn published(&self) -> Option<[f64; 2]> {
        match self.expected {
            Expected::Change { published, .. } => published,
            Expected::Always(_) => None,
        }
    }

    /// How values are compared: as [`Measure::scale`] has it, but heading jumps, of which a smooth path has none, by their difference where no
    /// change of them was published.
    pub fn scale(&self) -> Scale {
        match self.measure {
            Measure::NonSmoothTurns if self.published().is_none() => Scale::Absolute,
            measure => measure.scale(),
        }
    }

    /// The published change, as [`Self::scale`] has it.
    pub fn published_effect(&self) -> Option<f64> {
        self.published().and_then(|[old, new]| self.scale().change(old, new))
    }

    /// The other method.
    pub const fn than(&self) -> Option<&'static str> {
        match self.expected {
            Expected::Change { than, .. } => Some(than),
            Expected::Always(_) => None,
        }
    }
}

impl Bound {
    /// Whether a value is within it.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtLeast(least) => value >= least,
            Self::AtMost(most) => value <= most,
        }
    }
}

impl Scale {
    /// The change from one value to another; `None` for a relative one from 0 to something else.
    pub fn change(self, old: f64, new: f64) -> Option<f64> {
        match self {
            Self::Absolute => Some(new - old),
            Self::Relative if old == new => Some(0.0),
            Self::Relative => (old != 0.0).then(|| (new - old) / old),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn there_are_28_claims_each_with_a_name_of_its_own() {
        let ids: BTreeSet<&str> = Claim::all().map(|claim| claim.id).collect();
        assert_eq!((ids.len(), Claim::all().count()), (28, 28));
        let counts =
            ["s0", "s1", "s2", "S4", "all", "s3", "", "s"].map(|name| Claim::named(name).len());
        assert_eq!(counts, [7, 8, 6, 7, 28, 0, 0, 0]);
        let one: Vec<&str> = Claim::named("s4-1").iter().map(|claim| claim.id).collect();
        assert_eq!(one, ["S4-1"]);
    }

    #[test]
    fn published_figures_go_the_way_that_is_claimed() {
        for claim in Claim::all() {
            assert!(!claim.figures.is_empty(), "{}", claim.id);
            for figure in claim.figures {
                let Expected::Change { direction, .. } = figure.expected else { continue };
                let Some(effect) = figure.published_effect() else { continue };
                let is_right = match direction {
                    Direction::Lower => effect < 0.0,
                    Direction::Higher => effect > 0.0,
                    Direction::Same { within } => effect.abs() <= within,
                    Direction::NotHigher { beyond } => effect <= beyond,
                };
                assert!(is_right, "{} {figure:?}", claim.id);
            }
        }
    }

    /// Percentages that the papers print, from the values that they print.
    #[test]
    fn published_percentages() {
        let per_cent = |id: &str, figure: usize| {
            let effect = Claim::named(id)[0].figures[figure].published_effect().unwrap();
            (effect * 1e4).round() / 1e2
        };
        assert_eq!([0, 1, 2].map(|i| per_cent("S0-1", i)), [-50.87, -59.77, -1.77]);
        assert_eq!([1, 2].map(|i| per_cent("S0-3", i)), [-3.75, 11.4]);
        assert_eq!([2, 5].map(|i| per_cent("S4-3", i)), [-2.45, -70.48]);
        assert_eq!(per_cent("S4-4", 0), -58.75);
        assert_eq!([0, 1].map(|i| per_cent("S1-1", i)), [-43.22, -29.94]);
        assert_eq!([0, 2].map(|i| per_cent("S1-2", i)), [-0.21, -4.51]);
        assert_eq!([0, 1, 2, 3].map(|i| per_cent("S4-1", i)), [-81.82, -64.63, -77.78, -75.0]);
    }

    #[test]
    fn methods_of_a_measured_claim_are_those_of_its_experiment() {
        for claim in Claim::all() {
            for figure in claim.figures {
                for name in [Some(figure.of), figure.than()].into_iter().flatten() {
                    assert!(claim.experiment.method(name).is_some(), "{} {name}", claim.id);
                }
            }
        }
    }

    #[test]
    fn changes() {
        let relative = |old, new| Scale::Relative.change(old, new);
        assert_eq!(
            (relative(4.0, 1.0), relative(0.0, 0.0), relative(0.0, 1.0)),
            (Some(-0.75), Some(0.0), None)
        );
        assert_eq!(Scale::Absolute.change(0.0, 0.75), Some(0.75));
        // From no heading jump at all there is no relative change.
        let jumps = |published| Figure::lower(Measure::NonSmoothTurns, "new", "old", published);
        assert_eq!(jumps(None).scale(), Scale::Absolute);
        assert_eq!(jumps(Some([18.0, 0.0])).published_effect(), Some(-1.0));
    }
}
