//! The claims as a table for papers.

use super::VERDICT_RULE;
use super::words::{measured, published, words};
use keyway_lab::claims::ClaimReport;
use keyway_lab::table::{comment, latex_table};

pub(super) fn latex(claims: &[ClaimReport]) -> String {
    let header = ["claim", "verdict", "figure", "published", "measured (95 % interval)"];
    let rows: Vec<Vec<String>> = claims
        .iter()
        .flat_map(|claim| {
            claim.family.figures.iter().map(|figure| {
                let (published, measured) = (published(claim, figure), measured(figure));
                let verdict = claim.verdict.to_string();
                vec![claim.id.to_owned(), verdict, words(figure), published, measured]
            })
        })
        .collect();
    comment(VERDICT_RULE) + &latex_table(&header, &rows, 3)
}
