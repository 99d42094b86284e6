//! Tests that `keyway navigate` explains and draws its decisions.

use crate::support::{expect_members, folder, keyway, read, write};
use serde_json::Value;
use tempfile::TempDir;

const SHORT: &str = "navigate small_house.yaml --start -8.175,-2.825 --goal -6,-2.6 --format json";

/// Discs around the start: they are 2 cm away from the robot, and the gap of 28 cm between two of
/// them is too narrow.
const BOXED_IN: &str = "navigate small_house.yaml --start -8.175,-2.825,0 --goal -6,-2.6 --format json \
    --time-limit 0.3 --explain why.jsonl --obstacle -7.875,-2.825,0.1 --obstacle -8.175,-2.525,0.1 \
    --obstacle -8.475,-2.825,0.1 --obstacle -8.175,-3.125,0.1";

fn lines(folder: &TempDir, name: &str) -> Vec<Value> {
    read(folder, name).lines().map(|line| line.parse().unwrap()).collect()
}

#[test]
fn a_line_for_every_cycle() {
    let folder = folder();
    let line = format!("{SHORT} --explain why.jsonl");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    assert_eq!(report["files"], serde_json::json!(["why.jsonl"]));
    let lines = lines(&folder, "why.jsonl");
    let rows: Vec<[f64; 6]> = serde_json::from_value(report["trajectory"].clone()).unwrap();
    // A row for the start and for the end of each cycle; the last line is the arrival.
    assert_eq!(lines.len(), rows.len());
    let text = read(&folder, "why.jsonl");
    assert!(!text.contains(":-0.0,") && !text.contains(":-0.0}"), "0 has no sign");
    expect_members(
        &lines[3],
        &[
            ("schema", |v| v == "keyway.cycle/1"),
            ("cycle", |v| v == 3),
            ("t_s", |v| v.as_f64().is_some_and(|t_s| (t_s - 0.3).abs() < 1e-9)),
            ("pose", |v| v.as_array().is_some_and(|pose| pose.len() == 3)),
            ("velocity", |v| v["v_mps"].is_f64() && v["omega_radps"].is_f64()),
            ("guide_m", |v| v.as_array().is_some_and(|point| point.len() == 2)),
            ("target_m", Value::is_null),
            ("remaining_m", Value::is_f64),
            ("movers", |v| v.as_array().is_some_and(Vec::is_empty)),
            ("walked", |v| v.as_array().is_some_and(Vec::is_empty)),
            ("step", |v| v == "drive"),
            ("reason", Value::is_null),
            ("command", Value::is_object),
            ("refusal", Value::is_null),
            ("candidates", Value::is_u64),
            ("driving", Value::is_u64),
            ("rejected", |v| v[0]["rule"] == "contact" && v[0]["count"].is_u64()),
            ("chosen", Value::is_object),
            ("runner_up", Value::is_object),
            ("remedies", |v| v.as_array().is_some_and(Vec::is_empty)),
        ],
    );
    let number = |value: &Value| value.as_f64().unwrap();
    let far = |line: &&Value| number(&line["remaining_m"]) > 0.5;
    let watched = lines.iter().take_while(far).count();
    assert!(watched > 20 && watched < lines.len());
    // Nearer to the goal the controller brakes, overriding the local planner.
    for (line, (before, after)) in lines[..watched].iter().zip(rows.iter().zip(&rows[1..])) {
        assert_eq!(line["pose"], serde_json::json!([before[1], before[2], before[3]]));
        assert_eq!(line["command"]["v_mps"], line["chosen"]["v_mps"]);
        assert_eq!(line["command"]["omega_radps"], line["chosen"]["omega_radps"]);
        // The motors follow the command.
        assert!((number(&line["command"]["v_mps"]) - after[4]).abs() < 1e-9);
        for best in [&line["chosen"], &line["runner_up"]] {
            let shares = best["shares"].as_array().unwrap();
            let sum: f64 = shares.iter().map(|share| number(&share["weighted"])).sum();
            assert!((sum - number(&best["score"])).abs() < 1e-12);
        }
        assert!(number(&line["chosen"]["score"]) >= number(&line["runner_up"]["score"]));
    }
}

#[test]
fn a_follower_has_nothing_to_choose_from() {
    let folder = folder();
    let line = format!("{SHORT} --set local.name=follower --explain why.jsonl --time-limit 0.5");
    keyway(folder.path(), &line).expect_code(1);
    let lines = lines(&folder, "why.jsonl");
    assert_eq!((lines.len(), &lines[0]["candidates"]), (5, &0.into()));
    assert_eq!((&lines[0]["step"], &lines[0]["chosen"]), (&"drive".into(), &Value::Null));
}

#[test]
fn what_would_free_a_robot_frees_it() {
    let folder = folder();
    keyway(folder.path(), BOXED_IN).expect_code(1);
    let first = lines(&folder, "why.jsonl").swap_remove(0);
    assert_eq!(first["driving"], 0, "{first}");
    let remedies = first["remedies"].as_array().unwrap();
    let of = |change: &str| remedies.iter().find(|one| one["change"] == change).unwrap();
    assert_eq!(of("wait")["frees"], false);
    assert_eq!(of("footprint")["frees"], true);
    let radius = 0.18 - of("footprint")["smaller_by_m"].as_f64().unwrap();
    let smaller = format!("{BOXED_IN} --radius {radius}");
    keyway(folder.path(), &smaller).expect_code(1);
    let first = lines(&folder, "why.jsonl").swap_remove(0);
    assert!(first["driving"].as_u64().unwrap() > 0, "{first}");
    assert_eq!(first["remedies"], serde_json::json!([]));
}

#[test]
fn the_fan_of_a_moment_is_drawn_beside_the_other_pictures() {
    let folder = folder();
    let drawn = keyway(folder.path(), &format!("{SHORT} --out run --fan 2")).expect_code(0).json();
    assert!(drawn["files"].as_array().unwrap().contains(&"run/fan.png".into()));
    assert!(std::fs::read(folder.path().join("run/fan.png")).unwrap().starts_with(b"\x89PNG"));
    let svg = read(&folder, "run/fan.svg");
    for text in [
        "2.0 s: ",
        "velocities tried",
        "admissible, by score",
        "chosen",
        "second best",
        "clearance",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    // A run that ends before has no such picture; an earlier one is removed, as it would seem to
    // belong to it.
    let late = keyway(folder.path(), &format!("{SHORT} --out run --fan 1000")).expect_code(0);
    assert!(
        late.err.contains("--fan 1000: no candidates were drawn, because the run ended after"),
        "{}",
        late.err
    );
    assert!(!folder.path().join("run/fan.svg").exists());
}

#[test]
fn a_drive_is_played() {
    let folder = folder();
    let line = format!("{SHORT} --out run --time-limit 2 --obstacle -7,-3.5,0.1");
    let answer = keyway(folder.path(), &format!("{line} --animate run/drive.gif"));
    let files = answer.expect_code(1).json()["files"].clone();
    assert_eq!(files.as_array().unwrap().last(), Some(&"run/drive.gif".into()));
    let gif = std::fs::read(folder.path().join("run/drive.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a"));
    keyway(folder.path(), &format!("{line} --animate drive.apng")).expect_code(1);
    let apng = std::fs::read(folder.path().join("drive.apng")).unwrap();
    let at = apng.windows(4).position(|name| name == b"acTL").unwrap();
    // 20 cycles, and the final state.
    assert_eq!(u32::from_be_bytes(apng[at + 4..at + 8].try_into().unwrap()), 21);
    assert!(gif.len() < 1_000_000 && apng.len() < 1_000_000);
}

#[test]
fn what_cannot_be_drawn_or_written_is_refused() {
    let folder = folder();
    write(&folder, "mine.toml", &read(&folder, "small_house.toml"));
    for (line, field) in [
        (format!("{SHORT} --fan 2"), "--out"),
        (format!("{SHORT} --out run --fan -1"), "--fan"),
        (format!("{SHORT} --animate drive.mp4"), "--animate"),
        (format!("{SHORT} --animate nowhere/drive.gif"), "--animate"),
        ("navigate --scene mine.toml --explain mine.toml --format json".to_owned(), "--explain"),
        (format!("{SHORT} --explain small_house.yaml"), "--explain"),
    ] {
        let error = keyway(folder.path(), &line).expect_code(2).json();
        assert_eq!(error["field"], field, "{error}");
    }
}

/// Around an unmapped disc `s4-guided` drives to a point behind it, equation (19) of
/// [ZhuYin2024], and not to the guide's point; without unknown obstacles, to its follower's
/// carrot.
#[test]
fn the_target_is_where_the_local_planner_drives() {
    let folder = folder();
    let hall = "version = 2\nstack = \"s4-guided\"\nstart = [1, 2, 0]\ngoal = [9, 2]\n\
        [world]\nwidth_m = 10\nheight_m = 4\nresolution_m = 0.1\n[rules]\ntime_limit_s = 10\n";
    write(&folder, "free.toml", hall);
    let disc = "[[unknown]]\nposition = [4.5, 2.05]\nradius_m = 0.3\n";
    write(&folder, "disc.toml", &format!("{hall}{disc}"));
    let targets = |scene: &str| -> Vec<[f64; 3]> {
        // The route is not replanned around the disc.
        let line = format!("navigate --scene {scene} --set controller.watch_route=false");
        keyway(folder.path(), &format!("{line} --explain why.jsonl")).expect_code(1);
        let lines = lines(&folder, "why.jsonl").into_iter();
        let asked = lines.filter(|line| !line["target_m"].is_null());
        let x = |point: &Value| point[0].as_f64().unwrap();
        asked.map(|line| [&line["pose"], &line["guide_m"], &line["target_m"]].map(x)).collect()
    };
    let free = targets("free.toml");
    assert!(free.len() > 50);
    for [robot, _, target] in free {
        assert!((0.0..0.7).contains(&(target - robot)), "{target} from {robot}");
    }
    // From the first detection of the disc until it is passed.
    let around = targets("disc.toml");
    let is_behind =
        |[robot, guide, target]: &&[f64; 3]| *robot < 4.1 && *target > 4.8 && target - guide > 0.3;
    assert!(around.iter().filter(is_behind).count() > 5, "{around:?}");
}
