//! Representation of a moving obstacle in files and reports.

use super::{
    KeyFrame, KeyFrames, MovingObstacle, ObstacleMotion, RandomWalk, RandomWalkConfig, Spline,
    WayPoints,
};
use keyway::ConfigError;
use keyway::geometry::Point;
use serde::{Deserialize, Serialize};

/// A round moving obstacle: its `radius_m` and the fields of one motion.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "MovingObstacle", extend("oneOf" = [
    {"required": ["position", "velocity_mps"], "propertyNames": {"enum": ["radius_m", "position", "velocity_mps"]}},
    {"required": ["key_frames"], "propertyNames": {"enum": ["radius_m", "key_frames"]}},
    {"required": ["spline", "duration_s"], "propertyNames": {"enum": ["radius_m", "spline", "duration_s"]}},
    {
        "required": ["way_points", "speed_mps"],
        "propertyNames": {"enum": ["radius_m", "way_points", "speed_mps", "to_and_fro", "gives_way"]},
    },
    {"required": ["random_walk"], "propertyNames": {"enum": ["radius_m", "random_walk"]}},
])))]
#[serde(deny_unknown_fields)]
pub(super) struct MoverTable {
    /// Radius \[m\], at least 0.
    radius_m: f64,
    /// Constant velocity: position at time 0 \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    position: Option<Point>,
    /// Constant velocity: velocity, `[vx, vy]` \[m/s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    velocity_mps: Option<Point>,
    /// Straight from each position to the next at constant speed: `[t, x, y]` each \[s, m, m\],
    /// in the order of their times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    key_frames: Option<Vec<KeyFrame>>,
    /// Smooth and periodic, through these positions: `[t, x, y]` each \[s, m, m\], in the order
    /// of their times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spline: Option<Vec<KeyFrame>>,
    /// Along a spline: duration of a lap \[s\], at least 0.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    duration_s: Option<f64>,
    /// From each position to the next at constant speed, and from the last back to the first,
    /// indefinitely \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    way_points: Option<Vec<Point>>,
    /// Along way-points: speed \[m/s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    speed_mps: Option<f64>,
    /// Along way-points: true if the obstacle turns back at the last one and returns on the same
    /// path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    to_and_fro: Option<bool>,
    /// Random walk in a rectangle, indefinitely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    random_walk: Option<RandomWalkConfig>,
    /// Along way-points: true if the obstacle gives way to robots and other moving obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gives_way: Option<bool>,
}

/// Fields that a table may have besides its radius.
const MOTIONS: &str = "`position` and `velocity_mps`, or `key_frames`, or `spline` and `duration_s`, \
     or `way_points` and `speed_mps`, or `random_walk`";

impl TryFrom<MoverTable> for MovingObstacle {
    type Error = ConfigError;

    fn try_from(table: MoverTable) -> Result<Self, ConfigError> {
        let flags = [("to_and_fro", table.to_and_fro), ("gives_way", table.gives_way)];
        for (name, _) in flags.into_iter().filter(|(_, flag)| flag.is_some()) {
            if table.way_points.is_none() {
                return Err(ConfigError::new(name, "is a field of a motion along `way_points`"));
            }
        }
        Self::new(table.radius_m, table.motion()?)
    }
}

impl MoverTable {
    fn motion(self) -> Result<ObstacleMotion, ConfigError> {
        // Fields of a second motion are an error.
        let given: Vec<&str> = self
            .fields()
            .into_iter()
            .filter_map(|(name, is_given)| is_given.then_some(name))
            .collect();
        match self {
            Self { position: Some(from), velocity_mps: Some(velocity_mps), .. }
                if given.len() == 2 =>
            {
                Ok(ObstacleMotion::Straight { from, velocity_mps })
            }
            Self { key_frames: Some(frames), .. } if given.len() == 1 => {
                KeyFrames::new(frames).map(ObstacleMotion::KeyFrames)
            }
            Self { spline: Some(frames), duration_s: Some(duration_s), .. } if given.len() == 2 => {
                Spline::new(frames, duration_s).map(ObstacleMotion::Spline)
            }
            Self {
                way_points: Some(points),
                speed_mps: Some(speed_mps),
                to_and_fro,
                gives_way,
                ..
            } if given.len() == 2 => {
                let to_and_fro = to_and_fro.unwrap_or_default();
                let gives_way = gives_way.unwrap_or_default();
                let motion =
                    if gives_way { ObstacleMotion::GivesWay } else { ObstacleMotion::WayPoints };
                WayPoints::new(points, speed_mps, to_and_fro).map(motion)
            }
            Self { random_walk: Some(config), .. } if given.len() == 1 => RandomWalk::new(config)
                .map(ObstacleMotion::RandomWalk)
                .map_err(|error| error.within("random_walk")),
            _ => Err(not_one_motion(&given)),
        }
    }

    /// Required fields of all motions; true for each that is given.
    fn fields(&self) -> [(&'static str, bool); 8] {
        [
            ("position", self.position.is_some()),
            ("velocity_mps", self.velocity_mps.is_some()),
            ("key_frames", self.key_frames.is_some()),
            ("spline", self.spline.is_some()),
            ("duration_s", self.duration_s.is_some()),
            ("way_points", self.way_points.is_some()),
            ("speed_mps", self.speed_mps.is_some()),
            ("random_walk", self.random_walk.is_some()),
        ]
    }
}

/// Error for a table with too many or too few fields for one motion.
fn not_one_motion(given: &[&str]) -> ConfigError {
    let given: Vec<String> = given.iter().map(|name| format!("`{name}`")).collect();
    let given = if given.is_empty() { "none of them".to_owned() } else { given.join(", ") };
    ConfigError::new("the motion", format!("must be {MOTIONS}, got {given}"))
}

impl From<MovingObstacle> for MoverTable {
    fn from(MovingObstacle { radius_m, motion }: MovingObstacle) -> Self {
        let radius_only = Self {
            radius_m,
            position: None,
            velocity_mps: None,
            key_frames: None,
            spline: None,
            duration_s: None,
            way_points: None,
            speed_mps: None,
            to_and_fro: None,
            random_walk: None,
            gives_way: None,
        };
        let along = |points: &WayPoints, radius_only: Self| Self {
            way_points: Some(points.points().to_vec()),
            speed_mps: Some(points.speed_mps()),
            to_and_fro: points.is_to_and_fro().then_some(true),
            ..radius_only
        };
        match motion {
            ObstacleMotion::Straight { from, velocity_mps } => {
                Self { position: Some(from), velocity_mps: Some(velocity_mps), ..radius_only }
            }
            ObstacleMotion::KeyFrames(frames) => {
                Self { key_frames: Some(frames.frames().to_vec()), ..radius_only }
            }
            ObstacleMotion::Spline(spline) => Self {
                spline: Some(spline.frames().to_vec()),
                duration_s: Some(spline.duration_s()),
                ..radius_only
            },
            ObstacleMotion::WayPoints(points) => along(&points, radius_only),
            ObstacleMotion::GivesWay(points) => {
                Self { gives_way: Some(true), ..along(&points, radius_only) }
            }
            ObstacleMotion::RandomWalk(walk) => {
                Self { random_walk: Some(walk.config().clone()), ..radius_only }
            }
        }
    }
}
