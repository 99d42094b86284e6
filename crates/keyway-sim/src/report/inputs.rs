//! Everything that a result depends on.

use crate::sim::{Arrival, Disturbances, Mover, StandingPolygon};
use keyway::geometry::Point;
use keyway::map::{Cell, LayerConfig};
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use serde::Serialize;

/// Everything that a route or a run depends on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inputs {
    /// Version of Keyway.
    pub version: &'static str,
    /// Name of the map, such as the path of its file.
    pub map: String,
    /// [`keyway::map::formats::digest`] of the map.
    pub map_digest: String,
    /// Where the map lies, where its file does not say so and a caller did.
    pub placement: Option<PlacementInput>,
    /// The robot; `None` for a route without one.
    pub robot: Option<Robot>,
    /// Name of the stack; `None` for a route.
    pub stack: Option<String>,
    /// All parameters.
    pub config: Parameters,
    /// `[x, y]`, or `[x, y, yaw_deg]` where a yaw was given \[m, m, deg\].
    pub start: Vec<f64>,
    /// Where to go, `[x, y]`, or `[x, y, yaw_deg]` where a yaw was given \[m, m, deg\]; of several goals the first.
    pub goal: Vec<f64>,
    /// All goals, where there are several \[m\].
    pub goals: Option<Vec<Point>>,
    /// Way-points, where there are any \[m\].
    pub via: Option<Vec<Point>>,
    /// Whether the nearest cell that can be reached takes the place of a goal; `None` for a run.
    pub nearest_reachable: Option<bool>,
    /// Unknown obstacles that stand, `[x, y, radius]` each \[m\].
    pub obstacles: Vec<[f64; 3]>,
    /// Unknown obstacles that stand and are polygons.
    pub polygons: Vec<StandingPolygon>,
    /// Cells of the map that are occupied, which it does not show.
    pub hidden_cells: Vec<Cell>,
    /// Obstacles that move.
    pub moving: Vec<Mover>,
    /// How many of these obstacles are random; `None` where none was asked for.
    pub random: Option<Placed>,
    /// What disturbs the robot; `None` where nothing does, and for a route.
    pub disturbances: Option<Disturbances>,
    /// How near to the goal was near enough \[m\], where it was not `controller.goal_tolerance_m`.
    pub goal_tolerance_m: Option<f64>,
    /// Whether the robot had to stand at its goal; `None` for a route.
    pub arrival: Option<Arrival>,
    /// Limit of the simulated time that was in force \[s\].
    pub time_limit_s: Option<f64>,
    /// Time without progress on the remaining way after which the robot was stuck \[s\]; `None` for
    /// a route.
    pub stuck_window_s: Option<f64>,
    /// Limit of expanded nodes.
    pub budget: Option<u64>,
}

/// How many random obstacles were asked for, and how many found a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Placed {
    /// Discs that stand, asked for.
    pub unknown_asked: u32,
    /// Discs that stand, placed: the last ones of the episode's obstacles.
    pub unknown_placed: u32,
    /// Discs that move, asked for.
    pub moving_asked: u32,
    /// Discs that move, placed: the last ones of the episode's movers.
    pub moving_placed: u32,
}

impl Placed {
    /// How many found no place.
    pub const fn left_out(&self) -> u32 {
        self.unknown_asked - self.unknown_placed + self.moving_asked - self.moving_placed
    }
}

impl Inputs {
    /// The version of this library.
    pub const VERSION: &'static str = env!("CARGO_PKG_VERSION");
}

/// The parameters that play a part in a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Parameters {
    /// Of a run: all of them.
    Run(Box<Stack>),
    /// Of a route: the rest of a stack plays no part.
    Route {
        /// How the layers follow from the map.
        map: LayerConfig,
        /// The planner.
        planner: PlannerConfig,
        /// The smoother.
        smoother: SmootherConfig,
    },
}

/// What identifies a map in reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapSource {
    /// Its name, such as the path of its file.
    pub name: String,
    /// [`keyway::map::formats::digest`] of the map.
    pub digest: String,
    /// Where it lies, where its file does not say so and a caller did.
    pub placement: Option<PlacementInput>,
}

/// Where a map lies, when its file does not say so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlacementInput {
    /// Side of a cell \[m\].
    pub resolution_m: f64,
    /// World pose of the lower left corner, `[x, y, yaw_deg]` \[m, m, deg\].
    pub origin: [f64; 3],
}

#[cfg(feature = "formats")]
impl From<&keyway::map::formats::LoadedMap> for MapSource {
    /// The map's file, and no placement.
    fn from(loaded: &keyway::map::formats::LoadedMap) -> Self {
        let name = loaded.sources.first().map(|path| path.display().to_string());
        let digest = loaded.digest.clone();
        Self { name: name.unwrap_or_default(), digest, placement: None }
    }
}

#[cfg(feature = "formats")]
impl From<keyway::map::formats::ImagePlacement> for PlacementInput {
    fn from(placement: keyway::map::formats::ImagePlacement) -> Self {
        let keyway::geometry::Pose { x, y, theta } = placement.origin;
        Self {
            resolution_m: placement.resolution_m,
            origin: [x, y, keyway::geometry::degrees(theta)],
        }
    }
}
