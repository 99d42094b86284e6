//! Tests of common mistakes, and of messages that suggest a correction.

use crate::support::{folder, keyway, write};

/// Checks that a line is refused, that the message contains all parts, and that the field is
/// blamed.
#[track_caller]
fn refused(folder: &tempfile::TempDir, line: &str, parts: &[&str], field: &str) {
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
    let message = report["message"].as_str().unwrap();
    for part in parts {
        assert!(message.contains(part), "{line}: {part}: {message}");
    }
    assert_eq!(report["field"], field, "{line}: {message}");
}

#[test]
fn numbers_that_are_too_small_are_told_what_is_allowed() {
    let folder = folder();
    let least = ["expected a whole number of at least 1"];
    for value in ["0", "-1", "many"] {
        let batch = format!("batch small_house.toml --jobs {value} --out batch");
        refused(&folder, &batch, &least, "--jobs");
        let claims = format!("reproduce S0-1 --jobs {value}");
        refused(&folder, &claims, &least, "--jobs");
        let seeds = format!("batch small_house.toml --seeds {value} --out batch");
        refused(&folder, &seeds, &["expected a whole number from 1 to 1000000"], "--seeds");
    }
    let pairs = "scene pairs pairs.csv --unknown 1001 --out pairs";
    refused(&folder, pairs, &["expected a whole number from 0 to 1000"], "--unknown");
    let pairs = "scene pairs pairs.csv --moving -1 --out pairs";
    refused(&folder, pairs, &["expected a whole number from 0 to 1000"], "--moving");
}

#[test]
fn what_a_scene_says_is_changed_in_its_file() {
    let folder = folder();
    let scene = "navigate --scene small_house.toml";
    for (option, field, instead) in [
        ("--start 1,1", "--start", "`start = [x, y]`"),
        ("--goal 1,1,90", "--goal", "`goal = [x, y]`"),
        ("--via 1,1", "--via", "`via = [[x, y]]`"),
        ("rooms.map", "[MAP]", "`map = \"FILE\"`"),
    ] {
        let parts = ["--scene", instead, "in the scene file"];
        refused(&folder, &format!("{scene} {option}"), &parts, field);
    }
}

#[test]
fn options_that_a_batch_does_not_have_are_explained() {
    let folder = folder();
    let batch = "batch small_house.toml --out batch";
    let parts = ["keyway batch has no --as-published", "keyway navigate --as-published"];
    refused(&folder, &format!("{batch} --as-published"), &parts, "--as-published");
    let parts = ["keyway batch has no --radius", "`radius_m = 0.22`"];
    refused(&folder, &format!("{batch} --radius 0.22"), &parts, "--radius");
    refused(&folder, "scene pairs pairs.csv --radius 0.22 --out x", &parts[1..], "--radius");
    // Other unknown options keep the parser's own message.
    refused(&folder, &format!("{batch} --stakcs keyway"), &["unexpected argument"], "--stakcs");
}

#[test]
fn numbers_that_are_separated_by_spaces_are_joined() {
    let folder = folder();
    for (options, meant) in [
        (
            "--start -8 -2 --goal 8,0",
            "--start -8 -2: separate the numbers by commas: --start -8,-2",
        ),
        ("--start 1,1 --goal -8 2.5 -90", "--goal -8 2.5 -90: separate"),
        ("--start -8.175 -2.825 --goal 1,1", "--start -8.175 -2.825: separate"),
        ("--start -2.5,1 --goal -2.825 -2.5", "--goal -2.825 -2.5: separate"),
    ] {
        let line = format!("navigate small_house.yaml {options}");
        let field = meant.split(' ').next().unwrap();
        refused(&folder, &line, &[meant], field);
        let text = keyway(folder.path(), &line).expect_code(2).err;
        assert!(text.starts_with(&format!("error: {meant}")), "{text}");
    }
}

#[test]
fn lists_of_names_are_taken_in_either_form() {
    let folder = folder();
    for [one, other] in [
        [
            "compare rooms.map --planners jps,astar --smoothers none,taut",
            "compare rooms.map --planner jps --planner astar --smoother none --smoother taut",
        ],
        [
            "bench grid rooms.map.scen --planners jps,astar --every 50",
            "bench grid rooms.map.scen --planner jps --planner astar --every 50",
        ],
    ] {
        let [one, other] = [one, other].map(|line| {
            let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0);
            let rows = report.json()["rows"].as_array().unwrap().clone();
            ["planner", "smoother"]
                .map(|name| rows.iter().map(|row| row[name].clone()).collect::<Vec<_>>())
        });
        assert!(one == other && one[0].len() > 1, "{one:?} {other:?}");
    }
    let batch = "batch small_house.toml --stack keyway --stack dwa-to-goal --out b --format json";
    let report = keyway(folder.path(), batch).expect_code(0).json();
    assert_eq!(report["stacks"].as_array().unwrap().len(), 2);
}

/// Both commands that read starts and goals know both spellings of the columns.
#[test]
fn columns_of_pairs_may_leave_out_the_unit() {
    let folder = folder();
    let pairs = |unit: &str| {
        let names = ["start_x", "start_y", "goal_x", "goal_y"].map(|name| format!("{name}{unit}"));
        format!("map,{}\nsmall_house.yaml,-8.175,-2.825,-4,-2.6\n", names.join(","))
    };
    let scenes = ["", "_m"].map(|unit| {
        write(&folder, "pairs.csv", &pairs(unit));
        keyway(folder.path(), "compare small_house.yaml --pairs pairs.csv").expect_code(0);
        let out = format!("scenes{unit}");
        keyway(folder.path(), &format!("scene pairs pairs.csv --out {out}")).expect_code(0);
        let mut scenes = std::fs::read_dir(folder.path().join(out)).unwrap();
        std::fs::read_to_string(scenes.next().unwrap().unwrap().path()).unwrap()
    });
    assert_eq!(scenes[0], scenes[1]);
}

#[test]
fn misspelt_names_are_recognised() {
    let folder = folder();
    let drive = "navigate --scene small_house.toml";
    for (options, meant, field) in [
        ("--stack keyawy", "keyway", "--stack"),
        ("--stack s0-keypoint", "s0-key-point", "--stack"),
        ("--robot jackel", "jackal", "--robot"),
        ("--robot Jackal", "jackal", "--robot"),
        ("--planner theta_star", "theta-star", "--planner"),
        ("--smoother tout", "taut", "--smoother"),
        ("--local dwaa", "dwa", "--local"),
        ("--set local.comfortabel_m=0.3", "comfortable_m", "local.comfortabel_m"),
        ("--set planer.corners=allow", "planner", "planer.corners"),
        ("--set controller.recoverys=[]", "recoveries", "controller.recoverys"),
        ("--stack stacked --as-published", "", "--stack"),
        ("--stack s0-keypoint --as-published", "s0-key-point", "--stack"),
    ] {
        let meant = match meant {
            "" => "must be one of".to_owned(),
            name => format!("; did you mean `{name}`?"),
        };
        refused(&folder, &format!("{drive} {options}"), &[&meant], field);
    }
    refused(&folder, "list jakcal", &["; did you mean `jackal`?"], "NAME");
    let papers = "scene papers you2012 --out papers";
    refused(&folder, papers, &["; did you mean `you2021`?"], "NAME");
    let columns = "compare rooms.map --columns lenght,turns";
    refused(&folder, columns, &["; did you mean `length`?"], "--columns");
    let far = keyway(folder.path(), &format!("{drive} --robot hal")).expect_code(2).err;
    assert!(!far.contains("did you mean"), "{far}");
}

#[test]
fn misspelt_fields_of_files_are_recognised() {
    let folder = folder();
    let scene = "version = 2\nmap = \"rooms.map\"\nstart = [1, 1]\ngaol = [9, 9]\n";
    write(&folder, "scene.toml", scene);
    refused(&folder, "navigate --scene scene.toml", &["; did you mean `goal`?"], "--scene");
    let robot = keyway(folder.path(), "list small").expect_code(0).out;
    write(&folder, "robot.toml", &robot.replace("cycle_s", "cycles_s"));
    let robot = "navigate --scene small_house.toml --robot robot.toml";
    refused(&folder, robot, &["`cycles_s`", "; did you mean `cycle_s`?"], "cycles_s");
    write(&folder, "over.toml", "[local]\nhorizons_s = 1.0\n");
    let over = "navigate --scene small_house.toml --config over.toml";
    refused(&folder, over, &["; did you mean `horizon_s`?"], "local.horizons_s");
    let stack = keyway(folder.path(), "list keyway").expect_code(0).out;
    write(&folder, "stack.toml", &stack.replace("\"key-points\"", "\"key-point\""));
    let stack = "navigate --scene small_house.toml --stack stack.toml";
    refused(&folder, stack, &["; did you mean `key-points`?"], "guide.name");
}

#[test]
fn a_folder_of_scenes_with_another_file_says_what_it_is() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("mixed")).unwrap();
    let stack = keyway(folder.path(), "list keyway").expect_code(0).out;
    write(&folder, "mixed/mine.toml", &stack);
    let parts = ["mine.toml: this is not a scene", "move the file to another folder"];
    refused(&folder, "batch mixed --out batch", &parts, "SCENE.toml");
    let parts = ["mine.toml: this is not a scene"];
    refused(&folder, "navigate --scene mixed/mine.toml", &parts, "--scene");
    write(&folder, "old.toml", "map = \"rooms.map\"\nstart = [1, 1]\ngoal = [9, 9]\n");
    let parts = ["missing field `version`", "`version = 2`"];
    refused(&folder, "navigate --scene old.toml", &parts, "--scene");
}
