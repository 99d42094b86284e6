//! Pictures of the results of all methods of an experiment on one map.

use keyway::geometry::{Polyline, Velocity};
use keyway_draw::layers::{
    GoalMark, HatchedDiscs, Layer, Meeting, Movers, PathLine, SearchNodes, SearchTrace, StartMark,
};
use keyway_draw::{
    LineStyle, MapPanels, MapPicture, Rgb, SpeedCurveOptions, SpeedSeries, Svg, series_style,
    speed_curve,
};
use keyway_lab::claims::{Experiment, How, Place, Shown};
use keyway_sim::sim::{Outcome, TrajectoryPoint};

/// Line style of a whole run, drawn below the compared parts.
const WAY: LineStyle = LineStyle { color: Rgb(0x88, 0x88, 0x88), width_px: 1.0, dashes: "" };
/// Line width of the parts \[px\].
const PART_PX: f64 = 2.6;

/// A map, with its captions.
pub(super) struct Stage<'a> {
    experiment: &'a Experiment,
    place: &'a Place,
    /// Name of the map.
    on: &'a str,
    /// The command that reproduces the pictures.
    made: &'a str,
    actors: Vec<Actor<'a>>,
}

/// A method in a picture.
struct Actor<'a> {
    name: &'static str,
    shown: &'a Shown,
    /// The trajectory of the run; empty for a path.
    points: Vec<TrajectoryPoint>,
    /// The stretches of the run that are compared; empty if the whole run is.
    stretches: Vec<Polyline>,
}

impl<'a> Stage<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        place: &'a Place,
        (on, made): (&'a str, &'a str),
    ) -> Self {
        let actor = |(i, shown): (usize, &'a Option<Shown>)| {
            Some(Actor::new(experiment.methods[i].name, shown.as_ref()?))
        };
        let actors = place.shown.iter().enumerate().filter_map(actor).collect();
        Self { experiment, place, on, made, actors }
    }

    /// Picture of the paths and trajectories; `None` if there are none.
    pub(super) fn paths(&self) -> Option<Svg> {
        // Methods that compare parts of a run share that run.
        let (parts, others): (Vec<_>, Vec<_>) =
            self.actors.iter().partition(|actor| actor.shown.part.is_some());
        let mut panels: Vec<_> =
            others.iter().map(|actor| (actor.title(), actor.path_layers())).collect();
        if let Some(first) = parts.first() {
            let way = PathLine::new(&first.shown.line, "rest of the trajectory", WAY);
            let mut layers: Vec<Box<dyn Layer + '_>> = vec![Box::new(way)];
            for (i, actor) in parts.iter().enumerate() {
                let style = LineStyle { width_px: PART_PX, ..series_style(i) };
                let line =
                    |line| Box::new(PathLine::new(line, actor.name, style)) as Box<dyn Layer>;
                layers.extend(actor.stretches.iter().map(line));
            }
            panels.push((first.ending("one run"), layers));
        }
        self.panels(&self.caption("Paths and trajectories", |_| true), panels)
    }

    /// Picture of the searches; `None` if there are none.
    pub(super) fn searches(&self) -> Option<Svg> {
        let actors = self.actors.iter();
        let panels = actors.filter_map(|actor| Some((actor.title(), actor.search_layers()?)));
        let caption = self.caption("Searches", |how| matches!(how, How::Plan(_)));
        self.panels(&caption, panels.collect())
    }

    /// Arranges panels; `None` if there are none.
    fn panels(
        &self,
        caption: &str,
        panels: Vec<(String, Vec<Box<dyn Layer + '_>>)>,
    ) -> Option<Svg> {
        if panels.is_empty() {
            return None;
        }
        let [start, goal] = self.place.ends;
        let common = MapPicture::new(&self.place.map)
            .with(StartMark(start))
            .with(GoalMark { point: goal, tolerance_m: None });
        let all = MapPanels::new(common).caption(caption);
        let all = panels.into_iter().fold(all, |all, (title, layers)| all.panel(title, layers));
        Some(all.svg())
    }

    /// Chart of speeds and turn rates; `None` without a run.
    pub(super) fn speed_curves(&self) -> Option<Svg> {
        let runs: Vec<(&str, Vec<TrajectoryPoint>)> = self
            .actors
            .iter()
            .filter(|actor| !actor.points.is_empty())
            .map(|actor| (actor.name, actor.compared()))
            .collect();
        let series: Vec<SpeedSeries<'_>> =
            runs.iter().map(|(name, points)| SpeedSeries { name, points }).collect();
        // A single run has no legend.
        let what = match series.as_slice() {
            [] => return None,
            [only] => format!("Speed and turn rate of {}", only.name),
            _ => "Speeds and turn rates".to_owned(),
        };
        let caption = self.caption(&what, |how| matches!(how, How::Drive(_)));
        let options = SpeedCurveOptions { caption, ..SpeedCurveOptions::default() };
        Some(speed_curve(&series, &options))
    }

    /// The caption. It also lists the methods without a result among those that belong in the
    /// picture.
    fn caption(&self, what: &str, is_of: fn(&How) -> bool) -> String {
        let missing = self.experiment.methods.iter().zip(&self.place.shown);
        let missing = missing.filter(|(method, shown)| is_of(&method.how) && shown.is_none());
        let missing: Vec<&str> = missing.map(|(method, _)| method.name).collect();
        let missing = match missing.as_slice() {
            [] => String::new(),
            names => format!(" {} found no path.", names.join(", ")),
        };
        format!("{what}: {} on {}.{missing} {}", self.experiment.name, self.on, self.made)
    }
}

impl<'a> Actor<'a> {
    fn new(name: &'static str, shown: &'a Shown) -> Self {
        let points = shown.run.iter().flat_map(|run| &run.samples).copied().collect();
        let mut actor = Self { name, shown, points, stretches: Vec::new() };
        if shown.part.is_some() {
            let compared = actor.compared();
            let stretches = compared.split(|point| !point.velocity.v.is_finite());
            let line = |points: &[TrajectoryPoint]| {
                Polyline::new(points.iter().map(|point| point.pose.point()).collect())
            };
            actor.stretches = stretches.filter(|points| !points.is_empty()).map(line).collect();
        }
        actor
    }

    /// The trajectory, with gaps outside the compared part.
    fn compared(&self) -> Vec<TrajectoryPoint> {
        let gap = Velocity::new(f64::NAN, f64::NAN);
        let mut points = self.points.clone();
        let outside = points.iter_mut().zip(self.shown.part.iter().flatten());
        outside.filter(|(_, is_in)| !**is_in).for_each(|(point, _)| point.velocity = gap);
        points
    }

    fn title(&self) -> String {
        self.ending(self.name)
    }

    /// A name with the path length, and the outcome of a run that missed its goal.
    fn ending(&self, name: &str) -> String {
        let end = match self.shown.run.as_ref().map(|run| run.outcome) {
            None | Some(Outcome::Reached) => "",
            Some(Outcome::Collided { .. }) => ", contact",
            Some(Outcome::Timeout) => ", timeout",
            Some(_) => ", stuck",
        };
        format!("{name}: {:.2} m{end}", self.shown.line.length_m())
    }

    fn path_layers(&self) -> Vec<Box<dyn Layer + '_>> {
        let line = PathLine::smoothed(&self.shown.line);
        if self.points.is_empty() {
            return vec![Box::new(line.label("path"))];
        }
        vec![
            Box::new(HatchedDiscs::unknown_obstacles(&self.shown.obstacles)),
            Box::new(line.label("trajectory")),
            Box::new(Movers::new(&self.shown.movers, &self.points)),
        ]
    }

    /// Layers of the search; `None` for a run.
    fn search_layers(&self) -> Option<Vec<Box<dyn Layer + '_>>> {
        let trace = SearchTrace::new(self.shown.search.as_ref()?);
        Some(vec![
            Box::new(trace),
            Box::new(SearchNodes(trace)),
            Box::new(Meeting(trace)),
            Box::new(PathLine::planned(&self.shown.line).label("path").rimmed()),
        ])
    }
}
