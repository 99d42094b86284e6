//! The tables of the documentation: `tables.md`.

use super::report::ReproduceReport;
use super::words::{
    COARSE, NONE, measure_name, papers_of, published_of, reconstructed_of, statement_with,
    verdict_with_counts,
};
use crate::claims::{
    AblationReport, ClaimReport, ExperimentReport, FamilyFigure, FigureCounts, FigureVerdict,
    Verdict,
};
use std::fmt::Write as _;
use std::ops::Range;

/// Returns all tables, each below a heading.
pub(super) fn markdown(report: &ReproduceReport) -> String {
    let ReproduceReport { claims, experiments, ablations, .. } = report;
    let mut text = format!("# Tables\n\n{} {}\n\n", counted(claims), papers_of(claims));
    let in_short =
        table(&["claim", "statement", "published", "measured", "verdict"], 2..4, in_short(claims));
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
        text.push_str(&ablation(one, &one.figures));
        if !one.reconstructed.is_empty() {
            let _ = writeln!(text, "\nOn {} maps that fit:\n", one.reconstructed_maps);
            text.push_str(&ablation(one, &one.reconstructed));
        }
        text.push('\n');
    }
    text
}

/// Returns a text such as `Of 28 claims 5 hold, 5 do not, 17 are mixed, 1 has only times. Of
/// their 60 figures 30 hold, 20 do not, 10 undecided; 20 more are times.`
fn counted(claims: &[ClaimReport]) -> String {
    let of = |verdict| claims.iter().filter(|claim| claim.verdict == verdict).count();
    let kinds = [
        (of(Verdict::Holds), "hold"),
        (of(Verdict::DoesNotHold), "do not"),
        (of(Verdict::Mixed), "are mixed"),
        (of(Verdict::Undecided), "cannot be decided"),
        (of(Verdict::NotJudged), "are about times only"),
        (of(Verdict::NotMeasured), "are not measured"),
    ];
    let kinds = kinds.iter().filter(|(count, _)| *count > 0);
    let kinds: Vec<String> = kinds.map(|(count, words)| format!("{count} {words}")).collect();
    let figures = claims.iter().flat_map(|claim| &claim.family.figures);
    let counts = FigureCounts::of(figures.filter_map(|figure| figure.verdict));
    let judged = counts.holds + counts.does_not_hold + counts.undecided;
    format!(
        "Of {} claims {}. Of their {judged} figures that are not times: {counts}.",
        claims.len(),
        kinds.join(", ")
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

/// Returns each claim with its first figure that is not a time; one with a published change if
/// there is one.
fn in_short(claims: &[ClaimReport]) -> Vec<Vec<String>> {
    let row = |claim: &ClaimReport| {
        let figures = &claim.family.figures;
        let judged = || figures.iter().filter(|it| !it.measure.is_timed());
        let is_published = |it: &&FamilyFigure| published_of(claim, it).is_some();
        let figure = judged().find(is_published).or(judged().next()).or(figures.first());
        let measured = figure.map_or(NONE.to_owned(), |figure| {
            let kept = if figure.than.is_none() { "as claimed on " } else { "" };
            format!("{}: {kept}{}", measure_name(figure.measure), measured(figure))
        });
        let published = figure.map_or(NONE.to_owned(), |figure| published(claim, figure));
        let id = format!("[{}](../papers/{}.md)", claim.id, claim.paper.to_lowercase());
        vec![id, claim.statement.to_owned(), published, measured, verdict_with_counts(claim)]
    };
    claims.iter().map(row).collect()
}

/// Returns a line for each figure; the first one also has the name of the claim.
fn figures(claim: &ClaimReport) -> Vec<Vec<String>> {
    let row = |(i, figure): (usize, &FamilyFigure)| {
        let id = if i == 0 { claim.id.to_owned() } else { String::new() };
        let fitting = reconstructed_of(claim, figure).map_or(NONE.to_owned(), measured);
        let of_method = |method: &str| format!("`{method}`");
        let words = statement_with(figure, &of_method);
        let verdict = figure.verdict.map_or(NONE.to_owned(), bold_against);
        vec![id, words, published(claim, figure), measured(figure), fitting, verdict]
    };
    claim.family.figures.iter().enumerate().map(row).collect()
}

/// Returns the text of a verdict; one against the paper is bold.
fn bold_against(verdict: FigureVerdict) -> String {
    let words = verdict.to_string();
    if verdict == FigureVerdict::DoesNotHold { format!("**{words}**") } else { words }
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
fn ablation(one: &AblationReport, figures: &[FamilyFigure]) -> String {
    let measures = one.measures();
    let names: Vec<String> = measures.iter().map(|&measure| measure_name(measure)).collect();
    let header: Vec<&str> =
        std::iter::once("variant").chain(names.iter().map(String::as_str)).collect();
    // The measures of a variant are consecutive.
    let row = |own: &[FamilyFigure]| {
        let variant = own.first().map_or("", |figure| figure.of).to_owned();
        std::iter::once(variant).chain(own.iter().map(measured)).collect()
    };
    let rows = figures.chunks(measures.len().max(1)).map(row).collect();
    table(&header, 1..header.len(), rows)
}

fn published(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    COARSE.published(claim, figure)
}

fn measured(figure: &FamilyFigure) -> String {
    COARSE.measured(figure)
}
