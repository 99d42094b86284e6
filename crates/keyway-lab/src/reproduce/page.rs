//! The report as one self-contained page: tables, and all pictures inline.

use super::report::{ReproduceReport, VERDICT_RULE};
use super::words::{
    NONE, change_text, measure_name, measured_text, papers_of, published_text, reconstructed_of,
    statement, verdict_with_counts,
};
use crate::claims::{
    AblationReport, Baseline, Claim, ClaimReport, ExperimentReport, FamilyFigure, MethodReport,
    ReconstructedReport,
};
use crate::table::number;
use keyway_sim::report::Inputs;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A picture that also has its own file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageFigure {
    /// File of the picture in the folder.
    pub file: String,
    /// The picture as SVG, which is included in the page unchanged.
    pub svg: String,
}

/// Parts of the page that are not in the report.
pub struct PageParts {
    /// Pictures of each claim of the report.
    pub claims: Vec<Vec<PageFigure>>,
    /// Pictures of each experiment of the report.
    pub experiments: Vec<Vec<PageFigure>>,
    /// Pictures of each ablation of the report.
    pub ablations: Vec<Vec<PageFigure>>,
    /// Returns the command that measures the claim of an id.
    pub command: fn(&str) -> String,
}

impl PageParts {
    /// Returns all pictures in the order of the page.
    pub fn figures(&self) -> impl Iterator<Item = &PageFigure> {
        let all = self.claims.iter().chain(&self.experiments).chain(&self.ablations);
        all.flatten()
    }
}

/// Style of the page: it can be printed, is legible without colours, and loads nothing.
const STYLE: &str = "\
body{font:15px/1.45 'DejaVu Sans',Verdana,Arial,sans-serif;color:#222;max-width:62em;margin:2em auto;padding:0 1em}\
h1,h2,h3{line-height:1.2}h2{margin-top:2.2em;border-bottom:1px solid #999}\
table{border-collapse:collapse;font-size:13px;margin:1em 0}\
th,td{border-bottom:1px solid #ccc;padding:.25em .6em;text-align:left;vertical-align:top}th{border-bottom:2px solid #222}\
td.number{text-align:right;white-space:nowrap}td.verdict{font-weight:bold;white-space:nowrap}\
code{font-family:'DejaVu Sans Mono',Consolas,monospace;font-size:90%}\
figure{margin:1.2em 0;break-inside:avoid}figcaption{font-size:13px;color:#444}\
svg{max-width:100%;height:auto}a{color:#0057a0}\
@page{margin:14mm}\
@media print{body{font-size:12px;max-width:none;margin:0;padding:0}table,figcaption{font-size:10.5px}th,td{padding:.2em .4em}\
h2{margin-top:1.6em}h2,section>p{break-after:avoid;break-inside:avoid}tr{break-inside:avoid}figure{margin:.8em 0}svg{max-height:16cm}\
a{color:inherit;text-decoration:none}}";

pub(super) fn page(report: &ReproduceReport, parts: &PageParts) -> String {
    let times = if report.times { "with times" } else { "without times" };
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "Reproduction of the papers' claims" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Reproduction of the papers' claims" }
                p {
                    "Keyway " (Inputs::VERSION) ", " (report.maps) " maps each from seed "
                    (report.seed) ", " (times) "."
                }
                p { (papers_of(&report.claims)) " " (VERDICT_RULE) }
                (headline(&report.claims))
                @for (claim, figures) in report.claims.iter().zip(&parts.claims) {
                    (claim_section(claim, figures, parts.command))
                }
                @for (experiment, figures) in report.experiments.iter().zip(&parts.experiments) {
                    (experiment_section(experiment, figures))
                }
                @for (ablation, figures) in report.ablations.iter().zip(&parts.ablations) {
                    (ablation_section(ablation, figures))
                }
            }
        }
    };
    markup.into_string()
}

/// Table of all claims with their first figures and their verdicts.
fn headline(claims: &[ClaimReport]) -> Markup {
    html! {
        table {
            thead { tr {
                th { "claim" } th { "statement" } th { "first figure" } th { "published" }
                th { "measured" } th { "verdict" }
            } }
            tbody { @for claim in claims { tr {
                td { a href={ "#" (claim.id) } { (claim.id) } }
                td { (claim.statement) }
                @match claim.family.figures.first() {
                    Some(figure) => {
                        td { (statement(figure)) }
                        td.number { (published_text(claim, figure)) }
                        td { (measured_text(figure)) }
                    }
                    None => { td {} td {} td {} }
                }
                td.verdict { (verdict_with_counts(claim)) }
            } } }
        }
    }
}

fn claim_section(
    claim: &ClaimReport,
    figures: &[PageFigure],
    command: fn(&str) -> String,
) -> Markup {
    let experiment = claim.family.experiment;
    html! {
        section {
            h2 id=(claim.id) { (claim.id) ": " (verdict_with_counts(claim)) }
            p { (claim.statement) "." }
            p {
                "Judged " @match claim.published {
                    Some(_) => "against published figures",
                    None => "by the sign of the change alone",
                }
                ". Experiment " a href={ "#" (experiment) } { (experiment) } ", "
                (claim.family.maps) " maps, " (claim.family.left_out) " left out. Code: "
                code { (claim.source) } ". Command: "
                code { (command(claim.id)) } "."
                @if let Some(scene) = &claim.scene { " Scene: " code { (scene.file) } "." }
            }
            @if let Some(found) = &claim.reconstructed { (reconstruction(claim.id, found)) }
            @if let Some(why) = claim.not_reconstructed { p { "No maps are fitted: " (why) "." } }
            @if !claim.family.figures.is_empty() { table {
                thead { tr {
                    th { "figure" } th { "published" } th { "over the family" }
                    th { "on the scene" } th { "on maps that fit" } th { "verdict" }
                } }
                tbody { @for figure in &claim.family.figures { tr {
                    td { (statement(figure)) }
                    td.number { (published_text(claim, figure)) }
                    td.number { (measured_text(figure)) }
                    td.number { (on_scene(claim, figure)) }
                    td.number { (reconstructed_of(claim, figure).map_or(NONE.to_owned(), measured_text)) }
                    td.verdict { (figure.verdict.map(|it| it.to_string()).unwrap_or_default()) }
                } } }
            } }
            (pictures(figures))
        }
    }
}

/// Published figures of the baselines, and the number of maps that have them.
fn reconstruction(id: &str, found: &ReconstructedReport) -> Markup {
    let baselines = Claim::named(id)
        .first()
        .and_then(|claim| claim.experiment.reconstruction.ok())
        .map_or(&[][..], |of| of.baselines);
    let said = |baseline: &Baseline| format!("{}: {}", baseline.name, baseline.published);
    html! {
        p {
            "Maps that fit the published figures of the baselines (" (found.name) "): "
            (found.seeds.len()) " of " (found.tried) " tried; " (found.maps) " of them count. "
            (baselines.iter().map(said).collect::<Vec<_>>().join("; ")) "."
        }
    }
}

/// Change on the scene, or the value that a bound applies to.
fn on_scene(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    let mut all = claim.scene.iter().flat_map(|scene| &scene.figures);
    let same =
        all.find(|it| (it.measure, it.of, it.than) == (figure.measure, figure.of, figure.than));
    let shown = same.and_then(|scene| match figure.than {
        Some(_) => scene.effect.map(|effect| change_text(figure, effect)),
        None => scene.new.map(|value| format!("{value:.3} {}", figure.unit).trim_end().to_owned()),
    });
    shown.unwrap_or_else(|| NONE.to_owned())
}

fn experiment_section(experiment: &ExperimentReport, figures: &[PageFigure]) -> Markup {
    let ExperimentReport { experiment: name, about, maps, left_out, methods } = experiment;
    html! {
        section {
            h2 id=(name) { "Experiment " (name) }
            p { (about) ". " (maps) " maps count; " (left_out) " were left out." }
            table {
                thead { tr {
                    th { "method" } th { "succeeded" } th { "expanded" } th { "length [m]" }
                    th { "excess [%]" } th { "turns" } th { "clearance [m]" }
                    th { "planning [us]" } th { "run [s]" } th { "speed [m/s]" }
                } }
                tbody { @for method in methods { (method_row(method)) } }
            }
            (pictures(figures))
        }
    }
}

/// Section with each variant and its change from the method as published.
fn ablation_section(ablation: &AblationReport, figures: &[PageFigure]) -> Markup {
    let AblationReport { experiment: name, about, base, maps, left_out, .. } = ablation;
    html! {
        section {
            h2 id=(name) { "Ablation " (name) }
            p {
                (about) ". Changes from \"" (base) "\" on each of " (maps) " maps, means with 95 % intervals; "
                (left_out) " maps were left out."
            }
            (change_table(&ablation.figures))
            @if !ablation.reconstructed.is_empty() {
                p { "On " (ablation.reconstructed_maps) " maps that fit:" }
                (change_table(&ablation.reconstructed))
            }
            (pictures(figures))
        }
    }
}

fn change_table(figures: &[FamilyFigure]) -> Markup {
    html! {
        table {
            thead { tr { th { "variant" } th { "quantity" } th { "change" } th { "maps" } } }
            tbody { @for figure in figures { tr {
                td { (figure.of) }
                td { (measure_name(figure.measure)) }
                td.number { (measured_text(figure)) }
                td.number { (figure.pairs) }
            } } }
        }
    }
}

fn method_row(method: &MethodReport) -> Markup {
    let cells = [
        (method.mean_expanded, 1.0, 1),
        (method.mean_length_m.or(method.mean_driven_length_m), 1.0, 2),
        (method.mean_excess, 100.0, 2),
        (method.mean_turns, 1.0, 1),
        (method.mean_clearance_m.or(method.mean_run_clearance_m), 1.0, 3),
        (method.mean_planning_s, 1e6, 1),
        (method.mean_run_time_s, 1.0, 1),
        (method.mean_speed_mps, 1.0, 3),
    ];
    html! {
        tr {
            td { (method.method) }
            td.number { (method.succeeded) }
            @for (value, scale, decimals) in cells {
                td.number { (number(value.map(|value| value * scale), decimals)) }
            }
        }
    }
}

fn pictures(figures: &[PageFigure]) -> Markup {
    html! {
        @for figure in figures {
            figure {
                // The text was escaped when the picture was drawn.
                (PreEscaped(figure.svg.as_str()))
                figcaption { "File: " code { (figure.file) } "." }
            }
        }
    }
}
