//! Pictures of experiments: the methods on one map, and the distribution of values over all maps.

use super::figures::made;
use super::stage::Stage;
use crate::error::{CliError, Kind};
use keyway_draw::{BoxGroup, BoxPlot, Svg, box_plot};
use keyway_lab::claims::{How, MapRow, Method, MethodResult, Part, RunFigures};
use keyway_lab::reproduce::{Measured, PageFigure, ReproduceRequest};
use keyway_sim::metrics::statistics::Sample;

/// The names of all possible pictures of an experiment.
pub(super) fn names_of_experiment(name: &str) -> [String; 6] {
    ["paths", "search", "speeds", "expanded", "time", "mean_speed"]
        .map(|kind| format!("figures/{name}.{kind}.svg"))
}

/// Draws the pictures of an experiment. `claim` is a claim that the experiment measures.
pub(super) fn of_experiment(
    measured: &Measured,
    claim: &str,
    request: &ReproduceRequest,
) -> Result<Vec<PageFigure>, CliError> {
    let experiment = measured.experiment;
    let rows = &measured.family.rows;
    let made = made(request, claim);
    let seed = rows.first().and_then(|row| row.seed).filter(|_| experiment.scene.is_none());
    let on = experiment.scene.as_ref().map_or_else(
        || format!("the map of seed {}", seed.unwrap_or_default()),
        |scene| scene.file.to_owned(),
    );
    let place = experiment.place(seed).map_err(|error| CliError::new(Kind::Config, error))?;
    let stage = place.as_ref().map(|place| Stage::new(experiment, place, (&on, &made)));
    let shown = stage.map(|stage| [stage.paths(), stage.searches(), stage.speed_curves()]);
    let maps = format!("the {} counted maps of {}", rows.len(), experiment.name);
    let boxes = [EXPANDED, TIME, MEAN_SPEED].map(|spread| {
        let caption = format!("{} over {maps}. {BOXES} {made}", spread.what);
        spread.boxes((experiment.methods, rows), &caption)
    });
    let all = shown.unwrap_or_default().into_iter().chain(boxes);
    let figures = names_of_experiment(experiment.name).into_iter().zip(all);
    Ok(figures
        .filter_map(|(file, svg)| Some(PageFigure { file, svg: svg?.into_string() }))
        .collect())
}

const BOXES: &str = "Box: quartiles; bar: median; cross: mean; whiskers: farthest values within 1.5 box lengths; rings: values beyond.";

/// A quantity whose distribution over the maps is drawn.
struct Spread {
    label: &'static str,
    what: &'static str,
    /// True if the quantity applies to a method.
    is_of: fn(&Method) -> bool,
    value: fn(&MethodResult) -> Option<f64>,
}

const EXPANDED: Spread = Spread {
    label: "expanded nodes",
    what: "Expanded nodes",
    is_of: |method| matches!(method.how, How::Plan(_)),
    value: |outcome| outcome.planned().map(|planned| planned.expanded as f64),
};
const TIME: Spread = Spread {
    label: "time to the goal [s]",
    what: "Simulated time to the goal",
    is_of: |method| part(method) == Some(Part::Whole),
    value: |outcome| arrived(outcome).map(|run| run.time_s),
};
/// Mean speeds of the parts of a run. There is no time for parts: they belong to the same run.
const MEAN_SPEED: Spread = Spread {
    label: "mean speed [m/s]",
    what: "Mean speed in a part of a run",
    is_of: |method| part(method).is_some_and(|part| part != Part::Whole),
    value: |outcome| arrived(outcome).and_then(|run| run.mean_speed_mps),
};

fn part(method: &Method) -> Option<Part> {
    match &method.how {
        How::Plan(_) => None,
        How::Drive(driving) => Some(driving.part),
    }
}

fn arrived(outcome: &MethodResult) -> Option<&RunFigures> {
    outcome.driven().filter(|run| run.reached())
}

impl Spread {
    /// Box plot; `None` without values. A method without values among others has an empty row.
    fn boxes(&self, (methods, rows): (&[Method], &[MapRow]), caption: &str) -> Option<Svg> {
        let own = methods.iter().enumerate().filter(|(_, method)| (self.is_of)(method));
        let sample = |(i, method): (usize, &Method)| {
            let outcomes = rows.iter().filter_map(|row| row.outcomes[i].as_ref());
            let values: Vec<f64> = outcomes.filter_map(self.value).collect();
            (method.name, format!("n = {}", values.len()), Sample::new(values).ok())
        };
        let samples: Vec<_> = own.map(sample).collect();
        let groups: Vec<BoxGroup<'_>> = samples
            .iter()
            .map(|(name, note, values)| BoxGroup { name, values: values.as_ref(), note })
            .collect();
        let is_any = groups.iter().any(|group| group.values.is_some());
        let (title, label) = ("", self.label);
        is_any.then(|| box_plot(&BoxPlot { title, label, groups: &groups, caption }))
    }
}
