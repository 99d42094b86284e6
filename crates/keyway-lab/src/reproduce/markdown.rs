//! The tables of the documentation: `tables.md`.

use super::report::ReproduceReport;
use super::words::{COARSE, NONE, measure_name, reconstructed_of, statement_with};
use crate::claims::{AblationReport, ClaimReport, ExperimentReport, FamilyFigure, Verdict};
use std::fmt::Write as _;
use std::ops::Range;

/// Returns all tables, each below a heading.
pub(super) fn markdown(report: &ReproduceReport) -> String {
    let ReproduceReport { claims, experiments, ablations, .. } = report;
    let mut text = format!("# Tables\n\n{}\n\n", counted(claims));
    let in_short = table(
        &["claim", "what it says", "published", "measured", "verdict"],
        2..4,
        in_short(claims),
    );
    let figures = table(
        &["claim", "figure", "published", "measured", "on maps that fit", "verdict"],
        2..5,
        claims.iter().flat_map(figures).collect(),
    );
    let maps = format!("maps tried for {} that count", report.maps);
    let header = ["experiment", maps.as_str(), "of these succeeded"];
    let experiments = table(&header, 1..2, experiments.iter().map(experiment).collect());
    for (heading, table) in
        [("Claims in short", in_short), ("Claims", figures), ("Experiments", experiments)]
    {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "## {heading}\n\n{table}");
    }
    for one in ablations {
        let _ = writeln!(text, "## Ablation {}\n\n{}\n", one.experiment, about(one));
        text.push_str(&ablation(one));
        text.push('\n');
    }
    text
}

/// Such as `Of the 28 claims 5 hold, 18 hold in part, 5 do not hold.`
fn counted(claims: &[ClaimReport]) -> String {
    let of = |verdict| claims.iter().filter(|claim| claim.verdict == verdict).count();
    let [hold, in_part, not, missing] =
        [Verdict::Holds, Verdict::HoldsInPart, Verdict::DoesNotHold, Verdict::NotMeasured].map(of);
    let missing = if missing > 0 { format!(", {missing} are not measured") } else { String::new() };
    let count = claims.len();
    format!(
        "Of the {count} claims {hold} hold, {in_part} hold in part, {not} do not hold{missing}."
    )
}

/// Returns a table whose columns of `numbers` are aligned to the right.
fn table(header: &[&str], numbers: Range<usize>, rows: Vec<Vec<String>>) -> String {
    let rule = |i: usize| if numbers.contains(&i) { "--:|" } else { "---|" };
    let rule: String = (0..header.len()).map(rule).collect();
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rows: String = rows.into_iter().map(row).collect();
    format!("| {} |\n|{rule}\n{rows}", header.join(" | "))
}

/// Returns each claim with its first figure that no clock measures.
fn in_short(claims: &[ClaimReport]) -> Vec<Vec<String>> {
    let row = |claim: &ClaimReport| {
        let figures = &claim.family.figures;
        let figure = figures.iter().find(|it| !it.measure.is_timed()).or(figures.first());
        let measured = figure.map_or(NONE.to_owned(), |figure| {
            let kept = if figure.than.is_none() { "as claimed on " } else { "" };
            format!("{}: {kept}{}", measure_name(figure.measure), measured(figure))
        });
        let published = figure.map_or(NONE.to_owned(), |figure| published(claim, figure));
        let id = format!("[{}](papers/{}.md)", claim.id, claim.paper.to_lowercase());
        vec![id, claim.statement.to_owned(), published, measured, claim.verdict.to_string()]
    };
    claims.iter().map(row).collect()
}

/// The name and the verdict of a claim stand beside its first figure.
fn figures(claim: &ClaimReport) -> Vec<Vec<String>> {
    let row = |(i, figure): (usize, &FamilyFigure)| {
        let [id, verdict] = match i {
            0 => [claim.id.to_owned(), format!("**{}**", claim.verdict)],
            _ => [String::new(), String::new()],
        };
        let fitting = reconstructed_of(claim, figure).map_or(NONE.to_owned(), measured);
        let of_method = |method: &str| format!("`{method}`");
        let words = statement_with(figure, &of_method);
        vec![id, words, published(claim, figure), measured(figure), fitting, verdict]
    };
    claim.family.figures.iter().enumerate().map(row).collect()
}

fn experiment(one: &ExperimentReport) -> Vec<String> {
    let tried = one.maps + one.left_out;
    let succeeded: Vec<String> = one
        .methods
        .iter()
        .map(|method| format!("`{}` {}", method.method, method.succeeded))
        .collect();
    let maps = format!("`{}`: {}", one.experiment, one.about);
    vec![maps, tried.to_string(), succeeded.join(", ")]
}

fn about(one: &AblationReport) -> String {
    let AblationReport { about, base, maps, .. } = one;
    format!("{about}: change from \"{base}\" on {maps} maps.")
}

/// Returns a line for each variant, a column for each quantity.
fn ablation(one: &AblationReport) -> String {
    let measures = one.measures();
    let names: Vec<String> = measures.iter().map(|&measure| measure_name(measure)).collect();
    let header: Vec<&str> =
        std::iter::once("variant").chain(names.iter().map(String::as_str)).collect();
    // The measures of a variant follow each other.
    let row = |own: &[FamilyFigure]| {
        let variant = own.first().map_or("", |figure| figure.of).to_owned();
        std::iter::once(variant).chain(own.iter().map(measured)).collect()
    };
    let rows = one.figures.chunks(measures.len().max(1)).map(row).collect();
    table(&header, 1..header.len(), rows)
}

fn published(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    COARSE.published(claim, figure)
}

fn measured(figure: &FamilyFigure) -> String {
    COARSE.measured(figure)
}
