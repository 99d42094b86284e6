//! Tests of the published schema of scene files: it accepts all existing scenes, and refuses
//! files of a form that the program refuses.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn schema() -> Value {
    keyway(Path::new("."), "scene schema").expect_code(0).json()
}

/// The first fault of a value, if any. It knows the keywords that the schema uses, and fails on
/// any other: none is ignored.
fn fault(root: &Value, schema: &Value, value: &Value, at: &str) -> Option<String> {
    let Some(keywords) = schema.as_object() else {
        return (schema != &json!(true)).then(|| format!("{at}: not allowed"));
    };
    let check = |(name, rule): (&String, &Value)| fault_of(root, keywords, (name, rule), value, at);
    keywords.iter().find_map(check)
}

fn fault_of(
    root: &Value,
    keywords: &serde_json::Map<String, Value>,
    (name, rule): (&str, &Value),
    value: &Value,
    at: &str,
) -> Option<String> {
    let rules = || rule.as_array().into_iter().flatten();
    let items = || value.as_array().into_iter().flatten();
    let members = || value.as_object().into_iter().flatten();
    let valid = |schema: &Value| fault(root, schema, value, at).is_none();
    let is_right = match name {
        "$schema" | "$defs" | "title" | "description" | "default" | "format" => true,
        "$ref" => {
            let pointer = rule.as_str().unwrap().strip_prefix('#').unwrap();
            return fault(root, root.pointer(pointer).unwrap(), value, at);
        }
        "type" => {
            let names = rule.as_array().cloned().unwrap_or_else(|| vec![rule.clone()]);
            names.iter().any(|name| is_of_type(value, name.as_str().unwrap()))
        }
        "const" => rule == value,
        "enum" => rules().any(|one| one == value),
        "allOf" => rules().all(valid),
        "anyOf" => rules().any(valid),
        "oneOf" => rules().filter(|one| valid(one)).count() == 1,
        "minimum" => value.as_f64().is_none_or(|it| it >= rule.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|it| it <= rule.as_f64().unwrap()),
        "minItems" => value.as_array().is_none_or(|it| it.len() as u64 >= rule.as_u64().unwrap()),
        "maxItems" => value.as_array().is_none_or(|it| it.len() as u64 <= rule.as_u64().unwrap()),
        "items" => {
            let item = |(i, item)| fault(root, rule, item, &format!("{at}[{i}]"));
            return items().enumerate().find_map(item);
        }
        "required" => {
            value.is_null() || rules().all(|name| value.get(name.as_str().unwrap()).is_some())
        }
        "propertyNames" => members().all(|(name, _)| fault(root, rule, &json!(name), at).is_none()),
        "properties" => {
            let member =
                |(name, member)| fault(root, rule.get(name)?, member, &format!("{at}.{name}"));
            return members().find_map(member);
        }
        "additionalProperties" => {
            assert_eq!(rule, &json!(false));
            let known = |name: &str| keywords["properties"].get(name).is_some();
            members().all(|(name, _)| known(name))
        }
        other => panic!("{at}: the keyword {other} is not known here"),
    };
    (!is_right).then(|| format!("{at}: {name}: {rule}, got {value}"))
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "null" => value.is_null(),
        other => panic!("{other} is no type"),
    }
}

/// The first fault of the text of a scene against the schema.
fn fault_in(schema: &Value, text: &str) -> Option<String> {
    let table: toml::Table = toml::from_str(text).unwrap();
    fault(schema, schema, &serde_json::to_value(table).unwrap(), "scene")
}

/// The scene files in a folder and its subfolders.
fn scenes_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            scenes_in(&path, found);
        } else if path.extension().is_some_and(|end| end == "toml") {
            found.push(path);
        }
    }
}

#[test]
fn it_has_a_name_and_describes_every_field_in_plain_words() {
    let schema = schema();
    assert_eq!(schema["title"], "keyway.scene.file/2");
    let mut tables = vec![&schema];
    tables.extend(schema["$defs"].as_object().unwrap().values());
    let mut fields = 0;
    for (name, field) in tables.iter().filter_map(|one| one["properties"].as_object()).flatten() {
        let text = field["description"].as_str().unwrap_or_else(|| panic!("{name}"));
        let is_plain = !text.contains(['\\', '\n']) && !text.contains("None");
        assert!(is_plain && !text.contains("```"), "{name}: {text}");
        fields += 1;
    }
    assert!(fields > 70, "{fields}");
}

#[test]
fn every_scene_is_valid() {
    let schema = schema();
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    scenes_in(&here.join("../../scenes"), &mut paths);
    // The folders also contain robots.
    paths.retain(|path| std::fs::read_to_string(path).unwrap().contains("version = "));
    assert!(paths.len() > 30, "{paths:?}");
    let folder = folder();
    write(&folder, "c.csv", "world,x,y,radius\n7,-2.0,8.0,0.075\n3,0,5,0.075\n");
    write(&folder, "s.csv", "world,cylinders,optimal_time_s\n7,2,5.5\n");
    write(&folder, "k.csv", "plugin,duration_s,repeat,t,x,y\na,4,1,0,5,5\na,4,1,4,6,5\n");
    write(&folder, "w.csv", "world,plugin,radius\n4,a,0.5\n");
    let pairs =
        "map,start_x_m,start_y_m,goal_x_m,goal_y_m\nsmall_house.yaml,-8.175,-2.825,8.725,0.875\n";
    write(&folder, "p.csv", pairs);
    for line in [
        "scene barn c.csv --summary s.csv --out barn",
        "scene barn c.csv --known --out known",
        "scene dynabarn k.csv --worlds w.csv --out dynabarn",
        "scene pairs p.csv --unknown 2 --moving 1 --out pairs",
    ] {
        keyway(folder.path(), line).expect_code(0);
    }
    // All fields that the scenes above do not have.
    let rest = "version = 2\nseed = 9223372036854775807\nstart = [1.0, 2]\nvia = [[2, 3]]\ngoal = [3, 4, 90]\nstack = \"s4-guided\"\n\
        [world]\nwidth_m = 6\nheight_m = 6\nresolution_m = 0.05\norigin = [-1, 0]\n[world.obstacles.u-traps]\ncount = 2\n\
        size_m = [0.4, 0.6]\nwall_m = 0.1\n[disturbances.sensor]\ndropped_scans = 0.1\n\
        [[unknown]]\ncells = [[4, 5]]\n[[unknown]]\nvertices_m = [[1, 1], [2, 1], [2, 2]]\n\
        [[moving]]\nradius_m = 0.2\nposition = [1, 1]\nvelocity_mps = [0, 1]\n\
        [[moving]]\nradius_m = 0.2\nkey_frames = [[0, 1, 1], [1, 2, 2]]\n\
        [[moving]]\nradius_m = 0.2\nway_points = [[1, 1], [2, 2]]\nspeed_mps = 1\nto_and_fro = true\ngives_way = true\n\
        [[moving]]\nradius_m = 0.2\n[moving.random_walk]\nposition = [1, 1]\narea = [[0, 0], [2, 2]]\nspeed_mps = [0.1, 1]\n\
        leg_s = [1, 2]\nseed = 4\n";
    write(&folder, "rest.toml", rest);
    keyway(folder.path(), "navigate --scene rest.toml --time-limit 0.1").expect_code(1);
    for made in ["barn", "known", "dynabarn", "pairs"] {
        scenes_in(&folder.path().join(made), &mut paths);
    }
    paths.extend(["rest.toml", "small_house.toml"].map(|name| folder.path().join(name)));
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(fault_in(&schema, &text), None, "{}", path.display());
    }
}

/// Each is refused by the program, too, before anything is driven.
#[test]
fn what_the_program_refuses_for_its_form_is_not_valid() {
    let (schema, folder) = (schema(), folder());
    let scene = read(&folder, "small_house.toml").replace("version = 1", "version = 2");
    write(&folder, "right.toml", &scene);
    keyway(folder.path(), "navigate --scene right.toml --time-limit 0.1").expect_code(1);
    assert_eq!(fault_in(&schema, &scene), None);
    let two = "version = 2\n[world]\nwidth_m = 4\nheight_m = 3\nresolution_m = 0.1\n[[robots]]\nstart = [0.5, 0.5]\ngoal = [1.5, 0.5]\n";
    assert_eq!(fault_in(&schema, two), None);
    let with = |line: &str| format!("{line}\n{scene}");
    let and = |lines: &str| format!("{scene}\n{lines}\n");
    let mover = |fields: &str| and(&format!("[[moving]]\n{fields}"));
    let world =
        |fields: &str| two.replace("resolution_m = 0.1", &format!("resolution_m = 0.1\n{fields}"));
    let wrong = [
        scene.replace("version = 2", "version = 3"),
        scene.replace("version = 2", "version = \"2\""),
        scene.replace("version = 2\n", ""),
        with("colour = 1"),
        with("seed = -1"),
        with("seed = 1.5"),
        with("via = [1, 2]"),
        scene.replace("description = \"", "description = 5 # \""),
        scene.replace("map = \"small_house.yaml\"\n", ""),
        and("[world]\nwidth_m = 4\nheight_m = 3\nresolution_m = 0.1"),
        scene.replace("goal = [", "goal = [1, 2, "),
        scene.replace("radius_m = 0.15", "radius_m = true"),
        scene.replace("radius_m = 0.15", "vertices_m = [[0, 0], [1, 0], [1, 1]]"),
        and("[[unknown]]\nvertices_m = [[0, 0], [1, 0]]"),
        and("[[unknown]]\ncells = []"),
        and("[[unknown]]\ncells = [[1.5, 2]]"),
        and("[[unknown]]\n"),
        mover("position = [0, 0]\nvelocity_mps = [0, 1]"),
        mover("radius_m = 0.2\nposition = [0, 0]"),
        mover("radius_m = 0.2\nposition = [0, 0]\nvelocity_mps = [0, 1]\nspeed_mps = 1"),
        mover("radius_m = 0.2\nposition = [0, 0]\nvelocity_mps = [0, 1]\ngives_way = true"),
        mover("radius_m = 0.2\nkey_frames = [[0, 1]]"),
        mover("radius_m = 0.2\nrandom_walk = {position = [1, 1]}"),
        and("[rules]\narrival = \"late\""),
        and("[rules]\ntime_limit_s = \"long\""),
        and("[rules]\nstuck_window_s = \"long\""),
        and("[rules]\ntolerance_m = 1"),
        and("[disturbances.sensor]\nnoise = 1"),
        and("[random]\ncount = 3"),
        and("[random.unknown]\ncount = -3\nradius_m = [0.1, 0.2]"),
        world("origin = [1]"),
        world("obstacles = \"rooms\""),
        world("[world.obstacles.maze]\ncorridor_m = 1"),
        world("[world.obstacles.tea]\ncups = 1"),
        two.replace("goal = [1.5, 0.5]\n", ""),
        two.replace("goal = [1.5, 0.5]", "goal = [1.5, 0.5]\nseed = 1"),
        format!("start = [1, 1]\ngoal = [2, 2]\n{two}"),
    ];
    for text in wrong {
        assert!(fault_in(&schema, &text).is_some(), "{text}");
        write(&folder, "wrong.toml", &text);
        keyway(folder.path(), "navigate --scene wrong.toml --time-limit 0.1").expect_code(2);
    }
}
