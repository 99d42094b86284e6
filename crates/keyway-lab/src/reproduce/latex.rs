//! The claims as a table for papers.

use super::report::VERDICT_RULE;
use super::words::{measured_text, papers_of, published_text, statement};
use crate::claims::{ClaimReport, FamilyFigure};
use crate::table::{comment, latex_table};

/// Returns a line for each figure of each claim.
pub(super) fn latex(claims: &[ClaimReport]) -> String {
    let header = ["claim", "verdict", "figure", "published", "measured (95 % interval)"];
    let line = |claim: &ClaimReport, figure: &FamilyFigure| {
        let id = claim.id.to_owned();
        let verdict = figure.verdict.map(|verdict| verdict.to_string()).unwrap_or_default();
        let published = published_text(claim, figure);
        vec![id, verdict, statement(figure), published, measured_text(figure)]
    };
    let lines = claims
        .iter()
        .flat_map(|claim| claim.family.figures.iter().map(move |figure| line(claim, figure)));
    comment(&format!("{}\n{VERDICT_RULE}", papers_of(claims)))
        + &latex_table(&header, &lines.collect::<Vec<_>>(), 3)
}
