//! Tests of `keyway batch` on folders with subfolders, and with files beside the scenes.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const HALL: &str = "version = 2\nseed = 5\nstart = [0.7, 1.0]\ngoal = [3.3, 1.0]\n[world]\nwidth_m = 4\nheight_m = 2\nresolution_m = 0.05\n";

/// Two robots, one of them with a robot file in another folder.
const PAIR: &str = "version = 2\n[world]\nwidth_m = 4\nheight_m = 4\nresolution_m = 0.05\n\
    [[robots]]\nstart = [0.7, 0.8]\ngoal = [3.3, 0.8]\n\
    [[robots]]\nstart = [3.3, 3.2]\ngoal = [0.7, 3.2]\nrobot = \"../robots/mine.toml\"\n";

/// Scenes with the same name in two subfolders, two identical scenes, and files that scenes refer
/// to: a robot and a stack.
fn scenes() -> TempDir {
    let folder = folder();
    for name in ["a/deep", "b", "robots", ".hidden"] {
        std::fs::create_dir_all(folder.path().join("scenes").join(name)).unwrap();
    }
    let list = |line: &str| keyway(folder.path(), line).expect_code(0).out;
    write(&folder, "scenes/robots/mine.toml", &list("list small"));
    write(&folder, "scenes/a/mine.toml", &list("list astar-follow"));
    write(&folder, "scenes/a/hall.toml", &format!("stack = \"./mine.toml\"\n{HALL}"));
    write(&folder, "scenes/a/deep/hall.toml", HALL);
    write(&folder, "scenes/b/hall.toml", &HALL.replace("3.3", "2.3"));
    write(&folder, "scenes/b/pair.toml", PAIR);
    write(&folder, "scenes/copy.toml", HALL);
    write(&folder, "scenes/.hidden/no.toml", "nothing = 1\n");
    write(&folder, "scenes/b/.#hall.toml", "kept by an editor");
    folder
}

fn names(folder: &TempDir, out: &str) -> Vec<Value> {
    let runs = read(folder, &format!("{out}/runs.jsonl"));
    runs.lines().map(|line| line.parse::<Value>().unwrap()["scene"].clone()).collect()
}

#[test]
fn scenes_of_subfolders_are_named_by_their_paths() {
    let folder = scenes();
    let run = |line: &str| keyway(folder.path(), line).expect_code(0);
    run("batch scenes --keep all --out one");
    let all = json!(["a/deep/hall", "a/hall", "b/hall", "b/pair", "copy"]);
    assert_eq!(json!(names(&folder, "one")), all);
    for name in ["a%2Fdeep%2Fhall.keyway.5.json", "b%2Fpair.keyway.0.json"] {
        assert!(folder.path().join("one/records").join(name).exists(), "{name}");
    }
    run("replay one/records/b%2Fpair.keyway.0.json --out replayed");
    // Known runs are not driven again, nor are those of two identical scenes.
    let times = read(&folder, "one/times.jsonl");
    run("batch scenes --keep all --out one");
    assert_eq!(read(&folder, "one/times.jsonl"), times);
    run("batch scenes --shard 1/2 --out part-1");
    run("batch scenes --shard 2/2 --out part-2");
    run("batch merge part-1 part-2 --out whole");
    for name in ["runs.jsonl", "robots.jsonl", "summary.md", "plots/time.svg"] {
        let [one, whole] = ["one", "whole"].map(|out| read(&folder, &format!("{out}/{name}")));
        assert!(one == whole, "{name}");
    }
    // The request refers to the stack, no scene does; every robot has it.
    std::fs::remove_file(folder.path().join("scenes/a/hall.toml")).unwrap();
    run("batch scenes --stacks scenes/a/mine.toml,rrt-follow --out two");
    assert_eq!(names(&folder, "two").len(), 8);
}

#[test]
fn what_is_no_scene_is_refused_unless_something_refers_to_it() {
    let folder = scenes();
    let refused =
        |line: &str| keyway(folder.path(), &format!("{line} --out no")).expect_code(2).err;
    let error = refused("batch scenes/a/deep scenes/b");
    assert!(
        error.contains(
            "two scenes are named `hall`, scenes/a/deep/hall.toml and scenes/b/hall.toml; give"
        ),
        "{error}"
    );
    // Only a scene in another folder refers to it.
    let error = refused("batch scenes/robots");
    assert!(error.contains("robots/mine.toml: this is not a scene"), "{error}");
    let error = refused("batch scenes/robots --robot scenes/robots/mine.toml");
    assert!(error.contains("there is no scene (*.toml) in this folder and its"), "{error}");
    write(&folder, "scenes/b/broken.toml", &HALL.replace("version = 2", ""));
    let error = refused("batch scenes");
    assert!(error.contains("scenes/b/broken.toml: missing field `version`"), "{error}");
}

/// The folder of the project's scenes, and that of the complaints, which contains a robot.
#[test]
fn the_folders_of_the_project_are_batches() {
    let folder = folder();
    let root: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let scenes = root.canonicalize().unwrap();
    for (below, name) in [("", "complaints/beside_a_wall"), ("complaints", "beside_a_wall")] {
        let given = scenes.join(below);
        // All scenes are read, and the first one is driven.
        let out = format!("out-{below}");
        let line = format!("batch {} --shard 1/1000 --out {out}", given.display());
        keyway(folder.path(), &line).expect_code(0);
        assert_eq!(names(&folder, &out), [name]);
    }
}
