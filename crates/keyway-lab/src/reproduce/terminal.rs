//! The claims as a table for the terminal.

use super::report::ReproduceReport;
use super::words::{measured_text, papers_of, published_text, statement};
use crate::claims::{ClaimReport, ExperimentReport, FamilyFigure, Verdict};
use crate::table::{paragraph, rows};

/// Table for the terminal: a line for each claim with its verdict, below it one for each figure.
pub fn claims_table(claims: &[ClaimReport]) -> String {
    let header = ["claim", "statement, figures", "published", "measured", "verdict"];
    rows(&header, claims.iter().flat_map(lines).collect(), 2)
}

fn lines(claim: &ClaimReport) -> Vec<Vec<String>> {
    let [id, of_claim] = [claim.id, claim.statement].map(str::to_owned);
    let verdict = claim.verdict.to_string();
    let of_claim = vec![id, of_claim, String::new(), String::new(), verdict];
    let of_figure = |figure: &FamilyFigure| {
        let (words, published) =
            (format!("- {}", statement(figure)), published_text(claim, figure));
        let verdict = figure.verdict.map(|verdict| verdict.to_string()).unwrap_or_default();
        vec![String::new(), words, published, measured_text(figure), verdict]
    };
    let figures = claim.family.figures.iter().map(of_figure);
    std::iter::once(of_claim).chain(figures).collect()
}

/// Texts below the table: the number of maps of each experiment, and claims that are not measured.
pub fn claims_notes(report: &ReproduceReport) -> Vec<String> {
    let mut notes = vec![paragraph(
        "\nMeasured: mean change over the maps, and its 95 % interval. Number of maps, and of others that \
         were left out because a method found no path or did not reach its goal:",
    )];
    notes.extend(report.experiments.iter().map(|one| {
        let ExperimentReport { experiment, about, maps, left_out, .. } = one;
        format!("  {experiment}: {maps}, left out {left_out}; {about}")
    }));
    notes.push(paragraph(&papers_of(&report.claims)));
    let is_missing = |claim: &&ClaimReport| claim.verdict == Verdict::NotMeasured;
    let missing: Vec<&str> =
        report.claims.iter().filter(is_missing).map(|claim| claim.id).collect();
    if !missing.is_empty() {
        notes.push(paragraph(&format!("Not measured: {}.", missing.join(", "))));
    }
    notes
}
