//! Obstacles that sensors have detected and the known map does not have.

mod points;
pub(super) use points::says_something;
#[cfg(test)]
mod tests;

use super::{Hit, Mover, ProjectedScan, SensorPoints, Tracker};
use crate::geometry::{Disc, Point, Square};
use crate::map::{BitGrid, Cell, CellState, CellWindow, Edit, GridFrame, OccupancyGrid};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Cells in which scans and points have detected something that the known map does not have.
///
/// The known map itself is never changed: a beam through a known obstacle does not clear it, and
/// a sensed cell that is cleared returns to its state in the known map, unknown included.
///
/// A cell is cleared when its last hit point is seen through: the beams to both sides of that
/// point continue beyond it. A beam through another part of the cell is no evidence: a cell may
/// be larger than the obstacle in it and is seldom filled by it.
///
/// Memory: one bit per cell, and one entry per sensed cell. An update costs one look-up per hit,
/// and one per sensed cell within the sensor's range.
#[derive(Clone, Debug)]
pub struct SensedLayer {
    sensed: BitGrid,
    count: u64,
    /// Last hit point in each cell, and the scan it is from.
    places: HashMap<Cell, Place>,
    /// Last point in each cell from each of the sensors that give points.
    met: HashMap<(Cell, usize), Point>,
    /// Number of scans so far, and the number of each sensor's last scan.
    cycle: u64,
    scanned: [u64; Robot::MOST_SENSORS],
    /// Scratch of [`Self::update`]; not meaningful between calls.
    cleared: Vec<Cell>,
    marked: Vec<Cell>,
    view: ProjectedScan,
}

/// A layer in compact form.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SensedPlaces {
    cycle: u64,
    scanned: [u64; Robot::MOST_SENSORS],
    /// In the order of [`Cell`].
    places: Vec<(Cell, Place)>,
    met: Vec<((Cell, usize), Point)>,
}

/// A hit of a beam.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Place {
    /// In the world frame \[m\].
    point: Point,
    /// Number of the scan.
    cycle: u64,
    sensor: usize,
}

/// Initial capacity in cells, so that no cycle has to wait for an allocation.
const USUAL_COUNT: usize = 4096;

impl SensedLayer {
    /// An empty layer on a grid of `frame`'s size.
    pub fn new(frame: &GridFrame) -> Self {
        let sensed = BitGrid::new(frame.width(), frame.height(), false);
        let places = HashMap::with_capacity(USUAL_COUNT);
        let [cleared, marked] = [(); 2].map(|()| Vec::with_capacity(USUAL_COUNT));
        let (scanned, view) = ([0; Robot::MOST_SENSORS], ProjectedScan::default());
        let met = HashMap::new();
        Self { sensed, count: 0, places, met, cycle: 0, scanned, cleared, marked, view }
    }

    /// The cells in which something was sensed that the known map does not have.
    pub const fn sensed(&self) -> &BitGrid {
        &self.sensed
    }

    /// Number of sensed cells.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The layer in compact form.
    pub(crate) fn stored(&self) -> SensedPlaces {
        let (cycle, scanned) = (self.cycle, self.scanned);
        SensedPlaces { cycle, scanned, places: in_order(&self.places), met: in_order(&self.met) }
    }

    /// Restores a layer on a map of this size. Cells outside the map and hits that no sensor can
    /// have made are dropped.
    pub(crate) fn restored(known: &OccupancyGrid, stored: &SensedPlaces) -> Self {
        let (cycle, scanned) = (stored.cycle, stored.scanned);
        let mut layer = Self { cycle, scanned, ..Self::new(known.frame()) };
        let is_inside = |cell: Cell| known.frame().contains(cell) && !known.occupied().get(cell);
        let is_place = |place: &Place| place.sensor < Robot::MOST_SENSORS;
        for &(cell, place) in &stored.places {
            if is_inside(cell) && is_place(&place) {
                layer.places.insert(cell, place);
                layer.count += u64::from(layer.sensed.set(cell, true));
            }
        }
        for &((cell, sensor), point) in &stored.met {
            if is_inside(cell) && sensor < SensorPoints::MOST_SENSORS {
                layer.met.insert((cell, sensor), point);
                layer.count += u64::from(layer.sensed.set(cell, true));
            }
        }
        layer
    }

    /// The sensed cells, in the order of [`Cell`].
    pub(crate) fn cells(&self) -> Vec<Cell> {
        let met = self.met.keys().map(|&(cell, _)| cell);
        let mut cells: Vec<Cell> = self.places.keys().copied().chain(met).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// Updates the layer with a scan on the `known` map, whose frame is the one given to
    /// [`Self::new`].
    ///
    /// First, every sensed cell whose hit point is seen through is cleared (by a beam without a
    /// hit, up to the sensor's range). Then every hit marks its cell, unless the cell is occupied
    /// in the known map or lies outside it. So within one scan marks win over clears. An invalid
    /// beam ([`Scan::reading`](super::Scan::reading)) is ignored, and so is a scan at a pose that
    /// is not finite.
    ///
    /// A `tracker` that has been given the same scan separates moving obstacles, so they leave no
    /// trail. A hit on a moving obstacle ([`Tracker::hits_mover`]) marks nothing. The cells under
    /// a moving obstacle that is seen are cleared, and so are those that were marked before it
    /// was known to move. Under one that is only predicted, nothing is cleared. Without a tracker
    /// everything counts as stationary.
    ///
    /// `edits` is emptied and receives exactly the cells that changed, each once: first those
    /// cleared, with their known state, in the order of [`Cell`]; then those marked, as occupied,
    /// in the order of the beams. Applied to a map of the known obstacles and the sensed cells so
    /// far, they keep it up to date.
    pub fn update(
        &mut self,
        known: &OccupancyGrid,
        scan: &ProjectedScan,
        tracker: Option<&Tracker>,
        edits: &mut Vec<Edit>,
    ) {
        self.update_from(known, 0, scan, tracker, edits);
    }

    /// Like [`Self::update`], for the sensor of this index. A cell that one sensor has marked
    /// stays marked, even if another one sees through it, until the first one has scanned again
    /// without a hit there.
    pub fn update_from(
        &mut self,
        known: &OccupancyGrid,
        sensor: usize,
        scan: &ProjectedScan,
        tracker: Option<&Tracker>,
        edits: &mut Vec<Edit>,
    ) {
        let sensor = sensor.min(Robot::MOST_SENSORS - 1);
        self.begin(edits);
        self.cycle = self.cycle.saturating_add(1);
        self.scanned[sensor] = self.cycle;
        let frame = known.frame();
        self.clear_seen_through(scan);
        if let Some(tracker) = tracker {
            tracker.left().iter().for_each(|&cell| self.clear(cell));
            let seen = tracker.movers().iter().filter(|mover| mover.unseen_s == 0.0);
            seen.for_each(|mover| self.clear_under(mover, frame));
        }
        self.cleared.sort_unstable();
        let moves = |beam: usize, hit: &Hit| {
            tracker.is_some_and(|tracker| tracker.hits_mover(beam, hit.point))
        };
        for (_, hit) in scan.hits().filter(|(beam, hit)| !moves(*beam, hit)) {
            self.mark(known, sensor, &hit);
        }
        self.list_changes(known, edits);
    }

    fn begin(&mut self, edits: &mut Vec<Edit>) {
        edits.clear();
        self.cleared.clear();
        self.marked.clear();
    }

    /// Lists the cleared cells, which are sorted, and the marked ones. A cell that is cleared and
    /// marked again is unchanged.
    fn list_changes(&mut self, known: &OccupancyGrid, edits: &mut Vec<Edit>) {
        self.count = self.count + self.marked.len() as u64 - self.cleared.len() as u64;
        let after_clears = self.cleared.iter().filter(|&&cell| !self.sensed.get(cell));
        edits.extend(after_clears.filter_map(|&cell| {
            let state = known.state(cell)?;
            Some(Edit { cell, state })
        }));
        let fresh = self.marked.iter().filter(|cell| self.cleared.binary_search(cell).is_err());
        edits.extend(fresh.map(|&cell| Edit { cell, state: CellState::Occupied }));
    }

    /// Moves everything sensed, for example with a correction of the robot's pose, onto a map
    /// that may be a different one. `edits` is emptied and receives the changed cells: first the
    /// previous cells, with their state in the known map.
    pub(crate) fn shift(
        &mut self,
        known: &OccupancyGrid,
        shift: impl Fn(Point) -> Point,
        edits: &mut Vec<Edit>,
    ) {
        let frame = known.frame();
        let before = {
            let (cycle, scanned) = (self.cycle, self.scanned);
            std::mem::replace(self, Self { cycle, scanned, ..Self::new(frame) })
        };
        edits.clear();
        let free = |cell| Some(Edit { cell, state: known.state(cell)? });
        edits.extend(before.cells().into_iter().filter_map(free));
        let mut mark = |layer: &mut Self, cell| {
            if layer.sensed.set(cell, true) {
                layer.count += 1;
                edits.push(Edit { cell, state: CellState::Occupied });
            }
        };
        let free_cell = |point| {
            let cell = frame.cell_from_world(point);
            cell.filter(|&cell| !known.occupied().get(cell))
        };
        for (_, place) in in_order(&before.places) {
            let point = shift(place.point);
            let Some(cell) = free_cell(point) else { continue };
            self.places.insert(cell, Place { point, ..place });
            mark(self, cell);
        }
        for ((_, sensor), point) in in_order(&before.met) {
            let point = shift(point);
            let Some(cell) = free_cell(point) else { continue };
            self.met.insert((cell, sensor), point);
            mark(self, cell);
        }
    }

    /// Clears the layer. `edits` is emptied and receives the cells that changed.
    pub(crate) fn forget(&mut self, known: &OccupancyGrid, edits: &mut Vec<Edit>) {
        edits.clear();
        let free = |cell| Some(Edit { cell, state: known.state(cell)? });
        edits.extend(self.cells().into_iter().filter_map(free));
        *self = Self { cycle: self.cycle, scanned: self.scanned, ..Self::new(known.frame()) };
    }

    /// Clears the cells that a disc touches. `edits` is emptied and receives the cells that
    /// changed.
    pub(crate) fn forget_disc(
        &mut self,
        known: &OccupancyGrid,
        disc: &Disc,
        edits: &mut Vec<Edit>,
    ) {
        edits.clear();
        for cell in cells_under(disc, known.frame()) {
            if self.sensed.set(cell, false) {
                self.places.remove(&cell);
                self.met.retain(|(met, _), _| *met != cell);
                self.count -= 1;
                edits.extend(known.state(cell).map(|state| Edit { cell, state }));
            }
        }
    }

    /// Takes in changes of the known map. An obstacle that is now on the map is no longer a
    /// sensed one; a sensed cell stays sensed even if the map now says that it is free. `changes`
    /// is emptied and receives the resulting changes of the map of known and sensed cells.
    pub(crate) fn learn(&mut self, known: &OccupancyGrid, edits: &[Edit], changes: &mut Vec<Edit>) {
        changes.clear();
        for edit in edits {
            if known.occupied().get(edit.cell) && self.sensed.set(edit.cell, false) {
                self.places.remove(&edit.cell);
                self.met.retain(|(cell, _), _| *cell != edit.cell);
                self.count -= 1;
            }
            if !self.sensed.get(edit.cell) {
                changes.push(*edit);
            }
        }
    }

    /// Removes the hit of a beam in a cell.
    fn clear(&mut self, cell: Cell) {
        if self.places.remove(&cell).is_some() && !self.has_met(cell) {
            self.sensed.set(cell, false);
            self.cleared.push(cell);
        }
    }

    /// True if a sensor that gives points has detected something in a cell.
    fn has_met(&self, cell: Cell) -> bool {
        let has = |sensor| self.met.contains_key(&(cell, sensor));
        !self.met.is_empty() && (0..SensorPoints::MOST_SENSORS).any(has)
    }

    /// Clears the cells that a moving obstacle touches at its estimated position.
    fn clear_under(&mut self, mover: &Mover, frame: &GridFrame) {
        if self.count == self.cleared.len() as u64 {
            return;
        }
        let disc = Disc { centre: mover.centre, radius_m: mover.radius_m };
        cells_under(&disc, frame).for_each(|cell| self.clear(cell));
    }

    /// Clears the cells whose hit points are seen through.
    fn clear_seen_through(&mut self, scan: &ProjectedScan) {
        // The sensor that made the hit has scanned again since, or does so now.
        let is_old = |place: &Place| self.scanned[place.sensor] > place.cycle;
        let is_gone = |place: &Place| is_old(place) && scan.sees_through(place.point);
        let gone = self.places.iter().filter(|(_, place)| is_gone(place)).map(|(&cell, _)| cell);
        self.cleared.extend(gone);
        let mut cleared = std::mem::take(&mut self.cleared);
        cleared.retain(|&cell| {
            self.places.remove(&cell);
            let is_free = !self.has_met(cell);
            is_free && self.sensed.set(cell, false)
        });
        self.cleared = cleared;
    }

    fn mark(&mut self, known: &OccupancyGrid, sensor: usize, hit: &Hit) {
        let Some(cell) = hit.cell.filter(|&cell| !known.occupied().get(cell)) else { return };
        self.places.insert(cell, Place { point: hit.point, cycle: self.cycle, sensor });
        self.mark_cell(cell);
    }

    fn mark_cell(&mut self, cell: Cell) {
        if self.sensed.set(cell, true) {
            self.marked.push(cell);
        }
    }
}

/// The entries of a map sorted by key, since the iteration order of a `HashMap` differs between
/// runs.
fn in_order<K: Ord + Copy, V: Copy>(map: &HashMap<K, V>) -> Vec<(K, V)> {
    let mut entries: Vec<(K, V)> = map.iter().map(|(&key, &value)| (key, value)).collect();
    entries.sort_unstable_by_key(|(key, _)| *key);
    entries
}

/// The cells whose squares a disc touches.
fn cells_under(disc: &Disc, frame: &GridFrame) -> impl Iterator<Item = Cell> + use<> {
    let centre = frame.grid_from_world(disc.centre);
    let reach = disc.radius_m / frame.resolution_m();
    CellWindow::around(frame, disc.centre, disc.radius_m).cells().filter(move |cell| {
        let square = Square { corner: Point::new(f64::from(cell.x), f64::from(cell.y)) };
        square.distance_sq_to_point(centre) <= reach * reach
    })
}
