//! The scene file, version 1.

use super::toml_text::{TomlError, from_toml};
use crate::episode::{Episode, Start};
use crate::geometry::Point;
use crate::given::Given;
use crate::map::formats::LoadedMap;
use crate::navigate::{Goal, Stack};
use crate::report::MapSource;
use crate::robot::Robot;
use crate::sim::{Circle, Mover};
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
/// assert_eq!((scene.start.yaw_deg, scene.unknown.len()), (Some(90.0), 1));
/// assert_eq!(scene.moving[0].at(2.5).centre, Point::new(4.0, 5.0));
/// # Ok::<(), keyway::files::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Version of the format: 1.
    pub version: u32,
    /// What the scene shows, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Map file, absolute or relative to the folder of the scene file.
    pub map: PathBuf,
    /// Name of a bundled robot, or a robot file, absolute or relative to the folder of the scene
    /// file.
    #[serde(default = "default_robot")]
    pub robot: String,
    /// Name of a stack; the default one when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stack: Option<String>,
    /// Where the robot stands.
    pub start: Start,
    /// By way of which points, in their order \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<Point>,
    /// Where it is to go.
    pub goal: Goal,
    /// Obstacles that stand and are not on the map.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknown: Vec<UnknownCircle>,
    /// Obstacles that move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<Mover>,
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
    #[error("`version` is {found}; this program reads scenes of version {}", SceneFile::VERSION)]
    Version {
        /// What the file says.
        found: String,
    },
    /// A scene with a seed, as earlier programs wrote it.
    #[error("`seed` is no field of a scene: nothing in a run is random; remove the line")]
    Seed,
    /// A stack that there is not.
    #[error("there is no stack `{name}`, expected one of {}", Stack::NAMES.join(", "))]
    Stack {
        /// Its name.
        name: String,
    },
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

/// The version, and what is no longer read: the rest of a later format may be anything.
#[derive(Deserialize)]
struct Versioned {
    version: toml::Value,
    seed: Option<toml::Value>,
}

fn default_robot() -> String {
    "small".to_owned()
}

impl SceneFile {
    /// The version that is read and written.
    pub const VERSION: u32 = 1;

    /// Reads and checks a scene.
    ///
    /// # Errors
    /// When the text is not a scene of this version, or a value cannot be used.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        let Versioned { version, seed } = from_toml(text)?;
        if version != toml::Value::from(Self::VERSION) {
            return Err(SceneError::Version { found: version.to_string() });
        }
        if seed.is_some() {
            return Err(SceneError::Seed);
        }
        let scene: Self = from_toml(text)?;
        scene.validate()?;
        Ok(scene)
    }

    /// The run that the scene describes, on its map and with its robot: the caller reads them, as they may be
    /// files (see [`super::find_robot`]).
    ///
    /// # Errors
    /// When there is no stack of the scene's name.
    pub fn episode(&self, map: LoadedMap, robot: Robot) -> Result<Episode, SceneError> {
        let source = MapSource::from(&map);
        let episode = Episode::new(map.grid, robot, self.start.position, self.goal);
        let stack_name = self.stack.clone().unwrap_or(episode.stack_name);
        let Some(stack) = Stack::by_name(&stack_name, &episode.robot) else {
            return Err(SceneError::Stack { name: stack_name });
        };
        let obstacles = self.unknown.iter().map(|&circle| circle.into()).collect();
        let (start, via, movers) = (self.start, self.via.clone(), self.moving.clone());
        Ok(Episode { source, obstacles, movers, stack, stack_name, start, via, ..episode })
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), SceneError> {
        let Point { x, y } = self.start.position;
        finite("start[0]", x)?;
        finite("start[1]", y)?;
        finite("start[2]", self.start.yaw_deg.unwrap_or_default())?;
        finite("goal[0]", self.goal.position.x)?;
        finite("goal[1]", self.goal.position.y)?;
        finite("goal[2]", self.goal.yaw_deg.unwrap_or_default())?;
        for (i, point) in self.via.iter().enumerate() {
            finite(&format!("via[{i}][0]"), point.x)?;
            finite(&format!("via[{i}][1]"), point.y)?;
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
    use crate::map::formats::map_from_bytes;
    use crate::sim::{KeyFrame, KeyFrames, Motion};
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
        assert_eq!((scene.start.yaw_deg, scene.goal), (None, Point::new(3.5, 4.0).into()));
        assert!(scene.via.is_empty());
        let straight = Mover::straight(Point::new(1.0, 2.0), 0.0, Point::new(0.0, -0.5)).unwrap();
        let full = SceneFile {
            description: Some("a hall".to_owned()),
            stack: Some("key-point-fusion".to_owned()),
            start: Start { position: Point::new(-1.0, 2.0), yaw_deg: Some(-90.0) },
            via: vec![Point::new(0.5, 1.5), Point::new(1.0, 2.5)],
            goal: Goal { position: Point::new(3.5, 4.0), yaw_deg: Some(45.0) },
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
        let episode = scene.episode(map(), robot.clone()).unwrap();
        assert_eq!((episode.source.name.as_str(), episode.source.digest), ("a.map", digest));
        assert_eq!((episode.start, episode.goal), (scene.start, scene.goal));
        let circle = Circle::standing(Point::new(2.0, 3.0), 0.5);
        assert_eq!((episode.obstacles, episode.robot), (vec![circle], robot.clone()));
        assert_eq!((episode.stack_name.as_str(), episode.movers), (Stack::DEFAULT, vec![mover()]));
        let other = SceneFile { stack: Some("other".to_owned()), ..scene };
        let error = other.episode(map(), robot).unwrap_err().to_string();
        assert_eq!(error, "there is no stack `other`, expected one of key-point-fusion");
    }

    #[test]
    fn later_versions_are_refused_whatever_they_hold() {
        let later = error("version = 2\nmovers = []\n");
        assert_eq!(later, "`version` is 2; this program reads scenes of version 1");
        assert!(error("version = \"1\"\n").starts_with("`version` is \"1\""));
        assert!(error("map = \"a.yaml\"\n").contains("missing field `version`"));
    }

    #[test]
    fn a_seed_is_refused_with_what_to_do() {
        let error = error(&format!("{LEAST}seed = 1\n"));
        assert!(error.contains("`seed`") && error.contains("remove the line"), "{error}");
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
