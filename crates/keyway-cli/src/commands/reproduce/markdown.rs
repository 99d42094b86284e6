//! The tables of the documentation: `tables.md`.

use super::ReproduceReport;
use super::figure_rows::reconstructed_of;
use super::words::{name, published_of, words_of};
use keyway_lab::claims::{
    AblationReport, ClaimReport, ExperimentReport, FamilyFigure, Scale, Verdict,
};
use std::fmt::Write as _;
use std::ops::Range;

/// All tables, each below a heading.
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

/// The columns of `numbers` are aligned to the right.
fn table(header: &[&str], numbers: Range<usize>, rows: Vec<Vec<String>>) -> String {
    let rule = |i: usize| if numbers.contains(&i) { "--:|" } else { "---|" };
    let rule: String = (0..header.len()).map(rule).collect();
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rows: String = rows.into_iter().map(row).collect();
    format!("| {} |\n|{rule}\n{rows}", header.join(" | "))
}

/// Each claim with its first figure that no clock measures.
fn in_short(claims: &[ClaimReport]) -> Vec<Vec<String>> {
    let row = |claim: &ClaimReport| {
        let figures = &claim.family.figures;
        let figure = figures.iter().find(|it| !it.measure.is_timed()).or(figures.first());
        let measured = figure.map_or("-".to_owned(), |figure| {
            let kept = if figure.than.is_none() { "as claimed on " } else { "" };
            format!("{}: {kept}{}", name(figure.measure), measured(figure))
        });
        let published = figure.map_or("-".to_owned(), |figure| published(claim, figure));
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
        let fitting = reconstructed_of(claim, figure).map_or("-".to_owned(), measured);
        let of_method = |method: &str| format!("`{method}`");
        let words = words_of(figure, &of_method);
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

/// A line for each variant, a column for each quantity.
fn ablation(one: &AblationReport) -> String {
    let mut measures = Vec::new();
    for measure in one.figures.iter().map(|figure| figure.measure) {
        if !measures.contains(&measure) {
            measures.push(measure);
        }
    }
    let names: Vec<String> = measures.iter().map(|&measure| name(measure)).collect();
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
    let effect = published_of(claim, figure).and_then(|published| published.effect);
    effect.map_or_else(|| "-".to_owned(), |effect| with_unit(figure, &number(figure, effect)))
}

/// The mean change and its interval; of a bound, on how many maps it is kept.
fn measured(figure: &FamilyFigure) -> String {
    let (Some(mean), Some(low), Some(high)) = (figure.mean, figure.ci95_low, figure.ci95_high)
    else {
        return "-".to_owned();
    };
    if figure.than.is_none() {
        let kept = (mean * figure.pairs as f64).round();
        return format!("{kept} of {} maps", figure.pairs);
    }
    let [mean, low, high] = [mean, low, high].map(|effect| number(figure, effect));
    format!("{} ({low} to {high})", with_unit(figure, &mean))
}

fn with_unit(figure: &FamilyFigure, number: &str) -> String {
    let unit = if figure.scale == Scale::Relative { "%" } else { figure.unit };
    format!("{number} {unit}").trim_end().to_owned()
}

fn number(figure: &FamilyFigure, effect: f64) -> String {
    match figure.scale {
        Scale::Relative => format!("{:+.1}", effect * 100.0),
        Scale::Absolute => format!("{effect:+.2}"),
    }
}
