//! Tests that the documentation matches the program.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

fn doc(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
    std::fs::read_to_string(path).unwrap()
}

/// Names of all members, except those in a config or a robot, which `keyway list` explains, or in
/// a scene.
fn collect(value: &Value, names: &mut BTreeSet<String>) {
    for (name, value) in value.as_object().into_iter().flatten() {
        names.insert(name.clone());
        if !["config", "robot", "scene_file"].contains(&name.as_str()) {
            collect(value, names);
        }
    }
    value.as_array().into_iter().flatten().for_each(|item| collect(item, names));
}

/// Two robots, and an obstacle that gives way.
const TEAM: &str = "version = 2\n[world]\nwidth_m = 4\nheight_m = 3\nresolution_m = 0.1\n\
    [[robots]]\nstart = [0.5, 0.5]\ngoal = [1.5, 0.5]\n[[robots]]\nstart = [0.5, 2.5]\ngoal = [1.5, 2.5]\n\
    [[moving]]\nradius_m = 0.2\nway_points = [[3, 1], [3, 2]]\nspeed_mps = 0.5\ngives_way = true\n";

#[test]
fn every_member_of_every_report_is_documented() {
    let (folder, text) = (folder(), doc("reference/json.md"));
    let curve = "plan rooms.map --start 1.5,1.5 --goal 9.5,9.5 --curve c.json --spacing 1";
    keyway(folder.path(), curve).expect_code(0);
    let curve = read(&folder, "c.json").parse::<Value>().unwrap();
    let cycles = "navigate --scene small_house.toml --time-limit 0.2 --explain c.jsonl";
    keyway(folder.path(), cycles).expect_code(1);
    let cycle = read(&folder, "c.jsonl").lines().next().unwrap().parse::<Value>().unwrap();
    write(&folder, "barn.csv", "world,x,y,radius\n0,-2,8,0.1\n");
    keyway(folder.path(), "batch small_house.toml --out batch").expect_code(0);
    let run = read(&folder, "batch/runs.jsonl").parse::<Value>().unwrap();
    let times = read(&folder, "batch/times.jsonl").parse::<Value>().unwrap();
    for name in [&run, &times].into_iter().flat_map(|line| line.as_object().unwrap().keys()) {
        assert!(text.contains(&format!("`{name}`")), "{name} of a run in a batch");
    }
    write(&folder, "team.toml", TEAM);
    keyway(folder.path(), "batch small_house.toml --keep all --out kept").expect_code(0);
    let record = read(&folder, "kept/records/small_house.keyway.0.json");
    let record = record.parse::<Value>().unwrap();
    keyway(folder.path(), "navigate --scene small_house.toml --record run.mcap").expect_code(0);
    let mut reports = vec![(curve, "the curve"), (cycle, "a cycle"), (record, "a record")];
    write(&folder, "wrong.scen", "version 1\n0\twalled.map\t7\t5\t1\t4\t5\t4\t9.5\n");
    for line in [
        "plan rooms.map --start 1.5,1.5 --goal 9.5,9.5 --smoother line-of-sight --resolution 1",
        "plan rooms.map --start 1.5,1.5 --goal 9.5,9.5 --goal 1.5,1.5 --goal 99,1",
        "navigate --scene small_house.toml --time-limit 1",
        "navigate --scene team.toml",
        "navigate --scene small_house.toml --moving -8.175,-7.825,0.3,0,5 --moving 0,0,0.1,1:2,0",
        "compare rooms.map --queries 2",
        "bench grid wrong.scen",
        "bench scale walled.map --sides 20 --planner jps",
        "map info rooms.map",
        "prepare rooms.map --out rooms.prepared --if-it-pays=1000000",
        "list dwa",
        "batch small_house.toml --out batch",
        "batch merge batch --out merged",
        "replay kept/records/small_house.keyway.0.json",
        "replay run.mcap",
        "scene barn barn.csv --out barn",
        "reproduce S0-1 S0-4 --maps 2 --out reproduced",
        "reproduce S2-2 --ablations --maps 2 --no-times --out parts",
        "plan nowhere.map --start 1,1 --goal 2,2",
    ] {
        let report = keyway(folder.path(), &format!("{line} --format json")).json();
        reports.push((report, line));
    }
    for (report, line) in reports {
        let mut names = BTreeSet::new();
        collect(&report, &mut names);
        assert!(text.contains(&format!("## `{}`", report["schema"].as_str().unwrap())), "{line}");
        for name in names {
            let listed =
                text.contains(&format!("`{name}`")) || text.contains(&format!("\"{name}\""));
            assert!(listed, "{name} of {line}");
        }
    }
}

#[test]
fn every_column_of_the_answers_is_documented_in_its_order() {
    let (folder, text) = (folder(), doc("reference/json.md"));
    keyway(folder.path(), "compare rooms.map --queries 1 --out out").expect_code(0);
    let csv = read(&folder, "out/queries.csv");
    let (_, rest) = text.split_once("| column | unit |").unwrap();
    let lines = rest.lines().skip(2).take_while(|line| line.starts_with('|'));
    let names = lines.flat_map(|line| line.split('|').nth(1).unwrap().split(','));
    let names: Vec<&str> = names.map(|name| name.trim().trim_matches('`')).collect();
    assert_eq!(names.join(","), csv.lines().next().unwrap());
}

#[test]
fn the_files_of_the_scene_guide_can_be_used() {
    let folder = folder();
    let text = doc("scenes.md");
    let mut blocks = text.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let scene = blocks.next().unwrap();
    write(&folder, "scene.toml", scene);
    write(&folder, "movers.toml", &format!("{scene}{}", blocks.next().unwrap()));
    write(&folder, "shapes.toml", &format!("{scene}{}", blocks.next().unwrap()));
    write(&folder, "door.toml", &format!("{scene}{}", blocks.next().unwrap()));
    write(&folder, "robots.toml", blocks.next().unwrap());
    write(&folder, "rooms.toml", blocks.next().unwrap());
    write(&folder, "random.toml", &format!("{scene}{}", blocks.next().unwrap()));
    write(&folder, "disturbances.toml", blocks.next().unwrap());
    write(&folder, "few.toml", blocks.next().unwrap());
    write(&folder, "like.toml", blocks.next().unwrap());
    write(&folder, "robot.toml", blocks.next().unwrap());
    write(&folder, "safe.toml", blocks.next().unwrap());
    write(&folder, "config.toml", blocks.next().unwrap());
    assert_eq!(blocks.next(), None);
    let line = "navigate --scene scene.toml --robot robot.toml --config config.toml";
    keyway(folder.path(), line).expect_code(0);
    keyway(folder.path(), "navigate --scene scene.toml --config safe.toml").expect_code(0);
    keyway(folder.path(), "navigate --scene scene.toml --robot few.toml").expect_code(0);
    keyway(folder.path(), "navigate --scene scene.toml --robot like.toml").expect_code(0);
    // One run with all disturbances at once, which is unrealistic but sufficient here.
    let disturbed =
        format!("{line} --disturbances disturbances.toml --time-limit 0.1 --format json");
    let report = keyway(folder.path(), &disturbed).expect_code(1).json();
    assert_eq!(report["inputs"]["disturbances"]["sensor"]["range_m"], 0.02);
    assert_eq!(report["inputs"]["disturbances"]["localisation"]["velocity_is_zero"], true);
    let short = "navigate --scene door.toml --time-limit 0.1 --format json";
    let report = keyway(folder.path(), short).expect_code(1).json();
    assert_eq!(report["inputs"]["elusive"][0]["until_s"], 20.0);
    assert_eq!(report["inputs"]["elusive"][2]["seen"], 0.1);
    assert!(report["inputs"]["absent_cells"].as_array().unwrap().len() > 10);
    keyway(folder.path(), "navigate --scene robots.toml").expect_code(0);
    keyway(folder.path(), "navigate --scene rooms.toml").expect_code(0);
    let short = "navigate --scene movers.toml --time-limit 0.1 --format json";
    let report = keyway(folder.path(), short).expect_code(1).json();
    assert_eq!(report["outcome"], "timeout");
    assert_eq!(report["inputs"]["moving"].as_array().unwrap().len(), 6);
    let short = "navigate --scene shapes.toml --time-limit 0.1 --format json";
    let report = keyway(folder.path(), short).expect_code(1).json();
    assert_eq!(report["inputs"]["polygons"][0][1], json!([3.6, -2.1]));
    assert_eq!(report["inputs"]["hidden_cells"], json!([[40, 30], [41, 30]]));
    let short = "navigate --scene random.toml --time-limit 0.1 --format json";
    let report = keyway(folder.path(), short).expect_code(1).json();
    assert_eq!(report["inputs"]["random"]["unknown_placed"], json!(3));
}
