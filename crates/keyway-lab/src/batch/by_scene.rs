//! Results of each stack in each scene.

use super::independent::independent;
use super::record::Record;
use super::row::{ContactWhile, Row};
use super::summary::{ended, of_reached, touched};
use crate::measure::mean;
use crate::table::rows;
use keyway_sim::episode::EpisodeOutcome;
use keyway_sim::metrics::statistics::{Confidence, Rate};
use serde::Serialize;
use std::collections::HashMap;

/// Results of a stack in a scene.
///
/// A summary over all scenes hides that one stack is better in one scene, and another one
/// elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneSummary {
    scene: String,
    stack: String,
    runs: usize,
    reached: usize,
    /// Wilson's 95 % interval of the share of runs that reached the goal.
    ci_low_reached: Option<f64>,
    ci_high_reached: Option<f64>,
    contacts_driving: usize,
    contacts_standing: usize,
    stuck: usize,
    timeout: usize,
    no_path: usize,
    mean_time_s: Option<f64>,
    mean_clearance_m: Option<f64>,
}

impl SceneSummary {
    /// Summary of the runs of a stack in a scene, with the interval of those that are
    /// `independent`.
    fn of(runs: &[&Row], independent: &[&Row]) -> Self {
        let of = |outcome| ended(runs, outcome);
        let rate = Rate::of(independent.iter().map(|run| run.has_reached()));
        let rate = rate.interval(Confidence::USUAL);
        Self {
            scene: runs[0].scene.clone(),
            stack: runs[0].stack.clone(),
            runs: runs.len(),
            reached: of(EpisodeOutcome::Reached),
            ci_low_reached: rate.map(|ends| ends.low),
            ci_high_reached: rate.map(|ends| ends.high),
            contacts_driving: touched(runs, ContactWhile::Driving),
            contacts_standing: touched(runs, ContactWhile::Standing),
            stuck: of(EpisodeOutcome::Stuck),
            timeout: of(EpisodeOutcome::Timeout),
            no_path: of(EpisodeOutcome::NoPath),
            mean_time_s: mean(&of_reached(runs, |run| run.time_s)),
            mean_clearance_m: mean(&of_reached(runs, |run| run.min_clearance_m)),
        }
    }
}

/// Summaries of all stacks in each scene, in the order of the first runs.
pub fn scene_summaries(records: &[Record]) -> Vec<SceneSummary> {
    let independent = by_scene_and_stack(independent(records).into_iter());
    let all = by_scene_and_stack(records.iter().map(|record| &record.run));
    let pairs = all.iter().zip(&independent);
    pairs.map(|(runs, independent)| SceneSummary::of(runs, independent)).collect()
}

/// The runs of each stack in each scene; no group is empty.
fn by_scene_and_stack<'a>(runs: impl Iterator<Item = &'a Row>) -> Vec<Vec<&'a Row>> {
    let (mut scenes, mut places) = (HashMap::new(), HashMap::new());
    let mut groups: Vec<(usize, Vec<&Row>)> = Vec::new();
    for run in runs {
        let next = scenes.len();
        let scene = *scenes.entry(run.scene.as_str()).or_insert(next);
        let place = *places.entry((scene, run.stack.as_str())).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, group)) => group.push(run),
            None => groups.push((scene, vec![run])),
        }
    }
    groups.sort_by_key(|&(scene, _)| scene);
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Largest number of scenes for which a table is shown.
const MOST_SHOWN: usize = 24;

/// Lines of a table: a scene and the shares of runs in which each stack reached the goal. `None`
/// if there is one scene, one stack, one run of each, or too many scenes.
fn shown(summaries: &[SceneSummary]) -> Option<(Vec<&str>, Vec<Vec<String>>)> {
    let (mut scenes, mut stacks): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for SceneSummary { scene, stack, .. } in summaries {
        for (names, name) in [(&mut scenes, scene), (&mut stacks, stack)] {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
    }
    let has_several_runs = summaries.iter().any(|one| one.runs > 1);
    let is_shown = (2..=MOST_SHOWN).contains(&scenes.len()) && stacks.len() > 1 && has_several_runs;
    let cell = |scene: &str, stack: &str| {
        let found = summaries.iter().find(|one| one.scene == scene && one.stack == stack);
        found.map_or_else(|| "-".to_owned(), |one| format!("{} of {}", one.reached, one.runs))
    };
    let line = |&scene: &&str| {
        let cells = stacks.iter().map(|stack| cell(scene, stack));
        std::iter::once(scene.to_owned()).chain(cells).collect()
    };
    is_shown.then(|| {
        let lines = scenes.iter().map(line).collect();
        (std::iter::once("scene").chain(stacks.iter().copied()).collect(), lines)
    })
}

/// Table for the terminal; `None` if it would show nothing new, or too many scenes.
pub fn scenes_table(summaries: &[SceneSummary]) -> Option<String> {
    let (header, lines) = shown(summaries)?;
    Some(format!("{ABOUT}\n\n{}", rows(&header, lines, 1)))
}

/// Table as Markdown.
pub(super) fn scenes_markdown(summaries: &[SceneSummary]) -> Option<String> {
    let (header, lines) = shown(summaries)?;
    let table = super::summary::markdown_table(&header, lines.into_iter());
    Some(format!("\n{ABOUT}\n\n{table}"))
}

const ABOUT: &str = "Runs that reached the goal, by scene:";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::wins::tests::{record, records};

    #[test]
    fn each_scene_by_hand() {
        let all: Vec<Record> = records().into_iter().chain(records()).collect();
        let summaries = scene_summaries(&all);
        assert_eq!(summaries.len(), 8);
        let (header, lines) = shown(&summaries).unwrap();
        assert_eq!(header, ["scene", "mine", "theirs"]);
        assert_eq!(lines[0], ["fast", "2 of 2", "2 of 2"]);
        assert_eq!(lines[2], ["stuck", "0 of 2", "2 of 2"]);
        // Single runs, single stacks, single scenes.
        assert_eq!(shown(&scene_summaries(&records())), None);
        let one_stack = ["a", "a", "b"].map(|scene| record(scene, "mine", Some(1.0)));
        assert_eq!(shown(&scene_summaries(&one_stack)), None);
        let one_scene = ["s", "s", "t"].map(|stack| record("a", stack, Some(1.0)));
        assert_eq!(shown(&scene_summaries(&one_scene)), None);
    }
}
