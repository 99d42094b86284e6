//! Pictures of claims: bars with intervals.

use keyway_draw::{IntervalChart, IntervalRow, Svg, interval_chart};
use keyway_lab::claims::{Claim, ClaimReport, FamilyFigure, Figure, Measure, Scale};
use keyway_lab::reproduce::{
    PageFigure, ReproduceRequest, measure_name, measured_text, published_of, published_text,
    statement,
};
use keyway_sim::report::Inputs;

/// The version and the command that reproduce a picture. `what` is the claim argument of the
/// command.
pub(super) fn made(request: &ReproduceRequest, what: &str) -> String {
    let ReproduceRequest { maps, seed, has_times, .. } = request;
    let times = if *has_times { "" } else { " --no-times" };
    let version = Inputs::VERSION;
    format!(
        "Keyway {version}: keyway reproduce {what} --maps {maps} --seed {seed}{times} --out DIR."
    )
}

/// The quantity along an axis.
#[derive(Clone, Copy, PartialEq)]
enum Axis {
    /// Relative changes.
    Change,
    /// Differences of a quantity, in its unit.
    Difference(Measure),
    /// Share of the maps on which a condition holds.
    Kept,
}

impl Axis {
    fn new(measure: Measure, scale: Scale, is_bound: bool) -> Self {
        match scale {
            _ if is_bound => Self::Kept,
            Scale::Relative => Self::Change,
            Scale::Absolute => Self::Difference(measure),
        }
    }

    fn of_claim(figure: &Figure) -> Self {
        Self::new(figure.measure, figure.scale(), figure.than().is_none())
    }

    fn of(figure: &FamilyFigure) -> Self {
        Self::new(figure.measure, figure.scale, figure.than.is_none())
    }

    fn file(self, id: &str) -> String {
        let kind = match self {
            Self::Change => "change".to_owned(),
            Self::Difference(measure) => measure_name(measure).replace(' ', "_"),
            Self::Kept => "kept".to_owned(),
        };
        format!("figures/{id}.{kind}.svg")
    }

    fn label(self) -> String {
        match self {
            Self::Change => "change [%]".to_owned(),
            Self::Difference(measure) => format!("difference of {}", with_unit(measure)),
            Self::Kept => "maps on which it holds [%]".to_owned(),
        }
    }

    fn bars(self) -> &'static str {
        match self {
            Self::Kept => "share of the maps",
            Self::Change | Self::Difference(_) => "mean over the maps",
        }
    }
}

/// Quantity with its unit, such as `clearance [m]`.
pub(super) fn with_unit(measure: Measure) -> String {
    let unit = if measure.unit().is_empty() { "1" } else { measure.unit() };
    format!("{} [{unit}]", measure_name(measure))
}

/// Distinct axes, in order.
fn distinct(axes: impl Iterator<Item = Axis>) -> Vec<Axis> {
    let mut all = Vec::new();
    axes.for_each(|axis| {
        if !all.contains(&axis) {
            all.push(axis);
        }
    });
    all
}

/// The names of all possible pictures of a claim.
pub(super) fn names_of_claim(claim: &Claim) -> impl Iterator<Item = String> + use<> {
    let (id, axes) = (claim.id, distinct(claim.figures.iter().map(Axis::of_claim)));
    axes.into_iter().map(move |axis| axis.file(id))
}

/// Draws a picture for each axis; none if nothing was measured.
pub(super) fn of_claim(claim: &ClaimReport, request: &ReproduceRequest) -> Vec<PageFigure> {
    let figure = |axis: Axis| {
        let all = claim.family.figures.iter();
        let own: Vec<&FamilyFigure> = all.filter(|figure| Axis::of(figure) == axis).collect();
        let is_measured = own.iter().any(|figure| figure.mean.is_some());
        is_measured.then(|| PageFigure {
            file: axis.file(claim.id),
            svg: chart(claim, axis, &own, request).into_string(),
        })
    };
    let axes = distinct(claim.family.figures.iter().map(Axis::of));
    axes.into_iter().filter_map(figure).collect()
}

fn chart(
    claim: &ClaimReport,
    axis: Axis,
    figures: &[&FamilyFigure],
    request: &ReproduceRequest,
) -> Svg {
    let bars: Vec<Bar<'_>> = figures
        .iter()
        .map(|figure| Bar {
            figure,
            name: statement(figure),
            reference: published_of(claim, figure).and_then(|published| published.effect),
            note: note(claim, figure),
        })
        .collect();
    let diamonds =
        if bars.iter().any(|bar| bar.reference.is_some()) { "diamonds: published; " } else { "" };
    let caption = format!(
        "Bars: {}; whiskers: its 95 % interval; {diamonds}n: maps. {}",
        axis.bars(),
        made(request, claim.id)
    );
    let ends = (axis == Axis::Kept).then_some((0.0, 100.0));
    draw(&bars, ends, &axis.label(), &caption)
}

/// Note with the published change, if there is one, and the number of maps, unless the bar shows
/// it.
fn note(claim: &ClaimReport, figure: &FamilyFigure) -> String {
    let maps = format!("n = {}", figure.pairs);
    match published_of(claim, figure) {
        _ if figure.than.is_none() => String::new(),
        None => maps,
        Some(_) => format!("published {}, {maps}", published_text(claim, figure)),
    }
}

/// One bar of a chart.
pub(super) struct Bar<'a> {
    pub(super) figure: &'a FamilyFigure,
    pub(super) name: String,
    /// The published change, on the scale of the figure.
    pub(super) reference: Option<f64>,
    /// Text below the numbers of the bar.
    pub(super) note: String,
}

impl Bar<'_> {
    fn row<'a>(&'a self, note: &'a str) -> IntervalRow<'a> {
        let unit = axis_scale(self.figure);
        let interval = self.figure.ci95_low.zip(self.figure.ci95_high);
        IntervalRow {
            name: &self.name,
            value: self.figure.mean.map(|mean| mean * unit),
            interval: interval.map(|(low, high)| (low * unit, high * unit)),
            reference: self.reference.map(|reference| reference * unit),
            note,
        }
    }
}

/// Draws bars with their numbers beside them. Shares and relative changes are in percent.
pub(super) fn draw(bars: &[Bar<'_>], ends: Option<(f64, f64)>, label: &str, caption: &str) -> Svg {
    let note = |Bar { figure, note, .. }: &Bar<'_>| {
        format!("{}\n{note}", measured_text(figure)).replace('-', "\u{2212}")
    };
    let notes: Vec<String> = bars.iter().map(note).collect();
    let rows: Vec<IntervalRow<'_>> =
        bars.iter().zip(&notes).map(|(bar, note)| bar.row(note)).collect();
    interval_chart(&IntervalChart { label, ends, rows: &rows, caption })
}

/// Factor from the value of a figure to the numbers along its axis.
pub(super) fn axis_scale(figure: &FamilyFigure) -> f64 {
    if figure.than.is_none() || figure.scale == Scale::Relative { 100.0 } else { 1.0 }
}
