//! Scenes of simple narrow places for robots of any shape, by seed.

mod places;
mod robots;

use super::{NamedScene, ScenesError};
use keyway::geometry::{Point, Pose};
use keyway::map::{DistanceField, FieldConfig};
use keyway::navigate::Goal;
use keyway::random::Random;
use keyway::robot::Robot;
use keyway_sim::episode::Start;
use keyway_sim::scene_files::SceneFile;
use keyway_sim::worlds::{Boxes, GeneratedMap, Pattern};
use places::Place;
use robots::any_robot;

/// Request for scenes of simple narrow places: tunnels, doors, bays, corners, lanes, rooms with
/// furniture, and walls to drive along. Each has its own robot, from a disc of 0.1 m to a
/// rectangle of 1.2 m x 0.6 m that turns about a point near its rear, of 0.3 to 3 m/s. The whole
/// map is known.
///
/// Some scenes cannot be driven at all: the example `possible_poses` of this crate identifies
/// them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NarrowRequest {
    /// Names of kinds, such as `tunnel`; if empty, all of them.
    pub names: Vec<String>,
    /// Seed of the first scene of each kind.
    pub seed: u64,
    /// Number of scenes of each kind, with consecutive seeds.
    pub count: usize,
}

impl NarrowRequest {
    /// The names of all kinds.
    pub fn all_names() -> impl Iterator<Item = &'static str> {
        Place::ALL.iter().map(|place| place.name)
    }

    /// Returns the scenes of each kind, in the order of their seeds.
    ///
    /// # Errors
    /// Returns [`ScenesError`] if no such kind exists.
    pub fn scenes(&self) -> Result<Vec<NamedScene>, ScenesError> {
        let is_unknown = |name: &&String| Self::all_names().all(|known| known != name.as_str());
        if let Some(name) = self.names.iter().find(is_unknown) {
            let known = Self::all_names().collect();
            return Err(ScenesError::Unknown { what: "kind", name: name.clone(), known });
        }
        let is_wanted = |place: &&Place| {
            self.names.is_empty() || self.names.iter().any(|name| name == place.name)
        };
        let mut scenes = Vec::new();
        for place in Place::ALL.iter().filter(is_wanted) {
            for seed in (self.seed..).take(self.count) {
                let scene = scene(place, seed).map_err(ScenesError::Narrow)?;
                scenes.push(NamedScene { file: format!("{}_{seed:05}.toml", place.name), scene });
            }
        }
        Ok(scenes)
    }
}

/// Side of the square maps \[m\], and of their cells.
const SIDE_M: f64 = 10.0;
const CELL_M: f64 = 0.05;

/// Start and goal pose of a robot, in the frame of the map, whose centre is (0, 0).
#[derive(Clone, Copy, Debug)]
struct Ends {
    start: Pose,
    goal: Pose,
    has_heading: bool,
}

/// Returns the scene of a seed: of all that are drawn, the first one in which the robot fits at
/// its start and goal.
fn scene(place: &Place, seed: u64) -> Result<SceneFile, keyway_sim::scene_files::SceneError> {
    /// Maximum number of draws, which hardly ever all fail.
    const MOST_DRAWS: u32 = 200;
    let name: u64 = place.name.bytes().fold(0, |name, byte| name << 8 | u64::from(byte));
    let mut random = Random::stream(seed, &[name]);
    let mut drawn = draw(place, &mut random);
    for _ in 0..MOST_DRAWS {
        if fits(&drawn) {
            break;
        }
        drawn = draw(place, &mut random);
    }
    let Drawn { robot, world, ends: Ends { start, goal, has_heading } } = drawn;
    let ends = (
        Start { position: start.point(), heading_rad: Some(start.theta) },
        Goal { position: goal.point(), heading_rad: has_heading.then_some(goal.theta) },
    );
    let scene = SceneFile {
        description: Some(place.about.to_owned()),
        world: Some(world),
        // A robot is plain data with string keys: this cannot fail.
        robot: toml::Value::try_from(&robot).map(|robot| robot.to_string()).unwrap_or_default(),
        ..SceneFile::new(ends.0, ends.1)
    };
    scene.validate()?;
    Ok(scene)
}

struct Drawn {
    robot: Robot,
    world: GeneratedMap,
    ends: Ends,
}

/// Draws a robot and a place for it; the place is rotated on the map.
fn draw(place: &Place, random: &mut Random) -> Drawn {
    let robot = any_robot(random);
    let (boxes, ends) = (place.draw)(&robot, random);
    let turned_deg = match random.below(3) {
        0 => 90.0 * f64::from(random.below(4)),
        1 => 45.0 * f64::from(random.below(8)),
        _ => random.between([0.0, 360.0]).round(),
    };
    let turn = Pose::new(0.0, 0.0, turned_deg.to_radians());
    let turned = |pose: Pose| rounded(turn.compose(pose));
    let ends = Ends { start: turned(ends.start), goal: turned(ends.goal), ..ends };
    let boxes = boxes.into_iter().map(|of| of.map(|at_m| to(at_m, 1e4))).collect();
    let world = GeneratedMap {
        origin: Point::new(-0.5 * SIDE_M, -0.5 * SIDE_M),
        free_ends_m: 0.0,
        obstacles: Pattern::Boxes(Boxes { boxes, turned_deg }),
        ..GeneratedMap::empty(SIDE_M, SIDE_M, CELL_M)
    };
    Drawn { robot, world, ends }
}

/// True if the robot has a margin of a centimetre at its start and goal.
fn fits(drawn: &Drawn) -> bool {
    const MARGIN_M: f64 = 0.01;
    let Ok(grid) = drawn.world.generate(0, &[]) else { return false };
    let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
    let (footprint, clearance) = (&drawn.robot.footprint, field.clearance());
    [drawn.ends.start, drawn.ends.goal].into_iter().all(|pose| {
        let room_m = footprint.distance_m(pose, &clearance, 1.0);
        room_m.min(footprint.to_border_m(pose, &clearance)) >= MARGIN_M
    })
}

/// Rounds to a millimetre and a tenth of a degree.
fn rounded(pose: Pose) -> Pose {
    let theta = to(pose.theta.to_degrees(), 10.0).to_radians();
    Pose { x: to(pose.x, 1e3), y: to(pose.y, 1e3), theta }
}

/// Rounds a number to whole parts of 1.
fn to(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(names: &[&str], seed: u64, count: usize) -> NarrowRequest {
        NarrowRequest { names: names.iter().map(|&name| name.to_owned()).collect(), seed, count }
    }

    #[test]
    fn each_seed_is_a_scene_of_its_own_that_others_do_not_change() {
        let all = request(&[], 5, 3).scenes().unwrap();
        assert_eq!(all.len(), 3 * Place::ALL.len());
        let one = request(&["bay"], 6, 1).scenes().unwrap();
        let same = all.iter().find(|named| named.file == "bay_00006.toml").unwrap();
        assert_eq!(&one[0], same);
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a.scene.robot != b.scene.robot), "{}", a.file);
        }
    }

    /// In nearly all of many draws, the robot fits at its start and goal.
    #[test]
    fn robots_fit_where_they_begin_and_end() {
        for place in Place::ALL {
            for seed in 0..20 {
                let scene = scene(place, seed).unwrap();
                let robot = keyway::files::robot_in_place(&scene.robot).unwrap();
                let (start, goal) = (scene.start.unwrap(), scene.goal.unwrap());
                let pose = |at: Point, theta: Option<f64>| Pose {
                    x: at.x,
                    y: at.y,
                    theta: theta.unwrap_or_default(),
                };
                let grid = scene.world.unwrap().generate(0, &[]).unwrap();
                let field =
                    DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
                let is_free = |pose| robot.footprint.is_free(pose, &field);
                assert!(is_free(pose(start.position, start.heading_rad)), "{} {seed}", place.name);
                let is_free_at_goal =
                    goal.heading_rad.is_none() || is_free(pose(goal.position, goal.heading_rad));
                assert!(is_free_at_goal, "{} {seed}", place.name);
            }
        }
    }

    #[test]
    fn kinds_are_chosen_by_their_names() {
        let error = request(&["tunel"], 1, 1).scenes().unwrap_err();
        let expected = "there is no kind `tunel`; expected one of tunnel, door";
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(error.to_string().ends_with("; did you mean `tunnel`?"), "{error}");
        assert_eq!(error.field(), Some("names"));
    }
}
