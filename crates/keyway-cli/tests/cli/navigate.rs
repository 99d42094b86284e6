//! Tests of `keyway navigate` and `keyway demo`.

use crate::support::{expect_members, folder, keyway, read, without_times, write};
use serde_json::{Value, json};

const SHORT: &str = "navigate small_house.yaml --start -8.175,-2.825 --goal -6,-2.6 --format json";

#[test]
fn the_bundled_scene() {
    let folder = folder();
    let line = "navigate --scene small_house.toml --format json --out run";
    let report = keyway(folder.path(), line).expect_code(0).json();
    expect_members(
        &report,
        &[
            ("schema", |v| v == "keyway.navigate/4"),
            ("outcome", |v| v == "reached"),
            ("reason", Value::is_null),
            ("plan", |v| v["outcome"] == "found" && v["time_s"].is_f64()),
            ("smoothed", |v| v["length_m"].is_f64() && v["min_clearance_m"].is_f64()),
            ("key_points_m", |v| v.as_array().is_some_and(|points| !points.is_empty())),
            ("misfit", Value::is_null),
            ("noticed", |v| v.as_array().is_some_and(Vec::is_empty)),
            ("run", Value::is_object),
            ("trajectory", Value::is_array),
            ("inputs", Value::is_object),
            ("files", Value::is_array),
        ],
    );
    expect_members(
        &report["run"],
        &[
            ("time_s", Value::is_f64),
            ("length_m", Value::is_f64),
            ("mean_speed_mps", Value::is_f64),
            ("min_clearance_m", |v| v.as_f64().is_some_and(|clearance| clearance > 0.0)),
            ("min_standing_clearance_m", |v| v.as_f64().is_some_and(|clearance| clearance > 0.0)),
            ("min_mover_clearance_m", Value::is_null),
            ("contact", Value::is_null),
            ("cycles", Value::is_u64),
            ("mean_cycle_us", Value::is_f64),
            ("routes_planned", Value::is_u64),
            ("recoveries", |v| {
                ["replan", "turn", "manoeuvre", "back_up", "wait"]
                    .iter()
                    .all(|kind| v[kind].is_u64())
            }),
            ("unsafe_commands", Value::is_null),
            ("way_points", Value::is_null),
            ("omega_sign_changes_per_m", Value::is_f64),
            ("v_variation_mps", Value::is_f64),
            ("omega_variation_radps", Value::is_f64),
            ("max_jerk_mps3", Value::is_f64),
            ("max_angular_jerk_radps3", Value::is_f64),
            ("mrpb", Value::is_object),
        ],
    );
    let inputs = &report["inputs"];
    assert_eq!(inputs["robot"]["footprint"]["radius_m"], 0.18);
    assert_eq!(inputs["stack"], "keyway");
    assert_eq!(inputs["obstacles"], json!([[0.3, -0.275, 0.15]]));
    let limit = 60.0 + 4.0 * report["smoothed"]["length_m"].as_f64().unwrap() / 0.5;
    assert_eq!(inputs["time_limit_s"], limit);

    // The obstacle is on the route, which was planned without it, and was not touched.
    let away = |[x, y]: [f64; 2]| (x - 0.3).hypot(y + 0.275);
    let rows: Vec<[f64; 6]> = serde_json::from_value(report["trajectory"].clone()).unwrap();
    let nearest = rows.iter().map(|row| away([row[1], row[2]])).fold(f64::INFINITY, f64::min);
    assert!(nearest > 0.15 + 0.18 && nearest < 1.0, "{nearest}");
    assert_eq!(rows.len() as u64, report["run"]["cycles"].as_u64().unwrap() + 1);

    assert_eq!(read(&folder, "run/report.json").parse::<Value>().unwrap(), report);
    assert_eq!(read(&folder, "run/trajectory.csv").lines().count(), rows.len() + 1);
    for (name, magic) in [
        ("map.svg", b"<svg".as_slice()),
        ("map.png", b"\x89PNG"),
        ("speed.svg", b"<svg"),
        ("speed.png", b"\x89PNG"),
    ] {
        assert!(std::fs::read(folder.path().join("run").join(name)).unwrap().starts_with(magic));
    }
    let again = keyway(folder.path(), line).expect_code(0).json();
    assert_eq!(without_times(again), without_times(report));
}

#[test]
fn the_stop_rule_can_be_asked_for_and_set() {
    let folder = folder();
    let set = "--set controller.safe.movers.acceleration_mps2=2";
    let line = format!("{SHORT} --moving -7,-4.2,0.2,0,0.4 --safe {set}");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    let changed = &report["run"]["unsafe_commands"];
    assert!(
        ["standing", "mover", "covered", "not_a_number"].iter().all(|why| changed[why].is_u64())
    );
    let controller = &report["inputs"]["config"]["controller"];
    assert_eq!(controller["safe"]["movers"], json!({"speed_mps": 1.5, "acceleration_mps2": 2.0}));
    let table = keyway(folder.path(), &line.replace(" --format json", "")).expect_code(0).out;
    assert!(table.contains("commands changed"), "{table}");
    let error = keyway(folder.path(), &format!("{line} --set controller.safe.margin_m=0"));
    let error = error.expect_code(2).out;
    assert!(error.contains("controller.safe.margin_m"), "{error}");
    let error = keyway(folder.path(), &format!("{SHORT} {set}")).expect_code(2).out;
    assert!(error.contains("controller.safe"), "{error}");
}

#[test]
fn a_scene_and_arguments_are_the_same() {
    let folder = folder();
    write(
        &folder,
        "short.toml",
        "version = 1\nmap = \"small_house.yaml\"\nstart = [-8.175, -2.825, 20]\nvia = [[-7, -2.7]]\ngoal = [-6, -2.6, 90]\n[[unknown]]\nposition = [-7, -3.5]\nradius_m = 0.1\n",
    );
    let scene = keyway(folder.path(), "navigate --scene short.toml --format json");
    let line = SHORT.replace("2.825", "2.825,20").replace("-6,-2.6", "-6,-2.6,90")
        + " --via -7,-2.7 --obstacle -7,-3.5,0.1";
    let args = keyway(folder.path(), &line);
    let [scene, args] = [scene, args].map(|answer| without_times(answer.expect_code(0).json()));
    assert_eq!(scene, args);
    assert_eq!(args["inputs"]["start"], json!([-8.175, -2.825, 20.0]));
    assert_eq!(args["inputs"]["goal"], json!([-6.0, -2.6, 90.0]));
    assert_eq!(args["inputs"]["via"], json!([[-7.0, -2.7]]));
    assert_eq!(args["run"]["way_points"][0]["position"], json!([-7.0, -2.7]));
    assert!(args["run"]["way_points"][0]["passed_s"].as_f64().is_some_and(|time_s| time_s > 1.0));
    let last = args["trajectory"].as_array().unwrap().last().unwrap().clone();
    assert!((last[3].as_f64().unwrap() - 90f64.to_radians()).abs() < 0.05);
    assert_eq!((&last[4], &last[5]), (&json!(0.0), &json!(0.0)), "it stands");
    assert!((args["trajectory"][0][3].as_f64().unwrap() - 20f64.to_radians()).abs() < 1e-12);
}

#[test]
fn movers_of_a_scene_and_of_arguments_are_the_same() {
    let folder = folder();
    let scene = "version = 1\nmap = \"small_house.yaml\"\nstart = [-8.175, -2.825]\ngoal = [-6, -2.6]\n\
        [[moving]]\nposition = [-7, 1]\nvelocity_mps = [0, -0.1]\nradius_m = 0.2\n\
        [[moving]]\nway_points = [[-7, -4], [-8, -4], [-8, -4.5]]\nspeed_mps = 0.3\nradius_m = 0.1\n";
    write(&folder, "movers.toml", scene);
    let line = "navigate --scene movers.toml --format json --out run";
    let scene = keyway(folder.path(), line).expect_code(0).json();
    let movers = "--moving -7,1,0.2,0,-0.1 --moving -7,-4,0.1,0.3:-8,-4:-8,-4.5";
    let args = keyway(folder.path(), &format!("{SHORT} {movers} --out run")).expect_code(0).json();
    assert_eq!(without_times(scene), without_times(args.clone()));
    let moving = json!([
        {"radius_m": 0.2, "position": [-7.0, 1.0], "velocity_mps": [0.0, -0.1]},
        {"radius_m": 0.1, "way_points": [[-7.0, -4.0], [-8.0, -4.0], [-8.0, -4.5]], "speed_mps": 0.3},
    ]);
    assert_eq!(args["inputs"]["moving"], moving);
    let run = &args["run"];
    let clearance = |name: &str| run[name].as_f64().unwrap();
    let apart = clearance("min_standing_clearance_m").min(clearance("min_mover_clearance_m"));
    assert_eq!(clearance("min_clearance_m"), apart);
    assert!(read(&folder, "run/map.svg").contains(">moving obstacle</text>"));
}

#[test]
fn a_mover_that_jumps_onto_the_robot_is_reported() {
    let folder = folder();
    // It is ahead of the robot for a moment, then far away until three seconds, and then back at
    // the position of the robot at that time.
    let mover = "[[moving]]\nradius_m = 0.5\nduration_s = 3.02\n\
                 spline = [[0, -7.0, -2.4], [0.5, -3.0, -2.4], [1.5, 8.0, 5.0]]\n";
    write(&folder, "jump.toml", &format!("{}\n{mover}", read(&folder, "small_house.toml")));
    let report = keyway(folder.path(), "navigate --scene jump.toml --format json");
    let report = report.expect_code(1).json();
    let contact = &report["run"]["contact"];
    assert_eq!((&contact["with"], &contact["jumped_onto"]), (&json!({"mover": 0}), &json!(true)));
    assert!((contact["t_s"].as_f64().unwrap() - 3.02).abs() < 1e-9, "{contact}");
    assert!(report["reason"].as_str().unwrap().contains(", just after it had jumped"));
}

#[test]
fn a_mover_that_runs_into_the_robot_is_reported() {
    let folder = folder();
    // Faster than the robot can escape.
    let hit = keyway(folder.path(), &format!("{SHORT} --moving -8.175,-7.825,0.3,0,5"));
    let hit = hit.expect_code(1).json();
    let contact = &hit["run"]["contact"];
    assert_eq!((&hit["outcome"], &contact["with"]), (&json!("collided"), &json!({"mover": 0})));
    assert_eq!((&contact["t_s"], &contact["robot_stood"]), (&hit["run"]["time_s"], &json!(false)));
    assert_eq!(
        (&contact["jumped_onto"], &contact["mover_speed_mps"]),
        (&json!(false), &json!(5.0))
    );
    assert!(hit["reason"].as_str().unwrap().starts_with("touched moving obstacle 0 at ("));
    let wrong = keyway(folder.path(), &format!("{SHORT} --moving 1,2,0.3"));
    wrong.expect_code(2);
}

#[test]
fn without_a_yaw_the_robot_looks_along_its_path() {
    let report = keyway(folder().path(), SHORT).expect_code(0).json();
    let points: Vec<[f64; 2]> =
        serde_json::from_value(report["smoothed"]["waypoints_m"].clone()).unwrap();
    let heading = (points[1][1] - points[0][1]).atan2(points[1][0] - points[0][0]);
    assert!((report["trajectory"][0][3].as_f64().unwrap() - heading).abs() < 1e-12);
}

#[test]
fn a_run_that_does_not_reach_its_goal_says_why() {
    let folder = folder();
    let late = keyway(folder.path(), &format!("{SHORT} --time-limit 1")).expect_code(1).json();
    assert_eq!((&late["outcome"], &late["run"]["time_s"]), (&json!("timeout"), &json!(1.0)));
    assert!(late["reason"].as_str().unwrap().contains("time limit of 1.0 s"));
    let inside = format!("{SHORT} --obstacle -8.3,-2.825,0.2");
    let collided = keyway(folder.path(), &inside).expect_code(1).json();
    assert_eq!(collided["outcome"], "collided");
    assert!(collided["reason"].as_str().unwrap().starts_with("touched unknown obstacle 0"));
    // The picture marks the end: the letter there and in the legend, and what it means.
    for (line, label) in
        [(inside, ">contact<"), (format!("{SHORT} --time-limit 1"), ">time limit<")]
    {
        let line = line.replace(" --format json", "");
        keyway(folder.path(), &format!("{line} --out out")).expect_code(1);
        let svg = read(&folder, "out/map.svg");
        assert!(svg.contains(label) && svg.matches(">X<").count() == 2, "{label}: {svg}");
    }
    keyway(folder.path(), "navigate --scene small_house.toml --out out").expect_code(0);
    assert!(!read(&folder, "out/map.svg").contains(">X<"));
}

#[test]
fn no_path_leaves_a_report_and_removes_what_it_does_not_belong_to() {
    let folder = folder();
    let line = |map: &str| {
        format!("navigate {map} --start 1.5,1.5 --goal 5.5,1.5 --format json --out run")
    };
    keyway(folder.path(), &line("walled.map")).expect_code(0);
    assert!(folder.path().join("run/trajectory.csv").exists());
    let without = keyway(folder.path(), &format!("{} --explain why.jsonl", line("closed.map")));
    let without = without.expect_code(1);
    let report = without.json();
    let warning = "--explain: no file was written, because the robot did not start";
    assert!(without.err.contains(warning), "{}", without.err);
    assert!(!folder.path().join("why.jsonl").exists());
    assert_eq!(
        (&report["outcome"], &report["plan"]["outcome"]),
        (&json!("no_path"), &json!("no_path"))
    );
    for null in ["smoothed", "key_points_m", "run", "trajectory"] {
        assert!(report[null].is_null(), "{null}");
    }
    assert!(report["reason"].as_str().unwrap().contains("no path"));
    assert_eq!(read(&folder, "run/report.json").parse::<Value>().unwrap(), report);
    assert!(!folder.path().join("run/trajectory.csv").exists(), "of the earlier run");
}

/// A goal in a closed room, and one outside the map.
#[test]
fn the_nearest_place_is_driven_to_where_the_goal_cannot_be_reached() {
    let folder = folder();
    let rows = ["..........", ".......###", ".......#.#", ".......###", ".........."];
    let map = format!("type octile\nheight 5\nwidth 10\nmap\n{}\n", rows.join("\n"));
    write(&folder, "room.map", &map.replace('#', "@"));
    let drive = |goal: &str| {
        let line = format!("navigate room.map --start 1.5,2.5 --goal {goal} --format json");
        keyway(folder.path(), &format!("{line} --nearest-reachable"))
    };
    let closed = drive("8.5,2.5").expect_code(0);
    assert!(closed.err.contains("the goal (8.500, 2.500) cannot be reached"), "{}", closed.err);
    let report = closed.json();
    assert_eq!(report["outcome"], "reached");
    assert_eq!(report["inputs"]["goal"], json!([8.5, 0.5]));
    let outside = drive("12,0.5").expect_code(0).json();
    assert_eq!(outside["inputs"]["goal"], json!([9.5, 0.5]));
    let open = drive("4.2,0.7").expect_code(0);
    assert_eq!((open.err.as_str(), &open.json()["inputs"]["goal"]), ("", &json!([4.2, 0.7])));
}

/// A robot file with few fields, and one overridden value.
#[test]
fn a_robot_is_a_few_lines_and_values_are_set() {
    let folder = folder();
    write(&folder, "mine.toml", "radius_m = 0.12\nv_max_mps = 0.4\n");
    write(&folder, "like.toml", "like = \"small\"\nlimits = { v_max_mps = 0.4 }\n");
    let robot = |options: &str| {
        let line = format!("{SHORT} {options}");
        keyway(folder.path(), &line).expect_code(0).json()["inputs"]["robot"].clone()
    };
    let derived = robot("--robot mine.toml");
    assert_eq!((&derived["limits"]["v_max_mps"], &derived["cycle_s"]), (&json!(0.4), &json!(0.1)));
    let like = robot("--robot like.toml");
    assert_eq!(
        (&like["limits"]["v_max_mps"], &like["footprint"]["radius_m"]),
        (&json!(0.4), &json!(0.18))
    );
    let set =
        robot("--robot mine.toml --set robot.limits.omega_max_radps=1 --set local.discomfort=1");
    assert_eq!(set["limits"]["omega_max_radps"], 1.0);
    let refused = |options: &str| keyway(folder.path(), &format!("{SHORT} {options}")).out;
    assert!(refused("--set robot.limits.v_max=1").contains("there is no field `limits.v_max`"));
    assert!(
        refused("--set robot.cycle_s=0").contains("--set: of the robot: cycle_s must be a time")
    );
    assert!(
        refused("--as-published --set robot.cycle_s=0.2")
            .contains("--as-published needs the robot `paper`")
    );
}

#[test]
fn robots_by_name_and_from_files() {
    let folder = folder();
    let robot = "footprint = { radius_m = 0.1 }\ncycle_s = 0.2\n[limits]\nv_min_mps = 0.0\nv_max_mps = 0.4\n\
                 omega_max_radps = 1.0\nacceleration_mps2 = 0.5\ndeceleration_mps2 = 0.5\n\
                 angular_acceleration_radps2 = 3.0\nangular_deceleration_radps2 = 3.0\n\
                 [[sensors]]\nbeams = 90\nfield_of_view_deg = 360.0\nrange_m = 3.0\n";
    write(&folder, "my.toml", robot);
    let report = keyway(folder.path(), &format!("{SHORT} --robot my.toml --radius 0.15"));
    let inputs = report.expect_code(0).json()["inputs"].clone();
    assert_eq!(inputs["robot"]["sensors"][0]["beams"], 90);
    assert_eq!(inputs["robot"]["footprint"]["radius_m"], 0.15);
    // The stack is derived from the robot: radius plus one cycle at full speed.
    let clearance = inputs["config"]["map"]["clearance_m"].as_f64().unwrap();
    assert!((clearance - 0.23).abs() < 1e-12, "{clearance}");

    write(&folder, "bad.toml", &robot.replace("v_max_mps = 0.4", "v_max_mps = \"fast\""));
    let error = keyway(folder.path(), &format!("{SHORT} --robot bad.toml")).expect_code(2).json();
    let message = error["message"].as_str().unwrap();
    assert!(message.starts_with("bad.toml: line 5"), "{message}");
    assert!(message.contains("limits.v_max_mps"), "{message}");
    write(&folder, "bad.toml", &robot.replace("cycle_s = 0.2", "cycle_s = 0.0"));
    let error = keyway(folder.path(), &format!("{SHORT} --robot bad.toml")).expect_code(2).json();
    assert_eq!(error["field"], "cycle_s");
}

#[test]
fn demo_leaves_a_scene_that_can_be_driven_again() {
    let folder = tempfile::tempdir().unwrap();
    let demo = keyway(folder.path(), "demo").expect_code(0);
    let mut last = demo.out.trim_end().lines().rev();
    let next = last.next().and_then(|line| line.strip_prefix("keyway ")).unwrap().to_owned();
    assert!(last.next().unwrap().contains("map.png"), "{}", demo.out);
    // The proposal works.
    keyway(folder.path(), &next).expect_code(0);
    let listed: Vec<&str> =
        demo.out.lines().filter_map(|line| line.strip_prefix("wrote ")).collect();
    for line in &listed {
        assert!(folder.path().join(line).is_file(), "{line}");
    }
    // Hidden file lists of Keyway are not counted.
    let entries = std::fs::read_dir(folder.path().join("keyway-demo")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(listed.len(), names.filter(|name| !name.starts_with('.')).count());
    keyway(folder.path(), "demo").expect_code(0);
    let scene = "navigate --scene keyway-demo/small_house.toml --format json";
    let again = keyway(folder.path(), scene).expect_code(0).json();
    let mut first = read(&folder, "keyway-demo/report.json").parse::<Value>().unwrap();
    assert_eq!(first["files"], Value::from(listed));
    first["files"] = json!([]);
    assert_eq!(without_times(again), without_times(first));
}

#[test]
fn unknown_shapes_are_met_and_reported() {
    let folder = folder();
    // A box and two cells (of 0.05 m) without a detour in sight: the robot drives until it senses
    // them.
    let hall = "version = 2\nmap = \"walled.map\"\nstart = [1.5, 1.5]\ngoal = [5.5, 1.5]\n";
    let touched = |shape: &str, with: Value, reason: &str| {
        write(&folder, "shape.toml", &format!("{hall}[[unknown]]\n{shape}\n"));
        let line = "navigate --scene shape.toml --format json --out shape";
        let report = keyway(folder.path(), line).expect_code(1).json();
        assert_eq!(report["run"]["contact"]["with"], with, "{}", report["reason"]);
        assert!(report["reason"].as_str().unwrap().starts_with(reason), "{}", report["reason"]);
        read(&folder, "shape/map.svg")
    };
    // Around the start of the robot.
    let around = "vertices_m = [[1.2, 1.2], [1.8, 1.2], [1.8, 1.8], [1.2, 1.8]]";
    let svg = touched(around, json!({"polygon": 0}), "touched unknown polygon 0 at (1.500, 1.500)");
    assert!(svg.contains(">unknown obstacle<"));
    let svg =
        touched("cells = [[1, 1]]", json!("hidden_square"), "touched an unknown cell at (1.5");
    assert!(svg.contains(">unknown obstacle (cells)<"));
    write(&folder, "shape.toml", &format!("{hall}[[unknown]]\ncells = [[1, 99]]\n"));
    let error = keyway(folder.path(), "navigate --scene shape.toml --format json").expect_code(2);
    let error = error.json();
    assert_eq!(error["field"], "--scene");
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("`unknown[0].cells[0]` must be a cell of the map")
    );
}
