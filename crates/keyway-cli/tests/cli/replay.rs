//! Tests of `keyway batch --keep` and `keyway replay`.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

/// A route that is too long for its time limit.
const LATE: &str = "version = 2\nmap = \"../rooms.map\"\nstart = [1.5, 1.5]\ngoal = [30.5, 30.5]\n[rules]\ntime_limit_s = 3\n\
                    [disturbances.actuation]\nv_relative = 0.1\n";

/// A shorter one, in a generated hall.
const HALL: &str = "version = 2\nseed = 5\nstart = [0.7, 2.0]\ngoal = [5.3, 2.0]\n[world]\nwidth_m = 6\nheight_m = 4\n\
                    resolution_m = 0.05\n[world.obstacles.clutter]\nshare = 0.05\nradius_m = [0.1, 0.2]\n";

const BATCH: &str = "batch scenes --stacks keyway,astar-follow --seeds 2";

/// Records of the four runs that do not reach their goal.
const FAILED: [&str; 4] = [
    "late.astar-follow.0.json",
    "late.astar-follow.1.json",
    "late.keyway.0.json",
    "late.keyway.1.json",
];

fn scenes() -> TempDir {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    write(&folder, "scenes/hall.toml", HALL);
    write(&folder, "scenes/late.toml", LATE);
    folder
}

/// The files of a folder, with their content.
fn files(folder: &TempDir, of: &str) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder.path().join(of)).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names.into_iter().map(|name| (name.clone(), read(folder, &format!("{of}/{name}")))).collect()
}

fn names(files: &[(String, String)]) -> Vec<&str> {
    files.iter().map(|(name, _)| name.as_str()).collect()
}

#[test]
fn the_records_are_those_of_the_runs_that_failed_however_often_it_was_killed() {
    let folder = scenes();
    let batch = |rest: &str| keyway(folder.path(), &format!("{BATCH} {rest}")).expect_code(0);
    let report = batch("--keep failures --out one --jobs 1 --format json").json();
    assert_eq!(report["records"], 4);
    let one = files(&folder, "one/records");
    assert_eq!(names(&one), FAILED);
    // Killed after six runs of a batch without records, and after the first record of one with
    // records.
    batch("--out other");
    let rows = read(&folder, "other/runs.jsonl");
    let journal = rows.lines().map(|run| {
        let run: Value = run.parse().unwrap();
        json!({"run": run, "measured": {"wall_s": 4321.0, "mean_cycle_us": null}}).to_string()
            + "\n"
    });
    fs::create_dir_all(folder.path().join("killed/records")).unwrap();
    write(&folder, "killed/journal.jsonl", &journal.take(6).collect::<String>());
    write(&folder, &format!("killed/records/{}", FAILED[2]), &one[2].1);
    // A record that was kept of an earlier batch with another seed.
    write(&folder, "killed/records/late.astar-follow.7.json", &one[1].1);
    batch("--keep failures --out killed --jobs 2");
    assert_eq!(files(&folder, "killed/records"), one);
    assert_eq!(read(&folder, "killed/runs.jsonl"), rows);
    // Four runs that reached the goal, and the one with a record; the other one was repeated for
    // its record.
    assert_eq!(read(&folder, "killed/times.jsonl").matches("4321.0").count(), 5);
    // A batch without records removes none, unless they belong to something else.
    batch("--out killed");
    assert_eq!(files(&folder, "killed/records"), one);
    write(&folder, "scenes/late.toml", &LATE.replace("time_limit_s = 3", "time_limit_s = 2"));
    batch("--out killed");
    assert_eq!(files(&folder, "killed/records"), []);
    batch("--out killed --keep all");
    assert_eq!(files(&folder, "killed/records").len(), 8);
    write(&folder, &format!("killed/records/{}", FAILED[0]), "dear diary");
    let again = format!("{BATCH} --keep all --out killed --format json");
    let error = keyway(folder.path(), &again).expect_code(2).json();
    assert!(error["message"].as_str().unwrap().contains("not a record of a run"), "{error}");
    assert_eq!(read(&folder, &format!("killed/records/{}", FAILED[0])), "dear diary");
}

#[test]
fn a_replay_is_the_run_as_navigate_shows_it() {
    let folder = scenes();
    let run = |line: &str| keyway(folder.path(), line);
    run("batch scenes/late.toml --keep failures --out out").expect_code(0);
    // The scene itself is not needed.
    let scene = read(&folder, "scenes/late.toml");
    fs::remove_file(folder.path().join("scenes/late.toml")).unwrap();
    let record = "out/records/late.keyway.0.json";
    let options = "--fan 1 --explain why.jsonl --animate drive.gif";
    let line = format!("replay {record} --out again {options} --format json");
    let report = run(&line).expect_code(0).json();
    assert_eq!(
        (&report["schema"], &report["runs"][0]["record"]),
        (&json!("keyway.replay/1"), &json!(record))
    );
    let again = "again/late.keyway.0";
    assert_eq!(report["runs"][0]["report"]["files"][0], format!("{again}/report.json"));
    let replayed = files_as_bytes(&folder, again);
    let own = ["why.jsonl", "drive.gif"].map(|name| fs::read(folder.path().join(name)).unwrap());
    write(&folder, "scenes/late.toml", &scene);
    run(&format!("navigate --scene scenes/late.toml --out alone {options}")).expect_code(1);
    assert_eq!(replayed, files_as_bytes(&folder, "alone"));
    let alone = ["why.jsonl", "drive.gif"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(own == alone);
    let text = run(&format!("replay {record}")).expect_code(0).out;
    assert!(text.contains("run reproduced") && text.contains("timeout"), "{text}");
}

/// All files but the report, which contains measured times.
fn files_as_bytes(folder: &TempDir, of: &str) -> Vec<(String, Vec<u8>)> {
    let names = ["map.svg", "map.png", "speed.svg", "trajectory.csv", "fan.svg", "fan.png"];
    let bytes = |name: &str| fs::read(folder.path().join(of).join(name)).unwrap();
    names.into_iter().map(|name| (name.to_owned(), bytes(name))).collect()
}

#[test]
fn several_runs_have_a_folder_each() {
    let folder = scenes();
    keyway(folder.path(), &format!("{BATCH} --keep all --out out")).expect_code(0);
    let records: Vec<String> = files(&folder, "out/records")
        .iter()
        .map(|(name, _)| format!("out/records/{name}"))
        .collect();
    assert_eq!(records.len(), 8);
    let line = format!("replay {} --out again", records.join(" "));
    keyway(folder.path(), &line).expect_code(0);
    for record in &records {
        let name = record.trim_start_matches("out/records/").trim_end_matches(".json");
        assert!(folder.path().join("again").join(name).join("report.json").exists(), "{name}");
    }
    let error = keyway(folder.path(), &format!("{line} --animate a.gif --format json"));
    assert_eq!(error.expect_code(2).json()["field"], "--animate");
}

#[test]
fn what_is_no_longer_the_same_is_said() {
    let folder = scenes();
    keyway(folder.path(), "batch scenes/late.toml --keep all --out out").expect_code(0);
    let path = "out/records/late.keyway.0.json";
    let good = read(&folder, path);
    let message = |line: &str| {
        let error = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        assert_eq!(error["field"], "RECORD.json");
        error["message"].as_str().unwrap().to_owned()
    };
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut record: Value = good.parse().unwrap();
        change(&mut record);
        write(&folder, "changed.json", &record.to_string());
        message("replay changed.json --out no")
    };
    let text = changed(&|record| record["report"]["outcome"] = json!("reached"));
    assert!(text.contains("outcome was reached and is timeout now"), "{text}");
    assert!(!folder.path().join("no").exists());
    // The last digit of one number.
    let text = changed(&|record| {
        let x_m = &mut record["report"]["trajectory"][20][1];
        *x_m = json!(f64::from_bits(x_m.as_f64().unwrap().to_bits() + 1));
    });
    assert!(text.contains("row 20 of its trajectory was ["), "{text}");
    let text = changed(&|record| {
        record["report"]["inputs"]["version"] = json!("0.0.7");
        record["report"]["trajectory"].as_array_mut().unwrap().pop();
    });
    assert!(text.contains("its trajectory had 30 rows and has 31 now"), "{text}");
    assert!(text.contains("recorded by keyway 0.0.7 and replayed by keyway "), "{text}");
    // The program would drive differently: here because the robot is a different one.
    let text = changed(&|record| record["robot"]["limits"]["v_max_mps"] = json!(0.4));
    assert!(text.contains("of its trajectory was ["), "{text}");
    let text = changed(&|record| record["robot"]["cycle_s"] = json!(-1));
    assert!(text.contains("`robot.cycle_s` must be"), "{text}");
    let text = changed(&|record| drop(record.as_object_mut().unwrap().remove("config")));
    assert!(
        text.contains("it must contain `robot` and `config`, because the scene has one robot"),
        "{text}"
    );
    let text = changed(&|record| record["scene_file"]["goal"] = json!("there"));
    assert!(text.contains("this is not a record of a run"), "{text}");
    let text = changed(&|record| {
        let scene = record["scene_file"].as_object_mut().unwrap();
        let robot = json!({"start": scene.remove("start"), "goal": scene.remove("goal")});
        scene.insert("robots".to_owned(), json!([robot]));
    });
    // The scene has `[[robots]]`, although only one, and the record is that of a single robot.
    assert!(
        text.contains("it must contain `robots`, one for each robot of the scene (1), and"),
        "{text}"
    );
    let text = changed(&|record| record["schema"] = json!("keyway.record/2"));
    assert!(text.contains("\"keyway.record/2\"; this program replays keyway.record/1"), "{text}");
    assert!(message("replay scenes/late.toml").contains("not a record"));
    assert!(message("replay nowhere.json").contains("nowhere.json"));
    // Another map at the same path; the old one elsewhere.
    let map = read(&folder, "rooms.map");
    write(&folder, "rooms.map", &map.replacen('.', "@", 1));
    let text = message(&format!("replay {path}"));
    assert!(text.contains("rooms.map has changed since") && text.contains("--map-dir"), "{text}");
    fs::create_dir(folder.path().join("maps")).unwrap();
    write(&folder, "maps/rooms.map", &map);
    keyway(folder.path(), &format!("replay {path} --map-dir maps")).expect_code(0);
}
