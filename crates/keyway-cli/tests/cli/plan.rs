//! Tests of `keyway plan`.

use crate::support::{expect_members, folder, keyway, read, without_times, write};
use serde_json::{Value, json};

const WALLED: &str = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5 --format json";

#[test]
fn the_report_of_a_path_by_hand() {
    let report = keyway(folder().path(), WALLED).expect_code(0).json();
    expect_members(
        &report,
        &[
            ("schema", |v| v == "keyway.plan/3"),
            ("outcome", |v| v == "found"),
            ("planner", |v| v == "jps"),
            ("length_m", Value::is_f64),
            ("cost_cells", Value::is_f64),
            ("expanded", Value::is_u64),
            ("generated", Value::is_u64),
            ("search", Value::is_object),
            ("stopped", |v| v == "nothing_better"),
            ("meeting", Value::is_null),
            ("why", Value::is_null),
            ("largest_clearance_m", Value::is_null),
            ("narrowest_cells", Value::is_null),
            ("relaxed", Value::is_null),
            ("optimum_cells", Value::is_null),
            ("excess", Value::is_null),
            ("time_s", Value::is_f64),
            ("turns", Value::is_u64),
            ("turning_angle_deg", Value::is_f64),
            ("min_clearance_m", Value::is_f64),
            ("kept_clearance_m", Value::is_null),
            ("waypoints_m", Value::is_array),
            ("cells", Value::is_array),
            ("goal", |v| *v == json!({"index": 0, "cell": [5, 0], "gap_m": 0.0})),
            ("goals", Value::is_null),
            ("smoothed", Value::is_null),
            ("inputs", Value::is_object),
            ("files", Value::is_array),
        ],
    );
    // Up to row 4 (with one step aside), over the wall in a straight line, and down again.
    let expected = 6.0 + 2.0 * 2f64.sqrt() + 2.0;
    let length = report["length_m"].as_f64().unwrap();
    assert!((length - expected).abs() < 1e-9, "{length}");
    assert_eq!(report["cost_cells"], report["length_m"], "cells of 1 m");
    assert_eq!(report["min_clearance_m"], 0.5);
    let cells = report["cells"].as_array().unwrap();
    assert_eq!((&cells[0], &cells[cells.len() - 1]), (&json!([1, 0]), &json!([5, 0])));
    let points = report["waypoints_m"].as_array().unwrap();
    assert_eq!((&points[0], &points[points.len() - 1]), (&json!([1.5, 0.5]), &json!([5.5, 0.5])));
    assert!(points.len() < cells.len(), "collinear points are merged");
}

#[test]
fn an_end_nearer_than_the_clearance_is_reported_even_without_a_smoother() {
    let folder = folder();
    let map = "type octile\nheight 3\nwidth 4\nmap\n....\n@...\n....\n";
    write(&folder, "near.map", map);
    let plan = |more: &str| {
        let line = format!("plan near.map --start 1.05,1.5 --goal 3.5,1.5 --radius 0.4 {more}");
        keyway(folder.path(), &line).expect_code(0)
    };
    let report = plan("--format json").json();
    assert!((report["kept_clearance_m"].as_f64().unwrap() - 0.05).abs() < 1e-9, "{report}");
    for smoother in ["none", "line-of-sight"] {
        let table = plan(&format!("--smoother {smoother}")).out;
        assert_eq!(table.matches("not kept").count(), 1, "{table}");
        assert!(table.contains("only 0.050 m"), "{table}");
    }
}

#[test]
fn the_excess_is_over_the_cheapest_path_under_the_same_corner_rule() {
    let folder = folder();
    let ask = |more: &str| {
        let line = format!("{WALLED} --excess {more}");
        let report = keyway(folder.path(), &line).expect_code(0).json();
        let of = |name: &str| report[name].as_f64().unwrap();
        (of("cost_cells"), of("optimum_cells"), of("excess"))
    };
    let optimum = 8.0 + 2.0 * 2f64.sqrt();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
    let (cost, best, excess) = ask("--planner jps");
    assert!(near(cost, optimum) && near(best, optimum) && excess == 0.0);
    // Up, over the wall and down, without diagonal steps.
    let (cost, best, excess) = ask("--planner astar4");
    assert!(near(cost, 12.0) && near(best, optimum) && near(excess, 12.0 / optimum - 1.0));
    let (cost, best, excess) = ask("--planner astar --set planner.corners=allow");
    assert!(near(cost, best) && best < optimum && excess == 0.0);
    let none = keyway(folder.path(), &format!("{WALLED} --excess --budget 1")).expect_code(1);
    let report = none.json();
    assert!(report["excess"].is_null());
    assert!(report["why"].as_str().unwrap().contains("budget of 1"), "{report}");
}

#[test]
fn inputs_say_everything() {
    let line = "plan walled.map --start 1.25,0.5 --goal 10.5,0.5 --resolution 2 --origin -1,-1,0 \
                --radius 0.2 --unknown free --planner astar --set planner.corners=allow --budget 999 --format json";
    let inputs = &keyway(folder().path(), line).expect_code(0).json()["inputs"];
    expect_members(
        inputs,
        &[
            ("version", |v| v == env!("CARGO_PKG_VERSION")),
            ("map", |v| v == "walled.map"),
            ("map_digest", |v| v.as_str().is_some_and(|digest| digest.len() == 16)),
            ("placement", |v| *v == json!({"resolution_m": 2.0, "origin": [-1.0, -1.0, 0.0]})),
            ("robot", Value::is_null),
            ("stack", Value::is_null),
            ("config", Value::is_object),
            ("start", |v| *v == json!([1.25, 0.5])),
            ("goal", |v| *v == json!([10.5, 0.5])),
            ("goals", Value::is_null),
            ("via", Value::is_null),
            ("nearest_reachable", |v| *v == false),
            ("obstacles", |v| *v == json!([])),
            ("polygons", |v| *v == json!([])),
            ("hidden_cells", |v| *v == json!([])),
            ("absent_cells", |v| *v == json!([])),
            ("elusive", |v| *v == json!([])),
            ("moving", |v| *v == json!([])),
            ("random", Value::is_null),
            ("disturbances", Value::is_null),
            ("goal_tolerance_m", Value::is_null),
            ("arrival", Value::is_null),
            ("reached_by", Value::is_null),
            ("time_limit_s", Value::is_null),
            ("stuck_window_s", Value::is_null),
            ("budget", |v| *v == 999),
        ],
    );
    let config = &inputs["config"];
    assert_eq!(config["map"]["clearance_m"], 0.2);
    assert_eq!(config["map"]["unknown"], "free");
    assert_eq!(
        config["planner"],
        json!({
            "name": "astar", "corners": "allow", "heuristic": "octile", "g": "accumulated"
        })
    );
    assert_eq!(config["smoother"], json!({"name": "none"}));
}

#[test]
fn two_runs_differ_in_times_only() {
    let folder = folder();
    let line = "plan small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 --radius 0.2 \
                --smoother line-of-sight --format json";
    let runs = [(); 2].map(|()| without_times(keyway(folder.path(), line).expect_code(0).json()));
    assert_eq!(runs[0], runs[1]);
    let (smoothed, length) = (&runs[0]["smoothed"], runs[0]["length_m"].as_f64().unwrap());
    assert!(smoothed["length_m"].as_f64().unwrap() < length);
    assert!(smoothed["min_clearance_m"].as_f64().unwrap() >= 0.2 - 1e-9);
    let ends = |line: &Value| {
        let points = line["waypoints_m"].as_array().unwrap();
        (points[0].clone(), points[points.len() - 1].clone())
    };
    assert_eq!(ends(smoothed), ends(&runs[0]));
}

#[test]
fn no_path_is_exit_code_1() {
    let folder = folder();
    let line = WALLED.replace("walled", "closed");
    let report = keyway(folder.path(), &line).expect_code(1).json();
    assert_eq!(report["outcome"], "no_path");
    for null in ["goal", "length_m", "cost_cells", "turns", "waypoints_m", "cells", "smoothed"] {
        assert!(report[null].is_null(), "{null}");
    }
    assert_eq!(report["expanded"], 0, "found without a search");
    let table = keyway(folder.path(), &line.replace("--format json", "")).expect_code(1);
    assert!(table.out.contains("no path"), "{}", table.out);

    let budget = keyway(folder.path(), &format!("{WALLED} --planner astar --budget 3"))
        .expect_code(1)
        .json();
    assert_eq!((&budget["outcome"], &budget["expanded"]), (&json!("budget_exhausted"), &json!(3)));
}

#[test]
fn cells_and_negative_positions() {
    let folder = folder();
    let placed = "plan walled.map --origin -3.5,-1 --format json";
    let metres = format!("{placed} --start -2,-0.5 --goal=2,-0.5");
    let cells = format!("{placed} --cells --start 1,0 --goal 5,0");
    let [metres, cells] = [metres, cells]
        .map(|line| without_times(keyway(folder.path(), &line).expect_code(0).json()));
    assert_eq!(metres, cells);
    assert_eq!(metres["inputs"]["start"], json!([-2.0, -0.5]));
}

#[test]
fn pictures_have_the_format_of_their_name() {
    let folder = folder();
    for (name, magic) in [("a.svg", b"<svg".as_slice()), ("b.PNG", b"\x89PNG")] {
        keyway(folder.path(), &format!("{WALLED} --picture {name}")).expect_code(0);
        let bytes = std::fs::read(folder.path().join(name)).unwrap();
        assert!(bytes.starts_with(magic), "{name}");
    }
}

#[test]
fn pictures_show_the_search() {
    let folder = folder();
    let picture = |line: &str, code| {
        let shown = format!("{line} --picture a.svg");
        let mut report = keyway(folder.path(), &shown).expect_code(code).json();
        report["files"] = json!([]);
        let silent = keyway(folder.path(), line).expect_code(code).json();
        assert_eq!(without_times(report), without_times(silent), "a picture changes no result");
        read(&folder, "a.svg")
    };
    let found = picture(&format!("{WALLED} --planner astar"), 0);
    assert!(
        found.contains(">expanded, early to late</text>") && found.contains(">planned path</text>")
    );
    let both = picture(&format!("{WALLED} --planner bidirectional-optimal"), 0);
    assert!(both.contains(">expanded, early to late, from the goal</text>"));
    assert!(both.contains(">the two sides met</text>"));
    let jumps = picture(WALLED, 0);
    assert!(jumps.contains(">scans, early to late</text>"));
    // A failed search is drawn, too; one that did not start is not.
    let failed = picture(&format!("{WALLED} --planner astar --budget 3"), 1);
    assert!(failed.contains(">expanded, early to late</text>") && !failed.contains("planned path"));
    let closed = picture(&WALLED.replace("walled", "closed"), 1);
    assert!(!closed.contains("early to late"));
    // The search for the nearest goal.
    let nearest = picture(&WALLED.replace("5.5,0.5", "2.5,0.5 --planner astar"), 0);
    let several = format!("{WALLED} --planner astar --goal 2.5,0.5 --picture a.svg");
    keyway(folder.path(), &several).expect_code(0);
    let path_of = |svg: &str| -> Option<String> {
        svg.lines().find(|line| line.contains("stroke-width=\"1.4\"")).map(str::to_owned)
    };
    assert!(path_of(&nearest).is_some());
    assert_eq!(path_of(&read(&folder, "a.svg")), path_of(&nearest));
}

#[test]
fn animations_play_the_search() {
    let folder = folder();
    let play = |line: &str, name: &str, code| {
        keyway(folder.path(), &format!("{line} --animate {name}")).expect_code(code);
        std::fs::read(folder.path().join(name)).unwrap()
    };
    let astar = format!("{WALLED} --planner astar");
    for (name, magic) in [("a.gif", b"GIF89a".as_slice()), ("b.APNG", b"\x89PNG")] {
        let found = play(&astar, name, 0);
        assert!(found.starts_with(magic) && found.len() < 200_000, "{name}: {}", found.len());
        assert_eq!(found, play(&astar, name, 0), "the same bytes");
        let failed = play(&format!("{astar} --budget 3"), name, 1);
        assert!(failed.starts_with(magic) && failed.len() < found.len());
    }
    // No search started: a single picture.
    assert!(play(&WALLED.replace("walled", "closed"), "c.gif", 1).starts_with(b"GIF89a"));
    let house = "plan small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875";
    let house = play(house, "house.gif", 0);
    assert!(house.len() < 2_000_000, "{} bytes", house.len());
}

#[test]
fn config_file_then_options_then_set() {
    let folder = folder();
    write(
        &folder,
        "my.toml",
        "[map]\nclearance_m = 0.1\nunknown = \"free\"\n[planner]\nname = \"astar\"\ncorners = \"allow\"\n[controller]\nblocked_s = 2\n",
    );
    let config = |more: &str| {
        let report = keyway(folder.path(), &format!("{WALLED} --config my.toml {more}"));
        report.expect_code(0).json()["inputs"]["config"].clone()
    };
    let file = config("");
    assert_eq!(file["map"]["clearance_m"], 0.1);
    assert_eq!(
        (&file["map"]["unknown"], &file["planner"]["corners"]),
        (&json!("free"), &json!("allow"))
    );
    let options = config("--radius 0.2 --unknown penalised");
    assert_eq!(options["map"]["clearance_m"], 0.2);
    assert_eq!(options["map"]["unknown"], "penalised");
    let set = config("--radius 0.2 --set map.clearance_m=0.3 --set smoother.name=line-of-sight");
    assert_eq!(set["map"]["clearance_m"], 0.3);
    assert_eq!(set["smoother"]["name"], "line-of-sight");
}

#[test]
fn the_table_is_for_people() {
    let table = keyway(folder().path(), &WALLED.replace("--format json", "")).expect_code(0).out;
    for part in ["outcome", "found", "10.828 m", "cells", "turning angle", "clearance"] {
        assert!(table.contains(part), "{part}:\n{table}");
    }
}

#[test]
fn the_nearest_reachable_cell_stands_in_for_a_goal() {
    let folder = folder();
    // Beyond the closed wall of column 3, and inside it: column 2 is the nearest reachable one.
    for (goal, cell, gap) in [("5.5,1.5", [2, 1], 3.0), ("3.25,2.5", [2, 2], 0.75)] {
        let line = format!("plan closed.map --start 0.5,0.5 --goal {goal} --nearest-reachable");
        let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
        assert_eq!(report["outcome"], "found");
        assert_eq!(report["goal"], json!({"index": 0, "cell": cell, "gap_m": gap}));
        assert_eq!(report["inputs"]["nearest_reachable"], true);
        let points = report["waypoints_m"].as_array().unwrap();
        let centre = json!([f64::from(cell[0]) + 0.5, f64::from(cell[1]) + 0.5]);
        assert_eq!(points[points.len() - 1], centre);
        let table = keyway(folder.path(), &line).expect_code(0).out;
        let short = format!("{gap:.3} m short of it, in cell ({}, {})", cell[0], cell[1]);
        assert!(table.contains(&short), "{table}");
    }
    let reached = format!("{WALLED} --nearest-reachable");
    let reached = keyway(folder.path(), &reached).expect_code(0).json();
    assert_eq!(reached["goal"]["gap_m"], 0.0);
    let outside = WALLED.replace("5.5,0.5", "9.5,0.5") + " --nearest-reachable";
    keyway(folder.path(), &outside).expect_code(2);
}

#[test]
fn several_goals_nearest_first() {
    let folder = folder();
    let ask = |map: &str, code| {
        let goals = "--goal 4.5,0.5 --goal 3.5,0.5 --goal 0.5,4.5 --goal 2.5,0.5 --goal 99,0";
        let line = format!("plan {map} --start 0.5,0.5 {goals} --format json");
        keyway(folder.path(), &line).expect_code(code).json()
    };
    let rows = |report: &Value| -> Vec<(u64, String)> {
        let row = |goal: &Value| {
            (goal["index"].as_u64().unwrap(), goal["outcome"].as_str().unwrap().to_owned())
        };
        report["goals"].as_array().unwrap().iter().map(row).collect()
    };
    let expected = |rows: &[(u64, &str)]| -> Vec<(u64, String)> {
        rows.iter().map(|&(index, outcome)| (index, outcome.to_owned())).collect()
    };
    // The goal behind the wall is as near in a straight line as the one up along the border.
    let report = ask("walled.map", 0);
    let order = [(3, "found"), (2, "found"), (0, "found"), (1, "blocked"), (4, "outside_map")];
    assert_eq!(rows(&report), expected(&order));
    assert_eq!((&report["goal"]["index"], &report["cost_cells"]), (&json!(3), &json!(2.0)));
    assert_eq!(report["goals"][1]["cost_cells"], 4.0);
    assert_eq!(report["inputs"]["goals"].as_array().unwrap().len(), 5);
    let closed = ask("closed.map", 0);
    let order = [(3, "found"), (2, "found"), (0, "no_path"), (1, "blocked"), (4, "outside_map")];
    assert_eq!(rows(&closed), expected(&order));

    let goals = "--goal 4.5,0.5 --goal 3.5,0.5";
    let nowhere = format!("plan closed.map --start 0.5,0.5 {goals}");
    let report = keyway(folder.path(), &format!("{nowhere} --format json")).expect_code(1).json();
    assert_eq!((&report["outcome"], &report["goal"]), (&json!("no_path"), &Value::Null));
    let table = keyway(folder.path(), &nowhere).expect_code(1).out;
    assert!(table.contains("blocked") && table.contains("no path"), "{table}");
    keyway(folder.path(), &format!("{nowhere} --nearest-reachable")).expect_code(2);
    keyway(folder.path(), &nowhere.replace("0.5,0.5", "3.5,0.5")).expect_code(2);
    let jps = format!("{nowhere} --planner jps --unknown penalised");
    let refused = keyway(folder.path(), &jps.replace("closed", "walled"));
    assert!(refused.expect_code(2).err.contains("one cost for all cells"));
}

#[test]
fn all_goals_are_drawn_and_the_reached_one_is_marked() {
    let folder = folder();
    let picture = |line: &str| {
        keyway(folder.path(), &format!("{line} --picture goals.svg"));
        read(&folder, "goals.svg")
    };
    let goals = "--goal 6.5,0.5 --goal 0.5,3.5 --goal 3.5,0.5 --goal 99,1";
    let found = picture(&format!("plan walled.map --start 0.5,0.5 {goals}"));
    // The one outside the map is left out; the legend has one of each kind.
    assert_eq!(found.matches(">G<").count(), 3 + 2, "{found}");
    assert!(found.contains(">goal<") && found.contains(">other goal<"), "{found}");
    let none = picture("plan closed.map --start 0.5,0.5 --goal 6.5,0.5 --goal 5.5,0.5");
    assert_eq!(none.matches(">G<").count(), 2 + 1, "{none}");
    assert!(none.contains(">goal without a path<") && !none.contains(">goal<"), "{none}");
    let one = picture("plan closed.map --start 0.5,0.5 --goal 6.5,0.5");
    assert!(one.contains(">goal<") && !one.contains(">other goal<"), "{one}");
}

/// The goal is 0.5 m beside the wall, and the corner of the path is sharp: there is no edge to
/// bend on.
#[test]
fn what_a_smoother_could_not_give_is_named() {
    let folder = folder();
    let plan = |options: &str| -> String {
        let line = format!("plan walled.map --start 0.5,0.5 --goal 2.5,0.5 {options}");
        keyway(folder.path(), &line).expect_code(0).out
    };
    let own = plan("--smoother key-points --set smoother.safe_distance_m=0.75");
    assert!(own.contains("the smoother's safe distance of 0.750 m, only 0.500 m"), "{own}");
    let kept = plan("--smoother key-points --set smoother.safe_distance_m=0.5");
    assert!(!kept.contains("not kept"), "{kept}");
    let bend = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5 --smoother hierarchical \
                --set smoother.safe_distance_m=0 --set smoother.control_distance_m=0.001";
    let bend = keyway(folder.path(), bend).expect_code(0).out;
    assert!(bend.contains("a curve would turn more than 5 degrees per centimetre"), "{bend}");
}

/// The jump points reach the smoother in every command that smooths.
#[test]
fn key_points_are_chosen_from_the_jump_points_of_the_plan() {
    let folder = folder();
    write(&folder, "q.csv", "1.5,1.5,30.5,30.5\n");
    let lengths = |choice: &str| {
        let plan = "plan rooms.map --start 1.5,1.5 --goal 30.5,30.5 --planner bidirectional-jps \
                    --smoother key-points --format json";
        let plan = keyway(folder.path(), &format!("{plan} {choice}")).expect_code(0).json();
        let compare = "compare rooms.map --pairs q.csv --planners bidirectional-jps \
                       --smoothers key-points --format json";
        let compare = keyway(folder.path(), &format!("{compare} {choice}")).expect_code(0).json();
        let lengths = [&plan["smoothed"]["length_m"], &compare["rows"][0]["mean_length_m"]];
        lengths.map(|length| length.as_f64().unwrap())
    };
    let is_near =
        |lengths: [f64; 2], expected: f64| lengths.iter().all(|m| (m - expected).abs() < 1e-3);
    let (paper, cells) = (lengths(""), lengths("--set smoother.candidates=cells"));
    assert!(is_near(paper, 48.186), "{paper:?}");
    assert!(is_near(cells, 46.715), "{cells:?}");
    let config = "planner.name = \"bidirectional-jps\"\nsmoother.name = \"key-points\"\n";
    write(&folder, "c.toml", config);
    let driven = |choice: &str| {
        let line = "navigate rooms.map --start 1.5,1.5 --goal 30.5,30.5 --time-limit 1 \
                    --config c.toml --set smoother.safe_distance_m=0.5 --format json";
        let report = keyway(folder.path(), &format!("{line} {choice}")).json();
        report["smoothed"]["length_m"].as_f64().unwrap()
    };
    let (paper, cells) = (driven(""), driven("--set smoother.candidates=cells"));
    assert!((paper - 48.186).abs() < 1e-3 && (cells - 47.711).abs() < 1e-3, "{paper} {cells}");
}

#[test]
fn the_time_of_smoothing_is_reported() {
    let folder = folder();
    let smoothed = format!("{WALLED} --smoother taut");
    let report = keyway(folder.path(), &smoothed).expect_code(0).json();
    let time_s = report["smoothed"]["time_s"].as_f64().unwrap();
    assert!(time_s > 0.0 && time_s < 60.0, "{time_s}");
    let table = |line: &str| keyway(folder.path(), &line.replace(" --format json", "")).out;
    assert!(table(&smoothed).contains("smoothing time"));
    assert!(!table(WALLED).contains("smoothing time"), "nothing was smoothed");
}

#[test]
fn smoothers_begin_with_distances_for_the_robot() {
    let folder = folder();
    let open = ".........\n".repeat(9);
    write(&folder, "a.map", &format!("type octile\nheight 9\nwidth 9\nmap\n{open}"));
    let safe_m = |smoother: &str, more: &str| {
        let line = format!(
            "plan a.map --start 2.5,2.5 --goal 6.5,6.5 --smoother {smoother} {more} --format json"
        );
        keyway(folder.path(), &line).expect_code(0).json()["inputs"]["config"]["smoother"]["safe_distance_m"].as_f64()
    };
    let small_m = keyway::robot::Robot::small().preferred_clearance_m();
    for (smoother, published_m) in [("hierarchical", 0.8), ("key-points", 0.5)] {
        assert_eq!(safe_m(smoother, ""), Some(published_m));
        assert_eq!(safe_m(smoother, "--robot small"), Some(small_m));
        assert_eq!(safe_m(smoother, "--radius 0.3"), Some(0.3));
        assert_eq!(safe_m(smoother, "--robot small --as-published"), Some(published_m));
        let set = format!("--robot small --set {smoother}.safe_distance_m=0.4");
        assert_eq!(safe_m(smoother, &set), Some(0.4));
    }
}
