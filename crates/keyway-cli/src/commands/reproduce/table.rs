//! The claims as a table for people.

use super::words::{measured, published, words};
use keyway_lab::claims::{ClaimReport, ExperimentReport, FamilyFigure, Verdict};
use keyway_lab::table::{paragraph, rows};

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
        let words = format!("- {}", words(figure));
        vec![String::new(), words, published(claim, figure), measured(figure), String::new()]
    };
    let figures = claim.family.figures.iter().map(of_figure);
    std::iter::once(of_claim).chain(figures).collect()
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
