//! The worlds of BARN \[Perille2020\]: a robot crosses a field of cylinders that it does not know.
//!
//! As in the challenge: start (-2.25, 3) facing upwards, goal 10 m ahead, reached when the robot comes within 1 m, at most
//! 100 s; the robot is the Jackal. It is given a map on which nothing stands. The best time is that of the reference path at
//! 2 m/s.
//!
//! With `--known` the cylinders are on the map: the cells whose centres they hold. These are then what stands in the world,
//! instead of the cylinders.

use super::rows::rows;
use super::{Named, unless_empty};
use crate::args::BarnArgs;
use crate::error::{CliError, Kind};
use keyway::geometry::Point;
use keyway_sim::episode::Start;
use keyway_sim::scene_files::{SceneFile, SceneRules, UnknownCircle, UnknownObstacle};
use keyway_sim::sim::Arrival;
use keyway_sim::worlds::{Discs, GeneratedMap, Pattern};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

const START: Point = Point::new(-2.25, 3.0);
const START_HEADING_RAD: f64 = FRAC_PI_2;
const GOAL: Point = Point::new(-2.25, 13.0);

/// The lower left corner of the map and its side \[m\]: the middle of the way is the middle of the map, and what stands beside the
/// course is on it.
const MAP_CORNER: Point = Point::new(-12.25, -2.0);
const MAP_SIDE_M: f64 = 20.0;
const CELL_M: f64 = 0.05;

const RULES: SceneRules = SceneRules {
    goal_tolerance_m: Some(1.0),
    arrival: Some(Arrival::Passing),
    time_limit_s: Some(100.0),
    stuck_window_s: None,
    reference_time_s: None,
};

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

/// A scene for each world, in the order of their numbers.
pub(super) fn scenes(args: &BarnArgs) -> Result<Vec<Named>, CliError> {
    let cylinders: Vec<Cylinder> = rows(&args.cylinders, "CYLINDERS.csv")?;
    unless_empty(&cylinders, &args.cylinders, "CYLINDERS.csv")?;
    let mut worlds: BTreeMap<u32, Vec<UnknownCircle>> = BTreeMap::new();
    for Cylinder { world, x, y, radius } in cylinders {
        let circle = UnknownCircle { position: Point::new(x, y), radius_m: radius };
        worlds.entry(world).or_default().push(circle);
    }
    let best_s: BTreeMap<u32, f64> = match &args.summary {
        Some(path) => {
            let rows: Vec<Summary> = rows(path, "--summary")?;
            rows.into_iter().map(|row| (row.world, row.optimal_time_s)).collect()
        }
        None => BTreeMap::new(),
    };
    let named =
        |(world, cylinders)| named(world, cylinders, args.known, best_s.get(&world).copied());
    worlds.into_iter().map(named).collect()
}

fn named(
    world: u32,
    cylinders: Vec<UnknownCircle>,
    is_known: bool,
    reference_time_s: Option<f64>,
) -> Result<Named, CliError> {
    let empty = GeneratedMap::empty(MAP_SIDE_M, MAP_SIDE_M, CELL_M);
    let mut map = GeneratedMap { origin: MAP_CORNER, ..empty };
    let mut unknown = cylinders;
    if is_known {
        let disc = |circle: &UnknownCircle| [circle.position.x, circle.position.y, circle.radius_m];
        map.obstacles = Pattern::Discs(Discs(unknown.iter().map(disc).collect()));
        // All of them stand, wherever that is.
        map.free_ends_m = 0.0;
        unknown.clear();
    }
    let known = if is_known { ", known" } else { "" };
    let scene = SceneFile {
        description: Some(format!("BARN, world {world}{known}")),
        world: Some(map),
        robot: "jackal".to_owned(),
        rules: SceneRules { reference_time_s, ..RULES },
        unknown: unknown.into_iter().map(UnknownObstacle::from).collect(),
        ..SceneFile::new(
            Start { position: START, heading_rad: Some(START_HEADING_RAD) },
            GOAL.into(),
        )
    };
    let blame = |error| CliError::new(Kind::Input, format!("world {world}: {error}"));
    scene.validate().map_err(|error| blame(error).field("CYLINDERS.csv"))?;
    // A batch of several benchmarks tells its scenes apart by the names of their files.
    let name = if is_known { "barn_known" } else { "barn" };
    Ok(Named { file: format!("{name}_{world:03}.toml"), scene })
}
