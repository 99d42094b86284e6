//! Tests of `keyway batch` and `keyway replay` on scenes with several robots.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Two robots side by side, with different obstacles for each seed; the second one has its own
/// stack.
const PAIR: &str = "version = 2\nseed = 3\n[world]\nwidth_m = 6\nheight_m = 5\nresolution_m = 0.05\n[rules]\nreference_time_s = 5\n\
    [random.unknown]\ncount = 2\nradius_m = [0.1, 0.15]\n\
    [[robots]]\nstart = [0.7, 1.2]\ngoal = [5.3, 1.2]\n\
    [[robots]]\nstart = [5.3, 3.8]\ngoal = [0.7, 3.8]\nstack = \"astar-follow\"\n";

/// One robot.
const HALL: &str = "version = 2\nstart = [0.7, 2.0]\ngoal = [3.3, 2.0]\n[world]\nwidth_m = 4\nheight_m = 4\nresolution_m = 0.05\n";

/// Files that must not depend on the number of repetitions and threads, nor on the parts.
const SAME: [&str; 6] =
    ["runs.jsonl", "runs.csv", "robots.jsonl", "robots.csv", "summary.csv", "summary.md"];

/// The scenes, and two of the project's scenes, in which two robots collide, or pass a door.
fn scenes() -> TempDir {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    write(&folder, "scenes/pair.toml", PAIR);
    write(&folder, "scenes/hall.toml", HALL);
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/fleet");
    for name in ["crossing.toml", "doorway.toml", "doorway.yaml", "doorway.pgm"] {
        fs::copy(from.join(name), folder.path().join("scenes").join(name)).unwrap();
    }
    folder
}

fn lines(folder: &TempDir, path: &str) -> Vec<Value> {
    read(folder, path).lines().map(|line| line.parse().unwrap()).collect()
}

fn results(folder: &TempDir, out: &str) -> Vec<String> {
    SAME.iter().map(|name| read(folder, &format!("{out}/{name}"))).collect()
}

fn numbers(rows: &[&Value], name: &str) -> Vec<f64> {
    rows.iter().filter_map(|row| row[name].as_f64()).collect()
}

#[test]
fn a_run_is_that_of_all_robots_and_each_has_a_row() {
    let folder = scenes();
    let line = "batch scenes --stacks key-point-fusion,s4-guided --out out --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let (runs, robots) = (lines(&folder, "out/runs.jsonl"), lines(&folder, "out/robots.jsonl"));
    assert_eq!((runs.len(), robots.len()), (8, 12));
    for run in &runs {
        let [scene, stack] = ["scene", "stack"].map(|name| run[name].as_str().unwrap());
        let own: Vec<&Value> = robots.iter().filter(|row| row["digest"] == run["digest"]).collect();
        // The same run on its own.
        let line = format!("navigate --scene scenes/{scene}.toml --stack {stack} --format json");
        let alone = keyway(folder.path(), &line).json();
        if scene == "hall" {
            assert_eq!((&run["robots"], own.len()), (&json!(1), 0));
            assert_eq!(run["time_s"], alone["run"]["time_s"]);
            assert_eq!(run["min_robot_clearance_m"], Value::Null);
            continue;
        }
        assert_eq!(run.get("robot"), None);
        assert_eq!((&run["robots"], own.len()), (&json!(2), 2), "{scene}");
        let mut reached = 0;
        for (index, row) in own.iter().enumerate() {
            let (robot, what) = (&alone["robots"][index], format!("{scene}, {stack}, {index}"));
            assert_eq!((&row["robot"], &row["robots"]), (&json!(index), &json!(1)), "{what}");
            assert_eq!((&row["stack"], &row["scene"]), (&json!(stack), &json!(scene)), "{what}");
            assert_eq!(row["outcome"], robot["outcome"], "{what}");
            for name in ["time_s", "length_m", "min_clearance_m", "routes_planned"] {
                assert_eq!(row[name], robot["run"][name], "{what}: {name}");
            }
            reached += u32::from(robot["outcome"] == "reached");
        }
        assert_eq!(run["robots_reached"], json!(reached), "{scene}");
        assert_eq!(run["outcome"] == "reached", reached == 2, "{scene}");
        assert_eq!(run["min_robot_clearance_m"], alone["min_robot_clearance_m"], "{scene}");
        let last_s = numbers(&own, "time_s").into_iter().fold(0.0, f64::max);
        assert_eq!(run["time_s"], json!(last_s), "{scene}");
        let driven_m: f64 = numbers(&own, "length_m").iter().sum();
        assert_eq!(run["length_m"], json!(driven_m), "{scene}");
        if reached == 2 {
            assert_eq!(run["time_s"], alone["makespan_s"], "{scene}");
        }
    }
    let of = |scene: &str, stack: &str| {
        runs.iter().find(|run| run["scene"] == scene && run["stack"] == stack).unwrap()
    };
    let crossing = of("crossing", "s4-guided");
    assert_eq!(
        (&crossing["outcome"], &crossing["contact"]),
        (&json!("collided"), &json!("driving"))
    );
    assert!(crossing["reason"].as_str().unwrap().starts_with("robot "), "{crossing}");
    let pair = of("pair", "key-point-fusion");
    let score = 5.0 / pair["time_s"].as_f64().unwrap().clamp(10.0, 40.0);
    assert_eq!((&pair["score"], &pair["left_out"]), (&json!(score), &json!(0)));
    // In the summary a run of several robots is one run.
    let fusion = &report["stacks"][0];
    let reached =
        runs.iter().filter(|run| run["stack"] == fusion["stack"] && run["outcome"] == "reached");
    assert_eq!((&fusion["runs"], &fusion["reached"]), (&json!(4), &json!(reached.count())));
    assert_eq!(fusion["robots"], json!(7));
    let csv = read(&folder, "out/robots.csv");
    assert!(csv.starts_with("scene,stack,seed,robot,") && csv.lines().count() == 13, "{csv}");
    assert!(!read(&folder, "out/runs.csv").lines().next().unwrap().contains(",robot,"));
    assert!(read(&folder, "out/summary.md").contains("| robots |"));
    // Without several robots there are no such files.
    keyway(folder.path(), "batch scenes/hall.toml --out single").expect_code(0);
    assert!(!folder.path().join("single/robots.csv").exists());
    assert!(!read(&folder, "single/summary.md").contains("| robots |"));
}

#[test]
fn stacks_and_robots_that_are_named_are_those_of_all_robots() {
    let folder = scenes();
    let run = |rest: &str| -> (Value, Vec<Value>) {
        // A folder keeps the runs of its batch.
        let _ = fs::remove_dir_all(folder.path().join("out"));
        keyway(folder.path(), &format!("batch scenes/pair.toml --out out {rest}")).expect_code(0);
        let stack = |row: &Value| row["stack"].clone();
        let robots = lines(&folder, "out/robots.jsonl").iter().map(stack).collect();
        (stack(&lines(&folder, "out/runs.jsonl")[0]), robots)
    };
    let (own, each) = run("");
    assert_eq!(own, "keyway+astar-follow");
    assert_eq!(each, ["keyway", "astar-follow"]);
    let (named, each) = run("--stacks rrt-follow");
    assert_eq!(named, "rrt-follow");
    assert_eq!(each, ["rrt-follow"; 2]);
    let slow = keyway(folder.path(), "list small").expect_code(0).out;
    write(&folder, "slow.toml", &slow.replace("v_max_mps = 0.5", "v_max_mps = 0.2"));
    run("--robot slow.toml");
    for row in lines(&folder, "out/robots.jsonl") {
        assert!(row["mean_speed_mps"].as_f64().unwrap() <= 0.2, "{row}");
    }
}

#[test]
fn killed_or_in_parts_it_is_the_same() {
    let folder = scenes();
    let run = |rest: &str| {
        let line = format!("batch scenes --seeds 2 --keep all {rest}");
        keyway(folder.path(), &line).expect_code(0)
    };
    run("--out whole --jobs 1");
    let whole = results(&folder, "whole");
    run("--out three --jobs 3");
    assert_eq!(results(&folder, "three"), whole);
    // A batch that was killed while writing its fifth run, the third one with several robots.
    let robots = lines(&folder, "whole/robots.jsonl");
    let journal = lines(&folder, "whole/runs.jsonl").into_iter().map(|run| {
        let own = robots.iter().filter(|row| row["digest"] == run["digest"]);
        let measured = json!({"wall_s": 4321.0, "mean_cycle_us": null});
        let own: Vec<&Value> = own.collect();
        json!({"run": run, "robots": own, "measured": measured}).to_string()
    });
    let journal: Vec<String> = journal.collect();
    fs::create_dir(folder.path().join("torn")).unwrap();
    fs::rename(folder.path().join("three/records"), folder.path().join("torn/records")).unwrap();
    let torn = journal[..4].join("\n") + "\n" + &journal[4][..200];
    write(&folder, "torn/journal.jsonl", &torn);
    run("--out torn");
    assert_eq!(results(&folder, "torn"), whole);
    let again = || read(&folder, "torn/times.jsonl").matches("4321.0").count();
    assert_eq!(again(), 4);
    // Runs known from the results are not driven again, either.
    run("--out torn --jobs 1");
    assert_eq!((results(&folder, "torn"), again()), (whole.clone(), 4));
    // They are if the rows of their robots are lost: three scenes with several robots, of which
    // two seeds were in the journal.
    fs::remove_file(folder.path().join("torn/robots.jsonl")).unwrap();
    run("--out torn");
    assert_eq!(results(&folder, "torn"), whole);
    assert!(again() < 4);
    for i in 1..=2 {
        run(&format!("--shard {i}/2 --out part-{i}"));
    }
    keyway(folder.path(), "batch merge part-1 part-2 --out merged").expect_code(0);
    assert_eq!(results(&folder, "merged"), whole);
    let name = "records/pair.keyway%2Bastar-follow.4.json";
    let [one, other] = ["whole", "merged"].map(|out| read(&folder, &format!("{out}/{name}")));
    assert!(one == other);
    write(&folder, "part-2/robots.jsonl", "");
    let refused = keyway(folder.path(), "batch merge part-1 part-2 --out no").expect_code(2).err;
    assert!(refused.contains("robots.jsonl have no entries for this run"), "{refused}");
}

#[test]
fn a_record_of_several_robots_is_replayed() {
    let folder = scenes();
    let line =
        "batch scenes/pair.toml scenes/crossing.toml --stacks s4-guided --keep failures --out out";
    keyway(folder.path(), line).expect_code(0);
    let path = "out/records/crossing.s4-guided.0.json";
    assert_eq!(fs::read_dir(folder.path().join("out/records")).unwrap().count(), 1);
    let line = format!("replay {path} --out shown --animate drive.gif");
    let shown = keyway(folder.path(), &line).expect_code(0).out;
    for text in [
        "run reproduced",
        "reached                   0 of 2",
        "wrote shown/crossing.s4-guided.0/map.svg",
    ] {
        assert!(shown.contains(text), "{shown}");
    }
    let map = "shown/crossing.s4-guided.0/map.svg";
    assert!(
        read(&folder, map).contains("robot 1, s4-guided")
            && folder.path().join("drive.gif").exists()
    );
    let report =
        keyway(folder.path(), &format!("replay {path} --format json")).expect_code(0).json();
    assert_eq!(report["runs"][0]["report"]["schema"], "keyway.team/1");
    assert_eq!(report["runs"][0]["report"]["outcomes"], json!(["collided", "collided"]));
    let record: Value = read(&folder, path).parse().unwrap();
    assert_eq!((record.get("robot"), record.get("config")), (None, None));
    assert_eq!(record["scene_file"]["robots"][1]["stack"], "s4-guided");
    let refused = |change: &dyn Fn(&mut Value), rest: &str| {
        let mut other = record.clone();
        change(&mut other);
        write(&folder, "other.json", &serde_json::to_string_pretty(&other).unwrap());
        keyway(folder.path(), &format!("replay other.json {rest}")).expect_code(2).err
    };
    let text = refused(&|it| it["report"]["robots"][1]["trajectory"][9][1] = json!(0), "");
    assert!(
        text.contains("run differs from the record: robot 1: row 9 of its trajectory was ["),
        "{text}"
    );
    let text = refused(&|it| it["robots"][1]["robot"]["cycle_s"] = json!(-1), "");
    assert!(text.contains("`robots[1].robot.cycle_s` must be"), "{text}");
    for change in [
        &(|it: &mut Value| drop(it["robots"].as_array_mut().unwrap().pop())) as &dyn Fn(&mut Value),
        &|it| it["robot"] = it["robots"][0]["robot"].clone(),
    ] {
        let text = refused(change, "");
        assert!(
            text.contains("it must contain `robots`, one for each robot of the scene (2), and"),
            "{text}"
        );
    }
    let text = refused(&|_| (), "--fan 1 --out out2");
    assert!(text.contains("--fan shows the decisions of a single robot"), "{text}");
    // A scene with a single `[[robots]]` table.
    let (one, _) = PAIR.rsplit_once("[[robots]]").unwrap();
    write(&folder, "one.toml", one);
    keyway(folder.path(), "batch one.toml --keep all --out one").expect_code(0);
    assert!(!folder.path().join("one/robots.jsonl").exists());
    let line = "replay one/records/one.keyway.3.json --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    assert_eq!(report["runs"][0]["report"]["schema"], "keyway.team/1");
}
