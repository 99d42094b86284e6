//! `keyway batch` and `keyway scene`.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A generated hall of 6 m x 4 m, with more to come from other seeds.
const HALL: &str = "version = 2\nseed = 5\nstart = [0.7, 2.0]\ngoal = [5.3, 2.0]\n[world]\nwidth_m = 6\nheight_m = 4\n\
                    resolution_m = 0.05\n[world.obstacles.clutter]\nshare = 0.05\nradius_m = [0.1, 0.2]\n\
                    [rules]\nreference_time_s = 10\n";

/// Two scenes, with two stacks and two seeds: eight runs.
const BATCH: &str = "batch scenes --stacks key-point-fusion,astar-follow --seeds 2";

/// All that must not depend on how often, where and on how many threads it was made.
const SAME: [&str; 4] = ["runs.jsonl", "runs.csv", "summary.csv", "summary.md"];

fn scenes() -> TempDir {
    let folder = folder();
    std::fs::create_dir(folder.path().join("scenes")).unwrap();
    write(&folder, "scenes/hall.toml", HALL);
    write(&folder, "scenes/more.toml", &HALL.replace("seed = 5", "seed = 9"));
    folder
}

fn results(folder: &TempDir, out: &str) -> Vec<String> {
    SAME.iter().map(|name| read(folder, &format!("{out}/{name}"))).collect()
}

#[test]
fn the_results_are_the_same_on_any_number_of_threads_and_in_parts() {
    let folder = scenes();
    let batch = |rest: &str| keyway(folder.path(), &format!("{BATCH} {rest}")).expect_code(0);
    let report = batch("--out one --jobs 1 --format json").json();
    assert_eq!((&report["schema"], &report["runs"]), (&json!("keyway.batch/1"), &json!(8)));
    assert_eq!(report["stacks"][0]["stack"], "key-point-fusion");
    assert_eq!(report["stacks"][0]["runs"], 4);
    batch("--out three --jobs 3");
    assert_eq!(results(&folder, "one"), results(&folder, "three"));
    batch("--out a --shard 1/2");
    batch("--out b --shard 2/2");
    assert_eq!(read(&folder, "a/runs.jsonl").lines().count(), 4);
    batch("--out whole --from a,b");
    assert_eq!(results(&folder, "one"), results(&folder, "whole"));
    // What was measured was taken over, too: nothing was driven again.
    let times: String = ["a", "b"].map(|out| read(&folder, &format!("{out}/times.jsonl"))).concat();
    let whole = read(&folder, "whole/times.jsonl");
    assert!(whole.lines().all(|line| times.contains(line)), "{whole}\n{times}");
}

#[test]
fn each_run_says_what_it_was() {
    let folder = scenes();
    keyway(folder.path(), &format!("{BATCH} --out out")).expect_code(0);
    let rows: Vec<Value> =
        read(&folder, "out/runs.jsonl").lines().map(|line| line.parse().unwrap()).collect();
    let keys = |row: &Value| (row["scene"].clone(), row["stack"].clone(), row["seed"].clone());
    let expected = ["hall", "more"].into_iter().zip([5, 9]).flat_map(|(scene, seed)| {
        ["key-point-fusion", "astar-follow"].into_iter().flat_map(move |stack| {
            [seed, seed + 1].map(|seed| (json!(scene), json!(stack), json!(seed)))
        })
    });
    assert_eq!(rows.iter().map(keys).collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    let first = &rows[0];
    assert_eq!((&first["outcome"], &first["reference_time_s"]), (&json!("reached"), &json!(10.0)));
    let (time_s, score) = (first["time_s"].as_f64().unwrap(), first["score"].as_f64().unwrap());
    assert!((score - 10.0 / time_s.clamp(20.0, 80.0)).abs() < 1e-12, "{first}");
    // The same run by itself.
    let alone = keyway(folder.path(), "navigate --scene scenes/hall.toml --format json");
    let alone = alone.expect_code(0).json();
    for member in ["time_s", "length_m", "min_clearance_m"] {
        assert_eq!(alone["run"][member], first[member], "{member}");
    }
}

#[test]
fn nothing_finished_is_lost_or_made_again() {
    let folder = scenes();
    let batch = |out: &str| keyway(folder.path(), &format!("{BATCH} --out {out}")).expect_code(0);
    batch("whole");
    let whole = results(&folder, "whole");
    // A batch that was killed while it wrote its sixth run down.
    let journal: Vec<String> = read(&folder, "whole/runs.jsonl")
        .lines()
        .map(|line| {
            let run: Value = line.parse().unwrap();
            json!({"run": run, "measured": {"wall_s": 4321.0, "mean_cycle_us": null}}).to_string()
        })
        .collect();
    std::fs::create_dir(folder.path().join("torn")).unwrap();
    let torn = journal[..5].join("\n") + "\n" + &journal[5][..50];
    write(&folder, "torn/journal.jsonl", &torn);
    batch("torn");
    assert_eq!(results(&folder, "torn"), whole);
    let times = read(&folder, "torn/times.jsonl");
    assert_eq!(times.matches("4321.0").count(), 5, "{times}");
    assert!(!folder.path().join("torn/journal.jsonl").exists());
    // A scene that has changed is driven again; the others are not.
    write(&folder, "scenes/more.toml", &HALL.replace("seed = 5", "seed = 11"));
    batch("torn");
    assert_eq!(read(&folder, "torn/times.jsonl").matches("4321.0").count(), 4);
    assert_ne!(results(&folder, "torn"), whole);
}

/// The same worlds with another robot and under other conditions, and each run by itself.
#[test]
fn robot_and_disturbances_are_those_that_are_given() {
    let folder = scenes();
    let robot = keyway(folder.path(), "list small").expect_code(0).out;
    let late = robot.replace("actuation_delay_s = 0.0", "actuation_delay_s = 0.3");
    assert_ne!(late, robot);
    write(&folder, "late.toml", &late);
    write(&folder, "noise.toml", "[actuation]\nv_relative = 0.05\nomega_relative = 0.05\n");
    let rows = |out: &str, rest: &str| -> Vec<Value> {
        keyway(folder.path(), &format!("batch scenes/hall.toml --out {out} {rest}")).expect_code(0);
        read(&folder, &format!("{out}/runs.jsonl"))
            .lines()
            .map(|line| line.parse().unwrap())
            .collect()
    };
    let ideal = rows("ideal", "");
    let options = "--robot late.toml --disturbances noise.toml";
    let noisy = rows("noisy", &format!("{options} --seeds 2"));
    assert_ne!(ideal[0]["digest"], noisy[0]["digest"]);
    assert_ne!(ideal[0]["length_m"], noisy[0]["length_m"]);
    for (row, seed) in noisy.iter().zip([5, 6]) {
        let alone =
            format!("navigate --scene scenes/hall.toml {options} --seed {seed} --format json");
        let report = keyway(folder.path(), &alone).expect_code(0).json();
        assert_eq!((&report["run"]["length_m"], &json!(seed)), (&row["length_m"], &row["seed"]));
        assert_eq!(report["inputs"]["disturbances"]["seed"], json!(seed));
        assert_eq!(report["inputs"]["disturbances"]["actuation"]["v_relative"], json!(0.05));
        assert_eq!(report["inputs"]["robot"]["actuation_delay_s"], json!(0.3));
    }
    assert_ne!(noisy[0]["length_m"], noisy[1]["length_m"]);
    write(&folder, "wrong.toml", "[actuation]\nv_relative = 5\n");
    for command in ["batch scenes/hall.toml --out wrong", "navigate --scene scenes/hall.toml"] {
        let wrong =
            keyway(folder.path(), &format!("{command} --disturbances wrong.toml --format json"));
        let error = wrong.expect_code(2).json();
        assert_eq!(error["field"], "actuation.v_relative", "{error}");
    }
}

#[test]
fn a_stack_file_lies_beside_the_scene_that_names_it() {
    let folder = scenes();
    let printed = keyway(folder.path(), "list astar-follow").expect_code(0).out;
    write(&folder, "scenes/mine.stack", &printed);
    write(&folder, "scenes/hall.toml", &format!("stack = \"./mine.stack\"\n{HALL}"));
    keyway(folder.path(), "batch scenes/hall.toml --out out").expect_code(0);
    let other = "batch scenes/hall.toml --stacks scenes/mine.stack --out other";
    keyway(folder.path(), other).expect_code(0);
    let row = |out: &str| read(&folder, &format!("{out}/runs.jsonl")).parse::<Value>().unwrap();
    let (own, named) = (row("out"), row("other"));
    assert_eq!(
        (&own["stack"], &named["stack"]),
        (&json!("./mine.stack"), &json!("scenes/mine.stack"))
    );
    assert_eq!(own["time_s"], named["time_s"]);
}

#[test]
fn killed_at_any_moment_it_goes_on() {
    let folder = scenes();
    let line = format!("{BATCH} --seeds 6 --jobs 2");
    let line = line.replace("--seeds 2 ", "");
    keyway(folder.path(), &format!("{line} --out whole")).expect_code(0);
    for kill_at in [1, 7] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_keyway"))
            .args(line.split_whitespace().chain(["--out", "killed"]))
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let journal = folder.path().join("killed/journal.jsonl");
        let finished = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
        while finished() < kill_at && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    keyway(folder.path(), &format!("{line} --out killed")).expect_code(0);
    assert_eq!(results(&folder, "killed"), results(&folder, "whole"));
}

#[test]
fn what_cannot_be_driven_is_refused_before_anything_is() {
    let folder = scenes();
    let refused = |line: &str| {
        let error = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        assert!(!folder.path().join("out").exists(), "{line}");
        (error["field"].clone(), error["message"].as_str().unwrap().to_owned())
    };
    let (field, message) = refused("batch scenes nowhere.toml --out out");
    assert!(field == "SCENE.toml" && message.contains("nowhere.toml"), "{message}");
    let (_, message) = refused("batch scenes scenes/hall.toml --out out");
    assert!(message.contains("two scenes are named `hall`"), "{message}");
    let (_, message) = refused("batch scenes --stacks rrt-follow,rrt-follow --out out");
    assert!(message.contains("`rrt-follow` is given twice"), "{message}");
    let (field, message) = refused("batch scenes --stacks tea --out out");
    assert_eq!(field, "--stacks");
    assert!(message.contains("there is no stack `tea`"), "{message}");
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let (_, message) = refused("batch empty --out out");
    assert!(message.contains("there is no scene (*.toml)"), "{message}");
    let (field, _) = refused("batch scenes --shard 3/2 --out out");
    assert_eq!(field, "--shard");
    // Somebody's own file.
    write(&folder, "journal.jsonl", "dear diary\n");
    let error = keyway(folder.path(), "batch scenes --out . --format json").expect_code(2).json();
    assert!(error["message"].as_str().unwrap().contains("not the journal of a batch"), "{error}");
    assert_eq!(read(&folder, "journal.jsonl"), "dear diary\n");
    write(&folder, "journal.jsonl", "dear diary, without an end of the line");
    keyway(folder.path(), "batch scenes --out .").expect_code(2);
    assert!(read(&folder, "journal.jsonl").ends_with("end of the line"));
}

#[test]
fn worlds_of_barn_become_scenes() {
    let folder = folder();
    write(&folder, "c.csv", "world,x,y,radius\n7,-2.0,8.0,0.075\n7,-2.5,9.0,0.1\n3,0,5,0.075\n");
    write(&folder, "s.csv", "world,cylinders,optimal_time_s\n7,2,5.5\n");
    let line = "scene barn c.csv --summary s.csv --out barn --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let files = json!(["barn/world_003.toml", "barn/world_007.toml"]);
    assert_eq!((&report["schema"], &report["files"]), (&json!("keyway.scene/1"), &files));
    let run = keyway(folder.path(), "navigate --scene barn/world_007.toml --format json");
    let run = run.expect_code(0).json();
    assert_eq!(run["inputs"]["obstacles"], json!([[-2.0, 8.0, 0.075], [-2.5, 9.0, 0.1]]));
    assert_eq!(run["inputs"]["start"], json!([-2.25, 3.0, 90.0]));
    assert_eq!(run["inputs"]["arrival"], "passing");
    // 9 m from the rim of the goal, which is passed at speed.
    assert!(run["run"]["time_s"].as_f64().unwrap() < 6.5, "{}", run["run"]);
    let batch = keyway(folder.path(), "batch barn --out out --format json").expect_code(0).json();
    assert_eq!((&batch["runs"], &batch["stacks"][0]["mean_score"]), (&json!(2), &json!(0.5)));
    write(&folder, "c.csv", "world,x,y\n7,-2.0,8.0\n");
    let error = keyway(folder.path(), line).expect_code(2).json();
    let message = error["message"].as_str().unwrap();
    assert!(message.starts_with("c.csv: line 2: missing field `radius`"), "{message}");
}
