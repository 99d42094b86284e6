//! Tests of starts and goals: in one cell, in unknown space, and in separate components of the
//! map.

use crate::support::{folder, keyway, write};
use keyway::plan::PlannerConfig;
use keyway::smooth::SmootherConfig;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A square of 3 x 3 cells of 1 m.
fn square() -> TempDir {
    let folder = folder();
    write(&folder, "square.map", "type octile\nheight 3\nwidth 3\nmap\n...\n...\n...\n");
    folder
}

#[test]
fn in_one_cell_the_path_is_the_straight_line() {
    let folder = square();
    let line = "plan square.map --start 1.05,1.05 --planner theta-star --smoother taut --goal";
    let report = |goal: &str| {
        let line = format!("{line} {goal} --format json --curve c.csv");
        keyway(folder.path(), &line).expect_code(0).json()
    };
    let same = report("1.05,1.05");
    assert_eq!(same["waypoints_m"], json!([[1.05, 1.05]]));
    assert_eq!((&same["turns"], &same["smoothed"]["turns"]), (&json!(0), &json!(0)));
    for length in [&same["length_m"], &same["cost_cells"], &same["smoothed"]["length_m"]] {
        assert_eq!(length.as_f64().unwrap().to_bits(), 0, "{same}");
    }
    let beside = report("1.05,1.25");
    assert_eq!(beside["waypoints_m"], json!([[1.05, 1.05], [1.05, 1.25]]));
    assert!((beside["length_m"].as_f64().unwrap() - 0.2).abs() < 1e-12, "{beside}");
    let table = keyway(folder.path(), &format!("{line} 1.05,1.05")).expect_code(0).out;
    assert!(table.contains("0.000 m") && !table.contains("-0.0"), "{table}");
}

#[test]
fn in_one_cell_no_planner_and_no_smoother_makes_a_detour() {
    let folder = square();
    write(&folder, "q.csv", "1.05,1.05,1.05,1.05\n1.05,1.05,1.05,1.25\n");
    let names = |names: &[&str]| names.join(",");
    let line = format!(
        "compare square.map --pairs q.csv --planners {} --smoothers {} --out out",
        names(&PlannerConfig::NAMES),
        names(&SmootherConfig::NAMES)
    );
    keyway(folder.path(), &line).expect_code(0);
    let csv = crate::support::read(&folder, "out/queries.csv");
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let [length, turns] =
        ["length_m", "turns"].map(|wanted| header.iter().position(|name| *name == wanted).unwrap());
    let mut count = 0;
    for row in lines {
        let expected = if count % 2 == 0 { 0.0 } else { 0.2 };
        let found: f64 = row[length].parse().unwrap();
        assert!((found - expected).abs() < 1e-9 && !row[length].contains('-'), "{row:?}");
        assert_eq!(row[turns], "0", "{row:?}");
        count += 1;
    }
    assert_eq!(count, 2 * PlannerConfig::NAMES.len() * SmootherConfig::NAMES.len());
}

#[test]
fn a_robot_at_its_goal_has_arrived() {
    let line = "navigate square.map --start 1.05,1.05 --goal 1.05,1.05 --format json";
    let report = keyway(square().path(), line).expect_code(0).json();
    assert_eq!((&report["outcome"], &report["run"]["length_m"]), (&json!("reached"), &json!(0.0)));
    assert_eq!(report["plan"]["length_m"].as_f64().unwrap().to_bits(), 0);
}

/// Two rooms connected by a door of 3 cells of 0.3 m, and a third room beyond unknown space.
fn rooms() -> TempDir {
    let folder = folder();
    let row = |y: i32| -> String {
        let cell = |x: i32| match x {
            10 if !(3..=5).contains(&y) => '0',
            20 => '2',
            _ => '1',
        };
        (0..26).map(|x| cell(x).to_string() + " ").collect()
    };
    let cells: String = (0..9).map(|y| row(y) + "\n").collect();
    write(
        &folder,
        "rooms.pgm",
        &format!("P2\n26 9\n2\n{}", cells.replace('2', "z").replace('1', "2").replace('z', "1")),
    );
    let yaml = "image: rooms.pgm\nresolution: 0.3\norigin: [0, 0, 0]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    write(&folder, "rooms.yaml", yaml);
    folder
}

#[test]
fn no_path_says_which_radius_has_one() {
    let folder = rooms();
    let plan = |more: &str, code: i32| {
        let line =
            format!("plan rooms.yaml --start 1.35,1.35 --goal 4.65,1.35 {more} --format json");
        keyway(folder.path(), &line).expect_code(code).json()
    };
    let closed = plan("--radius 0.6", 1);
    let why = closed["why"].as_str().unwrap();
    assert!(
        why.contains(
            "for a radius of 0.6 m; the largest feasible radius is 0.45 m, limited by the clearance at"
        ),
        "{why}"
    );
    let largest = closed["largest_clearance_m"].as_f64().unwrap();
    assert!((largest - 0.45).abs() < 1e-9, "{closed}");
    assert!(closed["narrowest_cells"][0] == closed["narrowest_cells"][1], "{closed}");
    assert_eq!(plan("--radius 0.45", 0)["largest_clearance_m"], Value::Null);
    plan("--radius 0.451", 1);
    // The nearest one of several goals is explained.
    let several = plan("--goal 4.65,1.65 --radius 0.6", 1);
    assert!(several["why"].as_str().unwrap().contains("is 0.45 m"), "{several}");
}

#[test]
fn no_path_says_in_which_parts_the_ends_lie() {
    let folder = rooms();
    let plan = |more: &str| {
        let line =
            format!("plan rooms.yaml --start 1.35,1.35 --goal 7.2,1.35 {more} --format json");
        keyway(folder.path(), &line)
    };
    let apart = plan("").expect_code(1).json();
    let why = apart["why"].as_str().unwrap();
    assert!(why.contains("for any radius") && why.contains("of 174 and 45 cells"), "{why}");
    assert!(why.ends_with(
        "with --unknown free, paths may lead through unknown space, and such a path exists"
    ));
    assert_eq!(apart["largest_clearance_m"], Value::Null);
    plan("--unknown free").expect_code(0);
    let closed = "plan closed.map --start 1.5,0.5 --goal 5.5,0.5 --format json";
    let closed = keyway(folder.path(), closed).expect_code(1).json();
    let why = closed["why"].as_str().unwrap();
    assert!(why.contains("for any radius") && !why.contains("unknown"), "{why}");
}

/// Two rooms that touch at a corner of their cells; in the second map they do not.
#[test]
fn no_path_says_where_only_a_corner_has_to_be_cut() {
    let folder = folder();
    let map = |name: &str, row: &str| {
        write(
            &folder,
            name,
            &format!("type octile\nheight 4\nwidth 5\nmap\n..@..\n..@..\n{row}\n.....\n"),
        );
    };
    map("corner.map", "@@...");
    map("wall.map", "@@@..");
    let plan = |name: &str, more: &str, code| {
        let line = format!("plan {name} --start 1.5,2.5 --goal 4.5,0.5 {more} --format json");
        keyway(folder.path(), &line).expect_code(code).json()
    };
    for (more, advice) in [
        ("", "use --planner astar --set astar.corners=allow"),
        ("--planner astar4", "use --planner astar --set astar.corners=allow"),
        ("--planner theta-star", "add --set theta-star.corners=allow"),
    ] {
        let report = plan("corner.map", more, 1);
        let why = report["why"].as_str().unwrap();
        assert!(
            why.contains(
                "no path exists from the start to the goal for any radius without cutting corners"
            ),
            "{why}"
        );
        assert!(why.contains("of 4 and 12 cells, which touch only at corners of cells; "), "{why}");
        assert!(why.ends_with(advice), "{why}");
        let options = advice.split_once("--").unwrap().1;
        let followed = format!("{} --{options}", if advice.starts_with("add") { more } else { "" });
        assert_eq!(plan("corner.map", &followed, 0)["outcome"], "found");
    }
    let why = plan("wall.map", "", 1)["why"].to_string();
    assert!(why.contains("for any radius") && !why.contains("corner"), "{why}");
}

#[test]
fn unknown_space_is_no_obstacle() {
    let folder = rooms();
    let refused = |line: &str| keyway(folder.path(), line).expect_code(2).err;
    let inside = "plan rooms.yaml --start 1.35,1.35 --goal 6.15,1.35";
    let error = refused(inside);
    assert!(error.contains("is in unknown space, which counts as an obstacle"), "{error}");
    assert!(error.contains("; with --unknown free, paths may lead through"), "{error}");
    assert!(!error.contains("inside an obstacle"), "{error}");
    keyway(folder.path(), &format!("{inside} --unknown free")).expect_code(0);
    let near = refused("plan rooms.yaml --start 1.35,1.35 --goal 5.55,1.35 --radius 0.5");
    assert!(
        near.contains("from its centre, unknown space, which counts as an obstacle, is 0.450 m"),
        "{near}"
    );
    assert!(near.contains("--unknown free"), "{near}");
    write(&folder, "q.csv", "1.35,1.35,6.15,1.35\n");
    let compared = keyway(folder.path(), "compare rooms.yaml --pairs q.csv").expect_code(1).out;
    assert!(
        compared.contains("unknown space") && compared.contains("--unknown free"),
        "{compared}"
    );
    let robot = refused("navigate rooms.yaml --start 1.35,1.35 --goal 5.9,1.35");
    assert!(
        robot.contains("unknown space, which counts as an obstacle, is 0.100 m away"),
        "{robot}"
    );
    assert!(robot.contains("--unknown free"), "{robot}");
}

#[test]
fn a_robot_that_is_too_wide_says_what_would_fit() {
    let folder = rooms();
    let line = "navigate rooms.yaml --start 1.35,1.35 --goal 4.65,1.35 --radius 0.5 --format json";
    let report = keyway(folder.path(), line).expect_code(1).json();
    assert_eq!(report["outcome"], "no_path");
    let reason = report["reason"].as_str().unwrap();
    assert!(
        reason.starts_with("with the safety margin around the robot, no path exists"),
        "{reason}"
    );
    assert!(reason.contains("the largest feasible radius is 0.45 m, limited by"), "{reason}");
    assert_eq!(report["plan"]["why"], report["reason"]);
    let apart = line.replace("4.65,1.35", "7,1.35").replace("0.5", "0.2");
    let report = keyway(folder.path(), &apart).expect_code(1).json();
    assert!(report["reason"].as_str().unwrap().contains("for any radius"), "{report}");
}
