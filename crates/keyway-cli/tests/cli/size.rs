//! Tests of the size of a robot: `--robot` and `--radius` in every command that plans a path.

use crate::support::{folder, keyway};
use serde_json::json;

const HOUSE: &str = "small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875";

#[test]
fn a_robot_gives_its_size_and_a_radius_counts_more() {
    let folder = folder();
    let plan = |more: &str| {
        let line = format!("plan {HOUSE} {more} --format json");
        keyway(folder.path(), &line).expect_code(0).json()
    };
    let clearance =
        |report: &serde_json::Value| report["inputs"]["config"]["map"]["clearance_m"].clone();
    let point = plan("");
    assert_eq!((clearance(&point), &point["inputs"]["robot"]), (json!(0.0), &json!(null)));
    let robot = plan("--robot small");
    assert_eq!(
        (clearance(&robot), &robot["inputs"]["robot"]["footprint"]["radius_m"]),
        (json!(0.18), &json!(0.18))
    );
    assert!(robot["min_clearance_m"].as_f64().unwrap() >= 0.18 - 1e-9, "{robot}");
    let both = plan("--robot jackal --radius 0.1");
    let footprint = &both["inputs"]["robot"]["footprint"];
    assert_eq!((clearance(&both), footprint), (json!(0.1), &json!({ "radius_m": 0.1 })));
    // For a polygon, the inscribed disc is used.
    assert_eq!(clearance(&plan("--robot jackal")), 0.215);
    assert_eq!(both["inputs"]["robot"]["cycle_s"], json!(0.05));
    // A single parameter takes precedence over options.
    assert_eq!(clearance(&plan("--robot small --set map.clearance_m=0.05")), 0.05);
    // Without a robot, the speeds of a curve are those of the default robot, and the size is that
    // of a point.
    let curve = plan("--curve c.json");
    assert_eq!(clearance(&curve), 0.0);
}

#[test]
fn every_command_that_plans_takes_a_robot() {
    let folder = folder();
    let run = |line: &str| keyway(folder.path(), line).expect_code(0).json();
    let prepared = run("prepare small_house.yaml --robot small --out p --format json");
    assert_eq!(prepared["config"]["clearance_m"], 0.18);
    let plan = format!("plan {HOUSE} --prepared p --robot small --format json");
    assert_eq!(run(&plan)["planner"], "prepared");
    let compared = run("compare small_house.yaml --queries 1 --robot small --format json");
    assert_eq!(compared["config"]["map"]["clearance_m"], 0.18);
    let scale = |more: &str| {
        let line = format!("bench scale walled.map --sides 14 {more} --format json");
        run(&line)["rows"][0]["cost_cells"].as_f64().unwrap()
    };
    assert!(scale("--radius 0.6") < scale(""), "from farther inside");
    assert!(scale("--robot jackal --radius 0.6") < scale("--robot jackal"));
}
