//! Claims and figures in words, for tables, pages and papers.

use crate::claims::{ClaimReport, FamilyFigure, Measure, PublishedFigure, Scale, Verdict};

/// Text for a missing value.
pub(super) const NONE: &str = "-";

/// Authors of the papers, by the code of their claims.
const PAPERS: [(&str, &str); 4] = [
    ("S0", "You, Fang and Tang 2021"),
    ("S1", "an improved A* with an adaptive DWA, published without authors"),
    ("S2", "Wang, Zeng, Huang and Fang 2019"),
    ("S4", "Zhu and Yin 2024"),
];

/// Returns a sentence that says which papers the codes of the claims stand for.
pub(super) fn papers_of(claims: &[ClaimReport]) -> String {
    let is_there = |code: &str| claims.iter().any(|claim| claim.id.split('-').next() == Some(code));
    let papers = PAPERS.iter().filter(|(code, _)| is_there(code));
    let papers: Vec<String> = papers.map(|(code, authors)| format!("{code}: {authors}")).collect();
    format!("{}. Sources: docs/papers.md.", papers.join("; "))
}

/// Number of decimals of changes.
#[derive(Clone, Copy)]
pub(super) struct Decimals {
    /// Decimals of relative changes \[%\].
    relative: usize,
    /// Decimals of differences.
    absolute: usize,
}

/// Decimals if there is enough space.
const FINE: Decimals = Decimals { relative: 2, absolute: 3 };
/// Decimals in the documentation.
pub(super) const COARSE: Decimals = Decimals { relative: 1, absolute: 2 };

impl Decimals {
    /// Returns the published change; a dash if nothing comparable was published.
    pub(super) fn published(self, claim: &ClaimReport, figure: &FamilyFigure) -> String {
        let effect = published_of(claim, figure).and_then(|published| published.effect);
        effect.map_or_else(|| NONE.to_owned(), |effect| self.change(figure, effect))
    }

    /// Returns the mean change and its interval; for a bound, the number of maps on which it is
    /// kept.
    pub(super) fn measured(self, figure: &FamilyFigure) -> String {
        let (Some(mean), Some(low), Some(high)) = (figure.mean, figure.ci95_low, figure.ci95_high)
        else {
            return NONE.to_owned();
        };
        if figure.than.is_none() {
            let kept = (mean * figure.pairs as f64).round();
            return format!("{kept} of {} maps", figure.pairs);
        }
        let [low, high] = [low, high].map(|effect| self.number(figure, effect));
        format!("{} ({low} to {high})", self.change(figure, mean))
    }

    /// Returns a change with its unit.
    fn change(self, figure: &FamilyFigure, effect: f64) -> String {
        let unit = if figure.scale == Scale::Relative { "%" } else { figure.unit };
        format!("{} {unit}", self.number(figure, effect)).trim_end().to_owned()
    }

    fn number(self, figure: &FamilyFigure, effect: f64) -> String {
        match figure.scale {
            Scale::Relative => format!("{:+.*}", self.relative, effect * 100.0),
            Scale::Absolute => format!("{effect:+.*}", self.absolute),
        }
    }
}

/// Returns the verdict on a claim; a mixed one has the number of figures with each verdict.
pub(super) fn verdict_with_counts(claim: &ClaimReport) -> String {
    match claim.verdict {
        Verdict::Mixed => format!("mixed: {}", claim.figures),
        verdict => verdict.to_string(),
    }
}

/// Returns the published values of a figure.
pub fn published_of<'a>(
    claim: &'a ClaimReport,
    figure: &FamilyFigure,
) -> Option<&'a PublishedFigure> {
    let mut all = claim.published.iter().flat_map(|published| &published.figures);
    all.find(|it| (it.measure, it.of, it.than) == (figure.measure, figure.of, figure.than))
}

/// Returns the same figure on the maps that fit the published figures of the baselines.
pub(super) fn reconstructed_of<'a>(
    claim: &'a ClaimReport,
    figure: &FamilyFigure,
) -> Option<&'a FamilyFigure> {
    let mut all = claim.reconstructed.iter().flat_map(|found| &found.figures);
    all.find(|it| (it.measure, it.of, it.than) == (figure.measure, figure.of, figure.than))
}

/// Text of the published change; a dash if nothing comparable was published.
pub fn published_text(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    FINE.published(claim, figure)
}

/// Text of the mean change and its interval; for a bound, of the number of maps on which it is
/// kept.
pub fn measured_text(figure: &FamilyFigure) -> String {
    let text = FINE.measured(figure);
    let is_bound = figure.than.is_none() && text != NONE;
    if is_bound { format!("on {text}") } else { text }
}

/// Text of a change with its unit.
pub(super) fn change_text(figure: &FamilyFigure, effect: f64) -> String {
    FINE.change(figure, effect)
}

/// Text such as `expanded of bidirectional-astar, lower than astar`.
pub fn statement(figure: &FamilyFigure) -> String {
    statement_with(figure, &str::to_owned)
}

/// The same, with a format for the names of methods.
pub(super) fn statement_with(figure: &FamilyFigure, of_method: &dyn Fn(&str) -> String) -> String {
    let (name, of) = (measure_name(figure.measure), of_method(figure.of));
    let expected = figure.expected.replace('_', " ");
    let limit = figure.limit.map(|limit| (limit * 1e6).round() / 1e6);
    let tail = match (figure.than.map(of_method), limit) {
        (Some(than), Some(limit)) if figure.expected == "same" => {
            format!("within {} % of {than}", limit * 100.0)
        }
        (Some(than), Some(limit)) => format!("at most {} % above {than}", limit * 100.0),
        (Some(than), None) => format!("{expected} than {than}"),
        (None, Some(limit)) => format!("{expected} {limit} {}", figure.unit),
        (None, None) => expected,
    };
    format!("{name} of {of}, {}", tail.trim_end())
}

/// Returns the name of a measure as in JSON, with spaces in place of underscores.
pub fn measure_name(measure: Measure) -> String {
    // A name is plain data: this cannot fail.
    let value = serde_json::to_value(measure).unwrap_or_default();
    value.as_str().unwrap_or_default().replace('_', " ")
}
