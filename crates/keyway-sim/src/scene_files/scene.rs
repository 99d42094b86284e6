//! The scene file, version 2.

use super::robot_in_scene::name_or_table;
#[cfg(feature = "schema")]
use super::robot_in_scene::robot_schema;
use super::scene_error::SceneError;
use super::scene_robots::SceneRobot;
use super::scene_version::{VERSION, Versioned};
use super::unknown::{GroundShape, Standing, UnknownObstacle, absent_cells, validate_absent};
use crate::episode::{Episode, EpisodeRobot, EpisodeRules, RandomObstacles, Start};
use crate::report::MapSource;
use crate::sim::{Disturbances, MovingObstacle};
use crate::worlds::GeneratedMap;
use keyway::files::from_toml;
use keyway::geometry::Point;
use keyway::map::OccupancyGrid;
use keyway::map::formats::{LoadedMap, digest};
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Description of a run: map, robot, start, goal, and the static and moving obstacles that are
/// not on the map.
///
/// ```
/// use keyway_sim::scene_files::SceneFile;
/// use keyway::geometry::Point;
/// use std::f64::consts::FRAC_PI_2;
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
/// assert_eq!((scene.start.unwrap().heading_rad, scene.unknown.len()), (Some(FRAC_PI_2), 1));
/// assert_eq!(scene.moving[0].at(2.5).centre, Point::new(4.0, 5.0));
/// # Ok::<(), keyway_sim::scene_files::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend("allOf" = [
    {"oneOf": [{"required": ["map"]}, {"required": ["world"]}]},
    {"oneOf": [{"required": ["start", "goal"]}, {"required": ["robots"]}]},
])))]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format: 2. Files of version 1, which have no `world`, `seed`, `safe`,
    /// `rules`, `disturbances`, `robots`, `absent` and `random`, are accepted, too.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = VERSION)))]
    pub version: u32,
    /// Description of the scene, for human readers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Map file, absolute or relative to the folder of the scene file; `None` if there is a
    /// `world`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<PathBuf>,
    /// A map that is generated from the seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<GeneratedMap>,
    /// Seed of everything random.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub seed: u64,
    /// Name of a bundled robot, or a robot file, absolute or relative to the folder of the scene
    /// file; or a table with the fields of a robot file, which is stored as its text.
    #[serde(default = "default_robot", deserialize_with = "name_or_table")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "robot_schema"))]
    pub robot: String,
    /// Name of a stack, or a stack file, absolute or relative to the folder of the scene file.
    #[serde(default = "default_stack")]
    pub stack: String,
    /// Issue only commands after which a robot can still stop before a collision, whatever its
    /// stack requests. Applies to all robots of the scene.
    #[serde(default, skip_serializing_if = "is_not")]
    pub safe: bool,
    /// Start pose of the robot; `None` if there are `robots`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// Way-points of the robot, in this order \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<Point>,
    /// Goal of the robot; `None` if there are `robots`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<Goal>,
    /// Disturbances of the robot; its random numbers follow from the scene's `seed`.
    #[serde(default, skip_serializing_if = "Disturbances::is_none")]
    pub disturbances: Disturbances,
    /// Rules that end a run.
    #[serde(default, skip_serializing_if = "are_usual")]
    pub rules: EpisodeRules,
    /// Robots that drive at the same time, instead of `start`, `via` and `goal`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<SceneRobot>,
    /// Static obstacles that are not on the map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknown: Vec<UnknownObstacle>,
    /// Areas that the map shows as occupied although they are free, such as an open door.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub absent: Vec<GroundShape>,
    /// Moving obstacles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<MovingObstacle>,
    /// Random obstacles near the paths of the robots, drawn from the seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub random: Option<RandomObstacles>,
}

/// Map of a scene's run.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMap {
    /// The map.
    pub grid: OccupancyGrid,
    /// Identification of the map in reports.
    pub source: MapSource,
}

impl From<LoadedMap> for SceneMap {
    fn from(loaded: LoadedMap) -> Self {
        Self { source: MapSource::from(&loaded), grid: loaded.grid }
    }
}

fn are_usual(rules: &EpisodeRules) -> bool {
    *rules == EpisodeRules::USUAL
}

const fn is_not(safe: &bool) -> bool {
    !*safe
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
    /// Version of the format that is written.
    pub const VERSION: u32 = VERSION;

    /// Creates a scene with only a start and a goal; it still needs a map or a world.
    pub fn new(start: Start, goal: Goal) -> Self {
        Self {
            version: Self::VERSION,
            description: None,
            map: None,
            world: None,
            seed: 0,
            robot: default_robot(),
            stack: default_stack(),
            safe: false,
            start: Some(start),
            via: Vec::new(),
            goal: Some(goal),
            disturbances: Disturbances::default(),
            rules: EpisodeRules::USUAL,
            robots: Vec::new(),
            unknown: Vec::new(),
            absent: Vec::new(),
            moving: Vec::new(),
            random: None,
        }
    }

    /// Reads and checks a scene.
    ///
    /// # Errors
    /// Returns an error if the text is not a scene of this version, or a value is invalid.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        let versioned: Versioned = from_toml(text)?;
        let Some(version) = &versioned.version else {
            let is_scene = versioned.looks_like_a_scene();
            return Err(if is_scene { SceneError::NoVersion } else { SceneError::NoScene });
        };
        let is = |number: u32| *version == toml::Value::from(number);
        if !is(1) && !is(Self::VERSION) {
            return Err(SceneError::Version { found: version.to_string() });
        }
        if let (true, Some(field)) = (is(1), versioned.newer()) {
            return Err(SceneError::NeedsVersion { field });
        }
        let scene: Self = from_toml(text)?;
        if let (true, Some(field)) = (is(1), scene.unknown.iter().find_map(UnknownObstacle::newer))
        {
            return Err(SceneError::NeedsVersion { field });
        }
        scene.validate()?;
        Ok(scene)
    }

    /// Moving obstacles, with the seed of the scene if they need one.
    fn seeded_movers(&self) -> Vec<MovingObstacle> {
        (0..).zip(&self.moving).map(|(i, mover)| mover.clone().seeded(self.seed, i)).collect()
    }

    /// Returns the run that the scene describes, on its map. `find` reads a robot and its stack
    /// by their names, which may be files (see [`keyway::files::find_robot`] and
    /// [`keyway::files::find_stack`]).
    ///
    /// # Errors
    /// Those of `find`. Also fails if the scene was not read from a file and has neither a start
    /// and a goal nor robots, if an obstacle is not on the map, or if a random one cannot be
    /// drawn.
    pub fn episode<E: From<SceneError>>(
        &self,
        map: impl Into<SceneMap>,
        mut find: impl FnMut(&str, &str) -> Result<(Robot, Stack), E>,
    ) -> Result<Episode, E> {
        self.check_robots()?;
        let SceneMap { grid, source } = map.into();
        let mut robots = Vec::new();
        for (way, (robot, stack)) in self.ways().into_iter().zip(self.robots_and_stacks()) {
            let (SceneRobot { start, via, goal, .. }, stack_name) = (way, stack.to_owned());
            let (robot, stack) = find(robot, stack)?;
            let stack = stack.safe_if(self.safe, &robot);
            let disturbances = Disturbances { seed: self.seed, ..self.disturbances.clone() };
            robots.push(EpisodeRobot { robot, disturbances, stack, stack_name, start, via, goal });
        }
        let Standing { obstacles, polygons, hidden_cells, elusive } =
            Standing::of(&self.unknown, grid.frame()).map_err(SceneError::Obstacle)?;
        let absent_cells = absent_cells(&self.absent, &grid).map_err(SceneError::Obstacle)?;
        let (movers, rules) = (self.seeded_movers(), self.rules.clone());
        let episode = Episode { source, movers, rules, ..Episode::of_robots(grid, robots) };
        let episode = Episode { obstacles, polygons, hidden_cells, ..episode };
        let mut episode = Episode { absent_cells, elusive, ..episode };
        if let Some(random) = &self.random {
            random.put_into(&mut episode, self.seed).map_err(SceneError::Random)?;
        }
        Ok(episode)
    }

    /// Returns the same with this robot and this stack, whatever the scene names.
    ///
    /// # Errors
    /// Returns an error if an obstacle is not on the map, or a random one cannot be drawn.
    pub fn episode_with(
        &self,
        map: impl Into<SceneMap>,
        robot: &Robot,
        stack: &Stack,
    ) -> Result<Episode, SceneError> {
        self.episode(map, |_, _| Ok((robot.clone(), stack.clone())))
    }

    /// Names of each robot and its stack, in the order of the robots: the robot's own names, or
    /// those of the scene.
    pub fn robots_and_stacks(&self) -> Vec<(&str, &str)> {
        if self.robots.is_empty() {
            return vec![(&self.robot, &self.stack)];
        }
        let names = self.robots.iter().map(|one| {
            let (robot, stack) = (one.robot.as_deref(), one.stack.as_deref());
            (robot.unwrap_or(&self.robot), stack.unwrap_or(&self.stack))
        });
        names.collect()
    }

    /// Starts, way-points and goals of all robots, one or several.
    fn ways(&self) -> Vec<SceneRobot> {
        let one = self.start.zip(self.goal).map(|(start, goal)| {
            let (robot, stack) = (None, None);
            SceneRobot { start, via: self.via.clone(), goal, robot, stack }
        });
        self.robots.iter().cloned().chain(one).collect()
    }

    /// Checks that the scene has either one robot or several.
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

    /// True if another seed gives another run.
    pub fn is_random(&self) -> bool {
        let is_generated = self.world.as_ref().is_some_and(|world| world.obstacles.is_random());
        let takes_seed = self.moving.iter().any(MovingObstacle::needs_seed);
        let is_glimpsed = |it: &UnknownObstacle| !matches!(it.presence.seen, 0.0 | 1.0);
        let glimpses = self.unknown.iter().any(is_glimpsed);
        let disturbed = !self.disturbances.is_none();
        let is_drawn = self.random.as_ref().is_some_and(RandomObstacles::is_random);
        is_generated || takes_seed || is_drawn || disturbed || glimpses
    }

    /// Returns the map that is generated from the seed, with free space around start, way-points
    /// and goal; `None` if the map is a file.
    ///
    /// # Errors
    /// Returns an error if the scene was not read from a file and a value of its `world` is
    /// invalid.
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
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), SceneError> {
        if self.map.is_some() == self.world.is_some() {
            return Err(SceneError::MapOrWorld { both: self.map.is_some() });
        }
        self.world.as_ref().map_or(Ok(()), GeneratedMap::validate).map_err(SceneError::World)?;
        self.rules.validate().map_err(SceneError::Rules)?;
        self.disturbances.validate().map_err(SceneError::Disturbances)?;
        self.random
            .as_ref()
            .map_or(Ok(()), RandomObstacles::validate)
            .map_err(SceneError::Random)?;
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
        UnknownObstacle::validate_all(&self.unknown).map_err(SceneError::Obstacle)?;
        validate_absent(&self.absent).map_err(SceneError::Obstacle)
    }
}

fn finite(field: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError::Value { field: field.to_owned(), expected: "a finite number", value })
}

#[cfg(test)]
mod tests;
