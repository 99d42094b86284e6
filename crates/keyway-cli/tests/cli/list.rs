//! Tests of `keyway list` and `keyway completions`.

use crate::support::{expect_members, folder, keyway, write};
use serde_json::{Value, json};

#[test]
fn everything_has_a_kind_and_a_summary() {
    let report = keyway(folder().path(), "list --format json").expect_code(0).json();
    assert_eq!(report["schema"], "keyway.list/1");
    let entries = report["entries"].as_array().unwrap();
    for (kind, name) in [
        ("planner", "astar"),
        ("smoother", "line-of-sight"),
        ("local_planner", "dwa"),
        ("stack", "key-point-fusion"),
        ("robot", "small"),
    ] {
        assert!(entries.iter().any(|e| e["kind"] == kind && e["name"] == name), "{name}");
    }
    assert!(entries.iter().all(|e| e["summary"].as_str().is_some_and(|s| !s.is_empty())));
    assert!(entries.iter().all(|e| e["parameters"].is_null()));
    let table = keyway(folder().path(), "list").expect_code(0).out;
    assert!(table.contains("astar") && table.contains("jackal"), "{table}");
    assert!(table.lines().all(|line| line.chars().count() <= 120), "{table}");
    let header: Vec<&str> =
        table.lines().next().unwrap().split("  ").filter(|n| !n.is_empty()).collect();
    assert_eq!(
        header.iter().map(|name| name.trim()).collect::<Vec<_>>(),
        ["kind", "name", "description"]
    );
    let one = keyway(folder().path(), "list density-astar").expect_code(0).out;
    assert!(one.lines().all(|line| line.chars().count() <= 120), "{one}");
}

#[test]
fn parameters_have_units_defaults_and_papers() {
    let parameter = |line: &str, path: &str| {
        let report = keyway(folder().path(), line).expect_code(0).json();
        let parameters = report["entries"][0]["parameters"].as_array().unwrap().clone();
        parameters.into_iter().find(|p| p["path"] == path).unwrap()
    };
    let horizon = parameter("list dwa --format json", "local.window.horizon_s");
    expect_members(
        &horizon,
        &[
            ("path", Value::is_string),
            ("unit", |v| v == "s"),
            ("default", |v| v == 1.1),
            ("paper", |v| v == 3.0),
            ("choices", Value::is_null),
            ("description", |v| v.as_str().is_some_and(|text| text.contains("horizon"))),
        ],
    );
    let jackal =
        parameter("list key-point-fusion --robot jackal --format json", "local.window.horizon_s");
    assert_ne!(jackal["default"], horizon["default"]);
    let corners = parameter("list astar --format json", "planner.corners");
    assert_eq!(corners["choices"], json!(["forbid", "allow"]));
    assert_eq!((&corners["default"], &corners["paper"]), (&json!("forbid"), &Value::Null));
    let weight = parameter("list bidirectional-jps --format json", "planner.a");
    assert_eq!((&weight["default"], &weight["paper"]), (&json!(3.0), &json!(3.0)));
    // A parameter that the paper does not state has no value of the paper.
    let paper = |name: &str, path: &str| {
        parameter(&format!("list {name} --format json"), path)["paper"].clone()
    };
    assert_eq!(paper("key-points", "smoother.safe_distance_m"), 0.5);
    assert_eq!(paper("key-points", "smoother.candidates"), "jump-points");
    assert_eq!(paper("shortcut", "smoother.passes"), 2);
    assert_eq!(paper("hsta", "planner.l1_constraint"), 2.0);
    assert_eq!(paper("key-point-dwa", "local.speed_weight.largest"), 0.3);
    assert_eq!(paper("adaptive-dwa", "local.window.distance_at"), "end");
    for (name, path) in [
        ("hierarchical", "smoother.safe_distance_m"),
        ("hierarchical", "smoother.control_distance_m"),
        ("hierarchical", "smoother.bends_keep"),
        ("bidirectional", "smoother.spacing_cells"),
        ("bidirectional", "smoother.select"),
        ("bidirectional", "smoother.safety_distance_cells"),
        ("hsta", "planner.reference_cell_m"),
        ("bidirectional-jps", "planner.meeting"),
        ("dwa", "local.window.distance_cap_m"),
        ("key-point-dwa", "local.speed_weight.high_risk_m"),
        ("adaptive-dwa", "local.safe_radius_m"),
        ("guided-dwa", "local.detour.clearance_m"),
        ("local-goals", "guide.spacing_m"),
    ] {
        assert_eq!(paper(name, path), Value::Null, "{name} {path}");
    }
    let radius = parameter("list small --format json", "footprint.radius_m");
    assert_eq!((&radius["unit"], &radius["default"]), (&json!("m"), &json!(0.18)));
    let vertices = parameter("list jackal --format json", "footprint.vertices_m");
    let corners = json!([[0.254, 0.215], [-0.254, 0.215], [-0.254, -0.215], [0.254, -0.215]]);
    assert_eq!((&vertices["unit"], &vertices["default"]), (&json!("m"), &corners));
    for name in ["none", "dwa", "small", "key-point-fusion"] {
        assert!(keyway(folder().path(), &format!("list {name}")).expect_code(0).out.contains(name));
    }
    // The values of a stack's own paper.
    assert_eq!(paper("s0-key-point", "local.speed_weight.largest"), 0.3);
    assert_eq!(paper("s4-ref20", "local.weights.heading"), 0.15);
    assert_eq!(paper("key-point-fusion", "local.window.horizon_s"), Value::Null);
}

#[test]
fn every_listed_path_can_be_set() {
    let folder = folder();
    let report = keyway(folder.path(), "list keyway --format json").expect_code(0).json();
    let mut line = "navigate small_house.yaml --start -8.175,-2.825 --goal -7.6,-2.825".to_owned();
    for parameter in report["entries"][0]["parameters"].as_array().unwrap() {
        let value = parameter["default"].to_string();
        line = format!("{line} --set {}={value}", parameter["path"].as_str().unwrap());
    }
    keyway(folder.path(), &line).expect_code(0);
}

#[test]
fn methods_of_the_papers_are_options_that_work() {
    let folder = folder();
    // Cells of 1 m, as in the papers, and one obstacle.
    let row = |y: u32| {
        if (8..12).contains(&y) { "........@@@@........\n" } else { "....................\n" }
    };
    let rows: String = (0..20).map(row).collect();
    write(&folder, "block.map", &format!("type octile\nheight 20\nwidth 20\nmap\n{rows}"));
    let ends = "block.map --start 2.5,2.5 --goal 17.5,16.5";
    let names = keyway(folder.path(), "list --format json").expect_code(0).json();
    let mut tried = Vec::new();
    for entry in names["entries"].as_array().unwrap() {
        let name = entry["name"].as_str().unwrap();
        let report = keyway(folder.path(), &format!("list {name} --format json")).json();
        let drives = entry["kind"] == "local_planner" || entry["kind"] == "stack";
        // Reaching the goal is not required here.
        let command = if drives { "navigate --time-limit 2" } else { "plan" };
        for method in report["entries"][0]["published"].as_array().unwrap() {
            let options = method["options"].as_array().unwrap();
            let options: Vec<&str> = options.iter().map(|o| o.as_str().unwrap()).collect();
            let line = format!("{command} {ends} {} --format json", options.join(" "));
            if tried.contains(&line) {
                continue;
            }
            let run = keyway(folder.path(), &line);
            // A method may miss a path on a map that is not its paper's; its options are valid.
            assert!([0, 1].contains(&run.code), "{line}: {}", run.err);
            if run.code == 0 && command == "plan" {
                let planner = run.json()["planner"].clone();
                assert!(
                    options.contains(&format!("--planner {}", planner.as_str().unwrap()).as_str()),
                    "{line}"
                );
            }
            tried.push(line);
        }
    }
    assert_eq!(tried.len(), 28, "{tried:?}");
    let shown = keyway(folder.path(), "list shortcut").expect_code(0).out;
    assert!(
        shown.contains(
            "--planner ratio-astar --smoother shortcut --set map.published.expansion_cells=1"
        ),
        "{shown}"
    );
}

#[test]
fn completions_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = keyway(folder().path(), &format!("completions {shell}")).expect_code(0).out;
        assert!(script.contains("navigate") && script.contains("smoother"), "{shell}");
    }
    keyway(folder().path(), "completions tea").expect_code(2);
}

#[test]
fn a_robot_of_a_file_is_listed_whole() {
    let folder = folder();
    write(&folder, "mine.toml", "like = \"jackal\"\ncycle_s = 0.1\n");
    let text = keyway(folder.path(), "list mine.toml").expect_code(0).out;
    assert!(text.contains("\ncycle_s = 0.1\n") && text.contains("\nv_max_mps = 2.0\n"), "{text}");
    write(&folder, "again.toml", &text);
    assert_eq!(
        keyway(folder.path(), "list again.toml").expect_code(0).out.split_once('\n').unwrap().1,
        text.split_once('\n').unwrap().1
    );
    let published = keyway(folder.path(), "list mine.toml --as-published").expect_code(2).err;
    assert!(published.contains("mine.toml"), "{published}");
    write(&folder, "wrong.toml", "like = \"jackal\"\ncycle = 0.1\n");
    let error = keyway(folder.path(), "list wrong.toml").expect_code(2).err;
    assert!(error.contains("wrong.toml: line 2") && error.contains("cycle_s"), "{error}");
}
