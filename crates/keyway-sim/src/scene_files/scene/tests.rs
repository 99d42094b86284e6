//! Tests of scene files.

use super::*;
use crate::episode::EpisodeRules;
use crate::scene_files::UnknownDisc;
use crate::sim::{Arrival, KeyFrame, KeyFrames, ObstacleMotion, ReachedBy};
use keyway::geometry::Disc;
use keyway::map::formats::map_from_bytes;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::path::Path;

const LEAST: &str = "version = 1\nmap = \"a.yaml\"\nstart = [1, 2]\ngoal = [3.5, 4]\n";

fn error(text: &str) -> String {
    SceneFile::from_toml(text).unwrap_err().to_string()
}

const MOVING: &str = "[[moving]]\nradius_m = 0.25\nkey_frames = [[0, 1, 2], [4, 3, 2]]\n";

fn mover() -> MovingObstacle {
    let frames = [[0.0, 1.0, 2.0], [4.0, 3.0, 2.0]].map(KeyFrame::from).to_vec();
    MovingObstacle::new(0.25, ObstacleMotion::KeyFrames(KeyFrames::new(frames).unwrap())).unwrap()
}

#[test]
fn defaults_and_round_trip() {
    let scene = SceneFile::from_toml(LEAST).unwrap();
    assert_eq!((scene.robot.as_str(), scene.unknown.len()), ("small", 0));
    assert_eq!(scene.stack, Stack::DEFAULT);
    assert_eq!(scene.start.unwrap().heading_rad, None);
    assert_eq!(scene.goal, Some(Point::new(3.5, 4.0).into()));
    assert!(scene.via.is_empty());
    let straight =
        MovingObstacle::straight(Point::new(1.0, 2.0), 0.0, Point::new(0.0, -0.5)).unwrap();
    let full = SceneFile {
        description: Some("a hall".to_owned()),
        stack: "s0-key-point".to_owned(),
        start: Some(Start { position: Point::new(-1.0, 2.0), heading_rad: Some(-FRAC_PI_2) }),
        via: vec![Point::new(0.5, 1.5), Point::new(1.0, 2.5)],
        goal: Some(Goal { position: Point::new(3.5, 4.0), heading_rad: Some(FRAC_PI_4) }),
        unknown: vec![UnknownDisc { position: Point::new(0.5, 0.5), radius_m: 0.15 }.into()],
        moving: vec![mover(), straight],
        ..scene
    };
    let text = toml::to_string(&full).unwrap();
    assert_eq!(SceneFile::from_toml(&text).unwrap(), full);
}

#[test]
fn a_scene_is_an_episode_on_its_map() {
    let text = format!("{LEAST}{MOVING}[[unknown]]\nposition = [2, 3]\nradius_m = 0.5\n");
    let scene = SceneFile::from_toml(&text.replace("[1, 2]", "[1, 2, 90]")).unwrap();
    let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
    let map = || map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
    let (digest, robot) = (map().digest, Robot::small());
    let stack = Stack::by_name("s1-adaptive", &robot).unwrap();
    let episode = scene.episode_with(map(), &robot, &stack).unwrap();
    assert_eq!((episode.source.name.as_str(), episode.source.digest), ("a.map", digest));
    let one = episode.robots[0].clone();
    assert_eq!((Some(one.start), Some(one.goal)), (scene.start, scene.goal));
    let circle = Disc::new(Point::new(2.0, 3.0), 0.5);
    assert_eq!((episode.obstacles, one.robot), (vec![circle], robot.clone()));
    assert_eq!((one.stack, episode.movers), (stack, vec![mover()]));
    let other = SceneFile { stack: "mine.toml".to_owned(), ..scene };
    let stack = Stack::key_point_fusion(&robot);
    assert_eq!(
        other.episode_with(map(), &robot, &stack).unwrap().robots[0].stack_name,
        "mine.toml"
    );
}

#[test]
fn later_versions_are_refused_whatever_they_hold() {
    let later = error("version = 3\nmovers = []\n");
    assert_eq!(later, "`version` is 3; this program reads scenes of version 1 and 2");
    assert!(error("version = \"1\"\n").starts_with("`version` is \"1\""));
    assert!(error("map = \"a.yaml\"\n").contains("missing field `version`"));
}

#[test]
fn what_is_new_needs_the_version() {
    assert_eq!(error(&format!("{LEAST}seed = 1\n")), "`seed` needs `version = 2`");
    assert_eq!(error(&format!("{LEAST}[rules]\n")), "`rules` needs `version = 2`");
    let second = LEAST.replace("version = 1", "version = 2\nseed = 7");
    let scene = SceneFile::from_toml(&format!("{second}[rules]\ntime_limit_s = 9.5\n")).unwrap();
    assert_eq!((scene.seed, scene.rules.time_limit_s), (7, Some(9.5)));
    for field in ["time_limit_s", "stuck_window_s"] {
        for value in ["-1", "0", "nan"] {
            let wrong = error(&format!("{second}[rules]\n{field} = {value}\n"));
            assert!(wrong.contains(&format!("`rules.{field}`")), "{wrong}");
        }
    }
}

#[test]
fn disturbances_draw_from_the_seed_of_the_scene() {
    let text = LEAST.replace("version = 1", "version = 2\nseed = 7")
        + "[disturbances.actuation]\ndelay_s = 0.1\n";
    let scene = SceneFile::from_toml(&text).unwrap();
    assert!(scene.is_random());
    assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
    let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
    let map = map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
    let robot = Robot::small();
    let episode = scene.episode_with(map, &robot, &Stack::key_point_fusion(&robot)).unwrap();
    let Disturbances { seed, actuation, .. } = episode.robots[0].disturbances.clone();
    assert_eq!((seed, actuation.delay_s), (7, 0.1));
    let late = error(&text.replace("0.1", "-1"));
    assert!(late.starts_with("`disturbances.actuation.delay_s` must be"), "{late}");
    let seeded =
        error(&text.replace(
            "[disturbances.actuation]",
            "[disturbances]\nseed = 1\n[disturbances.actuation]",
        ));
    assert!(seeded.contains("set `seed` of the scene instead of `disturbances.seed`"), "{seeded}");
    assert_eq!(error(&format!("{LEAST}[disturbances]\n")), "`disturbances` needs `version = 2`");
}

#[test]
fn a_world_is_made_from_the_seed() {
    let text = "version = 2\nseed = 3\nstart = [1, 1]\ngoal = [7, 5]\n[world]\nwidth_m = 8\nheight_m = 6\n\
                resolution_m = 0.1\n[world.obstacles.clutter]\nshare = 0.3\nradius_m = [0.1, 0.3]\n\
                [rules]\nreached_by = \"belief\"\narrival = \"passing\"\ngoal_tolerance_m = 1\nstuck_window_s = 60\n";
    let scene = SceneFile::from_toml(text).unwrap();
    assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
    let map = scene.generated_map().unwrap().unwrap();
    assert_eq!(map.source.name, "generated with seed 3");
    let other = SceneFile { seed: 4, ..scene.clone() }.generated_map().unwrap().unwrap();
    assert_ne!(map.source.digest, other.source.digest);
    let robot = Robot::small();
    let episode = scene.episode_with(map, &robot, &Stack::key_point_fusion(&robot)).unwrap();
    let rules = EpisodeRules {
        goal_tolerance_m: Some(1.0),
        arrival: Arrival::Passing,
        reached_by: ReachedBy::Belief,
        stuck_window_s: 60.0,
        ..EpisodeRules::default()
    };
    assert_eq!((episode.rules, episode.known.frame().width()), (rules, 80));
    assert_eq!(
        error(&text.replace("0.3\n", "2\n")),
        "`world.obstacles.clutter.share` must be from 0 to 1, got 2"
    );
    let both = error(&text.replace("seed", "map = \"a.yaml\"\nseed"));
    assert_eq!(both, "a scene has either a `map` or a `[world]`, got both");
    let neither = error(&LEAST.replace("map = \"a.yaml\"\n", ""));
    assert_eq!(neither, "a scene has either a `map` or a `[world]`, got neither");
}

#[test]
fn errors_name_the_field() {
    assert!(error(&format!("{LEAST}speed = 1\n")).contains("unknown field `speed`"));
    let four = error(&LEAST.replace("[1, 2]", "[1, 2, 3, 4]"));
    assert!(four.contains("line 3") && four.contains("`start`: expected [x, y]"), "{four}");
    let circle = format!("{LEAST}[[unknown]]\nposition = [0, 0]\nradius_m = -1\n");
    let expected = "`unknown[0].radius_m` must be a length of at least 0, got -1";
    assert_eq!(error(&circle), expected);
    for (from, to, line, message) in [
        ("0.25", "-1", "line 5", "`moving[0]`: radius_m must be a number of at least 0, got -1"),
        ("[4, 3", "[0, 3", "line 5", "`moving[0]`: key_frames[1].t_s must be later"),
        ("key_frames", "frames", "line 7", "`moving[0].frames`: unknown field `frames`"),
        ("radius_m", "speed_mps = 1\nradius_m", "line 5", "got `key_frames`, `speed_mps`"),
        ("[4, 3, 2]", "[4, 3]", "line 7", "`moving[0].key_frames[1]`"),
    ] {
        let error = error(&format!("{LEAST}{}", MOVING.replace(from, to)));
        assert!(error.contains(line) && error.contains(message), "{error}");
    }
    assert!(error(&LEAST.replace("3.5", "nan")).starts_with("`goal[0]` must be a finite"));
    assert!(error(&LEAST.replace("4]", "4, inf]")).starts_with("`goal[2]` must be a finite"));
    let via = format!("{LEAST}via = [[1, 2], [nan, 2]]\n");
    assert!(error(&via).starts_with("`via[1][0]` must be a finite"));
}

#[test]
fn a_safe_scene_puts_the_stop_rule_behind_every_stack() {
    let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
    let map = || map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
    let robot = Robot::small();
    let stack = Stack::by_name("s1-adaptive", &robot).unwrap();
    for (line, is_safe) in [("", false), ("safe = false\n", false), ("safe = true\n", true)] {
        let scene = format!("{line}{}", LEAST.replace("version = 1", "version = 2"));
        let scene = SceneFile::from_toml(&scene).unwrap();
        assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        let episode = scene.episode_with(map(), &robot, &stack).unwrap();
        assert_eq!(episode.robots[0].stack.controller.safe.is_some(), is_safe, "{line}");
        let found = |_: &str, _: &str| Ok::<_, SceneError>((robot.clone(), stack.clone()));
        let team = scene.episode(map(), found).unwrap();
        assert_eq!(team.robots[0].stack, episode.robots[0].stack, "{line}");
    }
    assert_eq!(error(&format!("safe = true\n{LEAST}")), "`safe` needs `version = 2`");
}
