//! Tests of the answers of a page, compared with the library.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::map::formats::map_from_bytes;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway::search::{CornerRule, Cost};
use keyway_sim::episode::{RunOptions, watch_episode};
use keyway_sim::scene_files::SceneFile;
use keyway_web::{Message, Page};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;

const YAML: &[u8] = include_bytes!("../../keyway-cli/scenes/small_house.yaml");
const PNG: &[u8] = include_bytes!("../../keyway-cli/scenes/small_house.png");
const SCENE: &str = include_str!("../../keyway-cli/scenes/small_house.toml");

const WALLED: &[u8] = b"type octile\nheight 3\nwidth 5\nmap\n..@..\n..@..\n.....\n";
/// The cost of the path around the wall: four straight steps and two diagonal ones.
const AROUND: f64 = 4.0 + 2.0 * std::f64::consts::SQRT_2;

fn ask(page: &mut Page, question: &Value) -> (Value, Message) {
    let answer = page.answer(&Message::new(question.to_string()));
    (answer.head.parse().unwrap(), answer)
}

fn with_walls() -> Page {
    let mut page = Page::default();
    let open = json!({"ask": "open_map", "name": "walled.map"}).to_string();
    let opened = page.answer(&Message::new(open).with("walled.map", WALLED.to_vec()));
    let facts: Value = opened.head.parse().unwrap();
    assert_eq!((&facts["width"], &facts["height"]), (&json!(5), &json!(3)), "{facts}");
    assert_eq!(opened.part("cells").unwrap()[..10], [0, 0, 0, 0, 0, 0, 0, 1, 0, 0]);
    page
}

fn with_house() -> Page {
    let mut page = Page::default();
    let open = json!({"ask": "open_map", "name": "small_house.yaml"}).to_string();
    let files = Message::new(open).with("small_house.yaml", YAML.to_vec());
    let opened = page.answer(&files.with("small_house.png", PNG.to_vec()));
    let facts: Value = opened.head.parse().unwrap();
    assert_eq!((&facts["width"], &facts["resolution_m"]), (&json!(500), &json!(0.05)), "{facts}");
    assert_eq!(opened.part("cells").unwrap().len(), 500 * 500);
    page
}

fn numbers(part: &[u8]) -> Vec<i32> {
    part.chunks_exact(4).map(|bytes| i32::from_le_bytes(bytes.try_into().unwrap())).collect()
}

fn points(part: &[u8]) -> Vec<[f64; 2]> {
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap());
    part.chunks_exact(16).map(|bytes| [number(&bytes[..8]), number(&bytes[8..])]).collect()
}

#[test]
fn a_plan_follows_the_map_as_it_is_edited() {
    let mut page = with_walls();
    let plan = json!({"ask": "plan", "planner": "jps", "start": [0.5, 2.5], "goal": [4.5, 2.5]});
    let (report, answer) = ask(&mut page, &plan);
    assert_eq!(report["schema"], "keyway.plan/3");
    let around = report["cost_cells"].as_f64().unwrap();
    assert!((around - AROUND).abs() < 1e-9, "{report}");
    let line = points(answer.part("line").unwrap());
    assert_eq!((line[0], line[line.len() - 1]), ([0.5, 2.5], [4.5, 2.5]));
    let wall = json!([[2, 1], [2, 2], [99, 0]]);
    let edit = |state: &str| json!({"ask": "edit_map", "cells": wall, "state": state});
    assert_eq!(ask(&mut page, &edit("free")).0, json!({"changed": 2}));
    let (through, _) = ask(&mut page, &plan);
    assert_eq!(through["cost_cells"], 4.0);
    assert_ne!(through["inputs"]["map_digest"], report["inputs"]["map_digest"]);
    assert_eq!(ask(&mut page, &edit("occupied")).0, json!({"changed": 2}));
    assert_eq!(ask(&mut page, &plan).0, report);
}

#[test]
fn a_search_tells_what_it_did() {
    let mut page = with_walls();
    let search =
        json!({"ask": "search", "planner": "astar", "start": [0.5, 2.5], "goal": [4.5, 2.5]});
    let (head, answer) = ask(&mut page, &search);
    let events = numbers(answer.part("events").unwrap());
    assert_eq!(events.len(), 6 * head["events"].as_u64().unwrap() as usize);
    assert_eq!(events[..6], [0, 0, 0, 2, 0, 2], "the start is expanded first");
    let expanded = events.chunks_exact(6).filter(|event| event[0] == 0).count();
    assert_eq!(head["expanded"], expanded);
    let path = numbers(answer.part("path").unwrap());
    assert_eq!((&path[..2], &path[path.len() - 2..]), (&[0, 2][..], &[4, 2][..]));
    assert!((head["cost_cells"].as_f64().unwrap() - AROUND).abs() < 1e-9 && head["why"].is_null());
    let (none, answer) = ask(
        &mut page,
        &json!({"ask": "search", "planner": "jps", "budget": 0,
        "start": [0.5, 2.5], "goal": [4.5, 2.5]}),
    );
    assert!(none["cost_cells"].is_null() && none["why"].is_string(), "{none}");
    assert_eq!(answer.part("path"), Some(&[][..]));
}

/// A page contains the results of the library, and nothing else.
#[test]
fn a_drive_is_that_of_the_library() {
    let mut page = with_house();
    let (head, answer) = ask(&mut page, &json!({"ask": "drive", "scene": SCENE}));
    let image = |_: &Path| Ok(PNG.to_vec());
    let map = map_from_bytes(Path::new("small_house.yaml"), YAML, image, None).unwrap();
    let robot = Robot::small();
    let stack = Stack::keyway(&robot);
    let scene = SceneFile::from_toml(SCENE).unwrap();
    let mut episode = scene.episode_with(map, &robot, &stack).unwrap();
    episode.robots[0].stack_name = Stack::DEFAULT.to_owned();
    let expected = watch_episode(&episode, RunOptions::default(), &mut [(); 0]).unwrap();
    assert_eq!(head["reports"][0], serde_json::to_value(&expected.robots[0]).unwrap());
    assert_eq!(head["reports"][0]["outcome"], "reached");
    let cycles = head["cycles"][0].as_array().unwrap();
    assert_eq!(answer.part("poses 0").unwrap().len(), 24 * cycles.len());
    // Each list has the length given by its counts.
    let counted = |part: &str| {
        let (numbers, mut at, mut lists, mut sum) = (numbers(answer.part(part).unwrap()), 0, 0, 0);
        while at < numbers.len() {
            (lists, sum) = (lists + 1, sum + numbers[at]);
            at += 1 + 2 * numbers[at] as usize;
        }
        assert_eq!((at, lists), (numbers.len(), cycles.len()), "{part}");
        sum
    };
    assert!(counted("hits 0") > 1000 && counted("sensed 0") > 10);
    assert_eq!(head["routes"][0][0][0], 0);
    assert_eq!(head["outlines"][0], json!({"radius_m": 0.18, "vertices": []}));
    let (short, answer) =
        ask(&mut page, &json!({"ask": "drive", "scene": SCENE, "reports_only": true}));
    assert_eq!((&short["reports"], answer.parts.len()), (&head["reports"], 0));
}

#[test]
fn moving_obstacles_are_told_with_the_cycles() {
    let mut page = with_house();
    let walker = "\n[[moving]]\nradius_m = 0.25\nposition = [2.0, -3.0]\nvelocity_mps = [0.0, 0.5]\n\n\
        [rules]\ntime_limit_s = 1.0\n";
    let scene =
        SCENE.replace("version = 1", "version = 2").replace("\"small\"", "\"jackal\"") + walker;
    let (head, answer) = ask(&mut page, &json!({"ask": "drive", "scene": scene}));
    assert_eq!(head["mover_radii_m"], json!([0.25]), "{}", head["error"]);
    assert_eq!(head["outlines"][0]["vertices"].as_array().unwrap().len(), 4);
    let bytes = answer.part("movers 0").unwrap();
    let places: Vec<f32> =
        bytes.chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    let cycles = head["cycles"][0].as_array().unwrap();
    assert_eq!(places.len(), 2 * cycles.len());
    for (place, cycle) in places.chunks_exact(2).zip(cycles) {
        let y = -3.0 + 0.5 * cycle["t_s"].as_f64().unwrap();
        assert!((f64::from(place[1]) - y).abs() < 1e-6 && place[0] == 2.0, "{place:?}");
    }
}

#[test]
fn a_refusal_says_why_and_loses_nothing() {
    let mut page = Page::default();
    let refused = |page: &mut Page, question: &Value, kind: &str, field: &str, words: &str| {
        let (head, answer) = ask(page, question);
        let error = &head["error"];
        assert_eq!((&error["kind"], &error["field"]), (&json!(kind), &json!(field)), "{error}");
        assert!(error["message"].as_str().unwrap().contains(words), "{error}");
        assert_eq!(answer.parts, []);
    };
    let plan = json!({"ask": "plan", "start": [0.5, 0.5], "goal": [4.5, 2.5]});
    refused(&mut page, &plan, "usage", "ask", "no map is open");
    refused(&mut page, &json!({"ask": "drive", "scene": SCENE}), "usage", "ask", "no map is open");
    let mut page = with_walls();
    let open = json!({"ask": "open_map", "name": "other.map"});
    refused(&mut page, &open, "input", "name", "there is no such file");
    let cut = Message::new(open.to_string()).with("other.map", WALLED[..40].to_vec());
    assert!(page.answer(&cut).head.contains("line 6"), "{}", page.answer(&cut).head);
    let with = |field: &str, value: Value| {
        let mut plan = plan.clone();
        plan[field] = value;
        plan
    };
    refused(&mut page, &with("start", json!([2.5, 2.5])), "position", "start", "obstacle");
    refused(&mut page, &with("goal", json!([9.0, 2.5])), "position", "goal", "outside");
    refused(&mut page, &with("planner", json!("jsp")), "config", "planner.name", "jps");
    refused(&mut page, &with("robot", json!("smal")), "config", "robot", "there is no robot");
    refused(&mut page, &with("radius_m", json!(-1.0)), "config", "radius_m", "radius");
    refused(&mut page, &with("radius_m", json!(9.0)), "config", "radius_m", "no cell free");
    refused(
        &mut page,
        &with("settings", json!("map.clearance_m = -1")),
        "config",
        "map.clearance_m",
        "-1",
    );
    refused(&mut page, &with("settings", json!("map = ")), "config", "", "line 1");
    refused(&mut page, &with("strange", json!(1)), "usage", "ask", "strange");
    refused(&mut page, &json!({"ask": "fly"}), "usage", "ask", "fly");
    refused(
        &mut page,
        &json!({"ask": "drive", "scene": "version = 2"}),
        "input",
        "scene",
        "a `map` or a `[world]`",
    );
    let strange = SCENE.replace("\"small\"", "\"smal\"");
    refused(&mut page, &json!({"ask": "drive", "scene": strange}), "config", "robot", "smal");
    assert_eq!(ask(&mut page, &plan).0["outcome"], "found", "the map is as it was");
}

#[test]
fn all_names_are_told() {
    let (names, _) = ask(&mut Page::default(), &json!({"ask": "names"}));
    for (kind, name) in [
        ("robots", "jackal"),
        ("planners", "jps"),
        ("smoothers", "taut"),
        ("guides", "key-points"),
        ("local_planners", "space-time"),
        ("stacks", "keyway"),
    ] {
        let known = names[kind].as_array().unwrap();
        assert!(known.contains(&json!(name)), "{kind}: {known:?}");
    }
}

#[derive(Deserialize)]
struct Cases {
    case: Vec<Case>,
}

/// A case of `testdata/plan`; the format is described in its README.
#[derive(Deserialize)]
struct Case {
    name: String,
    map: String,
    start: [i32; 2],
    goal: [i32; 2],
    #[serde(default)]
    corners: CornerRule,
    cost: Option<[u64; 2]>,
}

impl Case {
    fn page(&self) -> Page {
        let rows: Vec<String> = self.map.lines().map(|row| row.replace(['#', '?'], "@")).collect();
        let (height, width) = (rows.len(), rows[0].len());
        let text =
            format!("type octile\nheight {height}\nwidth {width}\nmap\n{}\n", rows.join("\n"));
        let mut page = Page::default();
        let open = json!({"ask": "open_map", "name": "case.map"}).to_string();
        page.answer(&Message::new(open).with("case.map", text.into_bytes()));
        page
    }

    fn search(&self, page: &mut Page, planner: &str, settings: &str) -> Value {
        let centre = |[x, y]: [i32; 2]| [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let question = json!({"ask": "search", "planner": planner, "settings": settings,
            "start": centre(self.start), "goal": centre(self.goal)});
        ask(page, &question).0
    }
}

/// Cases shared by all bindings.
#[test]
fn plans_of_every_optimal_planner() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/plan");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let texts = files.map(|path| std::fs::read_to_string(path).unwrap());
    let cases: Vec<Case> =
        texts.flat_map(|text| toml::from_str::<Cases>(&text).unwrap().case).collect();
    let mut answers = 0;
    for case in &cases {
        let mut page = case.page();
        let cost = case.cost.map(|[straight, diagonal]| Cost::new(straight, diagonal).cells());
        let (planners, settings) = match case.corners {
            CornerRule::Allow => (&["astar"][..], "astar.corners = \"allow\""),
            _ => (&["jps", "astar", "dijkstra", "prepared", "bidirectional-optimal"][..], ""),
        };
        for planner in planners {
            let found = case.search(&mut page, planner, settings);
            let about = format!("{}, {planner}: {found}", case.name);
            assert!(found["error"].is_null(), "{about}");
            match (cost, found["cost_cells"].as_f64()) {
                (Some(cost), Some(found)) => assert!((found - cost).abs() < 1e-9, "{about}"),
                (None, None) => {}
                _ => panic!("{about}"),
            }
            answers += 1;
        }
    }
    assert!(answers > 5 * 10, "{answers} answers");
}
