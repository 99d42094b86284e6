//! Claims of a paper, as data.

use super::experiment::Experiment;
use super::measure::{Measure, Scale};
use serde::Serialize;

/// A claim of a paper, with its published figures and its experiment.
#[derive(Debug)]
pub struct Claim {
    /// Name such as `S0-1`; see [`Self::all`].
    pub id: &'static str,
    /// Key of the paper in docs/papers.md.
    pub paper: &'static str,
    /// The claim in a sentence.
    pub statement: &'static str,
    /// Figures of the claim; it holds if all of them do.
    pub figures: &'static [Figure],
    /// Experiment that measures the claim.
    pub experiment: &'static Experiment,
}

/// One part of a claim: the statement about one measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// The measure.
    pub measure: Measure,
    /// Method of the experiment to which the measure applies; for a driving claim, a stack.
    pub of: &'static str,
    /// Statement of the paper about it.
    pub expected: Expected,
}

/// Statement of a paper about a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// The measure differs from that of another method.
    Change {
        /// The other method.
        than: &'static str,
        /// Direction of the difference.
        direction: Direction,
        /// Published values of the other method and of this one; `None` if the paper has no
        /// comparable figures.
        published: Option<[f64; 2]>,
    },
    /// The measure is within a bound on every map.
    Always(Bound),
}

/// Direction of a difference from another method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// The measure is smaller.
    Lower,
    /// The measure is larger.
    Higher,
    /// The measure is the same, up to this change.
    Same {
        /// Tolerance, on the scale of [`Measure::scale`].
        within: f64,
    },
    /// The measure is not larger, up to this change.
    NotHigher {
        /// Tolerance, on the scale of [`Measure::scale`].
        beyond: f64,
    },
}

/// An inclusive bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// At least this value.
    AtLeast(f64),
    /// At most this value.
    AtMost(f64),
}

/// Rule by which a claim is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Comparison with published figures.
    Figures,
    /// Sign alone: nothing comparable was published.
    Sign,
}

impl Claim {
    /// Returns the rule, which depends on whether anything comparable was published.
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

    /// The measure of a method is larger than that of another one.
    pub(super) const fn higher(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self::change(measure, [of, than], Direction::Higher, published)
    }

    /// The measure of a method is the same as that of another one.
    pub(super) const fn same(
        measure: Measure,
        of: &'static str,
        than: &'static str,
        within: f64,
        published: Option<[f64; 2]>,
    ) -> Self {
        Self::change(measure, [of, than], Direction::Same { within }, published)
    }

    /// The measure of a method is at most slightly larger than that of another one. No values of
    /// such a figure were published.
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

    /// The measure of a method is within a bound on every map.
    pub(super) const fn always(measure: Measure, of: &'static str, bound: Bound) -> Self {
        Self { measure, of, expected: Expected::Always(bound) }
    }

    /// Returns the published values of the other method and of this one.
    pub const fn published(&self) -> Option<[f64; 2]> {
        match self.expected {
            Expected::Change { published, .. } => published,
            Expected::Always(_) => None,
        }
    }

    /// Returns the scale on which values are compared: [`Measure::scale`], except for heading jumps
    /// without a published change. These are compared by their difference, since a smooth path has
    /// none.
    pub fn scale(&self) -> Scale {
        match self.measure {
            Measure::NonSmoothTurns if self.published().is_none() => Scale::Absolute,
            measure => measure.scale(),
        }
    }

    /// Returns the published change, on the scale of [`Self::scale`].
    pub fn published_effect(&self) -> Option<f64> {
        self.published().and_then(|[old, new]| self.scale().change(old, new))
    }

    /// Returns the other method.
    pub const fn than(&self) -> Option<&'static str> {
        match self.expected {
            Expected::Change { than, .. } => Some(than),
            Expected::Always(_) => None,
        }
    }
}

impl Bound {
    /// True if a value is within the bound.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtLeast(least) => value >= least,
            Self::AtMost(most) => value <= most,
        }
    }
}

impl Scale {
    /// Returns the change from one value to another; `None` for a relative change from 0 to another
    /// value.
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
    fn there_are_31_claims_each_with_a_name_of_its_own() {
        let ids: BTreeSet<&str> = Claim::all().map(|claim| claim.id).collect();
        assert_eq!((ids.len(), Claim::all().count()), (31, 31));
        let counts =
            ["s0", "s1", "s2", "S4", "all", "s3", "", "s"].map(|name| Claim::named(name).len());
        assert_eq!(counts, [7, 8, 6, 10, 31, 0, 0, 0]);
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

    /// Percentages printed in the papers, from the printed values.
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
        assert_eq!([0, 1, 6, 7].map(|i| per_cent("S4-1", i)), [-81.82, -64.63, -77.78, -75.0]);
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
        // A relative change from zero heading jumps is undefined.
        let jumps = |published| Figure::lower(Measure::NonSmoothTurns, "new", "old", published);
        assert_eq!(jumps(None).scale(), Scale::Absolute);
        assert_eq!(jumps(Some([18.0, 0.0])).published_effect(), Some(-1.0));
    }
}
