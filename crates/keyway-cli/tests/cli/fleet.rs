//! Tests of several robots in one world: scenes with `[[robots]]`.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

/// A scene of the project, with its map.
fn scenes() -> TempDir {
    let folder = folder();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/fleet");
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    folder
}

fn driven(folder: &TempDir, arguments: &str, code: i32) -> Value {
    let line = format!("navigate {arguments} --format json");
    let report = keyway(folder.path(), &line).expect_code(code).json();
    assert_eq!(report["schema"], "keyway.team/1");
    report
}

/// The outcome of every robot.
fn outcomes(report: &Value) -> Vec<&str> {
    let outcomes: Vec<&str> =
        report["outcomes"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    let each = report["robots"].as_array().unwrap();
    assert!(each.iter().map(|robot| robot["outcome"].as_str().unwrap()).eq(outcomes.clone()));
    outcomes
}

/// The robots also pass in mirror images of each other's situations, and where only one has
/// space.
#[test]
fn robots_with_the_usual_stack_get_past_each_other() {
    let folder = scenes();
    for (scene, make_way) in [
        ("crossing", false),
        ("doorway", false),
        ("circle_swap", false),
        ("corridor", true),
        ("bay", true),
    ] {
        let report = driven(&folder, &format!("--scene {scene}.toml"), 0);
        assert!(outcomes(&report).iter().all(|&outcome| outcome == "reached"), "{scene}");
        assert!(report["min_robot_clearance_m"].as_f64() > Some(0.03), "{scene}");
        let robots = report["robots"].as_array().unwrap().iter();
        let ways = robots.map(|robot| robot["run"]["recoveries"]["make_way"].as_u64().unwrap());
        assert_eq!(ways.sum::<u64>() > 0, make_way, "{scene}");
    }
    let line = "--scene corridor.toml --set controller.make_way=false";
    assert_eq!(outcomes(&driven(&folder, line, 1)), ["stuck"; 2], "otherwise it shows nothing");
}

/// The outcomes document today's behaviour of the stacks; none is a requirement.
#[test]
fn what_becomes_of_the_robots_of_the_scenes() {
    let folder = scenes();
    for (scene, stack, expected) in [
        // Both give way to the same side, for more than a minute.
        ("crossing", "key-point-fusion", vec!["reached"; 2]),
        ("crossing", "s0-key-point", vec!["stuck"; 2]),
        ("crossing", "s4-guided", vec!["collided"; 2]),
        ("doorway", "key-point-fusion", vec!["reached"; 2]),
        ("doorway", "s1-adaptive", vec!["reached"; 2]),
        ("corridor", "key-point-fusion", vec!["reached"; 2]),
        ("corridor", "s1-adaptive", vec!["reached"; 2]),
        // The stack does not avoid moving obstacles.
        ("corridor", "s4-guided", vec!["collided"; 2]),
        ("circle_swap", "key-point-fusion", vec!["reached"; 6]),
        ("circle_swap", "s4-guided", vec!["collided"; 6]),
    ] {
        let code = i32::from(expected.iter().any(|&one| one != "reached"));
        let report = driven(&folder, &format!("--scene {scene}.toml --stack {stack}"), code);
        assert_eq!(outcomes(&report), expected, "{scene}, {stack}");
        let least_m = report["min_robot_clearance_m"].as_f64().unwrap();
        assert_eq!(least_m > 0.0, !expected.contains(&"collided"), "{scene}, {stack}: {least_m}");
        let ends_s = report["robots"].as_array().unwrap().iter();
        let last_s = ends_s.map(|robot| robot["run"]["time_s"].as_f64().unwrap());
        let makespan_s = (code == 0).then(|| last_s.fold(0.0, f64::max));
        assert_eq!(report["makespan_s"], json!(makespan_s), "{scene}, {stack}");
    }
}

#[test]
fn each_robot_is_reported_with_its_own_inputs() {
    let folder = scenes();
    let scene = read(&folder, "doorway.toml").replacen(
        "goal = [6.5, 2.0]",
        "goal = [6.5, 2.0, 90.0]\nvia = [[3.0, 2.0]]\nstack = \"s0-key-point\"\nrobot = \"small.toml\"",
        1,
    );
    write(&folder, "small.toml", &keyway(folder.path(), "list small").out);
    write(&folder, "mixed.toml", &scene);
    let line = "--scene mixed.toml --obstacle 3,3.5,0.1 --moving 7,0.5,0.1,0,0.01 --time-limit 4";
    let report = driven(&folder, &format!("{line} --set controller.goal_tolerance_m=0.12"), 1);
    assert_eq!(outcomes(&report), ["timeout"; 2]);
    let inputs = |index: usize| &report["robots"][index]["inputs"];
    assert_eq!(
        (&inputs(0)["stack"], &inputs(1)["stack"]),
        (&json!("s0-key-point"), &json!("keyway"))
    );
    assert_eq!(inputs(0)["goal"], json!([6.5, 2.0, 90.0]));
    assert_eq!((&inputs(0)["via"], &inputs(1)["via"]), (&json!([[3.0, 2.0]]), &Value::Null));
    for index in [0, 1] {
        assert_eq!(inputs(index)["obstacles"], json!([[3.0, 3.5, 0.1]]));
        assert_eq!(inputs(index)["moving"][0]["radius_m"], 0.1);
        assert_eq!(inputs(index)["time_limit_s"], 4.0);
        assert_eq!(inputs(index)["config"]["controller"]["goal_tolerance_m"], 0.12);
    }
    let all =
        driven(&folder, "--scene mixed.toml --stack dwa-to-goal --time-limit 1 --radius 0.1", 1);
    for robot in all["robots"].as_array().unwrap() {
        assert_eq!(robot["inputs"]["stack"], "dwa-to-goal");
        assert_eq!(robot["inputs"]["robot"]["footprint"], json!({"radius_m": 0.1}));
    }
}

#[test]
fn the_files_show_all_robots() {
    let folder = scenes();
    let line = "navigate --scene crossing.toml --out out --animate drive.gif --time-limit 3";
    let output = keyway(folder.path(), line).expect_code(1);
    for text in ["reached                   0 of 2", "robot 1: the time limit of 3.0 s passed"] {
        assert!(output.out.contains(text), "{}", output.out);
    }
    let names = ["report.json", "map.svg", "map.png", "speed.svg", "speed.png", "trajectory.csv"];
    for name in names {
        assert!(output.out.contains(&format!("wrote out/{name}")), "{}", output.out);
    }
    assert!(output.out.contains("wrote drive.gif"));
    assert!(std::fs::read(folder.path().join("drive.gif")).unwrap().starts_with(b"GIF89a"));
    let report: Value = read(&folder, "out/report.json").parse().unwrap();
    let csv = read(&folder, "out/trajectory.csv");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("robot,t_s,x_m,y_m,yaw_rad,v_mps,omega_radps"));
    let of = |index: usize| report["robots"][index]["trajectory"].as_array().unwrap().len();
    let count = |index: &str| csv.lines().filter(|line| line.starts_with(index)).count();
    assert_eq!((count("0,"), count("1,")), (of(0), of(1)));
    let map = read(&folder, "out/map.svg");
    for text in ["robot 0, keyway", "robot 1, keyway", "robot at a time [s]"] {
        assert!(map.contains(text), "{text}");
    }
    // Dashes, and numbers at both ends, distinguish the robots without colours.
    assert!(map.contains("stroke-dasharray=\"6 2.5\""));
    assert!(map.matches(">0</text>").count() >= 2 && map.matches(">1</text>").count() >= 2);
    assert!(read(&folder, "out/speed.svg").contains(">robot 1</text>"));
}

#[test]
fn what_no_map_shows_is_drawn_and_reported() {
    let folder = scenes();
    let shapes = "[[unknown]]\nvertices_m = [[0.4, 0.4], [0.9, 0.4], [0.6, 0.8]]\n[[unknown]]\ncells = [[2, 50]]\n";
    write(&folder, "shapes.toml", &format!("{}\n{shapes}", read(&folder, "crossing.toml")));
    keyway(folder.path(), "navigate --scene crossing.toml --time-limit 0.1 --out bare")
        .expect_code(1);
    let report = driven(&folder, "--scene shapes.toml --time-limit 0.1 --out out", 1);
    for robot in report["robots"].as_array().unwrap() {
        assert_eq!(robot["inputs"]["polygons"], json!([[[0.4, 0.4], [0.9, 0.4], [0.6, 0.8]]]));
        assert_eq!(robot["inputs"]["hidden_cells"], json!([[2, 50]]));
    }
    let (bare, shown) = (read(&folder, "bare/map.svg"), read(&folder, "out/map.svg"));
    for legend in [">unknown obstacle<", ">unknown obstacle (cells)<"] {
        assert!(shown.contains(legend) && !bare.contains(legend), "{legend}");
    }
}

#[test]
fn a_robot_that_stands_without_a_route_is_drawn_where_it_is() {
    let folder = scenes();
    let walls = read(&folder, "doorway.toml").replace("doorway.yaml", "walled.yaml");
    write(&folder, "walled.toml", &walls);
    write(&folder, "walled.yaml", &read(&folder, "doorway.yaml").replace("doorway", "walled"));
    let rows = read(&folder, "doorway.pgm");
    let rows: Vec<String> = rows
        .lines()
        .map(|line| {
            let mut cells: Vec<&str> = line.split(' ').collect();
            if cells.len() == 80 {
                (cells[39], cells[40]) = ("0", "0");
            }
            cells.join(" ")
        })
        .collect();
    write(&folder, "walled.pgm", &rows.join("\n"));
    let report = driven(&folder, "--scene walled.toml --out out --animate drive.gif", 1);
    assert_eq!(outcomes(&report), ["no_path"; 2]);
    assert_eq!(report["min_robot_clearance_m"], Value::Null);
    let names: Vec<&str> =
        report["files"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    assert_eq!(names, ["out/report.json", "out/map.svg", "out/map.png"]);
}

#[test]
fn what_cannot_be_driven_is_refused_with_the_robot_and_its_field() {
    let folder = scenes();
    let refused = |line: &str| {
        let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        let text = |name: &str| report[name].as_str().unwrap_or_default().to_owned();
        (text("field"), text("message"))
    };
    for option in ["--fan 1 --out out", "--explain why.jsonl"] {
        let (field, message) = refused(&format!("navigate --scene crossing.toml {option}"));
        assert!(option.starts_with(&field) && message.contains("of a single robot"), "{message}");
    }
    let crossing = read(&folder, "crossing.toml");
    let with = |from: &str, to: &str| {
        write(&folder, "bad.toml", &crossing.replacen(from, to, 1));
        refused("navigate --scene bad.toml")
    };
    let (field, message) = with("goal = [3.0, 5.0]", "goal = [3.0, 7.0]");
    assert_eq!(field, "robots[1].goal");
    assert!(message.starts_with("robot 1: "), "{message}");
    let (field, message) = with("goal = [3.0, 5.0]", "goal = [3.0, 5.0]\nrobot = \"jackal\"");
    assert_eq!(field, "robot.cycle_s");
    assert!(message.starts_with("robot 1: ") && message.contains("cycle of robot 0"), "{message}");
    let (field, message) = with("version = 2", "version = 2\nstart = [1.0, 1.0]");
    assert_eq!(field, "--scene");
    assert!(message.contains("either `start` and `goal` or `[[robots]]`"), "{message}");
    let (field, message) = with("[[robots]]", "[[unknown]]\ncells = [[1, 900]]\n[[robots]]");
    assert_eq!(field, "--scene");
    assert!(message.contains("`unknown[0].cells[0]` must be a cell of the map"), "{message}");
    let (_, message) = with("goal = [3.0, 5.0]", "goal = [3.0, 5.0]\nstack = \"none-such\"");
    assert!(message.contains("there is no stack `none-such`"), "{message}");
}

/// As many obstacles as find space, near the paths of all robots; the report of each robot lists
/// them.
#[test]
fn random_obstacles_are_those_of_the_seed() {
    let folder = scenes();
    let random = "[random.unknown]\ncount = 2\nradius_m = [0.1, 0.2]\n[random.moving]\ncount = 1\nradius_m = [0.2, 0.2]\n\
        speed_mps = [0.3, 0.5]\n[[robots]]";
    write(
        &folder,
        "random.toml",
        &read(&folder, "crossing.toml").replacen("[[robots]]", random, 1),
    );
    let inputs = |options: &str| {
        let report = driven(&folder, &format!("--scene random.toml --time-limit 0.1 {options}"), 1);
        let of = |robot: &Value| {
            let inputs = &robot["inputs"];
            ["obstacles", "moving", "random"].map(|name| inputs[name].clone())
        };
        let all: Vec<_> = report["robots"].as_array().unwrap().iter().map(of).collect();
        assert!(all.iter().all(|one| *one == all[0]));
        all[0].clone()
    };
    let first = inputs("");
    assert_eq!(first[0].as_array().unwrap().len(), 2);
    assert_eq!(first[1].as_array().unwrap().len(), 1);
    assert_eq!(
        first[2],
        json!({"unknown_asked": 2, "unknown_placed": 2, "moving_asked": 1, "moving_placed": 1})
    );
    assert_eq!(inputs("--stack s0-key-point"), first);
    assert_ne!(inputs("--seed 3")[0], first[0]);
    let crowded =
        random.replace("[random.unknown]", "[random]\nfree_ends_m = 50.0\n[random.unknown]");
    write(
        &folder,
        "crowded.toml",
        &read(&folder, "crossing.toml").replacen("[[robots]]", &crowded, 1),
    );
    let warned = keyway(folder.path(), "navigate --scene crowded.toml --time-limit 0.1").err;
    assert!(warned.contains("for 3 of the random obstacles"), "{warned}");
}

/// A hall with a walker that moves to and fro across the robot's path.
const WALKER: &str = "version = 2\nstart = [0.7, 2.0, 0.0]\ngoal = [7.3, 2.0]\n[world]\nwidth_m = 8\nheight_m = 4\n\
    resolution_m = 0.1\n[[moving]]\nradius_m = 0.25\nway_points = [[6.0, 2.0], [2.0, 2.0]]\nspeed_mps = 0.5\nto_and_fro = true\n";

#[test]
fn an_obstacle_that_gives_way_is_reported_and_drawn_where_it_went() {
    let folder = folder();
    let run = |name: &str, text: &str| {
        write(&folder, name, text);
        let line = format!("navigate --scene {name} --out out --time-limit 12 --format json");
        keyway(folder.path(), &line).json()
    };
    let stubborn = run("stubborn.toml", WALKER);
    assert!(stubborn["run"].get("gave_way").is_none());
    let polite = run("polite.toml", &format!("{WALKER}gives_way = true\n"));
    assert_eq!(polite["inputs"]["moving"][0]["gives_way"], true);
    let ways = polite["run"]["gave_way"].as_array().unwrap();
    assert_eq!((ways.len(), &ways[0]["index"]), (1, &json!(0)));
    let frames = ways[0]["key_frames"].as_array().unwrap();
    assert_eq!(
        (frames.len(), &frames[0]),
        (polite["trajectory"].as_array().unwrap().len(), &json!([0.0, 6.0, 2.0]))
    );
    // The obstacle leaves its straight line.
    let aside_m = frames.iter().map(|frame| (frame[2].as_f64().unwrap() - 2.0).abs());
    assert!(aside_m.fold(0.0, f64::max) > 0.2);
    // A stationary obstacle has a single mark for all times.
    assert!(!read(&folder, "out/map.svg").contains("2 \u{2026} 12"));
    assert_eq!(polite["outcome"], "timeout");
    assert!(polite["run"]["min_mover_clearance_m"].as_f64() > Some(0.0));
}
