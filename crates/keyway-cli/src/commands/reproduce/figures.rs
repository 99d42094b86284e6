//! Pictures of claims and experiments.

use super::measure::Measured;
use super::words::{published_of, words};
use crate::error::{CliError, Kind};
use keyway::claims::{
    Claim, ClaimReport, Experiment, FamilyFigure, MapRow, Outcome, Place, Scale, Shown,
};
use keyway::metrics::statistics::Sample;
use keyway::report::Inputs;
use keyway::sim::Outcome as RunOutcome;
use keyway_draw::layers::{
    Disc, Discs, DrivenPoint, Goal, Layer, Meeting, PathLine, SearchNodes, SearchTrace, Start,
};
use keyway_draw::{
    BoxGroup, BoxPlot, IntervalChart, IntervalRow, MapPanels, MapPicture, SpeedCurveOptions,
    SpeedSeries, Svg, box_plot, interval_chart, speed_curve,
};

/// A picture in a file of its own.
pub(super) struct Figure {
    /// Its file in the folder.
    pub(super) file: String,
    /// What it shows, and how it was made; `None` where the picture says it itself.
    pub(super) caption: Option<String>,
    pub(super) svg: Svg,
}

/// The names of all pictures that there may be of a claim.
pub(super) fn names_of_claim(id: &str) -> [String; 3] {
    ["change", "difference", "kept"].map(|kind| format!("figures/{id}.{kind}.svg"))
}

/// The same of an experiment.
pub(super) fn names_of_experiment(name: &str) -> [String; 5] {
    ["paths", "search", "speeds", "expanded", "time"]
        .map(|kind| format!("figures/{name}.{kind}.svg"))
}

/// What a chart of a claim shows: the label of its axis, and which figures.
type Chart<'a> = (&'a str, &'a dyn Fn(&FamilyFigure) -> bool);

/// Bars with intervals: relative changes, then differences, then bounds. What there is none of is left out.
pub(super) fn of_claim(claim: &ClaimReport) -> Vec<Figure> {
    let is_bound = |figure: &FamilyFigure| figure.than.is_none();
    let is_relative = |figure: &FamilyFigure| figure.scale == Scale::Relative;
    let kinds: [Chart<'_>; 3] = [
        ("change [%]", &|figure| !is_bound(figure) && is_relative(figure)),
        ("difference [unit of the quantity]", &|figure| !is_bound(figure) && !is_relative(figure)),
        ("maps on which it is so [%]", &is_bound),
    ];
    let figure = |(file, (label, is_shown)): (String, Chart<'_>)| {
        let figures: Vec<_> =
            claim.family.figures.iter().filter(|figure| is_shown(figure)).collect();
        let svg = (!figures.is_empty()).then(|| bars(claim, &figures, label))?;
        Some(Figure { file, caption: None, svg })
    };
    names_of_claim(claim.id).into_iter().zip(kinds).filter_map(figure).collect()
}

fn bars(claim: &ClaimReport, figures: &[&FamilyFigure], label: &str) -> Svg {
    let rows: Vec<(String, String, f64)> = figures
        .iter()
        .map(|figure| {
            let is_share = figure.than.is_none() || figure.scale == Scale::Relative;
            let per_cent = if is_share { 100.0 } else { 1.0 };
            (words(figure), format!("n = {}", figure.pairs), per_cent)
        })
        .collect();
    let rows: Vec<IntervalRow<'_>> = figures
        .iter()
        .zip(&rows)
        .map(|(figure, (name, note, per_cent))| {
            let published = published_of(claim, figure).and_then(|published| published.effect);
            let interval = figure.ci95_low.zip(figure.ci95_high);
            IntervalRow {
                name,
                value: figure.mean.map(|mean| mean * per_cent),
                interval: interval.map(|(low, high)| (low * per_cent, high * per_cent)),
                reference: published.map(|effect| effect * per_cent),
                note,
            }
        })
        .collect();
    let caption = format!(
        "Bars: mean over the maps; whiskers: its 95 % interval; diamonds: published; n: maps. Keyway {}, keyway reproduce {}.",
        Inputs::VERSION,
        claim.id
    );
    interval_chart(&IntervalChart { label, rows: &rows, caption: &caption })
}

/// Paths, searches and runs on one map, and how values are spread over all maps.
pub(super) fn of_experiment(measured: &Measured) -> Result<Vec<Figure>, CliError> {
    let experiment = measured.experiment;
    let mut figures = Vec::new();
    let [paths, search, speeds, expanded, time] = names_of_experiment(experiment.name);
    let seed = measured.family.rows.first().and_then(|row| row.seed);
    let seed = if experiment.scene.is_some() { None } else { seed };
    let place = experiment.place(seed).map_err(|error| CliError::new(Kind::Config, error))?;
    if let Some(place) = place {
        let on = match (&experiment.scene, seed) {
            (Some(scene), None) => scene.file.to_owned(),
            (_, seed) => format!("the map of seed {}", seed.unwrap_or_default()),
        };
        let make = |file: String, what: &str, svg: Option<Svg>| {
            let caption = format!(
                "{what} of {} on {on}. Keyway {}, keyway reproduce.",
                experiment.name,
                Inputs::VERSION
            );
            svg.map(|svg| Figure { file, caption: Some(caption), svg })
        };
        figures.extend(make(paths, "Paths and ways driven", panels(experiment, &place, false)));
        figures.extend(make(search, "Searches", panels(experiment, &place, true)));
        figures.extend(make(speeds, "Speeds and turn rates", speed_curves(experiment, &place)));
    }
    let rows = &measured.family.rows;
    let over = format!("over the {} maps of {} that count", rows.len(), experiment.name);
    let nodes = |outcome: &Outcome| outcome.planned().map(|planned| planned.expanded as f64);
    let time_s =
        |outcome: &Outcome| outcome.driven().filter(|run| run.reached()).map(|run| run.time_s);
    let boxes = [
        (expanded, "expanded nodes", "Expanded nodes", &nodes as &dyn Fn(&Outcome) -> Option<f64>),
        (time, "time to the goal [s]", "Simulated time to the goal", &time_s),
    ];
    for (file, label, what, value) in boxes {
        let caption = format!("{what} {over}. {BOXES}");
        let svg = spread((experiment, rows), label, &caption, value);
        figures.extend(svg.map(|svg| Figure { file, caption: None, svg }));
    }
    Ok(figures)
}

const BOXES: &str = "Box: quartiles; bar: median; cross: mean; whiskers: farthest values within 1.5 box lengths; rings: values beyond.";

/// A panel for each method; nothing without any that has what is to be shown.
fn panels(experiment: &Experiment, place: &Place, is_search: bool) -> Option<Svg> {
    let [start, goal] = place.ends;
    let discs: Vec<Vec<Disc>> = place
        .shown
        .iter()
        .map(|shown| {
            let circles = shown.iter().flat_map(|shown| &shown.obstacles);
            circles
                .map(|circle| Disc { centre: circle.centre, radius_m: circle.radius_m })
                .collect()
        })
        .collect();
    let common = MapPicture::new(&place.map)
        .with(Start(start))
        .with(Goal { point: goal, tolerance_m: None });
    let (mut panels, mut count) = (MapPanels::new(common), 0);
    for ((method, shown), discs) in experiment.methods.iter().zip(&place.shown).zip(&discs) {
        let Some(shown) = shown else { continue };
        let mut layers: Vec<Box<dyn Layer + '_>> = Vec::new();
        match (&shown.search, is_search) {
            (Some(search), true) => {
                let trace = SearchTrace::new(search);
                layers.push(Box::new(trace));
                layers.push(Box::new(SearchNodes(trace)));
                layers.push(Box::new(Meeting(trace)));
                layers.push(Box::new(PathLine::planned(&shown.line).label("path").rimmed()));
            }
            (None, true) => continue,
            (Some(_), false) => {
                layers.push(Box::new(PathLine::smoothed(&shown.line).label("path")));
            }
            (None, false) => {
                layers.push(Box::new(Discs::unknown_obstacles(discs)));
                layers.push(Box::new(PathLine::smoothed(&shown.line).label("way driven")));
            }
        }
        panels = panels.panel(title(method.name, shown), layers);
        count += 1;
    }
    (count > 0).then(|| panels.svg())
}

/// The name of a method, the length of its path or way, and what became of a run that did not reach its goal.
fn title(name: &str, shown: &Shown) -> String {
    let end = match shown.run.as_ref().map(|run| run.outcome) {
        None | Some(RunOutcome::Reached) => "",
        Some(RunOutcome::Collided { .. }) => ", contact",
        Some(RunOutcome::Timeout) => ", out of time",
        Some(_) => ", stuck",
    };
    format!("{name}: {:.2} m{end}", shown.line.length_m())
}

/// Nothing without a run.
fn speed_curves(experiment: &Experiment, place: &Place) -> Option<Svg> {
    let runs = experiment.methods.iter().zip(&place.shown).filter_map(|(method, shown)| {
        let samples = &shown.as_ref()?.run.as_ref()?.samples;
        let point = |sample: &keyway::sim::Sample| DrivenPoint {
            t_s: sample.t_s,
            pose: sample.pose,
            velocity: sample.velocity,
        };
        Some((method.name, samples.iter().map(point).collect::<Vec<_>>()))
    });
    let runs: Vec<(&str, Vec<DrivenPoint>)> = runs.collect();
    let series: Vec<SpeedSeries<'_>> =
        runs.iter().map(|(name, points)| SpeedSeries { name, points }).collect();
    (!series.is_empty()).then(|| speed_curve(&series, &SpeedCurveOptions::default()))
}

/// How a value of the methods is spread over the maps that count; nothing without values.
fn spread(
    (experiment, rows): (&Experiment, &[MapRow]),
    label: &str,
    caption: &str,
    value: &dyn Fn(&Outcome) -> Option<f64>,
) -> Option<Svg> {
    let of_method = |i: usize| {
        let outcomes = rows.iter().filter_map(|row| row.outcomes[i].as_ref());
        Sample::new(outcomes.filter_map(value).collect()).ok()
    };
    let samples: Vec<(&str, Sample)> = (0..experiment.methods.len())
        .filter_map(|i| Some((experiment.methods[i].name, of_method(i)?)))
        .collect();
    let notes: Vec<String> =
        samples.iter().map(|(_, sample)| format!("n = {}", sample.values().len())).collect();
    let groups: Vec<BoxGroup<'_>> = samples
        .iter()
        .zip(&notes)
        .map(|((name, values), note)| BoxGroup { name, values: Some(values), note })
        .collect();
    (!groups.is_empty()).then(|| box_plot(&BoxPlot { title: "", label, groups: &groups, caption }))
}

/// Of all claims and their experiments.
pub(super) fn all_names(claims: &[&'static Claim]) -> Vec<String> {
    let of_claims = claims.iter().flat_map(|claim| names_of_claim(claim.id));
    let of_experiments =
        super::experiments(claims).into_iter().flat_map(|one| names_of_experiment(one.name));
    of_claims.chain(of_experiments).collect()
}
