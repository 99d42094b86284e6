//! The map layers of a robot, by clearance.

use super::Stack;
use crate::ConfigError;
use crate::map::{Cell, CellState, Edit, LayerConfig, OccupancyGrid, SearchMap};
use crate::robot::Robot;
use crate::route::looser_clearance_m;

/// The map layers of one robot, widest clearance first: a route uses the first one that has a
/// path, or the first one on which it is no long detour.
///
/// The last one is for a robot that senses obstacles along its route: a lane between a sensed
/// obstacle and a wall may fit the robot although it contains no cell whose centre keeps the
/// clearance. The route then indicates where to try, and the local planner decides if the robot
/// fits.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    pub(super) maps: Vec<SearchMap>,
    /// Number of maps whose clearance is sufficient for the robot.
    pub(super) fitting: usize,
    /// True if the last but one of these was added for a route.
    is_inserted: bool,
    /// True if a route had to lead between the centres of cells, so later ones may have to.
    pub(super) is_between_cells: bool,
}

impl Layers {
    pub(super) fn new(
        known: &OccupancyGrid,
        stack: &Stack,
        robot: &Robot,
    ) -> Result<Self, ConfigError> {
        let layer = |config| SearchMap::new(known, config).map_err(|error| error.within("map"));
        let least_m = stack.controller.least_clearance_m;
        // For a round robot, the second one is the last one.
        let turning_m = turning_clearance_m(stack, robot);
        let mut maps = vec![layer(stack.map.clone())?];
        for clearance_m in [turning_m, least_m] {
            if maps.last().is_some_and(|map| clearance_m < map.config().clearance_m) {
                maps.push(layer(LayerConfig { clearance_m, ..stack.map.clone() })?);
            }
        }
        let fitting = maps.len();
        // A lane that is just wide enough has a cell near its centreline.
        let narrowest_m = least_m.min(stack.map.clearance_m);
        let clearance_m = looser_clearance_m(known.frame(), narrowest_m);
        maps.push(layer(LayerConfig { clearance_m, ..stack.map.clone() })?);
        Ok(Self { maps, fitting, is_inserted: false, is_between_cells: false })
    }

    /// Adds a map with a clearance between those that are sufficient for the robot, in place of
    /// the one that was added last.
    pub(super) fn insert(&mut self, map: SearchMap) {
        let at = self.fitting - 1;
        if self.is_inserted {
            self.maps[at - 1] = map;
            return;
        }
        self.maps.insert(at, map);
        (self.fitting, self.is_inserted) = (self.fitting + 1, true);
    }

    /// The maps whose clearance is sufficient for the robot.
    pub(super) fn fitting(&self) -> &[SearchMap] {
        &self.maps[..self.fitting]
    }

    /// The last map, and the clearance that the robot needs \[m\]; `None` if no map has a smaller
    /// clearance than that.
    pub(super) fn looser(&mut self) -> Option<(&mut SearchMap, f64)> {
        let [.., least, looser] = &mut self.maps[..] else { return None };
        let needed_m = least.config().clearance_m;
        (looser.config().clearance_m < needed_m).then_some((looser, needed_m))
    }

    /// Changes some cells of all maps.
    pub(super) fn mark(&mut self, cells: &[Cell], state: impl Fn(Cell) -> CellState) {
        let edits: Vec<_> = cells.iter().map(|&cell| Edit { cell, state: state(cell) }).collect();
        self.maps.iter_mut().for_each(|map| map.apply(&edits));
    }

    /// Resets some cells of all maps to their state in the known map.
    pub(super) fn unmark(&mut self, cells: &[Cell], known: &OccupancyGrid) {
        self.mark(cells, |cell| known.state(cell).unwrap_or(CellState::Free));
    }

    /// Clearance of the map that was added for a route, if any \[m\].
    pub(super) fn inserted_m(&self) -> Option<f64> {
        self.is_inserted.then(|| self.maps[self.fitting - 2].config().clearance_m)
    }

    /// Adds a map of a stored clearance \[m\].
    pub(super) fn insert_again(&mut self, known: &OccupancyGrid, clearance_m: f64) {
        let config = LayerConfig { clearance_m, ..self.maps[0].config().clone() };
        if let Ok(map) = SearchMap::new(known, config) {
            self.insert(map);
        }
    }

    /// One of the maps; all have the same obstacles.
    pub(super) fn obstacles(&self) -> &SearchMap {
        &self.maps[0]
    }
}

/// The smallest clearance at which the robot can rotate on the spot anywhere \[m\].
pub(super) fn turning_clearance_m(stack: &Stack, robot: &Robot) -> f64 {
    let Robot { footprint, .. } = robot;
    stack.controller.least_clearance_m + footprint.circumscribed_radius_m()
        - footprint.inscribed_radius_m()
}
