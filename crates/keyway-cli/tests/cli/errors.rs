//! Tests of bad input: exit code 2, and a helpful message.

use crate::support::{folder, keyway, read, write};
use serde_json::Value;
use std::fs;

const PLAN: &str = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5";

/// Checks exit code, message, kind and field in both formats.
#[track_caller]
fn refused(
    folder: &tempfile::TempDir,
    line: &str,
    parts: &[&str],
    kind: &str,
    field: Option<&str>,
) {
    let text = keyway(folder.path(), line).expect_code(2);
    assert!(text.out.is_empty() && text.err.starts_with("error: "), "{}{}", text.out, text.err);
    let json = keyway(folder.path(), &format!("{line} --format json")).expect_code(2);
    assert!(json.err.is_empty(), "{}", json.err);
    let report = json.json();
    let names: Vec<&String> = report.as_object().unwrap().keys().collect();
    assert_eq!(names, ["schema", "kind", "message", "field"]);
    assert_eq!(report["schema"], "keyway.error/1");
    assert_eq!(report["kind"], kind, "{report}");
    assert_eq!(report["field"].as_str(), field, "{report}");
    for part in parts {
        assert!(report["message"].as_str().unwrap().contains(part), "{part}: {report}");
        assert!(text.err.contains(part), "{part}: {}", text.err);
    }
}

#[test]
fn maps() {
    let folder = folder();
    let missing = "plan nowhere.map --start 1,1 --goal 2,2";
    refused(&folder, missing, &["nowhere.map"], "input", Some("MAP"));
    let strange = "plan walled.txt --start 1,1 --goal 2,2";
    refused(&folder, strange, &["walled.txt", ".yaml"], "input", Some("MAP"));
    write(&folder, "bad.map", "type octile\nheight 2\nwidth 3\nmap\n...\n.x\n");
    refused(&folder, "map info bad.map", &["bad.map: line 6"], "input", Some("MAP"));
    let placed = "map info small_house.yaml --resolution 2";
    refused(&folder, placed, &["YAML file already contains"], "input", Some("MAP"));
}

#[test]
fn arguments() {
    let folder = folder();
    let number = PLAN.replace("1.5,0.5", "1.5,abc");
    refused(&folder, &number, &["`abc` is not a number"], "usage", Some("--start"));
    refused(&folder, "plan walled.map --start 1,1", &["--goal"], "usage", Some("--goal"));
    refused(&folder, "fly", &["fly"], "usage", None);
    let picture = format!("{PLAN} --picture a.gif");
    refused(&folder, &picture, &[".svg or .png"], "usage", Some("--picture"));
    let early = "plan nowhere.map --start 1,1 --goal 2,2 --picture a.gif";
    refused(&folder, early, &[".svg or .png"], "usage", Some("--picture"));
    for name in ["a.png", "a.svg", "gif", "a.gif.mp4"] {
        let animation = format!("{PLAN} --animate {name}");
        refused(&folder, &animation, &[".gif or .apng"], "usage", Some("--animate"));
    }
    let curve = format!("{PLAN} --curve a.txt");
    refused(&folder, &curve, &[".csv or .json"], "usage", Some("--curve"));
    let twice = format!("{PLAN} --curve a.csv --curve b.csv");
    refused(&folder, &twice, &["multiple times"], "usage", Some("--curve"));
    for spacing in ["0", "-1", "nan", "inf", "x"] {
        let curve = format!("{PLAN} --curve a.csv --spacing {spacing}");
        let parts = ["a positive number of metres"];
        refused(&folder, &curve, &parts, "usage", Some("--spacing"));
    }
    let tiny = format!("{PLAN} --curve a.csv --spacing 1e-9");
    refused(&folder, &tiny, &["over a million samples"], "usage", Some("--spacing"));
    refused(&folder, &format!("{PLAN} --spacing 1"), &["--curve"], "usage", Some("--curve"));
    let robot = format!("{PLAN} --curve a.csv --robot hal");
    refused(&folder, &robot, &["small, jackal, paper"], "config", Some("--robot"));
    assert!(!folder.path().join("a.csv").exists());
    let half = format!("{} --cells", PLAN.replace("1.5,0.5", "1,0"));
    refused(&folder, &half, &["whole numbers, got 5.5"], "usage", Some("--goal"));
    let both = "navigate walled.map --scene small_house.toml";
    refused(&folder, both, &["--scene"], "usage", Some("[MAP]"));
    refused(&folder, &format!("{PLAN} --set corners"), &["PATH=VALUE"], "usage", Some("--set"));
    let limit = "navigate --scene small_house.toml --time-limit 0";
    refused(&folder, limit, &["positive"], "usage", Some("--time-limit"));
}

#[test]
fn outputs_without_a_folder_are_refused_before_the_search() {
    let folder = folder();
    for (flag, name) in [("--picture", "a.svg"), ("--animate", "a.gif"), ("--curve", "a.csv")] {
        let nowhere = format!("{PLAN} {flag} none/{name}");
        refused(&folder, &nowhere, &["the folder none does not exist"], "output", Some(flag));
        fs::create_dir(folder.path().join(name)).unwrap();
        refused(
            &folder,
            &format!("{PLAN} {flag} {name}"),
            &["it is a folder"],
            "output",
            Some(flag),
        );
    }
    // Neither of two outputs is written when one of them cannot be.
    let half = format!("{PLAN} --picture b.svg --animate none/b.gif");
    refused(&folder, &half, &["the folder none does not exist"], "output", Some("--animate"));
    assert!(!folder.path().join("b.svg").exists());
}

/// A preparation may have any file name.
#[test]
fn outputs_do_not_replace_what_is_read() {
    let folder = folder();
    keyway(folder.path(), "prepare walled.map --out p.csv").expect_code(0);
    let before = fs::read(folder.path().join("p.csv")).unwrap();
    let line = format!("{PLAN} --prepared p.csv --curve ./p.csv");
    refused(&folder, &line, &["input file", "choose another name"], "output", Some("--curve"));
    assert_eq!(fs::read(folder.path().join("p.csv")).unwrap(), before);
}

#[test]
fn parameters_of_planners_are_named_by_their_path() {
    let folder = folder();
    for (planner, setting) in [
        ("ratio-astar", "planner.x=0"),
        ("bidirectional-jps", "planner.a=-1"),
        ("rrt", "planner.goal_bias=2"),
        ("hsta", "planner.reference_cell_m=0"),
    ] {
        let (path, _) = setting.split_once('=').unwrap();
        let plan = format!("{PLAN} --planner {planner} --set {setting}");
        refused(&folder, &plan, &[&format!("{path} must be")], "config", Some(path));
    }
}

#[test]
fn names() {
    let folder = folder();
    let planner = format!("{PLAN} --planner teleport");
    refused(&folder, &planner, &["astar", "teleport"], "config", Some("--planner"));
    let smoother = format!("{PLAN} --smoother iron");
    let names = ["none, line-of-sight", "iron"];
    refused(&folder, &smoother, &names, "config", Some("--smoother"));
    let stack = "navigate --scene small_house.toml --stack hay";
    refused(&folder, stack, &["key-point-fusion", "hay"], "config", Some("--stack"));
    let robot = "navigate --scene small_house.toml --robot hal";
    refused(&folder, robot, &["small, jackal, paper", "hal"], "config", Some("--robot"));
    refused(&folder, "list nothing", &["astar", "dwa", "jackal"], "usage", Some("NAME"));
}

#[test]
fn parameters() {
    let folder = folder();
    let unknown = format!("{PLAN} --planner astar --set planner.corner=allow");
    let parts = ["no field `planner.corner`", "name, corners"];
    refused(&folder, &unknown, &parts, "config", Some("planner.corner"));
    let kind = format!("{PLAN} --set map.clearance_m=wide");
    let parts = ["`map.clearance_m`: invalid type", "expected a number", "wide"];
    refused(&folder, &kind, &parts, "config", Some("map.clearance_m"));
    let variant = format!("{PLAN} --planner astar --set planner.corners=maybe");
    let parts = ["`maybe`", "`forbid` or `allow`"];
    refused(&folder, &variant, &parts, "config", Some("planner.corners"));
    let range = format!("{PLAN} --radius -1");
    refused(&folder, &range, &["'-1'", "a length of at least 0"], "usage", Some("--radius"));
    for (command, part) in [
        (PLAN, "a radius of 1e308 m leaves no cell free"),
        ("prepare walled.map --out w", "a radius of 1e308 m leaves no cell free"),
        ("navigate --scene small_house.toml", "must be a length from 0 to 1000 m, got 1e308"),
    ] {
        let large = format!("{command} --radius 1e308");
        let parts = [part, "not in millimetres"];
        refused(&folder, &large, &parts, "config", Some("--radius"));
    }
    let local = "navigate --scene small_house.toml --set local.horizon_s=nan";
    refused(
        &folder,
        local,
        &["horizon_s must be a positive number"],
        "config",
        Some("local.horizon_s"),
    );

    write(&folder, "bad.toml", "[planner]\nname = \"astar\"\nspeed = 1\n");
    let file = format!("{PLAN} --config bad.toml");
    let parts = ["bad.toml", "`planner.speed`", "name, corners"];
    refused(&folder, &file, &parts, "config", Some("planner.speed"));
    write(&folder, "bad.toml", "[planner]\ncorners = \n");
    refused(&folder, &file, &["bad.toml: line 2"], "config", Some("--config"));
    let missing = format!("{PLAN} --config none.toml");
    refused(&folder, &missing, &["none.toml"], "input", Some("--config"));
}

#[test]
fn positions() {
    let folder = folder();
    let wall = PLAN.replace("1.5,0.5", "3.5,1.5");
    let parts = ["start (3.500, 1.500)", "inside an obstacle", "(2.500, 1.500)"];
    refused(&folder, &wall, &parts, "position", Some("--start"));
    let outside = PLAN.replace("5.5,0.5", "9,-3");
    let parts = ["goal (9.000, -3.000)", "outside the map", "(6.500, 0.500)"];
    refused(&folder, &outside, &parts, "position", Some("--goal"));
    let tight = format!("{PLAN} --radius 0.6");
    let parts = ["too little clearance for a radius of 0.6 m", "(1.500, 1.500)"];
    refused(&folder, &tight, &parts, "position", Some("--start"));
    let wall = format!("{wall} --radius 0.2");
    let parts = ["start (3.500, 1.500)", "inside an obstacle"];
    refused(&folder, &wall, &parts, "position", Some("--start"));
    let robot = "navigate walled.map --start 2.9,2 --goal 5.5,2.5";
    let parts = [
        "start (2.9, 2) has too little clearance for a radius of 0.18 m: an obstacle is 0.100 m away",
        "nearest position with enough clearance is (",
    ];
    refused(&folder, robot, &parts, "position", Some("--start"));
    let border = "navigate walled.map --start 1.5,2 --goal 6.875,2.5";
    let parts = ["goal (6.875, 2.5)", "0.18 m: the border of the map is 0.125 m away"];
    refused(&folder, border, &parts, "position", Some("--goal"));
    let outside = "navigate walled.map --start 1.5,2 --goal 7.5,2.5";
    refused(&folder, outside, &["it is outside the map"], "position", Some("--goal"));
}

/// Around the wall is a zone that is free but must not be planned to.
#[test]
fn positions_in_a_zone() {
    let folder = folder();
    let beside = "plan walled.map --start 0.5,0.5 --goal 2.5,0.5";
    let expanded = format!("{beside} --set map.published.expansion_cells=1");
    let parts = ["goal (2.500, 0.500)", "expanded zone", "expansion_cells is 1", "(1.500, 0.500)"];
    refused(&folder, &expanded, &parts, "position", Some("--goal"));
    let constrained = format!("{beside} --set map.published.l1_constraint=2");
    let parts = ["goal (2.500, 0.500)", "l1_constraint is 2", "map.free_ends_m"];
    refused(&folder, &constrained, &parts, "position", Some("--goal"));
    // A free disc around the goal helps, but not if the goal is in the wall.
    for zone in [&expanded, &constrained] {
        let freed = format!("{zone} --set map.free_ends_m=0.5 --format json");
        let report = keyway(folder.path(), &freed).expect_code(0).json();
        assert_eq!(report["length_m"], 2.0);
        let wall = freed.replace("2.5,0.5", "3.5,0.5").replace(" --format json", "");
        refused(&folder, &wall, &["inside an obstacle"], "position", Some("--goal"));
    }
    let several = format!("{expanded} --goal 2.5,2.5 --set map.free_ends_m=0.5 --format json");
    let report = keyway(folder.path(), &several).expect_code(0).json();
    assert!(report["goals"].as_array().unwrap().iter().all(|goal| goal["outcome"] == "found"));

    let robot = "navigate walled.map --start 1.5,2.5 --goal 5.5,2.5";
    let everywhere = format!("{robot} --set map.published.expansion_cells=3");
    let parts = ["start (1, 2)", "expanded zone", "no cell of this map is free"];
    refused(&folder, &everywhere, &parts, "position", Some("--start"));
    let freed = format!("{robot} --set map.free_ends_m=0.5");
    let parts = ["map.free_ends_m must be 0", "got 0.5"];
    refused(&folder, &freed, &parts, "config", Some("map.free_ends_m"));
}

#[test]
fn scenes() {
    let folder = folder();
    let scene = read(&folder, "small_house.toml");
    let line = "navigate --scene bad.toml";
    write(&folder, "bad.toml", &scene.replace("version = 1", "version = 3\nspace = 3"));
    refused(&folder, line, &["bad.toml", "`version` is 3"], "input", Some("--scene"));
    write(&folder, "bad.toml", &scene.replace("radius_m = 0.15", "radius_m = -0.15"));
    refused(&folder, line, &["unknown[0].radius_m", "-0.15"], "input", Some("--scene"));
    write(&folder, "bad.toml", &format!("sead = 1\n{scene}"));
    refused(&folder, line, &["line 1", "`sead`"], "input", Some("--scene"));
    write(&folder, "bad.toml", &format!("seed = 1\n{scene}"));
    refused(&folder, line, &["bad.toml: `seed`", "needs `version = 2`"], "input", Some("--scene"));
    write(&folder, "bad.toml", &scene.replace("small_house.yaml", "palace.yaml"));
    refused(&folder, line, &["palace.yaml"], "input", Some("MAP"));
}

#[test]
fn foreign_files_stay() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("run")).unwrap();
    write(&folder, "run/map.svg", "mine");
    write(&folder, "run/notes.txt", "mine, too");
    let line = "navigate --scene small_house.toml --out run";
    refused(&folder, line, &["run/map.svg is in the way"], "output", Some("--out"));
    assert_eq!(read(&folder, "run/map.svg"), "mine");
    assert_eq!(std::fs::read_dir(folder.path().join("run")).unwrap().count(), 2, "nothing written");
    write(&folder, "file", "mine");
    let file = "navigate --scene small_house.toml --out file";
    refused(&folder, file, &["file"], "output", Some("--out"));
}

/// An answer that could not be printed is not a success; a reader that closes the pipe early is
/// not a failure.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let run = |line: &str, out: Stdio| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_keyway"));
        command.args(line.split_whitespace()).current_dir(folder.path()).stderr(Stdio::piped());
        let output = command.stdout(out).spawn().unwrap().wait_with_output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for line in [
        PLAN,
        &format!("{PLAN} --format json"),
        "compare walled.map --queries 1",
        "compare walled.map --queries 1 --format json",
        "navigate --scene small_house.toml --time-limit 1",
        "prepare walled.map --out walled.prepared",
        "bench grid rooms.map.scen --every 100",
        "bench scale walled.map --sides 20 --planner jps",
        "map info walled.map",
        "list",
        "list dwa",
        "list dwa --format json",
        "completions bash",
        "plan --help",
        "--version",
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let (code, err) = run(line, full.into());
        assert_eq!(code, Some(2), "{line}: {err}");
        assert!(err.starts_with("error: cannot write to the standard output"), "{line}: {err}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let (code, err) = run(line, writer.into());
        assert!(code != Some(2) && err.is_empty(), "{line}: {code:?} {err}");
    }
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = folder();
    let version = keyway(folder.path(), "--version").expect_code(0);
    assert_eq!(version.out.trim(), format!("keyway {}", env!("CARGO_PKG_VERSION")));
    assert!(
        keyway(folder.path(), "plan --help --format json").expect_code(0).out.contains("Usage")
    );
    let bare = keyway(folder.path(), "").expect_code(2);
    assert!(bare.err.contains("Usage"), "{}", bare.err);
    let json = keyway(folder.path(), "plan --format json").expect_code(2);
    assert_eq!(json.out.parse::<Value>().unwrap()["kind"], "usage");
}
