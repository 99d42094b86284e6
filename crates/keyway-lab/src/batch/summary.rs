//! Summary of the runs of each stack.

use super::independent::independent;
use super::record::Record;
use super::row::{ContactWhile, Row};
use crate::measure::mean;
use crate::table::{comment, latex_table};
use crate::table::{number, percent, rows, with_range};
use keyway_sim::episode::EpisodeOutcome;
use keyway_sim::metrics::statistics::{Confidence, Interval, Rate, Sample};
use serde::Serialize;

/// Summary of the runs of a stack. Means are over the runs in which all robots reached their goals;
/// the score is over all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StackSummary {
    /// Name of the stack.
    pub stack: String,
    pub(super) runs: usize,
    pub(super) reached: usize,
    /// Runs that count in shares, means and intervals, and those of them that reached the goal: a
    /// scene in which every seed gives the same runs counts once.
    pub(super) independent_runs: usize,
    pub(super) independent_reached: usize,
    /// Wilson's 95 % interval of the share of runs that reached the goal.
    pub(super) ci_low_reached: Option<f64>,
    pub(super) ci_high_reached: Option<f64>,
    /// Number of robots in all runs, and of those that reached their goals.
    pub(super) robots: u32,
    pub(super) robots_reached: u32,
    pub(super) contacts_driving: usize,
    pub(super) contacts_standing: usize,
    pub(super) stuck: usize,
    pub(super) timeout: usize,
    pub(super) no_path: usize,
    pub(super) mean_time_s: Option<f64>,
    pub(super) sd_time_s: Option<f64>,
    /// Bootstrap 95 % interval of the mean, as for the score.
    pub(super) ci_low_time_s: Option<f64>,
    pub(super) ci_high_time_s: Option<f64>,
    pub(super) mean_length_m: Option<f64>,
    pub(super) mean_speed_mps: Option<f64>,
    pub(super) mean_clearance_m: Option<f64>,
    pub(super) least_clearance_m: Option<f64>,
    pub(super) least_robot_clearance_m: Option<f64>,
    pub(super) mean_share_near: Option<f64>,
    pub(super) mean_path_smoothness_m2: Option<f64>,
    pub(super) mean_velocity_smoothness_mps2: Option<f64>,
    pub(super) mean_score: Option<f64>,
    pub(super) ci_low_score: Option<f64>,
    pub(super) ci_high_score: Option<f64>,
}

/// Summaries of all stacks, in the order of their first runs.
pub fn summaries(records: &[Record]) -> Vec<StackSummary> {
    let mut names: Vec<&str> = Vec::new();
    for record in records {
        if !names.contains(&record.run.stack.as_str()) {
            names.push(&record.run.stack);
        }
    }
    let independent = independent(records);
    let of = |name: &str| {
        let runs = records.iter().map(|record| &record.run).filter(|run| run.stack == name);
        let counted = independent.iter().copied().filter(|run| run.stack == name);
        summary(name, &runs.collect::<Vec<_>>(), &counted.collect::<Vec<_>>())
    };
    names.into_iter().map(of).collect()
}

/// Summary of the runs of a stack: counts of all, shares and means of those that are
/// `independent`.
fn summary(stack: &str, runs: &[&Row], independent: &[&Row]) -> StackSummary {
    let of = |outcome| ended(runs, outcome);
    let touched = |while_| touched(runs, while_);
    let reached = |get| of_reached(independent, get);
    let clearances = reached(|run| run.min_clearance_m);
    let time = Sample::new(reached(|run| run.time_s)).ok();
    let score = Sample::new(independent.iter().filter_map(|run| run.score).collect()).ok();
    let rate = Rate::of(independent.iter().map(|run| run.has_reached()));
    let rate = rate.interval(Confidence::USUAL);
    let time_ends = time.as_ref().and_then(mean_interval);
    let score_ends = score.as_ref().and_then(mean_interval);
    StackSummary {
        stack: stack.to_owned(),
        runs: runs.len(),
        reached: of(EpisodeOutcome::Reached),
        independent_runs: independent.len(),
        independent_reached: ended(independent, EpisodeOutcome::Reached),
        ci_low_reached: rate.map(|ends| ends.low),
        ci_high_reached: rate.map(|ends| ends.high),
        robots: runs.iter().map(|run| run.robots).sum(),
        robots_reached: runs.iter().map(|run| run.robots_reached).sum(),
        contacts_driving: touched(ContactWhile::Driving),
        contacts_standing: touched(ContactWhile::Standing),
        stuck: of(EpisodeOutcome::Stuck),
        timeout: of(EpisodeOutcome::Timeout),
        no_path: of(EpisodeOutcome::NoPath),
        mean_time_s: time.as_ref().map(Sample::mean),
        sd_time_s: time.as_ref().and_then(Sample::standard_deviation),
        ci_low_time_s: time_ends.map(|ends| ends.low),
        ci_high_time_s: time_ends.map(|ends| ends.high),
        mean_length_m: mean(&reached(|run| run.length_m)),
        mean_speed_mps: mean(&reached(|run| run.mean_speed_mps)),
        mean_clearance_m: mean(&clearances),
        least_clearance_m: clearances.into_iter().reduce(f64::min),
        least_robot_clearance_m: reached(|run| run.min_robot_clearance_m)
            .into_iter()
            .reduce(f64::min),
        mean_share_near: mean(&reached(|run| run.share_near)),
        mean_path_smoothness_m2: mean(&reached(|run| run.path_smoothness_m2)),
        mean_velocity_smoothness_mps2: mean(&reached(|run| run.velocity_smoothness_mps2)),
        mean_score: score.as_ref().map(Sample::mean),
        ci_low_score: score_ends.map(|ends| ends.low),
        ci_high_score: score_ends.map(|ends| ends.high),
    }
}

/// Number of runs with an outcome.
pub(super) fn ended(runs: &[&Row], outcome: EpisodeOutcome) -> usize {
    runs.iter().filter(|run| run.outcome == outcome).count()
}

/// Number of runs that ended in a contact in this state of motion.
pub(super) fn touched(runs: &[&Row], while_: ContactWhile) -> usize {
    runs.iter().filter(|run| run.contact == Some(while_)).count()
}

/// Values of the runs that reached the goal.
pub(super) fn of_reached(runs: &[&Row], get: fn(&Row) -> Option<f64>) -> Vec<f64> {
    runs.iter().filter(|run| run.has_reached()).filter_map(|run| get(run)).collect()
}

/// Interval of the mean with a fixed seed, so that the same runs give the same bytes.
fn mean_interval(sample: &Sample) -> Option<Interval> {
    sample.mean_interval(Confidence::USUAL, 0)
}

/// Column names: as in the text below the table, and with units.
const COLUMNS: [[&str; 2]; 11] = [
    ["stack", "stack"],
    ["runs", "runs"],
    ["reached", "reached %"],
    ["robots", "robots %"],
    ["contacts", "contacts"],
    ["stuck", "stuck"],
    ["time", "time s"],
    ["length", "length m"],
    ["speed", "speed m/s"],
    ["clearance", "clearance m"],
    ["score", "score"],
];

/// Index of the column that is useful only for several robots.
const ROBOTS: usize = 3;

/// A table for the terminal and for papers.
struct Shown {
    header: Vec<&'static str>,
    lines: Vec<Vec<String>>,
    about: String,
}

impl Shown {
    fn of(stacks: &[StackSummary], with_units: bool) -> Self {
        let is_team = stacks.iter().any(|stack| stack.robots as usize > stack.runs);
        let is_shown = |i: usize| i != ROBOTS || is_team;
        let header = (0..COLUMNS.len()).filter(|&i| is_shown(i));
        let header = header.map(|i| COLUMNS[i][usize::from(with_units)]).collect();
        let line = |stack| {
            let cells = cells(stack).into_iter().enumerate();
            cells.filter_map(|(i, cell)| is_shown(i).then_some(cell)).collect()
        };
        let is_repeated = stacks.iter().any(|stack| stack.independent_runs < stack.runs);
        let more = [(is_team, ABOUT_ROBOTS), (is_repeated, ABOUT_REPEATED)];
        let more = more.into_iter().filter_map(|(is_said, text)| is_said.then_some(text));
        let about = std::iter::once(ABOUT).chain(more).collect::<Vec<_>>().join("\n");
        Self { header, lines: stacks.iter().map(line).collect(), about }
    }
}

/// Cells of a stack: contacts while driving and while standing, and the other runs that did not
/// reach the goal.
fn cells(summary: &StackSummary) -> Vec<String> {
    let share = summary.independent_reached as f64 / summary.independent_runs as f64;
    let robots_share = f64::from(summary.robots_reached) / f64::from(summary.robots);
    let others = summary.stuck + summary.timeout + summary.no_path;
    let reached = [summary.ci_low_reached, summary.ci_high_reached];
    let time = [summary.ci_low_time_s, summary.ci_high_time_s];
    let score = [summary.ci_low_score, summary.ci_high_score];
    vec![
        summary.stack.clone(),
        summary.runs.to_string(),
        with_range(Some(share), reached, |share| percent(share, 1)),
        percent(Some(robots_share), 1),
        format!("{} + {}", summary.contacts_driving, summary.contacts_standing),
        others.to_string(),
        with_range(summary.mean_time_s, time, |time| number(time, 1)),
        number(summary.mean_length_m, 2),
        number(summary.mean_speed_mps, 2),
        number(summary.mean_clearance_m, 3),
        with_range(summary.mean_score, score, |score| number(score, 3)),
    ]
}

/// Table for the terminal.
pub fn summary_table(stacks: &[StackSummary]) -> String {
    let Shown { header, lines, about } = Shown::of(stacks, false);
    format!("{}\n\n{about}", rows(&header, lines, 1))
}

/// Table as Markdown.
pub fn summary_markdown(stacks: &[StackSummary]) -> String {
    let Shown { header, lines, about } = Shown::of(stacks, false);
    format!("{}\n{about}\n", markdown_table(&header, lines.into_iter()))
}

/// Table as LaTeX.
pub fn summary_latex(stacks: &[StackSummary]) -> String {
    let Shown { header, lines, about } = Shown::of(stacks, true);
    comment(&about) + &latex_table(&header, &lines, 1)
}

/// Markdown table whose first column is text and whose others are numbers.
pub(super) fn markdown_table(header: &[&str], lines: impl Iterator<Item = Vec<String>>) -> String {
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let head = row(header.iter().map(|&name| name.to_owned()).collect());
    let line = format!("|---|{}\n", "--:|".repeat(header.len() - 1));
    head + &line + &lines.map(row).collect::<String>()
}

const ABOUT: &str = "reached [%], with its 95 % interval; contacts: while driving + while stationary; stuck: includes timeouts and runs\n\
                     without a path. time [s], length [m], speed [m/s] and clearance [m] are means of the runs that reached the goal,\n\
                     the score is the mean of all runs; in brackets: 95 % intervals of the means. Stacks that reach the goal in\n\
                     different runs have means of different runs: the paired differences compare the same ones.";

const ABOUT_REPEATED: &str = "A scene in which every seed gave the same runs counts once in shares, means, intervals and tests.";

const ABOUT_ROBOTS: &str = "With several robots, a run reaches the goal if all robots do: its time is that of the last robot, its length the sum,\n\
                            its clearance the smallest. robots [%]: robots that reached their own goals.";
