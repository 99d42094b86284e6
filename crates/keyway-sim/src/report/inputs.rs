//! Inputs of a result.

use crate::sim::{
    Arrival, Disturbances, ElusiveObstacle, MovingObstacle, ReachedBy, StandingPolygon,
};
use keyway::geometry::Point;
use keyway::map::{Cell, LayerConfig};
use keyway::navigate::Stack;
use keyway::plan::PlannerConfig;
use keyway::robot::Robot;
use keyway::smooth::SmootherConfig;
use serde::Serialize;

/// Inputs of a route or a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inputs {
    /// Version of Keyway.
    pub version: &'static str,
    /// Name of the map, such as the path of its file.
    pub map: String,
    /// [`keyway::map::formats::digest`] of the map.
    pub map_digest: String,
    /// Placement of the map, if the caller gave one because the file has none.
    pub placement: Option<PlacementInput>,
    /// The robot; `None` for a route without one.
    pub robot: Option<Robot>,
    /// Name of the stack; `None` for a route.
    pub stack: Option<String>,
    /// All parameters.
    pub config: Parameters,
    /// Start, `[x, y]`, or `[x, y, yaw_deg]` with a given yaw \[m, m, deg\].
    pub start: Vec<f64>,
    /// Goal, `[x, y]`, or `[x, y, yaw_deg]` with a given yaw \[m, m, deg\]; of several goals, the
    /// first.
    pub goal: Vec<f64>,
    /// All goals, if there are several \[m\].
    pub goals: Option<Vec<Point>>,
    /// Way-points, if there are any \[m\].
    pub via: Option<Vec<Point>>,
    /// True if the nearest reachable cell replaces an unreachable goal; `None` for a run.
    pub nearest_reachable: Option<bool>,
    /// Static unknown obstacles, `[x, y, radius]` each \[m\].
    pub obstacles: Vec<[f64; 3]>,
    /// Static unknown obstacles that are polygons.
    pub polygons: Vec<StandingPolygon>,
    /// Occupied cells that the map does not show.
    pub hidden_cells: Vec<Cell>,
    /// Cells that the map shows as occupied although they are free.
    pub absent_cells: Vec<Cell>,
    /// Obstacles that are present for a limited time, or that sensors miss.
    pub elusive: Vec<ElusiveObstacle>,
    /// Moving obstacles.
    pub moving: Vec<MovingObstacle>,
    /// Number of random obstacles; `None` if none was requested.
    pub random: Option<Placed>,
    /// Disturbances of the robot; `None` without any, and for a route.
    pub disturbances: Option<Disturbances>,
    /// Goal tolerance \[m\], if it was not `controller.goal_tolerance_m`.
    pub goal_tolerance_m: Option<f64>,
    /// Arrival rule, passing or standing; `None` for a route.
    pub arrival: Option<Arrival>,
    /// Pose by which the goal was reached; `None` for a route.
    pub reached_by: Option<ReachedBy>,
    /// Limit of the simulated time in this run \[s\].
    pub time_limit_s: Option<f64>,
    /// Time without progress along the remaining path after which the robot was stuck \[s\]; `None`
    /// for a route.
    pub stuck_window_s: Option<f64>,
    /// Limit of the number of expanded nodes.
    pub budget: Option<u64>,
}

/// Numbers of random obstacles, requested and placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Placed {
    /// Requested static discs.
    pub unknown_asked: u32,
    /// Placed static discs: the last ones of the episode's obstacles.
    pub unknown_placed: u32,
    /// Requested moving discs.
    pub moving_asked: u32,
    /// Placed moving discs: the last ones of the episode's `movers`.
    pub moving_placed: u32,
}

impl Placed {
    /// Returns the number of obstacles that could not be placed.
    pub const fn left_out(&self) -> u32 {
        self.unknown_asked - self.unknown_placed + self.moving_asked - self.moving_placed
    }
}

impl Inputs {
    /// Version of this library.
    pub const VERSION: &'static str = env!("CARGO_PKG_VERSION");
}

/// Parameters that affect a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Parameters {
    /// All parameters, for a run.
    Run(Box<Stack>),
    /// Parameters of a route, which does not depend on the rest of a stack.
    Route {
        /// Layers of the map.
        map: LayerConfig,
        /// The planner.
        planner: PlannerConfig,
        /// The smoother.
        smoother: SmootherConfig,
    },
}

/// Identification of a map in reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapSource {
    /// Name of the map, such as the path of its file.
    pub name: String,
    /// [`keyway::map::formats::digest`] of the map.
    pub digest: String,
    /// Placement of the map, if the caller gave one because the file has none.
    pub placement: Option<PlacementInput>,
}

/// Placement of a map whose file does not contain it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlacementInput {
    /// Side of a cell \[m\].
    pub resolution_m: f64,
    /// World pose of the lower left corner, `[x, y, yaw_deg]` \[m, m, deg\].
    pub origin: [f64; 3],
}

#[cfg(feature = "formats")]
impl From<&keyway::map::formats::LoadedMap> for MapSource {
    /// Identifies the map's file, without a placement.
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
