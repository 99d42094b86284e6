//! The figures of all claims as lines of a table.

use super::words::{published_of, reconstructed_of};
use crate::claims::{ClaimReport, FamilyFigure, FigureVerdict, Measure, SceneFigure, Verdict};
use serde::Serialize;

/// A line of `claims.csv`.
#[derive(Serialize)]
pub(super) struct FigureRow {
    id: &'static str,
    paper: &'static str,
    measure: Option<Measure>,
    of: Option<&'static str>,
    than: Option<&'static str>,
    expected: Option<&'static str>,
    limit: Option<f64>,
    published_old: Option<f64>,
    published_new: Option<f64>,
    published_effect: Option<f64>,
    scene_old: Option<f64>,
    scene_new: Option<f64>,
    scene_effect: Option<f64>,
    reconstructed_maps: Option<usize>,
    reconstructed_mean: Option<f64>,
    reconstructed_ci95_low: Option<f64>,
    reconstructed_ci95_high: Option<f64>,
    maps: usize,
    left_out: usize,
    pairs: Option<usize>,
    old_mean: Option<f64>,
    new_mean: Option<f64>,
    mean: Option<f64>,
    ci95_low: Option<f64>,
    ci95_high: Option<f64>,
    verdict: Option<FigureVerdict>,
    claim_verdict: Verdict,
}

/// Returns a line for each figure. A claim that was not measured has a single line.
pub(super) fn figure_rows(claims: &[ClaimReport]) -> Vec<FigureRow> {
    let of_claim = |claim: &ClaimReport| -> Vec<FigureRow> {
        let figures = &claim.family.figures;
        if figures.is_empty() {
            return vec![row(claim, None)];
        }
        figures.iter().map(|figure| row(claim, Some(figure))).collect()
    };
    claims.iter().flat_map(of_claim).collect()
}

fn scene_of<'a>(claim: &'a ClaimReport, figure: &FamilyFigure) -> Option<&'a SceneFigure> {
    let mut all = claim.scene.iter().flat_map(|scene| &scene.figures);
    all.find(|it| (it.measure, it.of, it.than) == (figure.measure, figure.of, figure.than))
}

fn row(claim: &ClaimReport, figure: Option<&FamilyFigure>) -> FigureRow {
    let published = figure.and_then(|figure| published_of(claim, figure));
    let scene = figure.and_then(|figure| scene_of(claim, figure));
    let found = figure.and_then(|figure| reconstructed_of(claim, figure));
    FigureRow {
        id: claim.id,
        paper: claim.paper,
        measure: figure.map(|figure| figure.measure),
        of: figure.map(|figure| figure.of),
        than: figure.and_then(|figure| figure.than),
        expected: figure.map(|figure| figure.expected),
        limit: figure.and_then(|figure| figure.limit),
        published_old: published.map(|published| published.old),
        published_new: published.map(|published| published.new),
        published_effect: published.and_then(|published| published.effect),
        scene_old: scene.and_then(|scene| scene.old),
        scene_new: scene.and_then(|scene| scene.new),
        scene_effect: scene.and_then(|scene| scene.effect),
        reconstructed_maps: claim.reconstructed.as_ref().map(|found| found.maps),
        reconstructed_mean: found.and_then(|found| found.mean),
        reconstructed_ci95_low: found.and_then(|found| found.ci95_low),
        reconstructed_ci95_high: found.and_then(|found| found.ci95_high),
        maps: claim.family.maps,
        left_out: claim.family.left_out,
        pairs: figure.map(|figure| figure.pairs),
        old_mean: figure.and_then(|figure| figure.old_mean),
        new_mean: figure.and_then(|figure| figure.new_mean),
        mean: figure.and_then(|figure| figure.mean),
        ci95_low: figure.and_then(|figure| figure.ci95_low),
        ci95_high: figure.and_then(|figure| figure.ci95_high),
        verdict: figure.and_then(|figure| figure.verdict),
        claim_verdict: claim.verdict,
    }
}
