//! The claims as a table for people.

use super::figure_rows::published_of;
use crate::table::{paragraph, rows};
use keyway::claims::{ClaimReport, ExperimentReport, FamilyFigure, Measure, Scale, Verdict};

/// One line for each figure; the claim and its verdict stand in the first one.
pub(super) fn table(claims: &[ClaimReport]) -> String {
    let header = ["claim", "statement", "figure", "published", "measured", "verdict"];
    let lines = claims.iter().flat_map(lines).collect();
    rows(&header, lines, 3)
}

fn lines(claim: &ClaimReport) -> Vec<Vec<String>> {
    let figures = claim.family.as_ref().map_or(&[][..], |family| &family.figures);
    let line = |[figure, published, measured]: [String; 3], is_first: bool| {
        let of_claim = |text: String| if is_first { text } else { String::new() };
        let [id, statement] = [claim.id, claim.statement].map(|text| of_claim(text.to_owned()));
        vec![id, statement, figure, published, measured, of_claim(claim.verdict.to_string())]
    };
    if figures.is_empty() {
        return vec![line(Default::default(), true)];
    }
    let cells = |figure: &FamilyFigure| {
        let effect = published_of(claim, figure).and_then(|published| published.effect);
        let published = effect.map_or_else(|| "-".to_owned(), |effect| change(figure, effect));
        [words(figure), published, measured(figure)]
    };
    figures.iter().enumerate().map(|(i, figure)| line(cells(figure), i == 0)).collect()
}

/// Such as `expanded lower than astar`.
fn words(figure: &FamilyFigure) -> String {
    let expected = figure.expected.replace('_', " ");
    let limit = figure.limit.map(|limit| (limit * 1e6).round() / 1e6);
    let tail = match (figure.than, limit) {
        (Some(than), Some(limit)) => format!("{expected} within {} % as {than}", limit * 100.0),
        (Some(than), None) => format!("{expected} than {than}"),
        (None, Some(limit)) => format!("{expected} {limit} {}", figure.unit),
        (None, None) => expected,
    };
    format!("{} {}", name(figure.measure), tail.trim_end())
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
         method found no path:",
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
