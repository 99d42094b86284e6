//! Worlds of BARN \[Perille2020\]: a robot crosses a field of cylinders that are not on its map.
//!
//! As in the challenge, the Jackal starts at (-2.25, 3) and faces upwards. The goal is 10 m
//! ahead, with a tolerance of 1 m and a time limit of 100 s. The map is empty. The best time is
//! that of the reference path at 2 m/s.
//!
//! If the cylinders are known, they are on the map: the cells whose centres they cover. The world
//! then contains these cells instead of the cylinders.

use super::table::{rows, rows_from_bytes, some_rows};
use super::{NamedScene, ScenesError};
use keyway::geometry::Point;
use keyway_sim::episode::{EpisodeRules, Start};
use keyway_sim::scene_files::{SceneError, SceneFile, UnknownDisc, UnknownObstacle};
use keyway_sim::sim::Arrival;
use keyway_sim::worlds::{Discs, GeneratedMap, Pattern};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

const START: Point = Point::new(-2.25, 3.0);
const START_HEADING_RAD: f64 = FRAC_PI_2;
const GOAL: Point = Point::new(-2.25, 13.0);

/// The lower left corner of the map and its side \[m\]: the map is centred on the middle of the
/// route, and includes the obstacles beside the field.
const MAP_CORNER: Point = Point::new(-12.25, -2.0);
const MAP_SIDE_M: f64 = 20.0;
const CELL_M: f64 = 0.05;

const RULES: EpisodeRules = EpisodeRules {
    goal_tolerance_m: Some(1.0),
    arrival: Arrival::Passing,
    time_limit_s: Some(100.0),
    ..EpisodeRules::USUAL
};

/// Request for scenes of BARN worlds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BarnRequest {
    /// Table of the cylinders: CSV with the columns `world`, `x`, `y` and `radius` \[m\].
    pub cylinders: PathBuf,
    /// Table of the best times: CSV with the columns `world` and `optimal_time_s` \[s\]; `None`:
    /// the scenes have no reference time.
    pub summary: Option<PathBuf>,
    /// True if the map shows the cylinders.
    pub is_known: bool,
}

#[derive(Deserialize)]
struct Cylinder {
    world: u32,
    x: f64,
    y: f64,
    radius: f64,
}

#[derive(Deserialize)]
struct Summary {
    world: u32,
    optimal_time_s: f64,
}

impl BarnRequest {
    /// Returns a scene for each world, in the order of their numbers.
    ///
    /// # Errors
    /// Returns [`ScenesError`] if a table cannot be used, or the cylinders of a world make no
    /// scene.
    pub fn scenes(&self) -> Result<Vec<NamedScene>, ScenesError> {
        let cylinders = some_rows(&self.cylinders).map_err(ScenesError::of_table("cylinders"))?;
        scenes(cylinders, self.is_known, &self.best_times_s()?)
    }

    /// Returns the same for a table of cylinders in memory, without best times; errors use `name`
    /// as its path.
    ///
    /// # Errors
    /// As for [`Self::scenes`].
    pub fn scenes_from_bytes(
        name: &Path,
        cylinders: &[u8],
        is_known: bool,
    ) -> Result<Vec<NamedScene>, ScenesError> {
        let cylinders =
            rows_from_bytes(name, cylinders).map_err(ScenesError::of_table("cylinders"))?;
        scenes(cylinders, is_known, &BTreeMap::new())
    }

    /// Returns the best times by the numbers of their worlds.
    fn best_times_s(&self) -> Result<BTreeMap<u32, f64>, ScenesError> {
        let Some(path) = &self.summary else { return Ok(BTreeMap::new()) };
        let rows: Vec<Summary> = rows(path).map_err(ScenesError::of_table("summary"))?;
        Ok(rows.into_iter().map(|row| (row.world, row.optimal_time_s)).collect())
    }
}

fn scenes(
    cylinders: Vec<Cylinder>,
    is_known: bool,
    best_s: &BTreeMap<u32, f64>,
) -> Result<Vec<NamedScene>, ScenesError> {
    let mut worlds: BTreeMap<u32, Vec<UnknownDisc>> = BTreeMap::new();
    for Cylinder { world, x, y, radius } in cylinders {
        let circle = UnknownDisc { position: Point::new(x, y), radius_m: radius };
        worlds.entry(world).or_default().push(circle);
    }
    let scene = |(world, cylinders)| {
        named(world, cylinders, is_known, best_s.get(&world).copied())
            .map_err(|reason| ScenesError::Cylinders { world, reason })
    };
    worlds.into_iter().map(scene).collect()
}

fn named(
    world: u32,
    cylinders: Vec<UnknownDisc>,
    is_known: bool,
    reference_time_s: Option<f64>,
) -> Result<NamedScene, SceneError> {
    let empty = GeneratedMap::empty(MAP_SIDE_M, MAP_SIDE_M, CELL_M);
    let mut map = GeneratedMap { origin: MAP_CORNER, ..empty };
    let mut unknown = cylinders;
    if is_known {
        let disc = |circle: &UnknownDisc| [circle.position.x, circle.position.y, circle.radius_m];
        map.obstacles = Pattern::Discs(Discs(unknown.iter().map(disc).collect()));
        // A cylinder near the start or goal is an obstacle, too.
        map.free_ends_m = 0.0;
        unknown.clear();
    }
    let known = if is_known { ", known" } else { "" };
    let scene = SceneFile {
        description: Some(format!("BARN, world {world}{known}")),
        world: Some(map),
        robot: "jackal".to_owned(),
        rules: EpisodeRules { reference_time_s, ..RULES },
        unknown: unknown.into_iter().map(UnknownObstacle::from).collect(),
        ..SceneFile::new(
            Start { position: START, heading_rad: Some(START_HEADING_RAD) },
            GOAL.into(),
        )
    };
    scene.validate()?;
    // A batch of several benchmarks distinguishes its scenes by the names of their files.
    let name = if is_known { "barn_known" } else { "barn" };
    Ok(NamedScene { file: format!("{name}_{world:03}.toml"), scene })
}
