//! The form of a moving obstacle in files and reports.

use super::{KeyFrame, KeyFrames, Motion, Mover, WayPoints};
use crate::ConfigError;
use crate::geometry::Point;
use serde::{Deserialize, Serialize};

/// A table with a radius and the fields of one motion.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MoverTable {
    radius_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    position: Option<Point>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    velocity_mps: Option<Point>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    key_frames: Option<Vec<KeyFrame>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    way_points: Option<Vec<Point>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    speed_mps: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    to_and_fro: Option<bool>,
}

/// What a table may hold beside its radius.
const MOTIONS: &str =
    "`position` and `velocity_mps`, or `key_frames`, or `way_points` and `speed_mps`";

impl TryFrom<MoverTable> for Mover {
    type Error = ConfigError;

    fn try_from(table: MoverTable) -> Result<Self, ConfigError> {
        let MoverTable {
            radius_m,
            position,
            velocity_mps,
            key_frames,
            way_points,
            speed_mps,
            to_and_fro,
        } = table;
        if to_and_fro.is_some() && way_points.is_none() {
            return Err(ConfigError::new(
                "to_and_fro",
                "is a field of a motion along `way_points`",
            ));
        }
        let motion = match (position, velocity_mps, key_frames, way_points, speed_mps) {
            (Some(from), Some(velocity_mps), None, None, None) => {
                Motion::Straight { from, velocity_mps }
            }
            (None, None, Some(frames), None, None) => Motion::KeyFrames(KeyFrames::new(frames)?),
            (None, None, None, Some(points), Some(speed_mps)) => {
                let to_and_fro = to_and_fro.unwrap_or_default();
                Motion::WayPoints(WayPoints::new(points, speed_mps, to_and_fro)?)
            }
            (position, velocity_mps, key_frames, way_points, speed_mps) => {
                let given = [
                    ("position", position.is_some()),
                    ("velocity_mps", velocity_mps.is_some()),
                    ("key_frames", key_frames.is_some()),
                    ("way_points", way_points.is_some()),
                    ("speed_mps", speed_mps.is_some()),
                ];
                return Err(not_one_motion(&given));
            }
        };
        Self::new(radius_m, motion)
    }
}

/// The fields of a table are too many or too few for one motion.
fn not_one_motion(fields: &[(&str, bool)]) -> ConfigError {
    let given = fields.iter().filter(|(_, is_given)| *is_given);
    let given: Vec<String> = given.map(|(name, _)| format!("`{name}`")).collect();
    let given = if given.is_empty() { "none of them".to_owned() } else { given.join(", ") };
    ConfigError::new("the motion", format!("must be {MOTIONS}, got {given}"))
}

impl From<Mover> for MoverTable {
    fn from(Mover { radius_m, motion }: Mover) -> Self {
        let radius_only = Self {
            radius_m,
            position: None,
            velocity_mps: None,
            key_frames: None,
            way_points: None,
            speed_mps: None,
            to_and_fro: None,
        };
        match motion {
            Motion::Straight { from, velocity_mps } => {
                Self { position: Some(from), velocity_mps: Some(velocity_mps), ..radius_only }
            }
            Motion::KeyFrames(frames) => {
                Self { key_frames: Some(frames.frames().to_vec()), ..radius_only }
            }
            Motion::WayPoints(points) => Self {
                way_points: Some(points.points().to_vec()),
                speed_mps: Some(points.speed_mps()),
                to_and_fro: points.is_to_and_fro().then_some(true),
                ..radius_only
            },
        }
    }
}
