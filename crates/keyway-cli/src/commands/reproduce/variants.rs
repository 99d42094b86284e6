//! Pictures of ablations: bars for omitted parts, curves for swept parameters.

use super::figures::{Bar, axis_scale, draw, made, with_unit};
use keyway_draw::{ChartPoint, PointPanels, PointSeries, Svg, point_panels};
use keyway_lab::claims::{Ablation, AblationReport, Claim, FamilyFigure, Measure, Scale};
use keyway_lab::reproduce::{PageFigure, ReproduceRequest, measure_name};

/// The names of all possible pictures of an ablation.
pub(super) fn names(ablation: &Ablation) -> Vec<String> {
    ablation.measures.iter().map(|&measure| file(ablation.experiment.name, measure)).collect()
}

fn file(experiment: &str, measure: Measure) -> String {
    format!("figures/{experiment}.{}.svg", measure_name(measure).replace(' ', "_"))
}

/// Draws a picture of each measure.
pub(super) fn figures(report: &AblationReport, request: &ReproduceRequest) -> Vec<PageFigure> {
    report.measures().into_iter().map(|measure| figure(report, measure, request)).collect()
}

fn figure(report: &AblationReport, measure: Measure, request: &ReproduceRequest) -> PageFigure {
    let own: Vec<&FamilyFigure> =
        report.figures.iter().filter(|figure| figure.measure == measure).collect();
    // Ablations are requested together with the claims of their paper.
    let claim = Claim::all().find(|claim| claim.paper == report.paper).map_or("", |claim| claim.id);
    let caption = format!(
        "{}: {}, change from \"{}\": mean over those of {} maps on which both have a value, and its 95 % interval. {}",
        report.about,
        measure_name(measure),
        report.base,
        report.maps,
        made(request, &format!("{claim} --ablations"))
    );
    let label = match own.first().map(|figure| figure.scale) {
        Some(Scale::Absolute) => format!("change of {}", with_unit(measure)),
        _ => format!("change of {} [%]", measure_name(measure)),
    };
    let svg = match report.parameter {
        Some(parameter) => curve(report, (&own, parameter), &label, &caption),
        None => bars(&own, &label, &caption),
    };
    PageFigure { file: file(report.experiment, measure), svg: svg.into_string() }
}

fn bars(figures: &[&FamilyFigure], label: &str, caption: &str) -> Svg {
    let bars: Vec<Bar<'_>> = figures
        .iter()
        .map(|figure| Bar {
            figure,
            name: figure.of.to_owned(),
            reference: None,
            note: format!("n = {}", figure.pairs),
        })
        .collect();
    draw(&bars, None, label, caption)
}

/// Curve over a parameter. The base is a point with zero change.
fn curve(
    report: &AblationReport,
    (figures, parameter): (&[&FamilyFigure], &str),
    label: &str,
    caption: &str,
) -> Svg {
    let point = |&value: &f64| {
        let own = figures.iter().find(|figure| value_of(figure.of) == Some(value));
        let Some(figure) = own else {
            let is_base = value_of(report.base) == Some(value);
            return is_base.then_some(ChartPoint { x: value, y: 0.0, y_interval: None });
        };
        let scale = axis_scale(figure);
        let interval = figure.ci95_low.zip(figure.ci95_high);
        Some(ChartPoint {
            x: value,
            y: figure.mean? * scale,
            y_interval: interval.map(|(low, high)| (low * scale, high * scale)),
        })
    };
    let points: Vec<ChartPoint> = report.values.iter().filter_map(point).collect();
    let series = [PointSeries { name: "", points: &points }];
    point_panels(&PointPanels {
        x_label: parameter,
        y_label: label,
        y_ends: None,
        are_joined: true,
        series: &series,
        caption,
    })
}

/// The value at the end of a variant's name.
fn value_of(variant: &str) -> Option<f64> {
    variant.rsplit(' ').next()?.parse().ok()
}
