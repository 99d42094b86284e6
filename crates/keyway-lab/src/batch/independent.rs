//! The runs that count in shares, means, intervals and tests.

use super::record::Record;
use super::row::Row;
use std::collections::{HashMap, HashSet};

/// The runs without the repetitions of scenes in which every seed gave the same runs.
///
/// Intervals and tests assume independent runs. A scene without randomness gives the same run
/// with every seed, so that each stack has only one run there: that of its first seed.
pub(super) fn independent(records: &[Record]) -> Vec<&Row> {
    let mut scenes: HashMap<&str, Vec<&Row>> = HashMap::new();
    for Record { run, .. } in records {
        scenes.entry(&run.scene).or_default().push(run);
    }
    let repeated: HashSet<&str> =
        scenes.iter().filter(|(_, runs)| are_repeated(runs)).map(|(&scene, _)| scene).collect();
    let mut counted = HashSet::new();
    let runs = records.iter().map(|record| &record.run);
    runs.filter(|run| {
        let scene = run.scene.as_str();
        !repeated.contains(scene) || counted.insert((scene, run.stack.as_str()))
    })
    .collect()
}

/// True if there are several seeds, and every stack has the same run with each of them.
fn are_repeated(runs: &[&Row]) -> bool {
    let mut firsts: HashMap<&str, &Row> = HashMap::new();
    let seeds: HashSet<u64> = runs.iter().map(|run| run.seed).collect();
    seeds.len() > 1 && runs.iter().all(|run| is_same(firsts.entry(&run.stack).or_insert(run), run))
}

/// True if two runs of a stack in a scene have the same results.
fn is_same(one: &Row, other: &Row) -> bool {
    let Row { seed, digest, .. } = one;
    *one == Row { seed: *seed, digest: digest.clone(), ..other.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::wins::tests::record;

    /// The runs of one stack in a scene, with these times and seeds from 0.
    fn runs(scene: &str, stack: &str, times_s: &[f64]) -> Vec<Record> {
        let run = |(seed, &time_s): (u64, &f64)| {
            let mut record = record(scene, stack, Some(time_s));
            (record.run.seed, record.run.digest) = (seed, format!("{seed}"));
            record
        };
        (0..).zip(times_s).map(run).collect()
    }

    #[test]
    fn repetitions_count_once_and_equal_runs_of_a_random_scene_count() {
        let all = [
            runs("still", "mine", &[10.0; 3]),
            runs("still", "theirs", &[20.0; 3]),
            // One stack cannot tell the seeds apart, the other one can.
            runs("random", "mine", &[10.0; 3]),
            runs("random", "theirs", &[20.0, 20.0, 21.0]),
            runs("once", "mine", &[90.0]),
        ];
        let all: Vec<Record> = all.into_iter().flatten().collect();
        let counts = |scene: &str| {
            let counted = independent(&all);
            counted.iter().filter(|run| run.scene == scene).map(|run| run.seed).collect::<Vec<_>>()
        };
        // A share and a mean are inside their own intervals.
        for one in crate::batch::summaries(&all) {
            let [share, mean_s] = [
                one.independent_reached as f64 / one.independent_runs as f64,
                one.mean_time_s.unwrap(),
            ];
            let reached = one.ci_low_reached.unwrap()..=one.ci_high_reached.unwrap();
            let time_s = one.ci_low_time_s.unwrap()..=one.ci_high_time_s.unwrap();
            assert!(reached.contains(&share) && time_s.contains(&mean_s), "{one:?}");
        }
        assert_eq!(counts("still"), [0, 0]);
        assert_eq!(counts("random"), [0, 1, 2, 0, 1, 2]);
        assert_eq!(counts("once"), [0]);
    }
}
