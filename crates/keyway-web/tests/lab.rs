//! Tests of scenes, comparisons and claims of a page, compared with the laboratory.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway_lab::claims::{Claim, ClaimReport, Family, Verdict};
use keyway_web::film::{FAN_NUMBERS, FAN_POINTS};
use keyway_web::{Message, Page};
use serde_json::{Value, json};

const BAY: [(&str, &[u8]); 3] = [
    ("bay.toml", include_bytes!("../../../scenes/fleet/bay.toml")),
    ("bay.yaml", include_bytes!("../../../scenes/fleet/bay.yaml")),
    ("bay.pgm", include_bytes!("../../../scenes/fleet/bay.pgm")),
];
/// A world generated from the seed, with one unmapped obstacle.
const MADE: &str = "version = 2\nseed = 4\nstart = [1.0, 1.0]\ngoal = [9.0, 9.0]\n\
    [world]\nwidth_m = 10.0\nheight_m = 10.0\nresolution_m = 0.1\n\
    obstacles = { blocks = { share = 0.04, side_m = [0.2, 0.6] } }\n\
    [[unknown]]\nposition = [5.0, 5.0]\nradius_m = 0.3\n";

fn ask(page: &mut Page, question: &Value) -> (Value, Message) {
    with_files(page, question, &[])
}

fn with_files(page: &mut Page, question: &Value, files: &[(&str, &[u8])]) -> (Value, Message) {
    let parts = files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec()));
    let answer = page.answer(&Message { head: question.to_string(), parts: parts.collect() });
    (answer.head.parse().unwrap(), answer)
}

#[test]
fn a_scene_brings_its_map_and_its_robots() {
    let mut page = Page::default();
    let open = json!({"ask": "open_scene", "name": "bay.toml"});
    let (scene, answer) = with_files(&mut page, &open, &BAY);
    assert_eq!(scene["robots"][1]["start"], json!([9.0, 1.4]), "{scene}");
    assert_eq!(scene["robots"][0]["stack"], "keyway");
    assert_eq!((&scene["is_generated"], &scene["is_random"]), (&json!(false), &json!(false)));
    let cells = scene["map"]["width"].as_u64().unwrap() * scene["map"]["height"].as_u64().unwrap();
    assert_eq!(answer.part("cells").unwrap().len() as u64, cells);
    let text = std::str::from_utf8(BAY[0].1).unwrap();
    let short = text.replace("time_limit_s = 120", "time_limit_s = 1");
    let drive = json!({"ask": "drive", "scene": short, "name": "bay"});
    let (driven, answer) = ask(&mut page, &drive);
    assert_eq!(driven["cycles"].as_array().unwrap().len(), 2, "{}", driven["error"]);
    assert!(answer.part("fans 1").is_some());
    assert_eq!((&driven["row"]["robots"], &driven["row"]["scene"]), (&json!(2), &json!("bay")));
    // An edited map does not become that of another scene.
    let (refused, _) = with_files(&mut Page::default(), &open, &BAY[..1]);
    assert_eq!(refused["error"]["field"], "scene");
    assert!(refused["error"]["message"].as_str().unwrap().contains("bay.yaml"), "{refused}");
}

#[test]
fn a_world_follows_its_seed() {
    let open = |seed: Option<u64>| {
        let ask = json!({"ask": "open_scene", "name": "made.toml", "seed": seed});
        with_files(&mut Page::default(), &ask, &[("made.toml", MADE.as_bytes())])
    };
    let (scene, answer) = open(None);
    assert_eq!((&scene["seed"], &scene["is_generated"]), (&json!(4), &json!(true)), "{scene}");
    assert_eq!(scene["discs"], json!([[5.0, 5.0, 0.3]]));
    assert_eq!(answer.part("cells"), open(Some(4)).1.part("cells"));
    assert_ne!(answer.part("cells"), open(Some(5)).1.part("cells"));
}

#[test]
fn tables_of_barn_give_a_scene_for_each_world() {
    let mut page = Page::default();
    let table = "world,x,y,radius\n7,-2.0,8.0,0.075\n9,-1.0,5.0,0.075\n7,-3.0,9.0,0.075\n";
    let ask_for = json!({"ask": "barn_scenes", "name": "worlds.csv"});
    let (scenes, _) = with_files(&mut page, &ask_for, &[("worlds.csv", table.as_bytes())]);
    assert_eq!(scenes.as_array().unwrap().len(), 2, "{scenes}");
    assert_eq!(scenes[0]["name"], "barn_007.toml");
    let text = scenes[0]["text"].as_str().unwrap();
    let open = json!({"ask": "open_scene", "name": "barn_007.toml"});
    let (scene, _) = with_files(&mut page, &open, &[("barn_007.toml", text.as_bytes())]);
    assert_eq!(scene["discs"], json!([[-2.0, 8.0, 0.075], [-3.0, 9.0, 0.075]]));
    let cut = [("worlds.csv", &b"world,x,y\n7,1,2\n"[..])];
    let (refused, _) = with_files(&mut page, &ask_for, &cut);
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(
        message.starts_with("worlds.csv: line 1: the header has no column `radius`"),
        "{message}"
    );
}

#[test]
fn a_drive_on_the_map_as_it_was_edited() {
    let mut page = Page::default();
    let open = json!({"ask": "open_scene", "name": "made.toml"});
    with_files(&mut page, &open, &[("made.toml", MADE.as_bytes())]);
    let wall: Vec<[i32; 2]> = (0..100).map(|i| [i, 50]).collect();
    ask(&mut page, &json!({"ask": "edit_map", "cells": wall, "state": "occupied"}));
    let drive = |on_open_map: bool| json!({"ask": "drive", "scene": MADE, "reports_only": true, "on_open_map": on_open_map});
    let outcome = |page: &mut Page, on_open_map| {
        ask(page, &drive(on_open_map)).0["reports"][0]["outcome"].clone()
    };
    assert_eq!([outcome(&mut page, false), outcome(&mut page, true)], ["reached", "no_path"]);
}

/// A stack that replaces those of the scene, and the candidates of each cycle.
#[test]
fn fans_hold_what_was_tried() {
    let mut page = Page::default();
    with_files(
        &mut page,
        &json!({"ask": "open_scene", "name": "made.toml"}),
        &[("made.toml", MADE.as_bytes())],
    );
    let scene = format!("{MADE}\n[rules]\ntime_limit_s = 3.0\n");
    let mut drive = json!({"ask": "drive", "scene": scene, "stack": "s0-key-point"});
    let (driven, answer) = ask(&mut page, &drive);
    assert_eq!(driven["row"]["stack"], "s0-key-point", "{}", driven["error"]);
    let own = format!("stack = \"s0-key-point\"\n{scene}");
    let (named, _) = ask(&mut page, &json!({"ask": "drive", "scene": own}));
    assert_eq!(named["cycles"], driven["cycles"], "as if the scene had named it");
    let bytes = answer.part("fans 0").unwrap().chunks_exact(4);
    let words: Vec<[u8; 4]> = bytes.map(|bytes| bytes.try_into().unwrap()).collect();
    let (mut at, mut chosen) = (0, 0);
    for cycle in driven["cycles"][0].as_array().unwrap() {
        let count = u32::from_le_bytes(words[at]) as usize;
        let fan = words[at + 1..][..count * FAN_NUMBERS].chunks_exact(FAN_NUMBERS);
        at += 1 + count * FAN_NUMBERS;
        for candidate in fan.filter(|candidate| f32::from_le_bytes(candidate[0]) == 1.0) {
            chosen += 1;
            let score = f64::from(f32::from_le_bytes(candidate[1]));
            assert!((score - cycle["chosen"]["score"].as_f64().unwrap()).abs() < 1e-5);
            let [x, y] = [2, 3].map(|i| f64::from(f32::from_le_bytes(candidate[i])));
            let pose = cycle["pose"].as_array().unwrap();
            let off = (x - pose[0].as_f64().unwrap()).hypot(y - pose[1].as_f64().unwrap());
            assert!(off < 1.0, "{off} m after a part of the prediction");
            assert_eq!(candidate.len(), 2 + 2 * FAN_POINTS);
        }
    }
    assert_eq!(at, words.len());
    assert!(chosen > 10, "{chosen} cycles");
    drive["without_reasons"] = json!(true);
    let (without, answer) = ask(&mut page, &drive);
    assert_eq!(without["reports"], driven["reports"]);
    assert!(answer.part("fans 0").unwrap().iter().all(|&byte| byte == 0));
}

#[test]
fn planners_are_compared_as_the_program_does() {
    let mut page = Page::default();
    let map: String = "type octile\nheight 6\nwidth 6\nmap\n".to_owned() + &"......\n".repeat(6);
    let open = json!({"ask": "open_map", "name": "open.map"});
    with_files(&mut page, &open, &[("open.map", map.as_bytes())]);
    let compare = json!({"ask": "compare", "planners": ["jps", "astar4"], "smoothers": ["none"],
        "radius_m": 0.0, "queries": 5, "seed": 3});
    let (compared, _) = ask(&mut page, &compare);
    assert_eq!(compared["report"]["schema"], "keyway.compare/1", "{compared}");
    let rows = compared["report"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!((&rows[0]["solved"], &rows[0]["median_plan_us"]), (&json!(5), &Value::Null));
    let mean = |row: usize| rows[row]["mean_length_m"].as_f64().unwrap();
    assert!(mean(1) > mean(0), "four neighbours make detours: {rows:?}");
    assert_eq!(compared["rows"].as_array().unwrap().len(), 2);
    assert!(compared["csv"].as_str().unwrap().starts_with("map,planner"));
    assert_eq!(compared["queries_csv"].as_str().unwrap().lines().count(), 1 + 2 * 5);
    assert!(compared["latex"].as_str().unwrap().contains("tabular"));
    let mut wrong = compare;
    wrong["planners"] = json!(["jsp"]);
    let (refused, _) = ask(&mut page, &wrong);
    assert_eq!(refused["error"]["field"], "planners", "{refused}");
}

#[test]
fn runs_are_summarised_by_stack() {
    let mut page = Page::default();
    let mut row = |stack: &str, seed: u64| {
        let mut drive = json!({"ask": "drive", "scene": MADE, "name": "made", "seed": seed});
        (drive["stack"], drive["reports_only"]) = (json!(stack), json!(true));
        ask(&mut page, &drive).0["row"].clone()
    };
    let rows: Vec<Value> = [("keyway", 4), ("keyway", 5), ("astar-follow", 4), ("astar-follow", 5)]
        .map(|(stack, seed)| row(stack, seed))
        .into();
    let (summary, _) = ask(&mut page, &json!({"ask": "summary", "rows": rows}));
    assert_eq!(summary["stacks"][0]["stack"], "keyway", "{summary}");
    assert_eq!(
        (&summary["stacks"][0]["runs"], &summary["stacks"][1]["runs"]),
        (&json!(2), &json!(2))
    );
    assert_eq!(summary["against_first"][0]["stack"], "astar-follow");
    let text = summary["text"].as_str().unwrap();
    assert!(text.contains("keyway") && text.contains("reached"), "{text}");
    assert_eq!(summary["runs_csv"].as_str().unwrap().lines().count(), 5);
    let reached = rows.iter().filter(|row| row["stack"] == "keyway" && row["outcome"] == "reached");
    assert_eq!(summary["stacks"][0]["reached"], reached.count());
}

#[test]
fn claims_are_measured_and_judged_as_in_the_laboratory() {
    let mut page = Page::default();
    let (claims, _) = ask(&mut page, &json!({"ask": "claims"}));
    assert_eq!(claims.as_array().unwrap().len(), Claim::all().count());
    let claim = Claim::named("S0-1")[0];
    let told = claims.as_array().unwrap().iter().find(|told| told["id"] == "S0-1").unwrap();
    assert_eq!(told["statement"], claim.statement);
    let (mut rows, mut family) = (Vec::new(), Family::default());
    for seed in 1..=6 {
        let measure = json!({"ask": "measure_claim", "id": "S0-1", "seed": seed});
        let row = claim.experiment.on_seed(seed, None).unwrap();
        let (measured, _) = ask(&mut page, &measure);
        assert_eq!(measured, serde_json::to_value(&row).unwrap());
        rows.push(measured);
        family.take(claim.experiment, row, 6);
    }
    let (judged, _) = ask(&mut page, &json!({"ask": "judge_claim", "id": "S0-1", "rows": rows}));
    let report = ClaimReport::new(claim, &family, false);
    assert_eq!(judged["report"], serde_json::to_value(&report).unwrap());
    assert_ne!(report.verdict, Verdict::NotMeasured);
    assert_eq!(judged["figures"].as_array().unwrap().len(), report.family.figures.len());
    let (map, answer) = ask(&mut page, &json!({"ask": "open_claim", "id": "S0-1", "seed": null}));
    assert!((map["lengths_m"][0].as_f64().unwrap() - 29.213).abs() < 1e-3, "{map}");
    assert_eq!(answer.part("line 0").unwrap().len() % 16, 0);
    // The map of the claim is now the open one.
    let plan = json!({"ask": "plan", "planner": "astar", "start": map["ends"][0],
        "goal": map["ends"][1], "with_shortest": true});
    let (planned, answer) = ask(&mut page, &plan);
    let length_m = planned["length_m"].as_f64().unwrap();
    assert!((length_m - 29.213).abs() < 1e-3, "{planned}");
    let shortest: Vec<f64> = answer
        .part("shortest")
        .unwrap()
        .chunks_exact(8)
        .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    let steps = shortest.windows(4).step_by(2);
    let shortest_m: f64 = steps.map(|at| (at[2] - at[0]).hypot(at[3] - at[1])).sum();
    assert!(shortest_m > 20.0 && shortest_m < length_m, "{shortest_m}");
    for (wrong, field) in [
        (json!({"ask": "open_claim", "id": "S9-1", "seed": 1}), "id"),
        (
            json!({"ask": "judge_claim", "id": "S0-1",
            "rows": [{"seed": 1, "outcomes": []}]}),
            "rows",
        ),
    ] {
        assert_eq!(ask(&mut page, &wrong).0["error"]["field"], field);
    }
}
