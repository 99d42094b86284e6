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
    // The hit point is 4.7 m away; the range is 3 m.
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
    // Through the wall, as after its removal.
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
    // Beams 10 degrees apart; the hit point is at (3.2, 0.5), between the first two of them.
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
    assert!(!cleared([MISS, 2.6, NO], 0.0) && !cleared([2.6, MISS, NO], 0.0), "on one side only");
    assert!(!cleared([MISS, NO, MISS], 0.0), "a beam that says nothing");
    // Within the cell, which spans 10 degrees to both sides, but not through the hit point.
    assert!(!cleared([MISS; 3], 8.0) && !cleared([MISS; 3], -18.0), "out of the field of view");
    assert!(cleared([NO, MISS, NO], -5.0), "right through it");
}

/// Discs of a radius from 0.2 to 0.75 m on cells of 1 m, seen from many poses and then left
/// behind.
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
fn what_was_sensed_on_a_disc_is_forgotten() {
    let mut case = Case::new(&[".....", "....."]);
    case.scan(0.5, 0.5, [2.7, NO, NO, NO]);
    case.scan(0.5, 1.5, [1.7, NO, NO, NO]);
    let mut forgotten = |x, y, radius_m| {
        let (disc, mut edits) = (Disc::new(Point::new(x, y), radius_m), Vec::new());
        case.layer.forget_disc(&case.known, &disc, &mut edits);
        assert_eq!(case.layer.count(), case.layer.sensed().count_ones());
        edits
    };
    assert_eq!(forgotten(1.0, 1.5, 0.9), [], "the nearer square begins 1 m away");
    assert_eq!(forgotten(1.0, 1.5, 1.1), [Edit { cell: Cell::new(2, 1), state: Free }]);
    assert_eq!(forgotten(2.3, 1.7, 0.9), [], "the corner of the other one is 0.99 m away");
    assert_eq!(case.layer.cells(), [Cell::new(3, 0)]);
    assert_eq!(case.scan(0.5, 1.5, [1.7, NO, NO, NO]), [(2, 1, Occupied)]);
}

#[test]
fn marks_win_whatever_the_order_of_the_beams() {
    // Both beams point right; one passes the cell (2, 0), the other ends in it.
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
    // Beams up and down leave the map before the hit.
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
