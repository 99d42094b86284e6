//! The scene file, version 2.

use super::scene_robots::SceneRobot;
use super::scene_rules::SceneRules;
use super::toml_text::{TomlError, from_toml};
use crate::ConfigError;
use crate::episode::{Episode, Start, Team, TeamRobot};
use crate::geometry::Point;
use crate::given::Given;
use crate::map::OccupancyGrid;
use crate::map::formats::{LoadedMap, digest};
use crate::navigate::{Goal, Stack};
use crate::report::MapSource;
use crate::robot::Robot;
use crate::sim::{Circle, Disturbances, Mover};
use crate::worlds::{GeneratedMap, Pattern};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use thiserror::Error;

/// A run to be made: map, robot, start, goal, and what stands or moves in the world but is not on the map.
///
/// ```
/// use keyway::files::SceneFile;
/// use keyway::geometry::Point;
/// let scene = SceneFile::from_toml(r#"
///     version = 1
///     map = "office.yaml"
///     robot = "small"
///     start = [1.0, 2.0, 90.0]
///     goal = [7.5, 2.0]
///
///     [[unknown]]
///     position = [4.0, 2.0]
///     radius_m = 0.15
///
///     [[moving]]
///     way_points = [[2.0, 5.0], [6.0, 5.0]]
///     speed_mps = 0.8
///     radius_m = 0.25
/// "#)?;
/// assert_eq!((scene.start.unwrap().yaw_deg, scene.unknown.len()), (Some(90.0), 1));
/// assert_eq!(scene.moving[0].at(2.5).centre, Point::new(4.0, 5.0));
/// # Ok::<(), keyway::files::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format: 2; files of version 1, which have no `world`, `seed`, `rules`, `disturbances` and `robots`, are read, too.
    pub version: u32,
    /// What the scene shows, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Map file, absolute or relative to the folder of the scene file; `None` where there is a `world`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<PathBuf>,
    /// A map that is made from the seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<GeneratedMap>,
    /// Of all that is random.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub seed: u64,
    /// Name of a bundled robot, or a robot file, absolute or relative to the folder of the scene
    /// file.
    #[serde(default = "default_robot")]
    pub robot: String,
    /// Name of a stack, or a stack file, absolute or relative to the folder of the scene file.
    #[serde(default = "default_stack")]
    pub stack: String,
    /// Where the robot stands; `None` where there are `robots`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// By way of which points, in their order \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<Point>,
    /// Where it is to go; `None` where there are `robots`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<Goal>,
    /// What keeps the robot from being ideal; its random numbers are those of the scene's `seed`.
    #[serde(default, skip_serializing_if = "Disturbances::is_none")]
    pub disturbances: Disturbances,
    /// When a run ends.
    #[serde(default, skip_serializing_if = "SceneRules::are_usual")]
    pub rules: SceneRules,
    /// Robots that drive at the same time, in the place of `start`, `via` and `goal`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<SceneRobot>,
    /// Obstacles that stand and are not on the map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknown: Vec<UnknownCircle>,
    /// Obstacles that move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<Mover>,
}

/// The map that a scene's run is made on.
#[derive(Clone, Debug)]
pub struct SceneMap {
    /// The map.
    pub grid: OccupancyGrid,
    /// What identifies it in reports.
    pub source: MapSource,
}

impl From<LoadedMap> for SceneMap {
    fn from(loaded: LoadedMap) -> Self {
        Self { source: MapSource::from(&loaded), grid: loaded.grid }
    }
}

/// A round obstacle that no map shows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnknownCircle {
    /// Its centre \[m\].
    pub position: Point,
    /// Its radius \[m\].
    pub radius_m: f64,
}

/// Why a scene cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Not TOML, or not a scene.
    #[error(transparent)]
    Toml(#[from] TomlError),
    /// A scene of a later format.
    #[error(
        "`version` is {found}; this program reads scenes of version 1 and {}",
        SceneFile::VERSION
    )]
    Version {
        /// What the file says.
        found: String,
    },
    /// A field that files of version 1 do not have.
    #[error("`{field}` needs `version = {}`", SceneFile::VERSION)]
    NeedsVersion {
        /// The field.
        field: &'static str,
    },
    /// Neither a map file nor a generated map, or both.
    #[error("a scene has either a `map` or a `[world]`, got {}", if *.both { "both" } else { "neither" })]
    MapOrWorld {
        /// Whether there are both.
        both: bool,
    },
    /// Neither a start and a goal nor several robots, or both.
    #[error("a scene has either `start` and `goal` or `[[robots]]`, got {got}")]
    OneOrSeveral {
        /// What there is of them.
        got: String,
    },
    /// Several robots where one was expected.
    #[error("a scene with `[[robots]]` is no run of one robot")]
    SeveralRobots,
    /// A seed of the disturbances alone.
    #[error("`disturbances.seed` is the `seed` of the scene; give it there")]
    SeedOfDisturbances,
    /// A value of the rules that cannot be used.
    #[error("`rules.{}` {}", .0.path, .0.reason)]
    Rules(ConfigError),
    /// A value of the disturbances that cannot be used.
    #[error("`disturbances.{}` {}", .0.path, .0.reason)]
    Disturbances(ConfigError),
    /// A value of a generated map that cannot be used.
    #[error("`world.{}` {}", .0.path, .0.reason)]
    World(ConfigError),
    /// A value that cannot be used.
    #[error("`{field}` must be {expected}, got {}", Given(*.value))]
    Value {
        /// The field, as a path such as `unknown[0].radius_m`.
        field: String,
        /// What was expected.
        expected: &'static str,
        /// What was given.
        value: f64,
    },
}

/// The version, and what files of version 1 do not have: the rest of a later format may be anything.
#[derive(Deserialize)]
struct Versioned {
    version: toml::Value,
    world: Option<toml::Value>,
    seed: Option<toml::Value>,
    rules: Option<toml::Value>,
    disturbances: Option<toml::Value>,
    robots: Option<toml::Value>,
}

impl Versioned {
    /// The first field that is not one of version 1.
    fn newer(&self) -> Option<&'static str> {
        let Self { world, seed, rules, disturbances, robots, .. } = self;
        let fields = [
            ("world", world),
            ("seed", seed),
            ("rules", rules),
            ("disturbances", disturbances),
            ("robots", robots),
        ];
        fields.into_iter().find(|(_, value)| value.is_some()).map(|(field, _)| field)
    }
}

const fn is_zero(seed: &u64) -> bool {
    *seed == 0
}

fn default_robot() -> String {
    "small".to_owned()
}

fn default_stack() -> String {
    Stack::DEFAULT.to_owned()
}

impl SceneFile {
    /// The version that is written.
    pub const VERSION: u32 = 2;

    /// Reads and checks a scene.
    ///
    /// # Errors
    /// When the text is not a scene of this version, or a value cannot be used.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        let versioned: Versioned = from_toml(text)?;
        let is = |version: u32| versioned.version == toml::Value::from(version);
        if !is(1) && !is(Self::VERSION) {
            return Err(SceneError::Version { found: versioned.version.to_string() });
        }
        if let (true, Some(field)) = (is(1), versioned.newer()) {
            return Err(SceneError::NeedsVersion { field });
        }
        let scene: Self = from_toml(text)?;
        scene.validate()?;
        Ok(scene)
    }

    /// The run that the scene describes, on its map, with its robot and its stack: the caller reads them, as they may be
    /// files (see [`super::find_robot`], [`super::find_stack`]).
    ///
    /// # Errors
    /// When the scene has several robots ([`Self::team`]), or was not read from a file and has no start or goal.
    pub fn episode(
        &self,
        map: impl Into<SceneMap>,
        robot: Robot,
        stack: Stack,
    ) -> Result<Episode, SceneError> {
        self.check_robots()?;
        let (Some(start), Some(goal)) = (self.start, self.goal) else {
            return Err(SceneError::SeveralRobots);
        };
        let map = map.into();
        let source = map.source;
        let episode = Episode::new(map.grid, robot, start.position, goal);
        let stack_name = self.stack.clone();
        let obstacles = self.unknown.iter().map(|&circle| circle.into()).collect();
        let (via, movers) = (self.via.clone(), self.moving.clone());
        let rules = self.rules.of_episode();
        let disturbances = Disturbances { seed: self.seed, ..self.disturbances };
        let episode = Episode { source, obstacles, movers, stack, stack_name, ..episode };
        Ok(Episode { disturbances, start, via, rules, ..episode })
    }

    /// The runs of all robots of the scene, on its map: of several, or of one. `find` is called with the names of each robot and its
    /// stack, for the two: they may be files.
    ///
    /// # Errors
    /// Those of `find`.
    pub fn team<E>(
        &self,
        map: impl Into<SceneMap>,
        mut find: impl FnMut(&str, &str) -> Result<(Robot, Stack), E>,
    ) -> Result<Team, E> {
        let SceneMap { grid, source } = map.into();
        let mut robots = Vec::new();
        for SceneRobot { start, via, goal, robot, stack } in self.ways() {
            let stack_name = stack.unwrap_or_else(|| self.stack.clone());
            let (robot, stack) = find(robot.as_deref().unwrap_or(&self.robot), &stack_name)?;
            let disturbances = Disturbances { seed: self.seed, ..self.disturbances };
            robots.push(TeamRobot { robot, disturbances, stack, stack_name, start, via, goal });
        }
        let obstacles = self.unknown.iter().map(|&circle| circle.into()).collect();
        let (movers, rules) = (self.moving.clone(), self.rules.of_episode());
        Ok(Team { source, obstacles, movers, rules, ..Team::new(grid, robots) })
    }

    /// The ways of all robots: of several, or of one.
    fn ways(&self) -> Vec<SceneRobot> {
        let one = self.start.zip(self.goal).map(|(start, goal)| {
            let (robot, stack) = (None, None);
            SceneRobot { start, via: self.via.clone(), goal, robot, stack }
        });
        self.robots.iter().cloned().chain(one).collect()
    }

    /// Whether the scene says where either one robot or several drive.
    fn check_robots(&self) -> Result<(), SceneError> {
        let given = [
            ("`start`", self.start.is_some()),
            ("`via`", !self.via.is_empty()),
            ("`goal`", self.goal.is_some()),
            ("`[[robots]]`", !self.robots.is_empty()),
        ];
        match given {
            [(_, true), _, (_, true), (_, false)]
            | [(_, false), (_, false), (_, false), (_, true)] => Ok(()),
            _ => {
                let given =
                    given.into_iter().filter_map(|(name, is_given)| is_given.then_some(name));
                let given: Vec<&str> = given.collect();
                let got = if given.is_empty() { "neither".to_owned() } else { given.join(", ") };
                Err(SceneError::OneOrSeveral { got })
            }
        }
    }

    /// Whether another seed gives another run.
    pub fn is_random(&self) -> bool {
        let is_generated =
            self.world.as_ref().is_some_and(|world| world.obstacles != Pattern::None);
        is_generated || !self.disturbances.is_none()
    }

    /// The map that is made from the seed, with room around start, way-points and goal; `None` where the map is a file.
    ///
    /// # Errors
    /// When the scene was not read from a file, and a value of its `world` cannot be used.
    pub fn generated_map(&self) -> Option<Result<SceneMap, SceneError>> {
        let world = self.world.as_ref()?;
        let ends: Vec<Point> = self.ways().iter().flat_map(SceneRobot::places).collect();
        let grid = world.generate(self.seed, &ends).map_err(SceneError::World);
        Some(grid.map(|grid| {
            let source = MapSource {
                name: format!("generated with seed {}", self.seed),
                digest: digest(&grid),
                placement: None,
            };
            SceneMap { grid, source }
        }))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), SceneError> {
        if self.map.is_some() == self.world.is_some() {
            return Err(SceneError::MapOrWorld { both: self.map.is_some() });
        }
        self.world.as_ref().map_or(Ok(()), GeneratedMap::validate).map_err(SceneError::World)?;
        self.rules.validate().map_err(SceneError::Rules)?;
        self.disturbances.validate().map_err(SceneError::Disturbances)?;
        if self.disturbances.seed != 0 {
            return Err(SceneError::SeedOfDisturbances);
        }
        self.check_robots()?;
        for (i, way) in self.ways().iter().enumerate() {
            if let Some((field, value)) = way.not_finite() {
                let of =
                    if self.robots.is_empty() { String::new() } else { format!("robots[{i}].") };
                finite(&format!("{of}{field}"), value)?;
            }
        }
        for (i, circle) in self.unknown.iter().enumerate() {
            finite(&format!("unknown[{i}].position[0]"), circle.position.x)?;
            finite(&format!("unknown[{i}].position[1]"), circle.position.y)?;
            let value = circle.radius_m;
            if !(value >= 0.0 && value.is_finite()) {
                let field = format!("unknown[{i}].radius_m");
                return Err(SceneError::Value { field, expected: "a length of at least 0", value });
            }
        }
        Ok(())
    }
}

fn finite(field: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError::Value { field: field.to_owned(), expected: "a finite number", value })
}

impl From<UnknownCircle> for Circle {
    fn from(circle: UnknownCircle) -> Self {
        Self::standing(circle.position, circle.radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::EpisodeRules;
    use crate::map::formats::map_from_bytes;
    use crate::sim::{Arrival, KeyFrame, KeyFrames, Motion};
    use std::path::Path;

    const LEAST: &str = "version = 1\nmap = \"a.yaml\"\nstart = [1, 2]\ngoal = [3.5, 4]\n";

    fn error(text: &str) -> String {
        SceneFile::from_toml(text).unwrap_err().to_string()
    }

    const MOVING: &str = "[[moving]]\nradius_m = 0.25\nkey_frames = [[0, 1, 2], [4, 3, 2]]\n";

    fn mover() -> Mover {
        let frames = [[0.0, 1.0, 2.0], [4.0, 3.0, 2.0]].map(KeyFrame::from).to_vec();
        Mover::new(0.25, Motion::KeyFrames(KeyFrames::new(frames).unwrap())).unwrap()
    }

    #[test]
    fn defaults_and_round_trip() {
        let scene = SceneFile::from_toml(LEAST).unwrap();
        assert_eq!((scene.robot.as_str(), scene.unknown.len()), ("small", 0));
        assert_eq!(scene.stack, Stack::DEFAULT);
        assert_eq!(scene.start.unwrap().yaw_deg, None);
        assert_eq!(scene.goal, Some(Point::new(3.5, 4.0).into()));
        assert!(scene.via.is_empty());
        let straight = Mover::straight(Point::new(1.0, 2.0), 0.0, Point::new(0.0, -0.5)).unwrap();
        let full = SceneFile {
            description: Some("a hall".to_owned()),
            stack: "s0-key-point".to_owned(),
            start: Some(Start { position: Point::new(-1.0, 2.0), yaw_deg: Some(-90.0) }),
            via: vec![Point::new(0.5, 1.5), Point::new(1.0, 2.5)],
            goal: Some(Goal { position: Point::new(3.5, 4.0), yaw_deg: Some(45.0) }),
            unknown: vec![UnknownCircle { position: Point::new(0.5, 0.5), radius_m: 0.15 }],
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
        let episode = scene.episode(map(), robot.clone(), stack.clone()).unwrap();
        assert_eq!((episode.source.name.as_str(), episode.source.digest), ("a.map", digest));
        assert_eq!((Some(episode.start), Some(episode.goal)), (scene.start, scene.goal));
        let circle = Circle::standing(Point::new(2.0, 3.0), 0.5);
        assert_eq!((episode.obstacles, episode.robot), (vec![circle], robot.clone()));
        assert_eq!((episode.stack, episode.movers), (stack, vec![mover()]));
        let other = SceneFile { stack: "mine.toml".to_owned(), ..scene };
        let stack = Stack::key_point_fusion(&robot);
        assert_eq!(other.episode(map(), robot, stack).unwrap().stack_name, "mine.toml");
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
        let scene =
            SceneFile::from_toml(&format!("{second}[rules]\ntime_limit_s = 9.5\n")).unwrap();
        assert_eq!((scene.seed, scene.rules.time_limit_s), (7, Some(9.5)));
        assert!(
            error(&format!("{second}[rules]\ntime_limit_s = -1\n"))
                .contains("`rules.time_limit_s`")
        );
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
        let episode = scene.episode(map, robot.clone(), Stack::key_point_fusion(&robot)).unwrap();
        let Disturbances { seed, actuation, .. } = episode.disturbances;
        assert_eq!((seed, actuation.delay_s), (7, 0.1));
        let late = error(&text.replace("0.1", "-1"));
        assert!(late.starts_with("`disturbances.actuation.delay_s` must be"), "{late}");
        let seeded = error(&text.replace(
            "[disturbances.actuation]",
            "[disturbances]\nseed = 1\n[disturbances.actuation]",
        ));
        assert!(seeded.contains("`disturbances.seed` is the `seed` of the scene"), "{seeded}");
        assert_eq!(
            error(&format!("{LEAST}[disturbances]\n")),
            "`disturbances` needs `version = 2`"
        );
    }

    #[test]
    fn a_world_is_made_from_the_seed() {
        let text = "version = 2\nseed = 3\nstart = [1, 1]\ngoal = [7, 5]\n[world]\nwidth_m = 8\nheight_m = 6\n\
                    resolution_m = 0.1\n[world.obstacles.clutter]\nshare = 0.3\nradius_m = [0.1, 0.3]\n\
                    [rules]\narrival = \"passing\"\ngoal_tolerance_m = 1\n";
        let scene = SceneFile::from_toml(text).unwrap();
        assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        let map = scene.generated_map().unwrap().unwrap();
        assert_eq!(map.source.name, "generated with seed 3");
        let other = SceneFile { seed: 4, ..scene.clone() }.generated_map().unwrap().unwrap();
        assert_ne!(map.source.digest, other.source.digest);
        let robot = Robot::small();
        let episode = scene.episode(map, robot.clone(), Stack::key_point_fusion(&robot)).unwrap();
        let rules = EpisodeRules {
            goal_tolerance_m: Some(1.0),
            arrival: Arrival::Passing,
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
            (
                "0.25",
                "-1",
                "line 5",
                "`moving[0]`: radius_m must be a number of at least 0, got -1",
            ),
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
}
