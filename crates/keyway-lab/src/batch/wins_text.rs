//! Tables of wins and losses, for display.

use super::record::Record;
use super::summary::markdown_table;
use super::wins::{Contest, RunMeasure, Verdict, Wins};
use crate::table::{number, paragraph, rows};
use std::collections::HashMap;

/// Maximum number of runs listed on the terminal; files list all of them.
const MOST_NAMED: usize = 8;

/// Table of counts for the terminal, with the runs in which the first stack is worse than another
/// one; `None` for a single stack.
pub fn wins_table(wins: &[Wins]) -> Option<String> {
    let first = &wins.first()?.first;
    let table = rows(&header(), counts(wins), 1);
    let runs = wins.iter().flat_map(|one| one.better_in.iter().chain(&one.worse_in));
    let with_seeds = has_seeds(runs.map(|run| (run.scene.as_str(), run.seed)));
    let line = |measure| worse_line(wins, measure, with_seeds);
    let worse: String = RunMeasure::ALL.into_iter().filter_map(line).collect();
    Some(format!("Runs in which {first} is better : equal : worse:\n\n{table}\n\n{ABOUT}{worse}"))
}

/// Counts as Markdown, and a table of all scenes with the values of the first stack and the best
/// other one; empty for a single stack.
pub(super) fn wins_markdown(records: &[Record], contest: &Contest<'_>) -> String {
    let Some(Wins { first, .. }) = contest.wins.first() else { return String::new() };
    let counts = markdown_table(&header(), counts(&contest.wins).into_iter());
    let scenes = scenes(records, contest);
    format!(
        "Runs in which {first} is better : equal : worse:\n\n{counts}\n{ABOUT}\n\nScene by scene:\n\n{scenes}\n{ABOUT_SCENES}\n"
    )
}

fn header() -> Vec<&'static str> {
    let mut header = vec!["stack"];
    header.extend(RunMeasure::ALL.map(RunMeasure::short_name));
    header
}

/// A line of counts for each stack.
fn counts(wins: &[Wins]) -> Vec<Vec<String>> {
    let line = |of_stack: &[Wins]| {
        let mut cells = vec![of_stack[0].stack.clone()];
        let cell = |one: &Wins| format!("{} : {} : {}", one.better, one.equal, one.worse);
        cells.extend(of_stack.iter().map(cell));
        cells
    };
    wins.chunks(RunMeasure::ALL.len()).map(line).collect()
}

/// Lists the runs in which a stack is better than the first one by a measure; `None` if there is
/// none.
fn worse_line(wins: &[Wins], measure: RunMeasure, with_seeds: bool) -> Option<String> {
    let mut names: Vec<String> = Vec::new();
    for one in wins.iter().filter(|one| one.measure == measure) {
        for run in &one.worse_in {
            let name = name(&run.scene, run.seed, with_seeds);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    let more = names.len().saturating_sub(MOST_NAMED);
    names.truncate(MOST_NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let (measure, names_text) = (measure.short_name(), names.join(", "));
    let text = format!("worse than another in {measure}: {names_text}{more}");
    (!names.is_empty()).then(|| format!("\n{}", paragraph(&text)))
}

/// True if a scene appears among these runs with several seeds.
fn has_seeds<'a>(runs: impl Iterator<Item = (&'a str, u64)>) -> bool {
    let mut first_seeds = HashMap::new();
    runs.into_iter().any(|(scene, seed)| *first_seeds.entry(scene).or_insert(seed) != seed)
}

fn name(scene: &str, seed: u64, with_seed: bool) -> String {
    if with_seed { format!("{scene} (seed {seed})") } else { scene.to_owned() }
}

/// Table of all runs of the first stack: its values, and the best ones of other stacks.
fn scenes(records: &[Record], contest: &Contest<'_>) -> String {
    let first = &contest.wins[0].first;
    let runs = || records.iter().map(|record| &record.run).filter(|run| run.stack == *first);
    let with_seeds = has_seeds(runs().map(|run| (run.scene.as_str(), run.seed)));
    let line = |run: &super::Row| {
        let mut cells = vec![name(&run.scene, run.seed, with_seeds)];
        let cell = |measure| scene_cell(contest, run, measure);
        cells.extend(RunMeasure::ALL.map(cell));
        cells
    };
    let mut header = header();
    header[0] = "scene";
    markdown_table(&header, runs().map(line))
}

/// Value of the first stack, and in brackets the best stack that is better, its value, and the
/// number of better ones.
fn scene_cell(contest: &Contest<'_>, run: &super::Row, measure: RunMeasure) -> String {
    let own = measure.of(run);
    let better: Vec<_> = contest.better_than_first(measure, &run.scene, run.seed).collect();
    let is_better = |a: f64, b: f64| measure.is_more_better() == (a > b) && a != b;
    let best = better.iter().copied().reduce(
        |best, one| {
            if is_better(one.1, best.1) { one } else { best }
        },
    );
    let shown = |value: Option<f64>| match (measure, value) {
        (RunMeasure::Reached, Some(reached)) if reached > 0.0 => "yes".to_owned(),
        (RunMeasure::Reached, _) => "no".to_owned(),
        (_, value) => number(value, measure.decimals()),
    };
    match best {
        None => shown(own),
        Some(_) if measure == RunMeasure::Reached => format!("no ({} do)", better.len()),
        Some((stack, value)) => {
            format!("{} ({stack} {}, {})", shown(own), shown(Some(value)), better.len())
        }
    }
}

impl Contest<'_> {
    /// Stacks that are better than the first one in a run, with their values.
    fn better_than_first(
        &self,
        measure: RunMeasure,
        scene: &str,
        seed: u64,
    ) -> impl Iterator<Item = (&str, f64)> {
        let lines = self.lines.iter().filter(move |line| {
            line.first_is == Verdict::Worse
                && (line.measure, line.scene, line.seed) == (measure, scene, seed)
        });
        lines.map(|line| (line.stack, line.of_stack))
    }
}

const ABOUT: &str = "reached: all runs; the other measures: runs in which both reached the goal. time, length: less is better; clearance: the\n\
                     smallest of a run, more is better; path, speed: smoothness by MRPB (f_ps, f_vs), less is better. equal: within 1 %.";

const ABOUT_SCENES: &str = "In brackets: the best of the better stacks, its value, and the number of better stacks. time [s], length [m],\n\
                            clearance [m], path [m²], speed [m/s²].";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::wins::tests::{record, records, stacks};

    #[test]
    fn seeds_are_named_where_a_scene_has_several() {
        let several = |runs: &[(&str, u64)]| has_seeds(runs.iter().copied());
        assert!(several(&[("a", 1), ("b", 1), ("a", 2)]));
        assert!(!several(&[("a", 1), ("b", 2), ("a", 1)]));
        // Seeds also appear if the runs of the other seed are equal.
        let mut records = records();
        let again = records.iter().filter(|record| record.run.scene == "same").cloned();
        let again: Vec<Record> = again.collect();
        records.extend(again.into_iter().map(|mut record| {
            record.run.seed = 2;
            record
        }));
        let stacks = stacks();
        let text = wins_markdown(&records, &Contest::of(&records, &stacks));
        assert!(text.contains("| same (seed 2) |"), "{text}");
    }

    #[test]
    fn tables_by_hand() {
        let (mut records, stacks) = (records(), stacks());
        let contest = Contest::of(&records, &stacks);
        let text = wins_table(&contest.wins).unwrap();
        assert!(text.contains(" theirs  0 : 3 : 1  1 : 1 : 1  0 : 3 : 0"), "{text}");
        assert!(text.contains("worse than another in reached: stuck\n"), "{text}");
        assert!(text.ends_with("worse than another in time: slow"), "{text}");
        let text = wins_markdown(&records, &contest);
        assert!(text.contains("| theirs | 0 : 3 : 1 | 1 : 1 : 1 |"), "{text}");
        assert!(text.contains("| slow | yes | 10.2 (theirs 10.0, 1) | 4.0 |"), "{text}");
        assert!(text.contains("| stuck | no (1 do) | - | - |"), "{text}");
        assert!(text.contains("| fast | yes | 10.0 | 4.0 |"), "{text}");
        // The best of two, and a second seed.
        let third = record("slow", "third", Some(9.0));
        let mut other = record("slow", "mine", Some(7.0));
        other.run.seed = 2;
        let mut late = record("slow", "theirs", Some(8.0));
        late.run.seed = 2;
        records.extend([third, other, late]);
        let stacks = [&stacks[..], &["third".to_owned()]].concat();
        let contest = Contest::of(&records, &stacks);
        let text = wins_markdown(&records, &contest);
        assert!(text.contains("| slow (seed 1) | yes | 10.2 (third 9.0, 2) |"), "{text}");
        assert!(text.contains("| slow (seed 2) | yes | 7.0 |"), "{text}");
        assert_eq!(wins_table(&[]), None);
    }
}
