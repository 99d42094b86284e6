use super::super::{SceneError, SceneFile};
use super::*;
use crate::episode::Episode;
use keyway::map::formats::map_from_bytes;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use std::path::Path;

const SCENE: &str = "version = 2\nmap = \"a.map\"\nstart = [1, 2]\ngoal = [3.5, 4]\n";
const SHAPES: &str = "[[unknown]]\nvertices_m = [[0, 0], [2, 0], [2, 1], [1, 0.5]]\n\
                      [[unknown]]\ncells = [[3, 2], [4, 0]]\n\
                      [[unknown]]\nposition = [2, 3]\nradius_m = 0.5\n";

fn error(text: &str) -> String {
    SceneFile::from_toml(text).unwrap_err().to_string()
}

fn episode(text: &str) -> Result<Episode, SceneError> {
    let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
    let map = map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
    let robot = Robot::small();
    let stack = Stack::key_point_fusion(&robot);
    SceneFile::from_toml(text).unwrap().episode_with(map, &robot, &stack)
}

#[test]
fn each_kind_comes_into_the_world() {
    let scene = SceneFile::from_toml(&format!("{SCENE}{SHAPES}")).unwrap();
    assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
    let episode = episode(&format!("{SCENE}{SHAPES}")).unwrap();
    assert_eq!(episode.obstacles, [Disc::new(Point::new(2.0, 3.0), 0.5)]);
    assert_eq!(episode.hidden_cells, [Cell::new(3, 2), Cell::new(4, 0)]);
    assert_eq!(episode.polygons[0].vertices()[3], Point::new(1.0, 0.5));
}

#[test]
fn what_stands_for_a_time_or_is_hard_to_see_is_elusive() {
    let text = format!(
        "{SCENE}[[unknown]]\nposition = [2, 3]\nradius_m = 0.5\nfrom_s = 8\n\
         [[unknown]]\nvertices_m = [[0, 0], [2, 0], [2, 1]]\nuntil_s = 20\n\
         [[unknown]]\ncells = [[3, 2], [4, 0]]\nseen = 0.1\n\
         [[unknown]]\nposition = [2, 3]\nradius_m = 0.5\nfrom_s = 0\nseen = 1\n"
    );
    let scene = SceneFile::from_toml(&text).unwrap();
    assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
    assert!(scene.is_random(), "which beams see it");
    let episode = episode(&text).unwrap();
    assert_eq!((episode.obstacles.len(), episode.polygons.len()), (1, 0));
    let presences: Vec<_> = episode.elusive.iter().map(ElusiveObstacle::presence).collect();
    let always = Presence::ALWAYS;
    let expected = [
        Presence { from_s: 8.0, ..always },
        Presence { until_s: Some(20.0), ..always },
        Presence { seen: 0.1, ..always },
        Presence { seen: 0.1, ..always },
    ];
    assert_eq!(presences, expected);
    let ElusiveShape::Polygon(square) = episode.elusive[2].shape() else { panic!() };
    let corners = [[3.0, 2.0], [4.0, 2.0], [4.0, 3.0], [3.0, 3.0]].map(Point::from);
    assert_eq!(square.vertices(), corners);
}

#[test]
fn occupied_cells_that_are_covered_are_absent() {
    // All columns except the left one are occupied; the start and the goal need not be free here.
    let map = OccupancyGrid::from_ascii(&[".####", ".####", ".####", ".####", ".####"]);
    let absent = |table: &str| {
        let text = format!("{SCENE}[[absent]]\n{table}\n");
        let scene = SceneFile::from_toml(&text).unwrap();
        assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        let cells = absent_cells(&scene.absent, &map).unwrap();
        cells.into_iter().map(|cell| (cell.x, cell.y)).collect::<Vec<_>>()
    };
    assert_eq!(absent("cells = [[3, 2], [1, 2], [0, 2], [3, 2]]"), [(1, 2), (3, 2)]);
    // By their centres, borders included; free cells are not absent.
    assert_eq!(absent("vertices_m = [[0, 1], [2.5, 1], [2.5, 2], [0, 2]]"), [(1, 1), (2, 1)]);
    assert_eq!(
        absent("position = [2.5, 2.5]\nradius_m = 1"),
        [(1, 2), (2, 1), (2, 2), (2, 3), (3, 2)]
    );
    let bad = |table: &str| error(&format!("{SCENE}[[absent]]\n{table}\n"));
    let timed = bad("cells = [[1, 1]]\nuntil_s = 3");
    assert!(timed.contains("`from_s`, `until_s` and `seen` belong to"), "{timed}");
    let nan = bad("position = [nan, 1]\nradius_m = 1");
    assert!(nan.starts_with("`absent[0].position[0]` must be a finite"), "{nan}");
    let off = episode(&format!("{SCENE}[[absent]]\ncells = [[5, 0]]\n"));
    let off = off.unwrap_err().to_string();
    assert!(off.starts_with("`absent[0].cells[0]` must be a cell of the map"), "{off}");
    let old = SCENE.replace("version = 2", "version = 1");
    let old = error(&format!("{old}[[absent]]\ncells = [[1, 1]]\n"));
    assert_eq!(old, "`absent` needs `version = 2`");
}

#[test]
fn what_is_random_follows_from_the_seed() {
    let walk = "[[moving]]\nradius_m = 0.1\n[moving.random_walk]\nposition = [2, 2]\n\
                area = [[1, 1], [3, 3]]\nspeed_mps = [1, 2]\nleg_s = [1, 2]\n";
    let own = format!("{walk}seed = 9\n");
    let random = "[random.unknown]\ncount = 1\nradius_m = [0.1, 0.2]\n";
    let scene = |seed: u32, text: &str| {
        let scene = SCENE.replace("version = 2", &format!("version = 2\nseed = {seed}"));
        format!("{scene}{text}{own}{random}")
    };
    let read = |text: &str| SceneFile::from_toml(text).unwrap();
    let first = read(&scene(1, walk));
    assert!(first.is_random());
    assert_eq!(read(&toml::to_string(&first).unwrap()), first);
    let movers = |seed| episode(&scene(seed, walk)).unwrap().movers;
    assert_eq!(movers(1), movers(1));
    assert_ne!(movers(1)[0], movers(2)[0]);
    assert_eq!(movers(1)[1], movers(2)[1]);
    // Two walks without a seed are different.
    let twice = episode(&scene(1, &format!("{walk}{walk}"))).unwrap().movers;
    assert_ne!(twice[0], twice[1]);
    let alone = |text: &str| read(&format!("{SCENE}{text}")).is_random();
    assert!(alone(walk) && alone(random) && !alone(&own));
    assert_eq!(episode(&scene(1, walk)).unwrap().random.unwrap().unknown_asked, 1);
    let bad = error(&format!("{SCENE}{}", random.replace("0.1, ", "-0.1, ")));
    assert_eq!(bad, "`random.unknown.radius_m[0]` must be a positive number, got -0.1");
    let old = error(&format!("{SCENE}{random}").replace("version = 2", "version = 1"));
    assert_eq!(old, "`random` needs `version = 2`");
}

#[test]
fn errors_name_the_field() {
    let bad = |table: &str| error(&format!("{SCENE}[[unknown]]\n{table}\n"));
    let both = bad("cells = [[1, 1]]\nradius_m = 1");
    assert!(both.contains("`unknown[0]`: the shape must be"), "{both}");
    assert!(both.contains("got `radius_m`, `cells`"), "{both}");
    assert!(bad("cells = []").contains("`unknown[0]`: cells needs at least one cell"));
    let bow = bad("vertices_m = [[0, 0], [1, 1], [1, 0], [0, 1]]");
    assert!(bow.contains("line 5") && bow.contains("`unknown[0]`: vertices_m must not"), "{bow}");
    let half = bad("cells = [[0.5, 1]]");
    assert!(half.contains("`unknown[0].cells[0]") || half.contains("`unknown[0]"), "{half}");
    let nan = bad("position = [nan, 1]\nradius_m = 1");
    assert!(nan.starts_with("`unknown[0].position[0]` must be a finite"), "{nan}");
    let before = bad("cells = [[1, 1]]\nfrom_s = 3\nuntil_s = 2");
    assert!(before.contains("until_s must be a time after `from_s`, got 2"), "{before}");
    let off = format!("{SCENE}{SHAPES}[[unknown]]\ncells = [[1, 1], [5, 0]]\n");
    let off = episode(&off).unwrap_err().to_string();
    assert_eq!(off, "`unknown[3].cells[1]` must be a cell of the map of 5 x 5 cells, got (5, 0)");
    let first = format!("{SCENE}{SHAPES}").replace("version = 2", "version = 1");
    assert_eq!(error(&first), "`unknown.vertices_m` needs `version = 2`");
}
