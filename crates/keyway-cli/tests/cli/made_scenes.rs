//! Tests of `keyway scene`: benchmark worlds, and rows of positions, as scenes.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use tempfile::TempDir;

#[test]
fn worlds_of_barn_become_scenes() {
    let folder = folder();
    write(&folder, "c.csv", "world,x,y,radius\n7,-2.0,8.0,0.075\n7,-2.5,9.0,0.1\n3,0,5,0.075\n");
    write(&folder, "s.csv", "world,cylinders,optimal_time_s\n7,2,5.5\n");
    let line = "scene barn c.csv --summary s.csv --out barn --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let files = json!(["barn/barn_003.toml", "barn/barn_007.toml"]);
    assert_eq!((&report["schema"], &report["files"]), (&json!("keyway.scene/1"), &files));
    let run = keyway(folder.path(), "navigate --scene barn/barn_007.toml --format json");
    let run = run.expect_code(0).json();
    assert_eq!(run["inputs"]["obstacles"], json!([[-2.0, 8.0, 0.075], [-2.5, 9.0, 0.1]]));
    assert_eq!(run["inputs"]["start"], json!([-2.25, 3.0, 90.0]));
    assert_eq!(run["inputs"]["arrival"], "passing");
    // 9 m to the rim of the goal, which is passed at speed.
    assert!(run["run"]["time_s"].as_f64().unwrap() < 6.5, "{}", run["run"]);
    let batch = keyway(folder.path(), "batch barn --out out --format json").expect_code(0).json();
    assert_eq!((&batch["runs"], &batch["stacks"][0]["mean_score"]), (&json!(2), &json!(0.5)));
    // With the cylinders on the map, all 20 m x 20 m are the same except for cells within 7.5 and
    // 10 cm.
    let line = "scene barn c.csv --known --out known";
    keyway(folder.path(), line).expect_code(0);
    let run = keyway(folder.path(), "navigate --scene known/barn_known_007.toml --format json");
    let run = run.expect_code(0).json();
    assert_eq!(run["inputs"]["obstacles"], json!([]));
    let clearance_m = run["run"]["min_standing_clearance_m"].as_f64().unwrap();
    assert!(clearance_m < 1.0, "{clearance_m}");
    let line = "scene barn c.csv --summary s.csv --out barn --format json";
    write(&folder, "c.csv", "world,x,y\n7,-2.0,8.0\n");
    let error = keyway(folder.path(), line).expect_code(2).json();
    let message = error["message"].as_str().unwrap();
    assert!(message.starts_with("c.csv: line 1: the header has no column `radius`"), "{message}");
}

#[test]
fn worlds_of_dynabarn_become_scenes() {
    let folder = folder();
    // One cylinder crosses ahead of the robot when it arrives, one stays beside the path and
    // jumps.
    let frames =
        "plugin,duration_s,repeat,t,x,y\nb,9.5,1,0,0,-5\nb,9.5,1,4,0,5\na,4,1,0,5,5\na,4,1,4,6,5\n";
    write(&folder, "k.csv", frames);
    write(&folder, "w.csv", "world,plugin,radius\n12,a,0.5\n12,b,0.4\n4,a,0.5\n");
    let line = "scene dynabarn k.csv --worlds w.csv --out dyna --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let files = json!(["dyna/dynabarn_004.toml", "dyna/dynabarn_012.toml"]);
    assert_eq!((&report["schema"], &report["files"]), (&json!("keyway.scene/1"), &files));
    let run = keyway(folder.path(), "navigate --scene dyna/dynabarn_012.toml --format json").json();
    let inputs = &run["inputs"];
    assert_eq!(
        (&inputs["start"], &inputs["goal"]),
        (&json!([11.0, 0.0, 180.0]), &json!([-9.0, 0.0]))
    );
    assert_eq!((&inputs["arrival"], &inputs["time_limit_s"]), (&json!("passing"), &json!(100.0)));
    assert_eq!(inputs["goal_tolerance_m"], json!(1.0));
    assert_eq!(inputs["robot"]["limits"]["v_max_mps"], json!(2.0));
    let spline = json!([[0.0, 0.0, -5.0], [4.0, 0.0, 5.0]]);
    let mover = json!({"radius_m": 0.4, "spline": spline, "duration_s": 9.5});
    assert_eq!(inputs["moving"][1], mover);
    let wall = |x0, y0, x1, y1| json!([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
    let walls = [
        wall(-10.25, -10.0, -9.75, 10.0),
        wall(-10.0, 9.75, 10.0, 10.25),
        wall(-10.0, -10.25, 10.0, -9.75),
    ];
    assert_eq!(inputs["polygons"], json!(walls));
    assert!(read(&folder, "dyna/dynabarn_012.toml").contains("reference_time_s = 10.0"));
    let refused = |expected: &str| {
        let error = keyway(folder.path(), line).expect_code(2).json();
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(expected), "{message}");
    };
    write(&folder, "w.csv", "world,plugin,radius\n12,c,0.5\n");
    refused("world 12: `c` has no key frames");
    write(&folder, "w.csv", "world,plugin,radius\n12,a,0.5\n");
    write(&folder, "k.csv", "plugin,duration_s,t,x,y\na,4,0,5,5\na,4,0,6,5\n");
    refused("world 12, `a`: spline[1].t_s must be later");
}

#[test]
fn pairs_become_scenes_with_other_obstacles_for_each_seed() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let pairs = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\n../small_house.yaml,-8.175,-2.825,8.725,0.875\n\
                 ../small_house.yaml,-8.175,-2.825,-5.5,-2.8\n";
    write(&folder, "data/pairs.csv", pairs);
    let line = "scene pairs data/pairs.csv --unknown 2 --moving 1 --out made/pairs --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let files = json!(["made/pairs/000_small_house.toml", "made/pairs/001_small_house.toml"]);
    assert_eq!(report["files"], files);
    let scene = read(&folder, "made/pairs/000_small_house.toml");
    assert!(scene.contains("map = \"../../small_house.yaml\""), "{scene}");
    let line = "navigate --scene made/pairs/000_small_house.toml --time-limit 0.1 --format json";
    let inputs = &keyway(folder.path(), line).json()["inputs"];
    assert_eq!(inputs["obstacles"].as_array().unwrap().len(), 2);
    assert_eq!(inputs["moving"].as_array().unwrap().len(), 1);
    let placed =
        json!({"unknown_asked": 2, "unknown_placed": 2, "moving_asked": 1, "moving_placed": 1});
    assert_eq!(inputs["random"], placed);
    let other = scene.replacen("version = 2", "version = 2\nseed = 1", 1);
    write(&folder, "made/pairs/000_small_house.toml", &other);
    let again = &keyway(folder.path(), line).json()["inputs"];
    assert_ne!(again["obstacles"], inputs["obstacles"]);
    // Obstacles that find no space are reported.
    let wide = scene.replacen("free_ends_m = 0.5", "free_ends_m = 100.0", 1);
    write(&folder, "wide.toml", &wide.replace("../../small", "small"));
    let short = "navigate --scene wide.toml --time-limit 0.1";
    let warned = keyway(folder.path(), short).err;
    assert!(warned.contains("for 3 of the random obstacles"), "{warned}");
    write(
        &folder,
        "wide.toml",
        &format!("{}\n[rules]\ntime_limit_s = 0.1\n", wide.replace("../../small", "small")),
    );
    keyway(folder.path(), "batch wide.toml --out wide").expect_code(0);
    assert_eq!(read(&folder, "wide/runs.jsonl").parse::<Value>().unwrap()["left_out"], json!(3));
    // A robot file of the user is found from the scenes' folder, too.
    let robot = keyway(folder.path(), "list small").expect_code(0).out;
    write(&folder, "mine.toml", &robot);
    let line = "scene pairs data/pairs.csv --robot mine.toml --out own";
    keyway(folder.path(), line).expect_code(0);
    let scene = read(&folder, "own/001_small_house.toml");
    assert!(scene.contains("robot = \"../mine.toml\"") && !scene.contains("random"), "{scene}");
    let batch = keyway(folder.path(), "batch own/001_small_house.toml --out out").expect_code(0);
    assert!(!batch.err.contains("error"), "{}", batch.err);
    write(&folder, "data/pairs.csv", &pairs.replace("../small_house.yaml", "none.yaml"));
    let error = keyway(folder.path(), line).expect_code(2);
    assert!(
        error.err.contains("pair 0, counted from 0: there is no map data/none.yaml"),
        "{}",
        error.err
    );
    // A pair that is given twice would be one run that counts as two.
    let first = pairs.lines().nth(1).unwrap();
    write(&folder, "data/pairs.csv", &format!("{pairs}{first}\n"));
    let error = keyway(folder.path(), line).expect_code(2);
    assert!(error.err.contains("are the same: give each pair once"), "{}", error.err);
}

/// On the scenes of the repository, A* has the published length, and the command writes the same
/// scenes.
#[test]
fn maps_of_papers_become_scenes() {
    let folder = folder();
    let line = "scene papers --out made --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let files = report["files"].as_array().unwrap();
    assert!(files.len() >= 90 && files.len().is_multiple_of(30), "{}", files.len());
    let kept = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/reconstructed");
    for file in files {
        let name = file.as_str().unwrap();
        let own = std::fs::read_to_string(kept.join(name.strip_prefix("made/").unwrap())).unwrap();
        assert_eq!(read(&folder, name), own, "{name}");
    }
    assert_eq!(std::fs::read_dir(kept).unwrap().count(), files.len());
    let first = files.iter().find(|file| file.as_str().unwrap().contains("/you2021_")).unwrap();
    let line = format!(
        "navigate --scene {} --stack dijkstra-follow --as-published --format json",
        first.as_str().unwrap()
    );
    let run = keyway(folder.path(), &line).json();
    assert_eq!(run["inputs"]["start"][0], 0.5);
    let text = read(&folder, first.as_str().unwrap());
    assert!(text.contains("29.213 m = 8 + 15 sqrt(2)") && text.contains("30.870 m"), "{text}");
    let error = keyway(folder.path(), "scene papers nobody --out x").expect_code(2).err;
    assert!(error.contains("expected one of you2021, s1"), "{error}");
}

/// A bay in which the robot has to end facing out: it backs in.
#[test]
fn narrow_places_are_made_by_seed() {
    let folder = folder();
    let line = "scene narrow bay --seed 15 --count 2 --out n --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    assert_eq!(report["files"], json!(["n/bay_00015.toml", "n/bay_00016.toml"]));
    keyway(folder.path(), "scene narrow bay --seed 9 --count 1 --out n").expect_code(0);
    // The last robot can turn partly at several positions in its bay, but nowhere fully.
    for seed in ["15", "16", "09"] {
        let line = format!("navigate --scene n/bay_000{seed}.toml --format json");
        let run = keyway(folder.path(), &line).expect_code(0).json();
        assert_eq!(run["outcome"], json!("reached"), "{seed}");
        assert_eq!(run["run"]["recoveries"]["manoeuvre"], json!(0), "{seed}");
    }
    // Robots without a reverse gear, which could not get out again if they entered at an angle.
    for scene in ["door_00002", "door_00019", "tunnel_00006"] {
        let run = driven(&folder, scene);
        assert_eq!(run["outcome"], json!("reached"), "{scene}");
        // Two of them need a manoeuvre to enter.
        let is_led = run["run"]["recoveries"]["manoeuvre"].as_u64().unwrap() > 0;
        assert_eq!(is_led, scene != "door_00019", "{scene}");
    }
    let error = keyway(folder.path(), "scene narrow bey --out n --format json");
    let error = error.expect_code(2).json();
    let message = error["message"].as_str().unwrap();
    assert!(message.ends_with("did you mean `bay`?"), "{message}");
}

/// Drives a scene of a kind and a seed, such as `door_00002`.
fn driven(folder: &TempDir, scene: &str) -> Value {
    let (kind, seed) = scene.split_once('_').unwrap();
    let line = format!("scene narrow {kind} --seed {seed} --count 1 --out n");
    keyway(folder.path(), &line).expect_code(0);
    keyway(folder.path(), &format!("navigate --scene n/{scene}.toml --format json")).json()
}

/// Passages with their middle between two rows of cells: no cell centre has the clearance that
/// the robot needs.
#[test]
fn passages_between_cells_are_driven() {
    let folder = folder();
    for scene in ["lane_07010", "tunnel_07002", "tunnel_07004"] {
        let run = driven(&folder, scene);
        assert_eq!(run["outcome"], json!("reached"), "{scene}");
        let clearance_m = run["run"]["min_clearance_m"].as_f64().unwrap();
        assert!(clearance_m > 0.0, "{scene}: {clearance_m}");
    }
    // This one is as wide as the robot, but narrower than the robot with its margin.
    assert_eq!(driven(&folder, "door_07010")["outcome"], json!("no_path"));
}
