//! Tests of `--stack`: a name or a file; replaced parts; stacks as published.

use crate::support::{folder, keyway, read, without_times, write};
use serde_json::{Value, json};

const SHORT: &str = "navigate small_house.yaml --start -8.175,-2.825 --goal -6,-2.6 --format json";
/// Cells of 1 m; reaching the goal does not matter.
const BEGUN: &str =
    "navigate rooms.map --cells --start 1,1 --goal 30,30 --time-limit 1 --format json";

fn config(report: &Value) -> &Value {
    &report["inputs"]["config"]
}

#[test]
fn what_list_prints_is_a_stack() {
    let folder = folder();
    let printed = keyway(folder.path(), "list s1-adaptive").expect_code(0).out;
    assert!(printed.starts_with("# s1-adaptive: "), "{printed}");
    assert!(printed.lines().all(|line| line.chars().count() <= 120), "{printed}");
    let above = printed.lines().take_while(|line| !line.starts_with("spacing_m = ")).last();
    assert!(
        above.is_some_and(|line| line.starts_with("# Spacing of the local goals")),
        "{above:?}"
    );
    write(&folder, "my.toml", &printed);
    let mut own = keyway(folder.path(), &format!("{SHORT} --stack my.toml")).expect_code(0).json();
    assert_eq!(own["inputs"]["stack"], "my.toml");
    own["inputs"]["stack"] = json!("s1-adaptive");
    let named = keyway(folder.path(), &format!("{SHORT} --stack s1-adaptive")).expect_code(0);
    assert_eq!(without_times(own), without_times(named.json()));
    // An ablation.
    write(&folder, "my.toml", &printed.replacen("spacing_m = ", "spacing_m = 1", 1));
    let ablation = keyway(folder.path(), &format!("{SHORT} --stack my.toml")).expect_code(0).json();
    assert_eq!(config(&ablation)["guide"]["spacing_m"], 11.05);
    let taken = keyway(folder.path(), &format!("{SHORT} --stack my.toml --explain my.toml"));
    assert!(taken.expect_code(2).json()["message"].as_str().unwrap().contains("is an input file"));
}

#[test]
fn what_list_prints_is_a_robot() {
    let folder = folder();
    for name in ["small", "jackal"] {
        let printed = keyway(folder.path(), &format!("list {name}")).expect_code(0).out;
        assert!(printed.starts_with(&format!("# {name}: ")), "{printed}");
        let above = printed.lines().take_while(|line| !line.starts_with("cycle_s = ")).last();
        assert!(above.is_some_and(|line| line.starts_with("# Control cycle")), "{above:?}");
        write(&folder, "my.toml", &printed);
        let own = keyway(folder.path(), &format!("{SHORT} --robot my.toml")).expect_code(0).json();
        let named = keyway(folder.path(), &format!("{SHORT} --robot {name}")).expect_code(0).json();
        assert_eq!(own["inputs"]["robot"], named["inputs"]["robot"]);
        assert_eq!(own["run"]["trajectory"], named["run"]["trajectory"]);
    }
}

#[test]
fn a_stack_file_that_is_wrong_is_named_with_the_line() {
    let folder = folder();
    let printed = keyway(folder.path(), "list dwa-to-goal").expect_code(0).out;
    let refused = |from: &str, to: &str| {
        write(&folder, "my.toml", &printed.replacen(from, to, 1));
        let line = printed.lines().position(|line| line.starts_with(from)).map(|line| line + 1);
        let error = keyway(folder.path(), &format!("{SHORT} --stack my.toml")).expect_code(2);
        (error.json(), line.unwrap())
    };
    let (far, line) = refused("horizon_s = ", "horizon_s = 'far' # ");
    let message = far["message"].as_str().unwrap();
    assert!(message.starts_with(&format!("my.toml: line {line}, column ")), "{message}");
    assert_eq!((&far["field"], &far["kind"]), (&json!("local.window.horizon_s"), &json!("config")));
    let (negative, _) = refused("horizon_s = ", "horizon_s = -");
    let message = negative["message"].as_str().unwrap();
    assert!(message.starts_with("my.toml: local.window.horizon_s must be"), "{message}");
    let none = keyway(folder.path(), &format!("{SHORT} --stack none.toml")).expect_code(2).json();
    assert_eq!((&none["field"], &none["kind"]), (&json!("--stack"), &json!("input")));
}

#[test]
fn a_part_is_swapped_by_its_name() {
    let folder = folder();
    let parts = "--planner theta-star --smoother none --guide carrot --local adaptive-dwa";
    let line = format!("{SHORT} --stack s0-key-point {parts} --set guide.look_ahead_m=0.7");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    let name = |part: &str| config(&report)[part]["name"].clone();
    let names = ["planner", "smoother", "guide", "local"].map(name);
    assert_eq!(names, ["theta-star", "none", "carrot", "adaptive-dwa"]);
    assert_eq!(config(&report)["guide"]["look_ahead_m"], 0.7);
    // Parameters are derived from the robot; a part that the stack already has keeps those of the
    // stack.
    assert_eq!(config(&report)["local"]["safe_radius_m"], 0.125);
    let same = format!("{BEGUN} --stack s4-ref20 --as-published --local dwa");
    let same = keyway(folder.path(), &same).expect_code(1).json();
    assert_eq!(config(&same)["local"]["weights"]["heading"], 0.15);
    let wrong = keyway(folder.path(), &format!("{SHORT} --guide hay")).expect_code(2).json();
    assert_eq!(wrong["field"], "--guide");
}

#[test]
fn as_published() {
    let folder = folder();
    let line =
        format!("{BEGUN} --stack s1-adaptive --as-published --planner astar --guide key-points");
    let report = keyway(folder.path(), &line).expect_code(1).json();
    assert_eq!(report["inputs"]["stack"], "s1-adaptive, as published");
    assert_eq!(report["inputs"]["robot"]["footprint"]["radius_m"], 0.0);
    assert_eq!(config(&report)["local"]["window"]["prediction"], "euler");
    assert_eq!(config(&report)["guide"]["reach_m"], 1.5, "swapped, and with its paper's value");
    let printed = keyway(folder.path(), "list s1-adaptive --as-published").expect_code(0).out;
    assert!(printed.contains("prediction = \"euler\""), "{printed}");
    keyway(folder.path(), &format!("{BEGUN} --stack s1-adaptive --as-published --robot paper"))
        .expect_code(1);
    for (line, field, part) in [
        (format!("{BEGUN} --as-published"), "--stack", "`keyway`"),
        (format!("{BEGUN} --stack my.toml --as-published"), "--stack", "`my.toml`"),
        (format!("{BEGUN} --stack s1-ref9 --as-published --robot small"), "--robot", "`paper`"),
        (
            format!("{BEGUN} --stack s1-ref9 --as-published --radius 1"),
            "--as-published",
            "--radius",
        ),
        ("list key-point-fusion --as-published --format json".to_owned(), "NAME", "s0-key-point"),
        ("list dwa --as-published --format json".to_owned(), "NAME", "`dwa`"),
    ] {
        let error = keyway(folder.path(), &line).expect_code(2).json();
        assert_eq!(error["field"], field, "{line}: {error}");
        assert!(error["message"].as_str().unwrap().contains(part), "{line}: {error}");
    }
}

#[test]
fn a_scene_has_a_stack_by_name_or_beside_it() {
    let folder = folder();
    let scene = |stack: &str| {
        let text = "version = 1\nmap = \"../small_house.yaml\"\nstart = [-8.175, -2.825]\ngoal = [-6, -2.6]\n";
        write(&folder, "inner/scene.toml", &format!("{text}stack = \"{stack}\"\n"));
        keyway(folder.path(), "navigate --scene inner/scene.toml --format json")
    };
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    let named = scene("s2-expanded").expect_code(0).json();
    assert_eq!(
        (&named["inputs"]["stack"], &config(&named)["map"]["published"]["expansion_cells"]),
        (&json!("s2-expanded"), &json!(1))
    );
    let printed = keyway(folder.path(), "list s2-expanded").expect_code(0).out;
    write(&folder, "inner/my.toml", &printed);
    let file = scene("my.toml").expect_code(0).json();
    assert_eq!(config(&file), config(&named));
    let error = scene("hay").expect_code(2).json();
    assert_eq!(error["field"], "--stack");
    assert!(read(&folder, "inner/scene.toml").contains("hay"));
}
