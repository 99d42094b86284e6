//! Tests of the scenes of the papers: the papers' baselines have the printed results there, and
//! every run ends as documented.

use keyway::files::{find_robot, find_stack};
use keyway::geometry::{Disc, Point, Segment};
use keyway::map::formats::read_map;
use keyway::map::{LayerConfig, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{
    AStar, AStar4, AStarConfig, BidirectionalAStar, Dijkstra, DijkstraConfig, GlobalPlanner, Plan,
    shortest_line,
};
use keyway::search::{CornerRule, Cost, Query, Workspace};
use keyway_sim::episode::{Episode, EpisodeOutcome, RobotReport, run_episode};
use keyway_sim::scene_files::read_scene;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn readme() -> String {
    std::fs::read_to_string(folder().join("README.md")).unwrap()
}

/// The row of a scene in the table of the readme.
fn readme_row(name: &str) -> String {
    let begin = format!("| `{name}.toml` |");
    let row = readme().lines().find(|line| line.starts_with(&begin)).map(str::to_owned);
    row.unwrap_or_else(|| panic!("{name} is not in the readme"))
}

/// Scene files as `paper/name`, in order.
fn names() -> Vec<String> {
    let mut names = Vec::new();
    for paper in ["you2021", "s1", "zhuyin2024"] {
        for entry in std::fs::read_dir(folder().join(paper)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                names.push(format!("{paper}/{}", path.file_stem().unwrap().to_str().unwrap()));
            }
        }
    }
    names.sort();
    names
}

fn episode(name: &str) -> Episode {
    let path = folder().join(name).with_extension("toml");
    let scene = read_scene(&path).unwrap();
    let beside = path.parent().unwrap();
    let map = read_map(&beside.join(scene.map.as_ref().unwrap()), None).unwrap();
    let robot = find_robot(&scene.robot, beside).unwrap();
    let stack = find_stack(&scene.stack, beside, &robot).unwrap();
    scene.episode_with(map, &robot, &stack).unwrap()
}

/// The planners of the papers' comparisons, with each paper's corner rule.
fn baseline(name: &str) -> Box<dyn GlobalPlanner> {
    let corners = CornerRule::Allow;
    match name {
        "A*" => Box::new(AStar::default()),
        "A*, cutting corners" => {
            Box::new(AStar::new(AStarConfig { corners, ..AStarConfig::default() }))
        }
        "A*, 4 neighbours" => Box::new(AStar4::default()),
        "Dijkstra, cutting corners" => Box::new(Dijkstra::new(DijkstraConfig { corners })),
        "bidirectional A*" => Box::new(BidirectionalAStar::default()),
        _ => panic!("{name}"),
    }
}

/// The map without any clearance, as the papers plan on it.
fn bare(episode: &Episode) -> SearchMap {
    SearchMap::new(&episode.known, LayerConfig::default()).unwrap()
}

fn plan(episode: &Episode, map: &SearchMap, planner: &str) -> Plan {
    let frame = map.frame();
    let query = Query::new(
        frame.cell_from_world(episode.robots[0].start.position).unwrap(),
        frame.cell_from_world(episode.robots[0].goal.position).unwrap(),
    );
    let mut plan = Plan::default();
    baseline(planner)
        .plan_into(map, &query, &mut Workspace::default(), None, &mut plan)
        .unwrap_or_else(|error| panic!("{planner}: {error}"));
    plan
}

/// Scene, planner, steps, and the length as printed in the paper.
const PUBLISHED: [(&str, &str, Cost, &str); 13] = [
    ("you2021/corner_to_corner", "A*", Cost::new(8, 15), "29.213"),
    ("you2021/corner_to_corner", "bidirectional A*", Cost::new(4, 19), "30.870"),
    ("s1/weights", "A*, cutting corners", Cost::new(6, 25), "41.3553"),
    ("s1/random_00", "A*, cutting corners", Cost::new(6, 26), "42.7696"),
    ("s1/random_05", "A*, cutting corners", Cost::new(6, 26), "42.7696"),
    ("s1/random_10", "A*, cutting corners", Cost::new(6, 26), "42.7696"),
    ("s1/random_20", "A*, cutting corners", Cost::new(6, 26), "42.7696"),
    ("s1/random_40", "A*, cutting corners", Cost::new(6, 26), "42.7696"),
    ("zhuyin2024/turning_roadway", "A*, 4 neighbours", Cost::new(77, 0), "77"),
    ("zhuyin2024/consecutive_turns", "A*, 4 neighbours", Cost::new(80, 0), "80"),
    ("zhuyin2024/roadway_to_roadway", "A*, 4 neighbours", Cost::new(88, 0), "88"),
    ("zhuyin2024/coal_mine", "A*, cutting corners", Cost::new(75, 8), "86.31"),
    ("zhuyin2024/coal_mine", "Dijkstra, cutting corners", Cost::new(75, 8), "86.31"),
];

#[test]
fn the_papers_baselines_have_their_published_lengths() {
    for (name, planner, steps, printed) in PUBLISHED {
        let episode = episode(name);
        let plan = plan(&episode, &bare(&episode), planner);
        assert_eq!(plan.cost.steps(), Some(steps), "{name}, {planner}");
        let decimals = printed.split('.').nth(1).map_or(0, str::len);
        assert_eq!(format!("{:.decimals$}", steps.cells()), printed, "{name}, {planner}");
    }
}

#[test]
fn the_readme_lists_every_scene_with_its_published_lengths() {
    let text = readme();
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `")?.split_once(".toml` |"));
    let mut listed: Vec<&str> = rows.map(|(name, _)| name).collect();
    listed.sort_unstable();
    assert_eq!(listed, names());
    for (name, planner, _, printed) in PUBLISHED {
        let row = readme_row(name);
        assert!(row.contains(&format!("{planner}: {printed} m")), "{name}: {row}");
    }
}

fn distance_m(point: Point, segment: Segment) -> f64 {
    let along = segment.b - segment.a;
    let share = (point - segment.a).dot(along) / along.dot(along);
    let nearest = segment.a + along * share.clamp(0.0, 1.0);
    (point - nearest).dot(point - nearest).sqrt()
}

/// \[ZhuYin2024\] prints a clearance of 0 for these paths: they run into obstacles that are not on
/// the map.
#[test]
fn paths_that_ignore_unknown_obstacles_touch_them_where_the_paper_says_so() {
    for (name, planner) in [
        ("zhuyin2024/turning_roadway", "A*, 4 neighbours"),
        ("zhuyin2024/consecutive_turns", "A*, 4 neighbours"),
        ("zhuyin2024/roadway_to_roadway", "A*, 4 neighbours"),
        ("zhuyin2024/coal_mine", "A*, cutting corners"),
        ("zhuyin2024/coal_mine", "Dijkstra, cutting corners"),
        ("zhuyin2024/lab_unknown", "A*, cutting corners"),
    ] {
        let episode = episode(name);
        let radius_m = episode.robots[0].robot.footprint.inscribed_radius_m();
        let inflated = LayerConfig { clearance_m: radius_m, ..LayerConfig::default() };
        let map = SearchMap::new(&episode.known, inflated).unwrap();
        let plan = plan(&episode, &map, planner);
        let line =
            plan.line(&map, episode.robots[0].start.position, episode.robots[0].goal.position);
        let segments: Vec<Segment> = line.polyline().segments().collect();
        let is_touched = episode.obstacles.iter().any(|circle| {
            let reach_m = circle.radius_m + radius_m;
            segments.iter().any(|&segment| distance_m(circle.centre, segment) < reach_m)
        });
        assert!(is_touched, "{name}, {planner}");
    }
}

/// The printed results of \[ZhuYin2024\]'s other baseline, RRT, are possible; those of table 3
/// are not, as the README says.
#[test]
fn shortest_lines() {
    let shortest_m = |name: &str| {
        let episode = episode(name);
        let (start, goal) = (episode.robots[0].start.position, episode.robots[0].goal.position);
        shortest_line(&bare(&episode), CornerRule::Allow, start, goal).unwrap().length_m()
    };
    for (name, rrt_m) in [
        ("zhuyin2024/turning_roadway", 66.78),
        ("zhuyin2024/consecutive_turns", 77.99),
        ("zhuyin2024/roadway_to_roadway", 90.39),
    ] {
        let shortest_m = shortest_m(name);
        assert!(shortest_m < rrt_m, "{name}: {shortest_m}");
        let row = readme_row(name);
        assert!(row.contains(&format!("shortest line {shortest_m:.2} m")), "{name}: {shortest_m}");
    }
    let coal_mine_m = shortest_m("zhuyin2024/coal_mine");
    assert!(coal_mine_m > 75.53, "{coal_mine_m}");
    let row = readme_row("zhuyin2024/coal_mine");
    assert!(row.contains(&format!("shortest line {coal_mine_m:.2} m")), "{coal_mine_m}");
}

/// Each scene has the obstacles of the one before it, and some more.
#[test]
fn random_obstacles_are_added() {
    let scenes = [0, 5, 10, 20, 40].map(|count| (count, episode(&format!("s1/random_{count:02}"))));
    for (count, episode) in &scenes {
        assert_eq!(episode.obstacles.len(), *count);
    }
    for pair in scenes.windows(2) {
        let [(fewer, before), (_, after)] = pair else { unreachable!() };
        assert_eq!(before.obstacles, after.obstacles[..*fewer]);
        assert_eq!((&before.known, before.robots[0].start), (&after.known, after.robots[0].start));
    }
}

/// Moving obstacles stay clear of walls, static obstacles, starts and goals.
#[test]
fn movers_pass_through_nothing() {
    let mut movers = 0;
    for name in names() {
        let episode = episode(&name);
        let map = bare(&episode);
        movers += episode.movers.len();
        for (mover, tenth_s) in
            episode.movers.iter().flat_map(|mover| (0..3000).map(move |tenth_s| (mover, tenth_s)))
        {
            let Disc { centre, radius_m, .. } = mover.at(f64::from(tenth_s) / 10.0);
            let away_m = |point: Point| (point - centre).dot(point - centre).sqrt() - radius_m;
            let from_walls_m = map.clearance().of_point(centre, 5.0) - radius_m;
            let standing = episode.obstacles.iter();
            let from_standing_m =
                standing.map(|other| away_m(other.centre) - other.radius_m).fold(1.0, f64::min);
            let from_ends_m = away_m(episode.robots[0].start.position)
                .min(away_m(episode.robots[0].goal.position));
            assert!(from_walls_m.min(from_standing_m).min(from_ends_m) > 0.0, "{name}, {centre:?}");
        }
    }
    assert_eq!(movers, 6);
}

/// The outcome of a scene in `docs/lab/findings.md`, with the default stack and the scene's robot.
fn documented(scene: &str) -> EpisodeOutcome {
    let path = folder().join("../docs/lab/findings.md");
    let text = std::fs::read_to_string(path).unwrap();
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let mut lines = text.lines().skip_while(|line| !line.starts_with("For the scene's robot"));
    let head = cells(lines.find(|line| line.starts_with("| scene |")).unwrap());
    let column = head.iter().position(|stack| stack == Stack::DEFAULT).unwrap();
    let row = lines.map(cells).find(|row| row[0] == scene);
    let row = row.unwrap_or_else(|| panic!("{scene} is not in the table"));
    match row[column].as_str() {
        "no path" => EpisodeOutcome::NoPath,
        cell if cell.starts_with(|first: char| first.is_ascii_digit()) => EpisodeOutcome::Reached,
        cell if cell.starts_with("contact") || cell.starts_with("run into") => {
            EpisodeOutcome::Collided
        }
        cell if cell.starts_with("stuck") => EpisodeOutcome::Stuck,
        cell if cell.starts_with("timeout") => EpisodeOutcome::Timeout,
        cell => panic!("{scene}: {cell}"),
    }
}

/// Every run ends as documented; without moving obstacles, it has no contact.
fn drive(paper: &str) {
    for name in names().iter().filter(|name| name.starts_with(paper)) {
        let episode = episode(name);
        let report =
            run_episode(&episode).unwrap_or_else(|error| panic!("{name}: {error}")).first();
        let RobotReport { outcome, reason, run, .. } = report;
        assert!(run.is_some(), "{name}: {reason:?}");
        assert_eq!(outcome, documented(name.split('/').next_back().unwrap()), "{name}: {reason:?}");
        let has_contact = outcome == EpisodeOutcome::Collided;
        assert!(!has_contact || !episode.movers.is_empty(), "{name}: {reason:?}");
    }
}

#[test]
fn the_default_stack_drives_the_scene_of_you2021() {
    drive("you2021/");
}

#[test]
fn the_default_stack_drives_the_scenes_of_s1() {
    drive("s1/");
}

#[test]
fn the_default_stack_drives_the_scenes_of_zhuyin2024() {
    drive("zhuyin2024/");
}
