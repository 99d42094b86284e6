//! Batches that are stopped, executed in parts, and replayed.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway_lab::batch::{
    BatchError, BatchRequest, BatchWarning, GivenScene, Keep, MergeRequest, Shard,
};
use keyway_lab::progress::Progress;
use keyway_lab::replay::{Difference, ReplayError, ReplayRequest};
use keyway_sim::episode::{EpisodeOutcome, run_episode};
use keyway_sim::scene_files::SceneFile;
use std::fmt::Display;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::TempDir;

/// A short route across a generated room, with noise that depends on the seed.
const NOISY: &str = "version = 2\nseed = 3\nstart = [1, 1]\ngoal = [3, 1]\n[world]\nwidth_m = 4\n\
                     height_m = 2\nresolution_m = 0.1\n[disturbances.sensor]\nrange_m = 0.01\n";

/// A folder with a scene, and a request for five runs of it.
fn prepared(scene: &str) -> (TempDir, BatchRequest) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.toml");
    fs::write(&path, scene).unwrap();
    let request = BatchRequest::new(vec![path.into()], folder.path().join("out"));
    (folder, BatchRequest { seeds: 5, jobs: Some(1), ..request })
}

fn runs(folder: &Path) -> String {
    fs::read_to_string(folder.join("runs.jsonl")).unwrap()
}

/// Stops the work after some answers, and stores the warnings.
struct Stop {
    after: usize,
    expected: Mutex<usize>,
    answers: AtomicUsize,
    warnings: Mutex<Vec<String>>,
}

impl Stop {
    fn after(after: usize) -> Self {
        let (expected, warnings) = (Mutex::default(), Mutex::default());
        Self { after, expected, answers: AtomicUsize::new(0), warnings }
    }
}

impl Progress for Stop {
    fn expect(&self, answers: usize) {
        *self.expected.lock().unwrap() += answers;
    }

    fn answered(&self) -> ControlFlow<()> {
        let answers = self.answers.fetch_add(1, Ordering::Relaxed) + 1;
        if answers == self.after { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn warned(&self, warning: &dyn Display) {
        self.warnings.lock().unwrap().push(warning.to_string());
    }
}

#[test]
fn a_batch_that_was_stopped_goes_on_and_parts_make_the_whole() {
    let (folder, request) = prepared(NOISY);
    assert_eq!(request.drive(&(), &()).unwrap().runs, 5);
    let whole = runs(&request.out);
    assert_eq!(whole.lines().count(), 5);
    // No run is missing.
    let again = Stop::after(1);
    request.drive(&(), &again).unwrap();
    assert_eq!(*again.expected.lock().unwrap(), 0);
    let stopped = BatchRequest { out: folder.path().join("stopped"), ..request.clone() };
    let error = stopped.drive(&(), &Stop::after(2)).unwrap_err();
    assert!(matches!(error, BatchError::Stopped), "{error}");
    let rest = Stop::after(9);
    stopped.drive(&(), &rest).unwrap();
    assert_eq!(*rest.expected.lock().unwrap(), 3);
    assert_eq!(runs(&stopped.out), whole);
    let part = |number: usize| {
        let out = folder.path().join(format!("part-{number}"));
        let shard = Some(Shard::new(number, 2).unwrap());
        BatchRequest { out: out.clone(), shard, ..request.clone() }.drive(&(), &()).unwrap();
        out
    };
    let parts = vec![part(2), part(1)];
    let one = MergeRequest { parts: parts[..1].to_vec(), out: folder.path().join("merged") };
    let error = one.merge(&(), &()).unwrap_err();
    assert_eq!(error.field(), Some("parts"));
    assert!(
        error.to_string().contains("other parts of the same batch are missing: 1/2"),
        "{error}"
    );
    let both = MergeRequest { parts, ..one };
    assert_eq!(both.merge(&(), &()).unwrap().runs, 5);
    assert_eq!(runs(&both.out), whole);
}

#[test]
fn a_scene_in_memory_gives_the_results_of_its_file() {
    let (folder, request) = prepared(NOISY);
    request.drive(&(), &()).unwrap();
    let given = |name: &str| GivenScene {
        name: name.to_owned(),
        file: SceneFile::from_toml(NOISY).unwrap(),
        folder: folder.path().to_owned(),
        map: None,
    };
    let of = |scenes| BatchRequest { scenes, out: folder.path().join("given"), ..request.clone() };
    let in_memory = of(vec![given("room").into()]);
    in_memory.drive(&(), &()).unwrap();
    assert_eq!(runs(&in_memory.out), runs(&request.out));
    let mut twice = request.scenes.clone();
    twice.push(given("room").into());
    for (scenes, text) in [
        (twice, "two scenes are named `room`; one of them needs another name"),
        (vec![given("").into()], "the name of a scene must not be empty"),
    ] {
        let error = of(scenes).drive(&(), &()).unwrap_err();
        assert_eq!((error.to_string(), error.field()), (text.to_owned(), Some("scenes")));
    }
}

#[test]
fn seeds_of_a_scene_without_anything_random_are_a_likely_mistake() {
    let noiseless = NOISY.split("[disturbances").next().unwrap();
    let (_folder, request) = prepared(noiseless);
    let said = Stop::after(9);
    request.drive(&(), &said).unwrap();
    let expected = BatchWarning::NotRandom { scene: "room".to_owned() }.to_string();
    assert_eq!(*said.warnings.lock().unwrap(), [expected]);
}

#[test]
fn a_record_gives_the_same_run_again() {
    let (_folder, request) = prepared(NOISY);
    let request = BatchRequest { seeds: 1, keep: Keep::All, ..request };
    let report = request.drive(&(), &()).unwrap();
    assert_eq!(report.records, 1);
    let path = report.records_folder.join("room.keyway.3.json");
    let replay = |record: &Path| {
        let record = record.to_owned();
        ReplayRequest { record, map_dir: None, max_cells: request.max_cells }.read(&()).unwrap()
    };
    let again = replay(&path);
    assert!(!again.has_robots);
    let made = run_episode(&again.episode).unwrap().first();
    assert_eq!(made.outcome, EpisodeOutcome::Reached);
    again.check(&made).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let changed = path.with_file_name("changed.json");
    let other = text.replace("\"outcome\": \"reached\"", "\"outcome\": \"stuck\"");
    fs::write(&changed, other).unwrap();
    let error = replay(&changed).check(&made).unwrap_err();
    let ReplayError::OtherRun { difference, robot: None, .. } = error else { panic!("{error}") };
    let (recorded, made) = ("stuck".to_owned(), "reached".to_owned());
    assert_eq!(difference, Difference::Outcome { recorded, made });
}
