//! Worlds of `DynaBARN` \[Nair2022\]: a robot crosses a field of moving cylinders that do not
//! yield.
//!
//! As in the challenge, the Jackal starts at (11, 0) and faces the field. The goal is 20 m ahead,
//! at (-9, 0), with a tolerance of 1 m and a time limit of 100 s. The best time is that of the
//! straight line at 2 m/s. Each cylinder follows the spline of its key frames and starts over
//! after its duration. Three walls surround the field, which is open towards the start. The map
//! is empty.

use super::table::some_rows;
use super::{NamedScene, ScenesError};
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway_sim::episode::{EpisodeRules, Start};
use keyway_sim::scene_files::{GroundShape, SceneFile, UnknownObstacle};
use keyway_sim::sim::{Arrival, KeyFrame, MovingObstacle, ObstacleMotion, Spline, StandingPolygon};
use keyway_sim::worlds::GeneratedMap;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::PathBuf;

const START: Point = Point::new(11.0, 0.0);
const START_HEADING_RAD: f64 = PI;
const GOAL: Point = Point::new(-9.0, 0.0);

/// The lower left corner of the map and its size \[m\]: it ends at the outer sides of the walls,
/// and 4 m behind the field.
const MAP_CORNER: Point = Point::new(-10.25, -10.25);
const MAP_SIZE_M: [f64; 2] = [24.5, 20.5];
const CELL_M: f64 = 0.05;

const RULES: EpisodeRules = EpisodeRules {
    goal_tolerance_m: Some(1.0),
    arrival: Arrival::Passing,
    time_limit_s: Some(100.0),
    // 20 m at 2 m/s.
    reference_time_s: Some(10.0),
    ..EpisodeRules::USUAL
};

/// Request for scenes of `DynaBARN` worlds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DynabarnRequest {
    /// Table of the positions of the cylinders: CSV with the columns `plugin`, `duration_s`, `t`,
    /// `x` and `y` \[s, m\].
    pub key_frames: PathBuf,
    /// Table of the cylinders of each world: CSV with the columns `world`, `plugin` and `radius`
    /// \[m\].
    pub worlds: PathBuf,
}

#[derive(Deserialize)]
struct Frame {
    plugin: String,
    duration_s: f64,
    t: f64,
    x: f64,
    y: f64,
}

#[derive(Deserialize)]
struct Cylinder {
    world: u32,
    plugin: String,
    radius: f64,
}

/// One lap of a cylinder.
#[derive(Default)]
struct Lap {
    duration_s: f64,
    frames: Vec<KeyFrame>,
}

impl DynabarnRequest {
    /// Returns a scene for each world, in the order of their numbers.
    ///
    /// # Errors
    /// Returns [`ScenesError`] if a table cannot be used, a cylinder has no key frames, or its
    /// motion is invalid.
    pub fn scenes(&self) -> Result<Vec<NamedScene>, ScenesError> {
        let laps = self.laps()?;
        let cylinders: Vec<Cylinder> =
            some_rows(&self.worlds).map_err(ScenesError::of_table("worlds"))?;
        let mut worlds: BTreeMap<u32, Vec<MovingObstacle>> = BTreeMap::new();
        for Cylinder { world, plugin, radius } in cylinders {
            let Some(lap) = laps.get(&plugin) else {
                return Err(ScenesError::NoKeyFrames { world, plugin });
            };
            let mover = mover(lap, radius).map_err(|reason| ScenesError::KeyFrames {
                world,
                plugin,
                reason,
            })?;
            worlds.entry(world).or_default().push(mover);
        }
        worlds.into_iter().map(|(world, movers)| named(world, movers)).collect()
    }

    /// Returns the laps by the names of their cylinders.
    fn laps(&self) -> Result<BTreeMap<String, Lap>, ScenesError> {
        let frames: Vec<Frame> =
            some_rows(&self.key_frames).map_err(ScenesError::of_table("key_frames"))?;
        let mut laps: BTreeMap<String, Lap> = BTreeMap::new();
        for Frame { plugin, duration_s, t, x, y } in frames {
            let lap = laps.entry(plugin).or_default();
            lap.duration_s = duration_s;
            lap.frames.push(KeyFrame::from([t, x, y]));
        }
        Ok(laps)
    }
}

fn mover(lap: &Lap, radius_m: f64) -> Result<MovingObstacle, ConfigError> {
    let spline = Spline::new(lap.frames.clone(), lap.duration_s)?;
    MovingObstacle::new(radius_m, ObstacleMotion::Spline(spline))
}

/// Returns the walls: boxes of 20 m x 0.5 m in the middle of three sides of the field.
fn walls() -> Result<Vec<UnknownObstacle>, ScenesError> {
    let wall = |(x, y): (f64, f64), (width_m, height_m): (f64, f64)| {
        let corner = |right: f64, up: f64| Point::new(x + right * width_m, y + up * height_m);
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let corners = corners.map(|(right, up)| corner(right, up)).to_vec();
        let polygon = StandingPolygon::new(corners).map_err(ScenesError::Wall)?;
        Ok(UnknownObstacle::new(GroundShape::Polygon(polygon)))
    };
    let sides =
        [((-10.0, 0.0), (0.5, 20.0)), ((0.0, 10.0), (20.0, 0.5)), ((0.0, -10.0), (20.0, 0.5))];
    sides.into_iter().map(|(middle, size_m)| wall(middle, size_m)).collect()
}

fn named(world: u32, moving: Vec<MovingObstacle>) -> Result<NamedScene, ScenesError> {
    let [width_m, height_m] = MAP_SIZE_M;
    let map = GeneratedMap { origin: MAP_CORNER, ..GeneratedMap::empty(width_m, height_m, CELL_M) };
    let scene = SceneFile {
        description: Some(format!("DynaBARN, world {world}")),
        world: Some(map),
        robot: "jackal".to_owned(),
        rules: RULES,
        unknown: walls()?,
        moving,
        ..SceneFile::new(
            Start { position: START, heading_rad: Some(START_HEADING_RAD) },
            GOAL.into(),
        )
    };
    Ok(NamedScene { file: format!("dynabarn_{world:03}.toml"), scene })
}
