//! From two positions to a smoothed route that the robot fits through.

use super::Stack;
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline, Segment};
use crate::given::Computed;
use crate::map::{Cell, Hindrance, LayerConfig, SearchMap, Separation};
use crate::plan::{GlobalPlanner, PathEnd, Plan, PlanError, check_end};
use crate::search::{Query, Workspace};
use crate::smooth::{Smoothed, Smoother};
use std::f64::consts::FRAC_1_SQRT_2;
use thiserror::Error;

/// How far the line of a route may be from the curve that it stands for \[cells\].
const CHORD_CELLS: f64 = 0.05;

/// A planned way from one position to another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Route {
    /// The planner's path.
    pub plan: Plan,
    /// The same as a line from position to position \[m\].
    pub line: PlannedLine,
    /// The smoothed path, and what was done to the line.
    pub smoothing: Smoothed,
    /// The smoothed path as a line; of a curve, chords along it.
    pub smoothed: Polyline,
    /// What the smoothed line keeps from obstacles wherever the path did \[m\].
    pub clearance_m: f64,
}

/// Why a robot cannot be sent to a goal.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NavigateError {
    /// A value of the robot or the stack cannot be used; for the robot's, the path begins with `robot`.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The footprint does not fit at the start or goal.
    #[error(
        "{end} ({}, {}) leaves no room for a radius of {} m: {why}{}",
        Computed(.position.x), Computed(.position.y), Computed(*.radius_m),
        nearest_text(.nearest.as_ref())
    )]
    NoRoom {
        /// Which of the two.
        end: PathEnd,
        /// The position asked for \[m\].
        position: Point,
        /// The robot's radius \[m\].
        radius_m: f64,
        /// What is too near.
        why: Hindrance,
        /// The nearest position with room \[m\], unless there is none.
        nearest: Option<Point>,
    },
    /// There is no way on the known map.
    #[error("{}{why}", margin_text(.why))]
    NoWay {
        /// Which clearance would leave one, or how the start and the goal are parted.
        why: Separation,
    },
    /// There is no route.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Of which radius it is.
const fn margin_text(why: &Separation) -> &'static str {
    match why {
        Separation::TooNarrow { .. } => "with the safety margin around the robot, ",
        Separation::Apart { .. } => "",
    }
}

fn nearest_text(nearest: Option<&Point>) -> String {
    nearest.map_or_else(
        || "; no other place on this map has room either".to_owned(),
        |p| format!("; the nearest position with room is ({:.3}, {:.3})", p.x, p.y),
    )
}

/// The map layers of one robot, widest clearance first: a route uses the first on which there is a
/// way.
///
/// The last one is for a robot that has met something on its way: a lane between what it sees and a
/// wall may fit the robot, and yet hold no cell whose centre keeps the clearance. There the route says
/// where to try, and the local planner whether the robot fits.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    pub(super) maps: Vec<SearchMap>,
    /// How many of the maps have the clearance that the robot needs.
    fitting: usize,
}

impl Layers {
    pub(super) fn new(
        known: &crate::map::OccupancyGrid,
        stack: &Stack,
    ) -> Result<Self, ConfigError> {
        let layer = |config| SearchMap::new(known, config).map_err(|error| error.within("map"));
        let least_m = stack.controller.least_clearance_m;
        let widest = layer(stack.map.clone())?;
        let mut maps = vec![widest];
        if least_m < stack.map.clearance_m {
            let config = LayerConfig { clearance_m: least_m, ..stack.map.clone() };
            maps.push(layer(config)?);
        }
        let fitting = maps.len();
        // Half the diagonal of a cell: a lane that is just wide enough has a cell as near as this to
        // its middle.
        let clearance_m = (least_m - known.frame().resolution_m() * FRAC_1_SQRT_2).max(0.0);
        maps.push(layer(LayerConfig { clearance_m, ..stack.map.clone() })?);
        Ok(Self { maps, fitting })
    }

    /// The maps on which a way has the clearance that the robot needs.
    pub(super) fn fitting(&self) -> &[SearchMap] {
        &self.maps[..self.fitting]
    }

    /// Any of the maps: they have the same obstacles.
    pub(super) fn obstacles(&self) -> &SearchMap {
        &self.maps[0]
    }
}

/// Plans and smooths a route for a footprint of `radius_m`.
///
/// The clearance of a layer is required of the path's cells. Where an end of the route is nearer to
/// something than that, the route begins (or ends) with the straight way to the nearest free cell
/// that the footprint can take.
pub(super) fn plan_route(
    maps: &[SearchMap],
    planner: &dyn GlobalPlanner,
    smoother: &dyn Smoother,
    (start, goal): (Point, Point),
    radius_m: f64,
    budget: Option<u64>,
    workspace: &mut Workspace,
) -> Result<Route, NavigateError> {
    let (mut failure, mut no_room) = (None, None);
    for map in maps {
        // Where cells are too coarse for the lane, shortcuts must still fit the footprint.
        let clearance_m = map.config().clearance_m.max(radius_m);
        let from = attach(map, PathEnd::Start, start, radius_m);
        let (from, to) = match (from, attach(map, PathEnd::Goal, goal, radius_m)) {
            (Ok(from), Ok(to)) => (from, to),
            (Err(why), _) => {
                no_room = Some(no_way_on(maps, (PathEnd::Start, start), radius_m, why));
                continue;
            }
            (_, Err(why)) => {
                no_room = Some(no_way_on(maps, (PathEnd::Goal, goal), radius_m, why));
                continue;
            }
        };
        let mut plan = Plan::default();
        let query = Query { budget, ..Query::new(from, to) };
        match planner.plan_into(map, &query, workspace, None, &mut plan) {
            Ok(()) => {
                let line = plan.line(map, start, goal);
                let smoothing = smoother.smooth(&line, &map.clearance(), clearance_m);
                let smoothed = smoothing.path.flattened(CHORD_CELLS * map.frame().resolution_m());
                return Ok(Route { plan, line, smoothing, smoothed, clearance_m });
            }
            // Where the budget is too small for one layer, the next would only cost as much again.
            Err(error @ PlanError::BudgetExhausted { .. }) => return Err(error.into()),
            Err(error) => failure = Some(error.into()),
        }
    }
    let statistics = crate::search::SearchStatistics::default();
    // The result of a search says more than an end from which none could begin.
    Err(failure.or(no_room).unwrap_or(PlanError::NoPath { statistics }.into()))
}

/// Refuses an end at which the footprint touches something, or would leave the map.
pub(super) fn check_room(
    layers: &Layers,
    end: PathEnd,
    position: Point,
    radius_m: f64,
) -> Result<(), NavigateError> {
    let map = layers.obstacles();
    if map.clearance().is_clear_point(position, radius_m) {
        return Ok(());
    }
    // The narrowest layer knows the cells with room.
    let least = layers.fitting().last().unwrap_or(map);
    Err(no_room(least, end, position, radius_m))
}

/// `map` has the clearance that leaves room.
fn no_room(map: &SearchMap, end: PathEnd, position: Point, radius_m: f64) -> NavigateError {
    let nearest = map
        .nearest_free(map.frame().cell_near(position))
        .map(|cell| map.frame().world_from_cell(cell));
    let why = map.hindrance(position);
    NavigateError::NoRoom { end, position, radius_m, why, nearest }
}

/// Why no route can begin (or end) at a position: where the footprint has no room, that says more than
/// the cell that is blocked in the last of the layers.
fn no_way_on(
    maps: &[SearchMap],
    (end, position): (PathEnd, Point),
    radius_m: f64,
    why: PlanError,
) -> NavigateError {
    let fits = |map: &&SearchMap| map.config().clearance_m >= radius_m;
    match maps.iter().rfind(fits) {
        Some(map) if !map.clearance().is_clear_point(position, radius_m) => {
            no_room(map, end, position, radius_m)
        }
        _ => why.into(),
    }
}

/// Says of a route that does not exist what is in the way: for the least clearance that the robot needs.
pub(super) fn explain(
    layers: &Layers,
    planner: &dyn GlobalPlanner,
    (start, goal): (Point, Point),
    radius_m: f64,
    error: NavigateError,
) -> NavigateError {
    let NavigateError::Plan(PlanError::NoPath { .. }) = error else { return error };
    let Some(map) = layers.fitting().last() else { return error };
    let ends = [(PathEnd::Start, start), (PathEnd::Goal, goal)];
    let [Ok(from), Ok(to)] = ends.map(|(end, position)| attach(map, end, position, radius_m))
    else {
        return error;
    };
    let why = map.separation(from, to, planner.connectivity());
    why.map_or(error, |why| NavigateError::NoWay { why })
}

/// The cell at which a route from (or to) a position meets the grid: its own if free, otherwise the
/// nearest free one, if the footprint can go there straight. Where the footprint has no room even
/// at the position (a cell was sensed too near), the way may not come nearer than that.
///
/// The error says why the position's own cell cannot be used.
fn attach(
    map: &SearchMap,
    end: PathEnd,
    position: Point,
    radius_m: f64,
) -> Result<Cell, PlanError> {
    let own = map.frame().cell_near(position);
    let Err(why) = check_end(map, end, own) else { return Ok(own) };
    let PlanError::Blocked { nearest: Some(cell), .. } = why else { return Err(why) };
    let way = Segment::new(position, map.frame().world_from_cell(cell));
    let room_m = map.clearance().of_point(position, radius_m);
    if map.clearance().is_clear(way, room_m) { Ok(cell) } else { Err(why) }
}
