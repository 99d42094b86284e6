//! Tests of parameters that name their planner or smoother, on the command line and in files: the
//! advice of an error can be pasted into the command that caused it.

use crate::batch::scenes;
use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};

/// A gap of one cell, which the distance of `hsta` closes.
const GAP: &str = "walled.map --pairs q.csv --planners";

/// The setting advised by a message.
fn advice(message: &str) -> String {
    let (_, setting) = message.split_once("add --set ").unwrap_or_else(|| panic!("{message}"));
    setting.split_whitespace().next().unwrap().to_owned()
}

#[test]
fn by_default_hsta_lowers_its_constraint_and_says_so() {
    let folder = folder();
    let line = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5 --planner hsta";
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
    assert_eq!(report["relaxed"], json!({"asked_m": 2.0, "used_m": 1.0}));
    let table = keyway(folder.path(), line).expect_code(0).out;
    let text = "lowered from 2.000 m to 1.000 m, the largest value with a path";
    assert!(table.contains(text), "{table}");
    let kept = format!("{line} --set hsta.l1_constraint=1 --format json");
    assert_eq!(keyway(folder.path(), &kept).expect_code(0).json()["relaxed"], Value::Null);
}

#[test]
fn what_is_advised_works_where_it_is_advised() {
    let folder = folder();
    write(&folder, "q.csv", "0.5,0.5,5.5,0.5\n");
    let fail = "--set hsta.if_no_path=fail";
    let plan = "plan walled.map --start 0.5,0.5 --goal 5.5,0.5 --planner hsta";
    let report =
        keyway(folder.path(), &format!("{plan} {fail} --format json")).expect_code(1).json();
    let setting = advice(report["why"].as_str().unwrap());
    assert_eq!(setting, "hsta.if_no_path=relax");
    keyway(folder.path(), &format!("{plan} --set {setting}")).expect_code(0);
    // A start beside the wall.
    let beside = plan.replace("0.5,0.5 ", "2.5,0.5 ");
    let error = keyway(folder.path(), &format!("{beside} {fail}")).expect_code(2).err;
    keyway(folder.path(), &format!("{beside} --set {}", advice(&error))).expect_code(0);
    // Several planners.
    let compare = format!("compare {GAP} jps,hsta,astar");
    let table = keyway(folder.path(), &format!("{compare} {fail}")).expect_code(0).out;
    let table = keyway(folder.path(), &format!("{compare} --set {}", advice(&table)));
    let table = table.expect_code(0).out;
    assert!(!table.contains("Not solved"), "{table}");
    let lowered = "walled.map: hsta in 1 of 1 queries, from 2.000 m to at least 1.000 m";
    assert!(table.contains(lowered), "{table}");
    for bench in ["bench grid rooms.map.scen --every 100", "bench scale walled.map --sides 20"] {
        let line = format!("{bench} --planner jps --planner hsta --set {setting}");
        keyway(folder.path(), &line).expect_code(0);
    }
    // The stack with this planner.
    let drive =
        "navigate walled.map --start 1.5,0.5 --goal 5.5,0.5 --set planner.name=hsta --time-limit 1";
    keyway(folder.path(), &format!("{drive} --set {setting}")).expect_code(1);
    let samples = format!(
        "{} --planner rrt --set rrt.samples=1 --format json",
        plan.replace(" --planner hsta", "")
    );
    let report = keyway(folder.path(), &samples).expect_code(1).json();
    assert_eq!(advice(report["why"].as_str().unwrap()), "rrt.samples=10");
}

#[test]
fn in_files() {
    let folder = folder();
    write(&folder, "q.csv", "0.5,0.5,5.5,0.5\n");
    write(&folder, "own.toml", "[hsta]\nif_no_path = \"fail\"\nl1_constraint = 3.0\n[taut]\n");
    let line =
        format!("compare {GAP} jps,hsta --smoothers none,taut --config own.toml --format json");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    assert_eq!(report["config"]["planners"][1]["l1_constraint"], 3.0);
    assert_eq!(
        report["rows"][2]["missed"].as_u64().or(report["rows"][2]["without_path"].as_u64()),
        Some(1)
    );
    // The command line takes precedence.
    let relaxed = format!("{line} --set hsta.if_no_path=relax");
    let report = keyway(folder.path(), &relaxed).expect_code(0).json();
    assert_eq!(report["config"]["planners"][1]["if_no_path"], "relax");
    let alone = "plan walled.map --start 0.5,0.5 --goal 5.5,0.5 --smoother taut --config own.toml";
    let lost = keyway(folder.path(), alone).expect_code(2).err;
    assert!(lost.contains("own.toml: hsta: hsta is not in use; the stack uses jps"), "{lost}");
    keyway(folder.path(), &format!("{alone} --planner hsta")).expect_code(2);
    write(&folder, "own.toml", "[hsta]\nl1 = 3.0\n");
    let wrong = keyway(folder.path(), &format!("{alone} --planner hsta")).expect_code(2).err;
    assert!(wrong.contains("own.toml: hsta: there is no field"), "{wrong}");
    write(&folder, "own.toml", "[hsta]\nname = \"jps\"\n");
    let wrong = keyway(folder.path(), &format!("{alone} --planner hsta")).expect_code(2).err;
    assert!(wrong.contains("the name of hsta cannot be set"), "{wrong}");
}

/// Values of the robot and of the stack, for all runs; and unknown ones.
#[test]
fn values_are_set_for_all_runs() {
    let folder = scenes();
    let batch = |rest: &str| keyway(folder.path(), &format!("batch scenes {rest}"));
    let speeds = |out: &str| -> Vec<f64> {
        let rows = read(&folder, &format!("{out}/runs.jsonl"));
        let row = |line: &str| serde_json::from_str::<Value>(line).unwrap();
        rows.lines().map(|line| row(line)["mean_speed_mps"].as_f64().unwrap()).collect()
    };
    batch("--out as-they-are").expect_code(0);
    batch("--out slow --set robot.limits.v_max_mps=0.2 --set controller.blocked_s=5")
        .expect_code(0);
    let (usual, slow) = (speeds("as-they-are"), speeds("slow"));
    assert!(usual.iter().all(|&mps| mps > 0.25) && slow.iter().all(|&mps| mps <= 0.2), "{slow:?}");
    for (value, text) in [
        ("robot.limits.v_max=1", "there is no field `limits.v_max`"),
        ("robot.limits.v_max_mps=-1", "v_max_mps"),
        ("controller.blocked_s=-1", "controller.blocked_s must be a positive number, got -1"),
        ("controller.block=1", "controller.block"),
    ] {
        let refused = batch(&format!("--out never --set {value} --format json")).expect_code(2);
        let error = refused.json();
        assert_eq!(error["field"], "--set", "{error}");
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(text), "{value}: {message}");
    }
}
