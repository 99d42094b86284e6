//! The claims as a table for people.

use super::figure_rows::published_of;
use crate::table::{paragraph, rows};
use keyway::claims::{ClaimReport, ExperimentReport, FamilyFigure, Measure, Scale, Verdict};

/// A line for each claim with its verdict, below it one for each of its figures.
pub(super) fn table(claims: &[ClaimReport]) -> String {
    let header = ["claim", "statement, figures", "published", "measured", "verdict"];
    rows(&header, claims.iter().flat_map(lines).collect(), 2)
}

fn lines(claim: &ClaimReport) -> Vec<Vec<String>> {
    let [id, statement] = [claim.id, claim.statement].map(str::to_owned);
    let verdict = claim.verdict.to_string();
    let of_claim = vec![id, statement, String::new(), String::new(), verdict];
    let of_figure = |figure: &FamilyFigure| {
        let effect = published_of(claim, figure).and_then(|published| published.effect);
        let published = effect.map_or_else(|| "-".to_owned(), |effect| change(figure, effect));
        let words = format!("- {}", words(figure));
        vec![String::new(), words, published, measured(figure), String::new()]
    };
    let figures = claim.family.iter().flat_map(|family| &family.figures).map(of_figure);
    std::iter::once(of_claim).chain(figures).collect()
}

/// Such as `expanded of bidirectional-astar, lower than astar`.
fn words(figure: &FamilyFigure) -> String {
    let (name, of) = (name(figure.measure), figure.of);
    let expected = figure.expected.replace('_', " ");
    let limit = figure.limit.map(|limit| (limit * 1e6).round() / 1e6);
    let tail = match (figure.than, limit) {
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

/// The name of a measure as in JSON, in words.
fn name(measure: Measure) -> String {
    // A name is plain data: this cannot fail.
    let value = serde_json::to_value(measure).unwrap_or_default();
    value.as_str().unwrap_or_default().replace('_', " ")
}

/// The mean change and its interval; of a bound, on how many maps it is kept.
fn measured(figure: &FamilyFigure) -> String {
    let (Some(mean), Some(low), Some(high)) = (figure.mean, figure.ci95_low, figure.ci95_high)
    else {
        return "-".to_owned();
    };
    if figure.than.is_none() {
        let kept = (mean * figure.pairs as f64).round();
        return format!("on {kept} of {} maps", figure.pairs);
    }
    format!("{} ({} to {})", change(figure, mean), number(figure, low), number(figure, high))
}

/// With its unit.
fn change(figure: &FamilyFigure, effect: f64) -> String {
    let unit = if figure.scale == Scale::Relative { "%" } else { figure.unit };
    format!("{} {unit}", number(figure, effect)).trim_end().to_owned()
}

fn number(figure: &FamilyFigure, effect: f64) -> String {
    match figure.scale {
        Scale::Relative => format!("{:+.2}", effect * 100.0),
        Scale::Absolute => format!("{effect:+.3}"),
    }
}

/// What stands below the table: how many maps there were, and which claims are not measured.
pub(super) fn notes(claims: &[ClaimReport], experiments: &[ExperimentReport]) -> Vec<String> {
    let mut notes = vec![paragraph(
        "\nMeasured: mean over the maps of the change on each, and its 95 % interval. Maps, and how many more were left out because a \
         method found no path, or did not reach its goal:",
    )];
    notes.extend(experiments.iter().map(|one| {
        let ExperimentReport { experiment, about, maps, left_out, .. } = one;
        format!("  {experiment}: {maps}, left out {left_out}; {about}")
    }));
    let missing: Vec<&str> = claims
        .iter()
        .filter(|claim| claim.verdict == Verdict::NotMeasured)
        .map(|claim| claim.id)
        .collect();
    if !missing.is_empty() {
        notes.push(paragraph(&format!("Not measured: {}.", missing.join(", "))));
    }
    notes
}
