//! Plots of the combined results of a batch.

use crate::pictures::PNG_SCALE;
use keyway_draw::{
    BoxGroup, BoxPlot, ChartPoint, PointPanels, PointSeries, Svg, box_plot, point_panels,
};
use keyway_lab::batch::{PictureFile, Pictures, Record, Row};
use keyway_sim::episode::EpisodeOutcome;
use keyway_sim::metrics::statistics::{Confidence, Rate, Sample};
use keyway_sim::report::Inputs;
use std::collections::HashSet;
use std::error::Error;
use std::fmt::Write as _;

/// The plots, in a folder of their own: each as SVG and as PNG.
const NAMES: [&str; 8] = [
    "plots/time.svg",
    "plots/time.png",
    "plots/clearance.svg",
    "plots/clearance.png",
    "plots/success.svg",
    "plots/success.png",
    "plots/length_time.svg",
    "plots/length_time.png",
];

/// The captions of all plots. A figure of a paper has its caption in the text, not in the picture.
const CAPTIONS: &str = "plots/captions.md";

/// A plot and its caption.
type Captioned = (Svg, String);

/// Plots of the results of a batch. A plot that would be empty is left out.
#[derive(Clone, Copy, Debug)]
pub struct BatchPlots;

impl Pictures for BatchPlots {
    fn names(&self) -> Vec<&'static str> {
        NAMES.into_iter().chain([CAPTIONS]).collect()
    }

    fn draw(
        &self,
        records: &[Record],
        stacks: &[&str],
    ) -> Result<Vec<PictureFile>, Box<dyn Error + Send + Sync>> {
        let by_stack = stacks.iter().map(|stack| runs_of(records, stack)).collect();
        let runs = Runs { names: short_names(stacks), by_stack, count: records.len() };
        let plots = [runs.times(), runs.clearances(), runs.success(), runs.lengths_and_times()];
        let (mut files, mut captions) = (Vec::new(), String::from("# Captions of the plots\n"));
        for (names, plot) in NAMES.chunks(2).zip(plots) {
            if let (Some((svg, caption)), &[svg_name, png_name]) = (plot, names) {
                files.push(PictureFile { name: svg_name, bytes: svg.as_str().into() });
                files.push(PictureFile { name: png_name, bytes: svg.to_png(PNG_SCALE)? });
                let file = svg_name.trim_start_matches("plots/");
                let _ = write!(captions, "\n**{file}**: {caption}\n");
            }
        }
        if !files.is_empty() {
            files.push(PictureFile { name: CAPTIONS, bytes: captions.into() });
        }
        Ok(files)
    }
}

fn runs_of<'a>(records: &'a [Record], stack: &str) -> Vec<&'a Row> {
    records.iter().map(|record| &record.run).filter(|run| run.stack == stack).collect()
}

/// Shortest unique tails of stack file paths, without `.toml`; other names are unchanged.
fn short_names(stacks: &[&str]) -> Vec<String> {
    let tail = |name: &str, parts: usize| {
        let Some(path) = name.strip_suffix(".toml") else { return name.to_owned() };
        let folders: Vec<&str> = path.split('/').collect();
        folders[folders.len().saturating_sub(parts)..].join("/")
    };
    let short = |&name: &&str| {
        let is_free = |(i, short): &(usize, String)| {
            stacks.iter().filter(|&&other| other != name).all(|other| tail(other, *i) != *short)
        };
        let mut tails = (1..=name.split('/').count()).map(|parts| (parts, tail(name, parts)));
        tails.find(is_free).map_or_else(|| name.to_owned(), |(_, short)| short)
    };
    stacks.iter().map(short).collect()
}

/// All runs, grouped by stack.
struct Runs<'a> {
    /// Names of the stacks.
    names: Vec<String>,
    by_stack: Vec<Vec<&'a Row>>,
    count: usize,
}

const BOXES: &str = "Box: quartiles; bar: median; cross: mean; whiskers: farthest values within 1.5 box lengths; rings: values beyond.";

impl Runs<'_> {
    /// Number of different scenes from which a trend over clutter is shown.
    const FEWEST_SCENES: usize = 10;

    fn times(&self) -> Option<Captioned> {
        let what = "Time to the goal, of the runs that reached it.";
        self.boxes("time [s]", what, |run| run.time_s)
    }

    fn clearances(&self) -> Option<Captioned> {
        let what = "Smallest distance from the footprint to any obstacle in a run, of the runs that reached the goal.";
        self.boxes("smallest clearance [m]", what, |run| run.min_clearance_m)
    }

    fn boxes(&self, label: &str, what: &str, value: fn(&Row) -> Option<f64>) -> Option<Captioned> {
        let of = |runs: &Vec<&Row>| -> (Option<Sample>, String) {
            let values: Vec<f64> = reached(runs).filter_map(value).collect();
            let note = format!("{} of {}", values.len(), runs.len());
            (Sample::new(values).ok(), note)
        };
        let samples: Vec<(Option<Sample>, String)> = self.by_stack.iter().map(of).collect();
        if samples.iter().all(|(sample, _)| sample.is_none()) {
            return None;
        }
        let group = |(name, (values, note))| BoxGroup { name, values, note };
        let shown = samples.iter().map(|(sample, note)| (sample.as_ref(), note.as_str()));
        let groups: Vec<BoxGroup<'_>> = self.names().zip(shown).map(group).collect();
        let caption = self.caption(&format!("{what} {BOXES} At the right: number of these runs."));
        Some((box_plot(&BoxPlot { title: "", label, groups: &groups, caption: "" }), caption))
    }

    /// Plot of success rates; `None` if all worlds are about equally cluttered, or if they are few:
    /// then a trend over clutter shows how these scenes differ.
    fn success(&self) -> Option<Captioned> {
        let runs = self.by_stack.iter().flatten();
        let scenes: HashSet<&str> = runs.map(|run| run.scene.as_str()).collect();
        if (2..Self::FEWEST_SCENES).contains(&scenes.len()) {
            return None;
        }
        let shares = self.by_stack.iter().flatten().filter_map(|run| run.occupied_share);
        let per_stack = self.count / self.names.len().max(1);
        let groups = Groups::of(shares.collect(), per_stack)?;
        let points: Vec<Vec<ChartPoint>> =
            self.by_stack.iter().map(|runs| groups.points(runs)).collect();
        let count = groups.middles.len();
        let what = format!(
            "Share of the runs that reached the goal, in {count} groups of runs in worlds of similar clutter ({} of each stack), with \
             Wilson's 95 % intervals; pale: the other stacks. Clutter: share of the known map that is covered by obstacles, including those that are not on the map; \
             a group is drawn at its median.",
            groups.sizes(&self.by_stack)
        );
        let labels = ("clutter [% of the map]", "reached [%]");
        // Several scenes may share a map, and its clutter stands for the map: no line joins them.
        Some(self.panels(&points, labels, (Some((0.0, 100.0)), scenes.len() == 1), &what))
    }

    fn lengths_and_times(&self) -> Option<Captioned> {
        let point =
            |run: &Row| Some(ChartPoint { x: run.length_m?, y: run.time_s?, y_interval: None });
        let points: Vec<Vec<ChartPoint>> =
            self.by_stack.iter().map(|runs| reached(runs).filter_map(point).collect()).collect();
        if points.iter().all(Vec::is_empty) {
            return None;
        }
        let what = "Distance driven and time to the goal, of each run that reached it; pale: the other stacks.";
        Some(self.panels(&points, ("length [m]", "time [s]"), (None, false), what))
    }

    fn panels(
        &self,
        points: &[Vec<ChartPoint>],
        (x_label, y_label): (&str, &str),
        (y_ends, are_joined): (Option<(f64, f64)>, bool),
        what: &str,
    ) -> Captioned {
        let points = points.iter().map(Vec::as_slice);
        let series = self.names().zip(points);
        let series: Vec<PointSeries<'_>> =
            series.map(|(name, points)| PointSeries { name, points }).collect();
        let (series, caption) = (&series, "");
        let panels = PointPanels { x_label, y_label, y_ends, are_joined, series, caption };
        (point_panels(&panels), self.caption(what))
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    fn caption(&self, what: &str) -> String {
        format!("{what} {} runs in total, simulated with Keyway {}.", self.count, Inputs::VERSION)
    }
}

fn reached<'a>(runs: &[&'a Row]) -> impl Iterator<Item = &'a Row> {
    runs.iter().copied().filter(|run| run.outcome == EpisodeOutcome::Reached)
}

/// Groups of runs in worlds of similar clutter.
struct Groups {
    /// Upper bound of the occupied share of each group but the last one.
    ends: Vec<f64>,
    /// Median of each group.
    middles: Vec<f64>,
}

impl Groups {
    /// Maximum number of groups.
    const MOST: usize = 6;
    /// Runs of a stack per group below which the interval is too wide to be informative.
    const FEWEST_RUNS: usize = 10;
    /// Difference in clutter between the first and the last group below which a plot over it would
    /// show chance.
    const LEAST_SPREAD: f64 = 0.01;

    /// Groups the shares into bins of similar size without splitting equal shares; few distinct
    /// shares get one bin each. `per_stack` is the number of runs of a stack. `None` if there is
    /// only one bin, or all are about equally cluttered.
    fn of(shares: Vec<f64>, per_stack: usize) -> Option<Self> {
        let most = (per_stack / Self::FEWEST_RUNS).clamp(2, Self::MOST);
        let sample = Sample::new(shares).ok()?;
        let mut distinct = sample.values().to_vec();
        distinct.dedup();
        let mut ends = if distinct.len() <= most {
            distinct
        } else {
            let end = |i: usize| {
                let place = sample.values().len() * i / most;
                sample.values()[place - 1]
            };
            (1..=most).map(end).collect()
        };
        ends.dedup();
        ends.pop();
        let group_of = |share: f64| ends.partition_point(|&end| end < share);
        let middle = |group: usize| {
            let own = sample.values().iter().copied().filter(|&share| group_of(share) == group);
            Sample::new(own.collect()).ok().map(|own| own.quantile(0.5))
        };
        let middles: Vec<f64> = (0..=ends.len()).filter_map(middle).collect();
        let spread = middles.last()? - middles.first()?;
        (spread >= Self::LEAST_SPREAD).then_some(Self { ends, middles })
    }

    /// Runs of a stack that belong to a group.
    fn own<'a>(&self, runs: &[&'a Row], group: usize) -> impl Iterator<Item = &'a Row> {
        let is_own = move |run: &&Row| {
            let share = run.occupied_share;
            share.is_some_and(|share| self.ends.partition_point(|&end| end < share) == group)
        };
        runs.iter().copied().filter(is_own)
    }

    /// Number of runs of a stack in a group, as text: `10`, or `8 to 12`.
    fn sizes(&self, by_stack: &[Vec<&Row>]) -> String {
        let groups = 0..self.middles.len();
        let of_group = |group| by_stack.iter().map(move |runs| self.own(runs, group).count());
        let sizes: Vec<usize> = groups.flat_map(of_group).collect();
        let (least, most) = (sizes.iter().min(), sizes.iter().max());
        match (least, most) {
            (Some(least), Some(most)) if least < most => format!("{least} to {most}"),
            _ => least.copied().unwrap_or_default().to_string(),
        }
    }

    /// Success rates of a stack.
    fn points(&self, runs: &[&Row]) -> Vec<ChartPoint> {
        let point = |(group, &middle): (usize, &f64)| {
            let own = self.own(runs, group);
            let rate = Rate::of(own.map(|run| run.outcome == EpisodeOutcome::Reached));
            let interval = rate.interval(Confidence::USUAL)?;
            Some(ChartPoint {
                x: 100.0 * middle,
                y: 100.0 * rate.share()?,
                y_interval: Some((100.0 * interval.low, 100.0 * interval.high)),
            })
        };
        self.middles.iter().enumerate().filter_map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_as_short_as_they_can_be_told_apart() {
        let stacks =
            ["astar-follow", "a/one.toml", "b/one.toml", "./two.toml", "./astar-follow.toml"];
        let expected = ["astar-follow", "a/one", "b/one", "two", "./astar-follow"];
        assert_eq!(short_names(&stacks), expected);
        assert_eq!(short_names(&["x", "x.toml"]), ["x", "x.toml"]);
    }

    #[test]
    fn groups_by_hand() {
        let of = |shares: &[f64]| Groups::of(shares.to_vec(), 60).map(|it| (it.ends, it.middles));
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[0.2, 0.2]), None);
        assert_eq!(of(&[0.0536, 0.0542, 0.0539]), None);
        assert_eq!(of(&[0.2, 0.1, 0.2]), Some((vec![0.1], vec![0.1, 0.2])));
        let shares: Vec<f64> = (1..=12).map(f64::from).collect();
        let ends = vec![2.0, 4.0, 6.0, 8.0, 10.0];
        assert_eq!(of(&shares), Some((ends, vec![1.5, 3.5, 5.5, 7.5, 9.5, 11.5])));
        // Few runs give two groups, whatever the number of shares.
        let few = Groups::of(vec![0.1, 0.2, 0.3, 0.4], 4).unwrap();
        assert_eq!((few.ends, few.middles.len()), (vec![0.2], 2));
        // Most worlds are empty.
        let mut shares = vec![0.0; 20];
        shares.extend((1..=10).map(f64::from));
        assert_eq!(of(&shares), Some((vec![0.0, 5.0], vec![0.0, 3.0, 8.0])));
    }
}
