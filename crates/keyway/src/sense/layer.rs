//! What scans have shown that the known map does not.

use super::{Hit, Mover, ProjectedScan, Tracker};
use crate::geometry::{Point, Square};
use crate::map::{BitGrid, Cell, CellState, CellWindow, Edit, GridFrame, OccupancyGrid};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Cells in which scans have met something that the known map does not have.
///
/// The known map itself is never changed: a beam through a known obstacle leaves it standing, and
/// a sensed cell that is cleared goes back to what the known map says, unknown included.
///
/// A cell is cleared when the place in it that a beam has met is seen through: when the beams to
/// both sides of that place go on beyond it. A beam through another part of the cell says nothing:
/// a cell may be larger than what stands in it, and is seldom filled by it.
///
/// Memory: one bit per cell, and a place for each sensed cell. An update costs a look-up per hit,
/// and one per sensed cell within the sensor's range.
#[derive(Clone, Debug)]
pub struct SensedLayer {
    sensed: BitGrid,
    count: u64,
    /// For each sensed cell the last place in it that a beam has met, and in which scan.
    places: HashMap<Cell, Place>,
    /// Number of scans so far, and of the last one of each sensor.
    cycle: u64,
    scanned: [u64; Robot::MOST_SENSORS],
    /// Scratch of [`Self::update`], without meaning between calls.
    cleared: Vec<Cell>,
    marked: Vec<Cell>,
}

/// A layer in few words.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SensedPlaces {
    cycle: u64,
    scanned: [u64; Robot::MOST_SENSORS],
    /// In the order of [`Cell`].
    places: Vec<(Cell, Place)>,
}

/// A place that a beam has met.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Place {
    /// In the world frame \[m\].
    point: Point,
    /// Number of the scan.
    cycle: u64,
    sensor: usize,
}

/// Room for so many cells is made at the beginning, so that no cycle has to wait for it.
const USUAL_COUNT: usize = 4096;

impl SensedLayer {
    /// Nothing sensed, on a grid of `frame`'s size.
    pub fn new(frame: &GridFrame) -> Self {
        let sensed = BitGrid::new(frame.width(), frame.height(), false);
        let places = HashMap::with_capacity(USUAL_COUNT);
        let [cleared, marked] = [(); 2].map(|()| Vec::with_capacity(USUAL_COUNT));
        let scanned = [0; Robot::MOST_SENSORS];
        Self { sensed, count: 0, places, cycle: 0, scanned, cleared, marked }
    }

    /// Cells in which something was met that the known map does not have.
    pub const fn sensed(&self) -> &BitGrid {
        &self.sensed
    }

    /// Number of sensed cells.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The layer in few words.
    pub(crate) fn stored(&self) -> SensedPlaces {
        let places = self.cells().into_iter().map(|cell| (cell, self.places[&cell]));
        let (cycle, scanned) = (self.cycle, self.scanned);
        SensedPlaces { cycle, scanned, places: places.collect() }
    }

    /// The layer that was stored, on a map of this size; cells outside it are left out.
    pub(crate) fn restored(known: &OccupancyGrid, stored: &SensedPlaces) -> Self {
        let mut layer = Self { cycle: stored.cycle, ..Self::new(known.frame()) };
        let inside = stored
            .places
            .iter()
            .filter(|(cell, _)| known.frame().contains(*cell) && !known.occupied().get(*cell));
        for &(cell, place) in inside {
            layer.places.insert(cell, place);
            layer.count += u64::from(layer.sensed.set(cell, true));
        }
        layer
    }

    /// The sensed cells, in the order of [`Cell`].
    pub(crate) fn cells(&self) -> Vec<Cell> {
        let mut cells: Vec<Cell> = self.places.keys().copied().collect();
        cells.sort_unstable();
        cells
    }

    /// Takes in a scan on the `known` map, whose frame is the one given to [`Self::new`].
    ///
    /// First every sensed cell is cleared whose place is seen through (up to the sensor's range by
    /// a beam without a hit); then every hit marks its cell, unless the known map already has it as
    /// occupied or it lies outside the map. So within one scan marks win over clears. A beam that
    /// says nothing ([`Scan::reading`](super::Scan::reading)) is ignored, and so is a scan at a
    /// pose that is not finite.
    ///
    /// A `tracker`, which has been given the same scan, tells apart what moves: that is not marked,
    /// so movers leave no trail. A hit on a mover ([`Tracker::hits_mover`]) marks nothing; the
    /// cells under a mover that is seen are cleared, and so are those that were marked before it
    /// was known to move. Where one is only expected, nothing is cleared. Without one everything
    /// counts as standing.
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

    /// The same of the sensor of this index. What one sensor has met stands, whatever another one
    /// has seen through, until the first one has scanned again without meeting it.
    pub fn update_from(
        &mut self,
        known: &OccupancyGrid,
        sensor: usize,
        scan: &ProjectedScan,
        tracker: Option<&Tracker>,
        edits: &mut Vec<Edit>,
    ) {
        self.cycle += 1;
        let sensor = sensor.min(Robot::MOST_SENSORS - 1);
        self.scanned[sensor] = self.cycle;
        edits.clear();
        self.cleared.clear();
        self.marked.clear();
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
        self.count = self.count + self.marked.len() as u64 - self.cleared.len() as u64;
        // Marked again is unchanged.
        let after_clears = self.cleared.iter().filter(|&&cell| !self.sensed.get(cell));
        edits.extend(after_clears.filter_map(|&cell| {
            let state = known.state(cell)?;
            Some(Edit { cell, state })
        }));
        let fresh = self.marked.iter().filter(|cell| self.cleared.binary_search(cell).is_err());
        edits.extend(fresh.map(|&cell| Edit { cell, state: CellState::Occupied }));
    }

    /// Moves what was sensed, such as with the robot that has sensed it, on a map that may be
    /// another one. `edits` is emptied and receives the cells that changed, as those of the map:
    /// first the cells of before, with the state that is known of them now.
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
        let mut places: Vec<(Cell, Place)> = before.places.into_iter().collect();
        places.sort_unstable_by_key(|(cell, _)| *cell);
        for (_, place) in places {
            let point = shift(place.point);
            let cell = frame.cell_from_world(point);
            let Some(cell) = cell.filter(|&cell| !known.occupied().get(cell)) else { continue };
            self.places.insert(cell, Place { point, ..place });
            if self.sensed.set(cell, true) {
                self.count += 1;
                edits.push(Edit { cell, state: CellState::Occupied });
            }
        }
    }

    /// Takes in changes of the known map. What stands on it is sensed no longer; a cell that was
    /// sensed stays so where the map now says that it is free. `changes` is emptied and receives
    /// those that follow for the map of known and sensed cells.
    pub(crate) fn learn(&mut self, known: &OccupancyGrid, edits: &[Edit], changes: &mut Vec<Edit>) {
        changes.clear();
        for edit in edits {
            if known.occupied().get(edit.cell) && self.sensed.set(edit.cell, false) {
                self.places.remove(&edit.cell);
                self.count -= 1;
            }
            if !self.sensed.get(edit.cell) {
                changes.push(*edit);
            }
        }
    }

    fn clear(&mut self, cell: Cell) {
        if self.sensed.set(cell, false) {
            self.places.remove(&cell);
            self.cleared.push(cell);
        }
    }

    /// Clears the cells that a mover touches where it is estimated to be.
    fn clear_under(&mut self, mover: &Mover, frame: &GridFrame) {
        if self.count == self.cleared.len() as u64 {
            return;
        }
        let centre = frame.grid_from_world(mover.centre);
        let reach = mover.radius_m / frame.resolution_m();
        for cell in CellWindow::around(frame, mover.centre, mover.radius_m).cells() {
            let square = Square { corner: Point::new(f64::from(cell.x), f64::from(cell.y)) };
            if square.distance_sq_to_point(centre) <= reach * reach {
                self.clear(cell);
            }
        }
    }

    /// Clears the cells whose places are seen through.
    fn clear_seen_through(&mut self, scan: &ProjectedScan) {
        // The sensor that has met it has looked again since, or does so now.
        let is_old = |place: &Place| self.scanned[place.sensor] > place.cycle;
        let is_gone = |place: &Place| is_old(place) && scan.sees_through(place.point);
        let through = self.places.iter().filter(|(_, place)| is_gone(place));
        self.cleared.extend(through.map(|(&cell, _)| cell));
        for cell in &self.cleared {
            self.sensed.set(*cell, false);
            self.places.remove(cell);
        }
    }

    fn mark(&mut self, known: &OccupancyGrid, sensor: usize, hit: &Hit) {
        let Some(cell) = hit.cell.filter(|&cell| !known.occupied().get(cell)) else { return };
        self.places.insert(cell, Place { point: hit.point, cycle: self.cycle, sensor });
        if self.sensed.set(cell, true) {
            self.marked.push(cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{LayerConfig, SearchMap};
    use crate::robot::Robot;
    use crate::sense::Scan;
    use crate::sense::test_scan::{projected, scan_among};
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Beams to the right, up, left and down of a robot with heading 0.
    fn four(ranges: [f64; 4]) -> Scan {
        Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: FRAC_PI_2,
            range_min_m: 0.1,
            range_max_m: 3.0,
            ranges_m: ranges.to_vec(),
        }
    }

    const NO: f64 = f64::NAN;
    const MISS: f64 = f64::INFINITY;

    struct Case {
        known: OccupancyGrid,
        layer: SensedLayer,
    }

    impl Case {
        fn new(rows: &[&str]) -> Self {
            let known = OccupancyGrid::from_ascii(rows);
            let layer = SensedLayer::new(known.frame());
            Self { known, layer }
        }

        fn scan(&mut self, x: f64, y: f64, ranges: [f64; 4]) -> Vec<(i32, i32, CellState)> {
            let mut edits = vec![Edit { cell: Cell::new(9, 9), state: CellState::Free }];
            let pose = Pose::new(x, y, 0.0);
            let scan = projected(self.known.frame(), pose, &four(ranges));
            self.layer.update(&self.known, &scan, None, &mut edits);
            assert_eq!(self.layer.count(), self.layer.sensed().count_ones());
            edits.iter().map(|edit| (edit.cell.x, edit.cell.y, edit.state)).collect()
        }
    }

    use CellState::{Free, Occupied, Unknown};

    #[test]
    fn a_hit_marks_and_a_later_beam_clears() {
        let mut case = Case::new(&["....."]);
        assert_eq!(case.scan(0.5, 0.5, [2.7, NO, NO, NO]), [(3, 0, Occupied)]);
        assert_eq!(case.scan(0.5, 0.5, [2.6, NO, NO, NO]), []);
        assert_eq!(case.scan(0.5, 0.5, [1.7, NO, NO, NO]), [(2, 0, Occupied)]);
        assert_eq!(case.scan(0.5, 0.5, [2.7, NO, NO, NO]), [(2, 0, Free)]);
        assert_eq!(case.layer.count(), 1);
        assert_eq!(case.scan(0.5, 0.5, [MISS, NO, NO, NO]), [(3, 0, Free)]);
    }

    #[test]
    fn a_miss_clears_up_to_the_range_only() {
        let mut case = Case::new(&["......"]);
        case.scan(2.5, 0.5, [2.7, NO, NO, NO]);
        // What was met is 4.7 m from here, the range is 3 m.
        assert_eq!(case.scan(0.5, 0.5, [MISS, NO, NO, NO]), []);
        assert_eq!(case.scan(2.3, 0.5, [4.9, NO, NO, NO]), [], "beyond the range says nothing");
        assert_eq!(case.scan(2.1, 0.5, [MISS, NO, NO, NO]), [], "into its cell, but not up to it");
        assert_eq!(case.scan(2.3, 0.5, [MISS, NO, NO, NO]), [(5, 0, Free)]);
    }

    #[test]
    fn a_hit_on_a_face_marks_the_square_behind() {
        let mut case = Case::new(&[".....", ".....", "....."]);
        let right_and_left = case.scan(2.5, 1.5, [1.5, NO, 1.5, NO]);
        assert_eq!(right_and_left, [(4, 1, Occupied), (0, 1, Occupied)]);
        assert_eq!(case.scan(2.5, 1.5, [NO, 0.5, NO, 0.5]), [(2, 2, Occupied), (2, 0, Occupied)]);
    }

    #[test]
    fn known_walls_are_neither_stored_nor_cleared() {
        let mut case = Case::new(&["..#.."]);
        assert_eq!(case.scan(0.5, 0.5, [1.5, NO, NO, NO]), []);
        assert_eq!(case.layer.count(), 0);
        // Through the wall, as after it was taken away.
        assert_eq!(case.scan(0.5, 0.5, [MISS, NO, NO, NO]), []);
        assert_eq!(case.known.state(Cell::new(2, 0)), Some(Occupied));
    }

    #[test]
    fn unknown_cells_become_unknown_again() {
        let mut case = Case::new(&["..?.."]);
        assert_eq!(case.scan(0.5, 0.5, [1.8, NO, NO, NO]), [(2, 0, Occupied)]);
        assert_eq!(case.scan(0.5, 0.5, [2.8, NO, NO, NO]), [(2, 0, Unknown), (3, 0, Occupied)]);
    }

    #[test]
    fn a_beam_through_another_part_of_a_cell_says_nothing() {
        // Beams 10 degrees apart; the place is at (3.2, 0.5), between the first two of them.
        let fan = |ranges: [f64; 3]| Scan {
            angle_min_rad: -5f64.to_radians(),
            angle_increment_rad: 10f64.to_radians(),
            range_min_m: 0.1,
            range_max_m: 3.0,
            ranges_m: ranges.to_vec(),
        };
        let cleared = |ranges, theta: f64| {
            let mut case = Case::new(&["....."]);
            case.scan(0.5, 0.5, [2.7, NO, NO, NO]);
            let mut edits = Vec::new();
            let pose = Pose::new(0.5, 0.5, theta.to_radians());
            let scan = projected(case.known.frame(), pose, &fan(ranges));
            case.layer.update(&case.known, &scan, None, &mut edits);
            edits.iter().any(|edit| edit.cell == Cell::new(3, 0))
        };
        assert!(cleared([MISS, MISS, NO], 0.0));
        assert!(
            !cleared([MISS, 2.6, NO], 0.0) && !cleared([2.6, MISS, NO], 0.0),
            "on one side only"
        );
        assert!(!cleared([MISS, NO, MISS], 0.0), "a beam that says nothing");
        // Within the cell, which spans 10 degrees to both sides, but beside the place.
        assert!(!cleared([MISS; 3], 8.0) && !cleared([MISS; 3], -18.0), "out of the field of view");
        assert!(cleared([NO, MISS, NO], -5.0), "right through it");
    }

    /// Discs of half a cell and more on cells of 1 m, seen from many places, and left behind.
    #[test]
    fn what_stands_is_not_forgotten() {
        let robot = Robot::paper();
        let known = OccupancyGrid::from_ascii(&[".............................."; 9]);
        let discs = [(9.5, 4.5, 0.5), (14.0, 6.0, 0.75), (19.9, 3.3, 0.5), (20.0, 8.0, 0.2)];
        let discs = discs.map(|(x, y, radius_m)| (Point::new(x, y), radius_m));
        for y in [1.5, 2.2, 6.9] {
            let mut layer = SensedLayer::new(known.frame());
            let mut edits = Vec::new();
            for step in 0..290 {
                let pose = Pose::new(0.5 + f64::from(step) * 0.1, y, 0.003 * f64::from(step));
                let scan = scan_among((known.frame(), &[]), &discs, pose, &robot.sensors[0]);
                layer.update(&known, &projected(known.frame(), pose, &scan), None, &mut edits);
                let freed = edits.iter().find(|edit| edit.state == Free);
                assert_eq!(freed, None, "from {pose:?}");
            }
            assert!(layer.count() >= 8, "{}", layer.count());
        }
    }

    #[test]
    fn marks_win_whatever_the_order_of_the_beams() {
        // Both beams look right; one passes the cell (2, 0), the other hits in it.
        for ranges in [[1.7, 2.7], [2.7, 1.7]] {
            let mut case = Case::new(&["....."]);
            let scan = Scan { angle_increment_rad: 2.0 * PI, ..four([NO; 4]) };
            let scan = Scan { ranges_m: ranges.to_vec(), ..scan };
            let mut edits = Vec::new();
            let pose = Pose::new(0.5, 0.5, 0.0);
            case.layer.update(
                &case.known,
                &projected(case.known.frame(), pose, &scan),
                None,
                &mut edits,
            );
            assert_eq!(edits.len(), 2);
            case.layer.update(
                &case.known,
                &projected(case.known.frame(), pose, &scan),
                None,
                &mut edits,
            );
            assert_eq!((edits.len(), case.layer.count()), (0, 2));
        }
    }

    #[test]
    fn unusable_ranges_and_poses_are_ignored() {
        let mut case = Case::new(&[".....", ".....", "....."]);
        case.scan(2.5, 1.5, [1.5, NO, 1.5, NO]);
        for bad in [f64::NAN, -1.0, 0.0, 0.09, 3.1, f64::NEG_INFINITY] {
            assert_eq!(case.scan(2.5, 1.5, [bad; 4]), []);
        }
        assert_eq!(case.scan(f64::NAN, 1.5, [1.5; 4]), []);
        // Up and down leave the map before the hit.
        assert_eq!(case.scan(2.5, 1.5, [NO, 2.5, NO, 1.6]), []);
        assert_eq!(case.layer.count(), 2);
    }

    proptest! {
        #[test]
        fn edits_keep_a_search_map_up_to_date(seed in prop::collection::vec(0u8..5, 12 * 9), yaw in -3.0..3.0f64,
                scans in prop::collection::vec((0.0..1.2f64, 0.0..0.9f64, -3.0..3.0f64,
                    prop::collection::vec(0.0..1.2f64, 24)), 1..6)) {
            let frame = GridFrame::new(12, 9, 0.1, Pose::new(-1.0, 3.0, yaw)).unwrap();
            let mut each = seed.iter();
            let known = OccupancyGrid::from_fn(frame, |_| match each.next().unwrap() {
                0 => Occupied,
                1 => Unknown,
                _ => Free,
            });
            let mut layer = SensedLayer::new(&frame);
            let mut edited = known.clone();
            let mut map = SearchMap::new(&known, LayerConfig::default()).unwrap();
            let mut edits = Vec::new();
            for (x, y, theta, ranges_m) in scans {
                let before = layer.clone();
                let at = frame.world_from_grid(Point::new(x * 10.0, y * 10.0));
                let scan = Scan { angle_min_rad: -PI, angle_increment_rad: PI / 12.0,
                    range_min_m: 0.0, range_max_m: 1.0, ranges_m };
                layer.update(&known, &projected(known.frame(), Pose::new(at.x, at.y, theta), &scan), None, &mut edits);
                for cell in frame.cells() {
                    let changed = before.sensed().get(cell) != layer.sensed().get(cell);
                    let edit_count = edits.iter().filter(|edit| edit.cell == cell).count();
                    prop_assert_eq!(edit_count, usize::from(changed));
                    prop_assert!(!(layer.sensed().get(cell) && known.occupied().get(cell)));
                }
                edited.apply(&edits);
                map.apply(&edits);
                let expected = OccupancyGrid::from_fn(frame, |cell| {
                    if layer.sensed().get(cell) { Occupied } else { known.state(cell).unwrap() }
                });
                prop_assert_eq!(edited.occupied(), expected.occupied());
                prop_assert_eq!(edited.unknown(), expected.unknown());
                let rebuilt = SearchMap::new(&expected, LayerConfig::default()).unwrap();
                prop_assert_eq!(map.blocked(), rebuilt.blocked());
            }
        }
    }
}
