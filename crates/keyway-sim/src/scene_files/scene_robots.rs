//! Robots of a scene.

#[cfg(feature = "schema")]
use super::robot_in_scene::robot_schema;
use super::robot_in_scene::some_name_or_table;
use crate::episode::Start;
use keyway::geometry::Point;
use keyway::navigate::Goal;
use serde::{Deserialize, Serialize};

/// One of several robots of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SceneRobot {
    /// Start pose of the robot.
    pub start: Start,
    /// Way-points, in this order \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<Point>,
    /// Goal of the robot.
    pub goal: Goal,
    /// Name of a bundled robot, or a robot file, or a table with the fields of one; `None`: the
    /// robot of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(deserialize_with = "some_name_or_table")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "robot_schema"))]
    pub robot: Option<String>,
    /// Name of a stack, or a stack file; `None`: the stack of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stack: Option<String>,
}

impl SceneRobot {
    /// Returns the first coordinate of the robot's positions that is not finite, with its field.
    pub(super) fn not_finite(&self) -> Option<(String, f64)> {
        let Self { start, via, goal, .. } = self;
        let pose = |name: &str, Point { x, y }: Point, heading_rad: Option<f64>| {
            let numbers = [x, y, heading_rad.unwrap_or_default()].into_iter().enumerate();
            numbers.map(|(i, value)| (format!("{name}[{i}]"), value)).collect::<Vec<_>>()
        };
        let via = via.iter().enumerate().flat_map(|(i, &at)| pose(&format!("via[{i}]"), at, None));
        let ends = pose("start", start.position, start.heading_rad).into_iter().chain(pose(
            "goal",
            goal.position,
            goal.heading_rad,
        ));
        ends.chain(via).find(|(_, value)| !value.is_finite())
    }

    /// Returns all positions that the robot has to visit.
    pub(super) fn places(&self) -> impl Iterator<Item = Point> + '_ {
        [self.start.position, self.goal.position].into_iter().chain(self.via.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Episode;
    use crate::scene_files::{SceneError, SceneFile};
    use crate::sim::Disturbances;
    use keyway::geometry::Disc;
    use keyway::map::formats::map_from_bytes;
    use keyway::map::{Cell, CellState};
    use keyway::navigate::Stack;
    use keyway::robot::Robot;
    use std::error::Error;
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::path::Path;

    const TWO: &str = "version = 2\nmap = \"a.map\"\nseed = 7\nstack = \"s0-key-point\"\n\
        [disturbances.actuation]\ndelay_s = 0.1\n\
        [[robots]]\nstart = [1, 2, 90]\ngoal = [3.5, 4]\n\
        [[robots]]\nstart = [3, 2]\ngoal = [1, 4, 180]\nvia = [[2, 3]]\nrobot = \"jackal\"\nstack = \"mine.toml\"\n";

    fn error(text: &str) -> String {
        SceneFile::from_toml(text).unwrap_err().to_string()
    }

    #[test]
    fn each_robot_has_its_own_way_and_stack_or_those_of_the_scene() {
        let scene = SceneFile::from_toml(TWO).unwrap();
        assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
        let map = || map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
        let mut asked = Vec::new();
        let found = |robot: &str, stack: &str| {
            asked.push((robot.to_owned(), stack.to_owned()));
            let robot = Robot::by_name(robot).ok_or("no robot")?;
            let stack = Stack::key_point_fusion(&robot);
            Ok::<_, Box<dyn Error>>((robot, stack))
        };
        let Episode { robots, .. } = scene.episode(map(), found).unwrap();
        let name = |robot: &str, stack: &str| (robot.to_owned(), stack.to_owned());
        assert_eq!(asked, [name("small", "s0-key-point"), name("jackal", "mine.toml")]);
        assert_eq!(
            (robots[0].start.heading_rad, robots[1].goal.heading_rad),
            (Some(FRAC_PI_2), Some(PI))
        );
        assert_eq!((robots[0].via.len(), robots[1].via[0]), (0, Point::new(2.0, 3.0)));
        assert_eq!(robots[1].stack_name, "mine.toml");
        let noisy = |it: &Disturbances| (it.seed, it.actuation.delay_s);
        assert!(robots.iter().all(|robot| noisy(&robot.disturbances) == (7, 0.1)));
        let refused = scene.episode(map(), |_, _| Err::<_, Box<dyn Error>>("no such robot".into()));
        assert_eq!(refused.unwrap_err().to_string(), "no such robot");
        // The same robot and stack for all of them.
        let (robot, stack) = (Robot::jackal(), Stack::by_name("keyway", &Robot::jackal()).unwrap());
        let same = scene.episode_with(map(), &robot, &stack).unwrap();
        assert!(same.robots.iter().all(|one| one.robot == robot && one.stack == stack));
        assert_eq!(same.robots.len(), 2);
    }

    #[test]
    fn a_scene_of_one_robot_is_an_episode_of_one() {
        let text =
            "version = 2\nmap = \"a.map\"\nstart = [1, 2]\nvia = [[2, 2]]\ngoal = [3.5, 4]\n";
        let scene = SceneFile::from_toml(text).unwrap();
        let octile = b"type octile\nheight 2\nwidth 2\nmap\n..\n..\n";
        let map = map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
        let small = |_: &str, _: &str| {
            let robot = Robot::small();
            let stack = Stack::key_point_fusion(&robot);
            Ok::<_, SceneError>((robot, stack))
        };
        let episode = scene.episode(map, small).unwrap();
        assert_eq!(episode.robots.len(), 1);
        assert_eq!((Some(episode.robots[0].start), episode.robots[0].via.len()), (scene.start, 1));
    }

    #[test]
    fn several_robots_have_what_no_map_shows_and_what_is_random_in_their_world() {
        let walk = "[[moving]]\nradius_m = 0.1\n[moving.random_walk]\nposition = [2, 2]\n\
            area = [[1, 1], [3, 3]]\nspeed_mps = [1, 2]\nleg_s = [1, 2]\n";
        let shapes = "[[unknown]]\nvertices_m = [[0, 0], [2, 0], [2, 1]]\n\
            [[unknown]]\ncells = [[4, 0], [3, 2], [4, 0]]\n[[unknown]]\nposition = [2, 3]\nradius_m = 0.5\n";
        let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
        let map = || map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
        let small = |_: &str, _: &str| {
            let robot = Robot::small();
            let stack = Stack::key_point_fusion(&robot);
            Ok::<_, SceneError>((robot, stack))
        };
        let episode = |text: &str| SceneFile::from_toml(text).unwrap().episode(map(), small);
        let shown = episode(&format!("{TWO}{walk}{shapes}")).unwrap();
        assert_eq!(shown.obstacles, [Disc::new(Point::new(2.0, 3.0), 0.5)]);
        assert_eq!(shown.hidden_cells, [Cell::new(3, 2), Cell::new(4, 0)]);
        assert_eq!(shown.polygons[0].vertices().len(), 3);
        // As for one robot, the walk follows from the seed of the scene.
        let other = TWO.replace("seed = 7", "seed = 8");
        assert_ne!(episode(&format!("{other}{walk}")).unwrap().movers, shown.movers);
        let one = "version = 2\nmap = \"a.map\"\nseed = 7\nstart = [1, 2]\ngoal = [3.5, 4]\n";
        let robot = Robot::small();
        let stack = Stack::key_point_fusion(&robot);
        let alone = SceneFile::from_toml(&format!("{one}{walk}")).unwrap();
        assert_eq!(alone.episode_with(map(), &robot, &stack).unwrap().movers, shown.movers);
        let off = episode(&format!("{TWO}[[unknown]]\ncells = [[1, 1], [5, 0]]\n")).unwrap_err();
        assert!(off.to_string().starts_with("`unknown[0].cells[1]` must be a cell"), "{off}");
        let random =
            "[random]\nfree_ends_m = 0.1\n[random.unknown]\ncount = 1\nradius_m = [0.1, 0.2]\n";
        let drawn = episode(&format!("{TWO}{random}")).unwrap();
        assert_eq!(drawn.random.map(|placed| placed.unknown_placed), Some(1));
        assert_ne!(drawn.obstacles, episode(&format!("{other}{random}")).unwrap().obstacles);
        // An episode of one robot in `robots` has the obstacles of this robot.
        let robot = Robot::small();
        let stack = Stack::key_point_fusion(&robot);
        let alone = SceneFile::from_toml(&format!("{one}{random}")).unwrap();
        let alone = alone.episode_with(map(), &robot, &stack).unwrap();
        let of_one = episode(&format!("{one}{random}")).unwrap();
        assert_eq!((of_one.obstacles, of_one.random), (alone.obstacles, alone.random));
    }

    #[test]
    fn a_generated_map_has_room_for_every_robot() {
        let world = "[world]\nwidth_m = 8\nheight_m = 8\nresolution_m = 0.1\n\
            [world.obstacles.clutter]\nshare = 0.5\nradius_m = [0.2, 0.4]\n";
        let text = TWO.replace("map = \"a.map\"\n", "").replace(
            "[[robots]]\nstart = [1, 2, 90]",
            &format!("{world}[[robots]]\nstart = [1, 2, 90]"),
        );
        for seed in 0..5 {
            let scene = SceneFile { seed, ..SceneFile::from_toml(&text).unwrap() };
            let grid = scene.generated_map().unwrap().unwrap().grid;
            for [x, y] in [[1.0, 2.0], [3.5, 4.0], [3.0, 2.0], [1.0, 4.0], [2.0, 3.0]] {
                let cell = grid.frame().cell_from_world(Point::new(x, y)).unwrap();
                assert_eq!(grid.state(cell), Some(CellState::Free), "{seed}: {x}, {y}");
            }
        }
    }

    #[test]
    fn errors_name_the_robot_and_its_field() {
        assert!(error(&TWO.replace("[1, 2, 90]", "[1, nan]")).starts_with("`robots[0].start[1]`"));
        assert!(error(&TWO.replace("1, 4, 180", "1, 4, inf")).starts_with("`robots[1].goal[2]`"));
        assert!(error(&TWO.replace("[2, 3]", "[2, nan]")).starts_with("`robots[1].via[0][1]`"));
        let unknown = error(&TWO.replace("via =", "by ="));
        assert!(unknown.contains("`robots[1].by`: unknown field `by`"), "{unknown}");
        let missing = error(&TWO.replace("goal = [3.5, 4]\n", ""));
        assert!(missing.contains("`robots[0]`") && missing.contains("`goal`"), "{missing}");
        assert_eq!(
            error(
                &TWO.replace("version = 2", "version = 1")
                    .replace("seed = 7\n", "")
                    .replace("[disturbances.actuation]\ndelay_s = 0.1\n", "")
            ),
            "`robots` needs `version = 2`"
        );
        let either = "a scene has either `start` and `goal` or `[[robots]]`, got ";
        let both = error(&TWO.replace("seed = 7", "start = [1, 2]"));
        assert_eq!(both, format!("{either}`start`, `[[robots]]`"));
        let via = error(&TWO.replace("seed = 7", "via = [[1, 2]]"));
        assert_eq!(via, format!("{either}`via`, `[[robots]]`"));
        let none = "version = 2\nmap = \"a.map\"\n";
        assert_eq!(error(none), format!("{either}neither"));
        assert_eq!(error(&format!("{none}goal = [1, 2]\n")), format!("{either}`goal`"));
    }
}
