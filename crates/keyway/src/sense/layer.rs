//! What scans have shown that the known map does not.

use super::beam::{Beam, beams};
use super::{Mover, Scan, Tracker};
use crate::geometry::{Point, Pose, Square};
use crate::map::{BitGrid, Cell, CellState, Edit, GridFrame, OccupancyGrid, RayCells};

/// Cells in which scans have met something that the known map does not have.
///
/// The known map itself is never changed: a beam through a known obstacle leaves it standing, and
/// a sensed cell that is cleared goes back to what the known map says, unknown included.
///
/// Memory: one bit per cell. An update costs a few operations per cell passed by a beam, and next
/// to nothing while no cell is sensed.
#[derive(Clone, Debug)]
pub struct SensedLayer {
    sensed: BitGrid,
    count: u64,
    /// Scratch of [`Self::update`], without meaning between calls.
    cleared: Vec<Cell>,
    marked: Vec<Cell>,
}

impl SensedLayer {
    /// Nothing sensed, on a grid of `frame`'s size.
    pub fn new(frame: &GridFrame) -> Self {
        let sensed = BitGrid::new(frame.width(), frame.height(), false);
        Self { sensed, count: 0, cleared: Vec::new(), marked: Vec::new() }
    }

    /// Cells in which something was met that the known map does not have.
    pub const fn sensed(&self) -> &BitGrid {
        &self.sensed
    }

    /// Number of sensed cells.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Takes in a scan made at `pose` (world frame) on the `known` map, whose frame is the one
    /// given to [`Self::new`].
    ///
    /// First every beam clears the sensed cells that it passes before its hit (up to the sensor's
    /// range when it has none); then every hit marks its cell, unless the known map already has it
    /// as occupied or it lies outside the map. So within one scan marks win over clears. A range
    /// that is NaN, negative or 0 is ignored, and so is a scan at a pose that is not finite.
    ///
    /// `edits` is emptied and receives exactly the cells that changed, each once: first those
    /// cleared, with their known state, in the order of [`Cell`]; then those marked, as occupied,
    /// in the order of the beams. Applied to a map of the known obstacles and the sensed cells so
    /// far, they keep it up to date.
    pub fn update(
        &mut self,
        known: &OccupancyGrid,
        pose: Pose,
        scan: &Scan,
        edits: &mut Vec<Edit>,
    ) {
        self.take_in(known, pose, scan, None, edits);
    }

    /// The same where `tracker`, which has been given the same scan, knows of movers: what stands is marked, what moves is not,
    /// so that movers leave no trail. A hit on a mover, or on ground that a mover may cover now, marks nothing; the
    /// cells under a mover are cleared, and those that were marked before it was known to move are cleared as well.
    pub fn update_beside_movers(
        &mut self,
        known: &OccupancyGrid,
        pose: Pose,
        scan: &Scan,
        tracker: &Tracker,
        edits: &mut Vec<Edit>,
    ) {
        self.take_in(known, pose, scan, Some(tracker), edits);
    }

    fn take_in(
        &mut self,
        known: &OccupancyGrid,
        pose: Pose,
        scan: &Scan,
        tracker: Option<&Tracker>,
        edits: &mut Vec<Edit>,
    ) {
        edits.clear();
        self.cleared.clear();
        self.marked.clear();
        let frame = known.frame();
        for beam in beams(frame, pose, scan) {
            self.clear_along(frame, &beam);
        }
        if let Some(tracker) = tracker {
            tracker.left().iter().for_each(|&cell| self.clear(cell));
            tracker.movers().iter().for_each(|mover| self.clear_under(mover, frame));
        }
        self.cleared.sort_unstable();
        let moves = |beam: &Beam| {
            let is_near = |mover: &Mover| {
                let hit = frame.world_from_grid(beam.end());
                let now = mover.now();
                hit.distance(now.centre) <= now.radius_m
            };
            tracker.is_some_and(|tracker| {
                tracker.hits_mover(beam.number) || tracker.movers().iter().any(is_near)
            })
        };
        for beam in beams(frame, pose, scan).filter(|beam| beam.hit && !moves(beam)) {
            self.mark(known, &beam);
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

    fn clear(&mut self, cell: Cell) {
        if self.sensed.set(cell, false) {
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
        let span = |at: f64, most: u32| {
            let last = most as i32 - 1;
            ((at - reach).floor().max(0.0) as i32)..=((at + reach).floor() as i32).min(last)
        };
        for y in span(centre.y, frame.height()) {
            for x in span(centre.x, frame.width()) {
                let square = Square { corner: Point::new(f64::from(x), f64::from(y)) };
                if square.distance_sq_to_point(centre) <= reach * reach {
                    self.clear(Cell::new(x, y));
                }
            }
        }
    }

    fn clear_along(&mut self, frame: &GridFrame, beam: &Beam) {
        if self.count == self.cleared.len() as u64 {
            return;
        }
        for passed in RayCells::new(frame, beam.start, beam.direction, beam.free) {
            self.clear(passed.cell);
        }
    }

    fn mark(&mut self, known: &OccupancyGrid, beam: &Beam) {
        let Some(cell) = beam.hit_cell(known.frame()) else { return };
        if !known.occupied().get(cell) && self.sensed.set(cell, true) {
            self.marked.push(cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, SearchMap};
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Beams to the right, up, left and down of a robot with heading 0.
    fn four(ranges: [f64; 4]) -> Scan {
        Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: FRAC_PI_2,
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
            self.layer.update(&self.known, pose, &four(ranges), &mut edits);
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
        // The cell (5, 0) begins 4.5 m from here, the range is 3 m.
        assert_eq!(case.scan(0.5, 0.5, [MISS, NO, NO, NO]), []);
        assert_eq!(case.scan(0.5, 0.5, [4.9, NO, NO, NO]), [], "beyond the range is a miss");
        assert_eq!(case.scan(2.1, 0.5, [MISS, NO, NO, NO]), [(5, 0, Free)]);
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
    fn marks_win_whatever_the_order_of_the_beams() {
        // Both beams look right; one passes the cell (2, 0), the other hits in it.
        for ranges in [[1.7, 2.7], [2.7, 1.7]] {
            let mut case = Case::new(&["....."]);
            let scan = Scan { angle_increment_rad: 2.0 * PI, ..four([NO; 4]) };
            let scan = Scan { ranges_m: ranges.to_vec(), ..scan };
            let mut edits = Vec::new();
            let pose = Pose::new(0.5, 0.5, 0.0);
            case.layer.update(&case.known, pose, &scan, &mut edits);
            assert_eq!(edits.len(), 2);
            case.layer.update(&case.known, pose, &scan, &mut edits);
            assert_eq!((edits.len(), case.layer.count()), (0, 2));
        }
    }

    #[test]
    fn unusable_ranges_and_poses_are_ignored() {
        let mut case = Case::new(&[".....", ".....", "....."]);
        case.scan(2.5, 1.5, [1.5, NO, 1.5, NO]);
        for bad in [f64::NAN, -1.0, 0.0, f64::NEG_INFINITY] {
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
                    range_max_m: 1.0, ranges_m };
                layer.update(&known, Pose::new(at.x, at.y, theta), &scan, &mut edits);
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
