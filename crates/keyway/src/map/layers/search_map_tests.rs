//! Tests of the layers: by hand, cell by cell against the rule, and after edits against a
//! rebuild.

use super::*;
use crate::geometry::Pose;
use crate::map::PublishedConstraints;
use proptest::prelude::*;

fn map(rows: &[&str], config: LayerConfig) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), config).unwrap()
}

fn with_clearance(clearance_m: f64) -> LayerConfig {
    LayerConfig { clearance_m, ..LayerConfig::default() }
}

#[test]
fn unknown_policies() {
    let rows = ["#?."];
    let blocked = |unknown| {
        let map = map(&rows, LayerConfig { unknown, ..LayerConfig::default() });
        (0..3).map(|x| !map.is_free(Cell::new(x, 0))).collect::<Vec<_>>()
    };
    assert_eq!(blocked(UnknownPolicy::Blocked), [true, true, false]);
    assert_eq!(blocked(UnknownPolicy::Free), [true, false, false]);
    assert_eq!(blocked(UnknownPolicy::Penalised), [true, false, false]);
}

#[test]
fn a_disc_may_not_leave_the_map() {
    let open = ["....."; 5];
    assert!(map(&open, with_clearance(0.5)).is_free(Cell::new(0, 2)));
    let inflated = map(&open, with_clearance(0.6));
    assert!(!inflated.is_free(Cell::new(0, 2)) && inflated.is_free(Cell::new(1, 1)));
    assert_eq!(map(&open, with_clearance(9.0)).nearest_free(Cell::new(0, 0)), None);
}

#[test]
fn closed_cells_are_blocked_until_they_are_opened() {
    let rows = [".....", "..#..", "....."];
    let (mut map, as_built) = (map(&rows, with_clearance(0.4)), map(&rows, with_clearance(0.4)));
    // One of them is blocked in any case.
    let cells = [Cell::new(2, 0), Cell::new(2, 1), Cell::new(2, 2)];
    map.close(&cells);
    assert!(cells.iter().all(|&cell| !map.is_free(cell)) && !map.obstacles().get(cells[0]));
    assert_eq!(map.components(Connectivity::Eight).sizes(), [6, 6]);
    assert_ne!(map.fingerprint(), as_built.fingerprint());
    map.open(&cells);
    assert_eq!(map.blocked(), as_built.blocked());
    assert_eq!(map.blocked_transposed(), as_built.blocked_transposed());
    assert_eq!(map.stops(), as_built.stops());
    assert_eq!(map.components(Connectivity::Eight).sizes(), [14]);
}

#[test]
fn unknown_cells_are_shared_with_the_grid_until_one_changes() {
    let mut grid = OccupancyGrid::from_ascii(&["#.?", "..."]);
    let (layers, cell) = (LayerConfig::default(), Cell::new(1, 0));
    let mut map = SearchMap::new(&grid, layers.clone()).unwrap();
    let is_shared =
        |map: &SearchMap, grid: &OccupancyGrid| std::ptr::eq(map.unknown(), grid.unknown());
    map.apply(&[Edit { cell, state: CellState::Occupied }]);
    assert!(is_shared(&map, &grid), "no unknown cell has changed");
    map.apply(&[Edit { cell, state: CellState::Unknown }]);
    assert!(!is_shared(&map, &grid));
    assert_eq!((map.state(cell), grid.state(cell)), (CellState::Unknown, Some(CellState::Free)));
    let map = SearchMap::new(&grid, layers).unwrap();
    assert!(is_shared(&map, &grid));
    grid.apply(&[Edit { cell: Cell::new(2, 1), state: CellState::Free }]);
    assert!(!is_shared(&map, &grid));
    assert_eq!(map.state(Cell::new(2, 1)), CellState::Unknown);
}

#[test]
fn names_the_bad_field() {
    let grid = OccupancyGrid::from_ascii(&["."]);
    let error = SearchMap::new(&grid, with_clearance(f64::NAN)).unwrap_err();
    assert_eq!(error.path, "clearance_m");
    let penalty = LayerConfig { unknown_penalty: 0, ..LayerConfig::default() };
    assert_eq!(SearchMap::new(&grid, penalty).unwrap_err().path, "unknown_penalty");
}

#[test]
fn nearest_free_cell() {
    let map = map(&["##.##", "#####", "###.#"], LayerConfig::default());
    assert_eq!(map.nearest_free(Cell::new(0, 0)), Some(Cell::new(2, 2)));
    assert_eq!(map.nearest_free(Cell::new(4, 1)), Some(Cell::new(3, 0)));
    assert_eq!(map.nearest_free(Cell::new(2, 2)), Some(Cell::new(2, 2)));
    assert_eq!(map.nearest_free(Cell::new(40, -3)), Some(Cell::new(3, 0)));
    assert_eq!(map.nearest_free(Cell::new(i32::MIN, i32::MAX)), Some(Cell::new(2, 2)));
}

fn any_state() -> impl Strategy<Value = CellState> {
    prop_oneof![
        4 => Just(CellState::Free),
        1 => Just(CellState::Occupied),
        1 => Just(CellState::Unknown)
    ]
}

fn any_config() -> impl Strategy<Value = LayerConfig> {
    let unknown = prop_oneof![
        Just(UnknownPolicy::Blocked),
        Just(UnknownPolicy::Free),
        Just(UnknownPolicy::Penalised)
    ];
    (unknown, 0.0..0.25f64, 0u32..2, 0.0..2.5f64).prop_map(|(unknown, clearance_m, e, l1)| {
        LayerConfig {
            unknown,
            clearance_m,
            published: PublishedConstraints {
                expansion_cells: e,
                l1_constraint: l1,
                reference_cell_m: 0.1,
            },
            ..LayerConfig::default()
        }
    })
}

/// Cycles through positions; the corner if there are none.
fn again(places: &[(i32, i32)]) -> impl Iterator<Item = (i32, i32)> + '_ {
    (0..).map(|index: usize| places.get(index % places.len().max(1)).copied().unwrap_or_default())
}

proptest! {
    #[test]
    fn a_cell_is_free_iff_every_rule_holds(states in prop::collection::vec(any_state(), 9 * 7),
                                           config in any_config()) {
        let frame = GridFrame::new(9, 7, 0.1, Pose::default()).unwrap();
        let mut each = states.iter();
        let grid = OccupancyGrid::from_fn(frame, |_| *each.next().unwrap());
        let map = SearchMap::new(&grid, config.clone()).unwrap();
        for cell in frame.cells() {
            let (cx, cy) = (f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
            let c = config.clearance_m - 1e-9;
            let border = cx.min(cy).min(9.0 - cx).min(7.0 - cy) * 0.1;
            let mut free = border >= c;
            for o in frame.cells() {
                let solid = match grid.state(o).unwrap() {
                    CellState::Occupied => true,
                    CellState::Unknown => config.unknown == UnknownPolicy::Blocked,
                    CellState::Free => false,
                };
                let (dx, dy) = ((cell.x - o.x).abs(), (cell.y - o.y).abs());
                let gap = |d: i32| (f64::from(d) - 0.5).max(0.0) * 0.1;
                let near = (dx, dy) == (0, 0)
                    || gap(dx).hypot(gap(dy)) < c
                    || dx.max(dy) <= config.published.expansion_cells as i32
                    || f64::from(dx + dy) < config.published.l1_constraint - 1e-9;
                free &= !(solid && near);
            }
            prop_assert_eq!(map.is_free(cell), free, "{}", cell);
        }
    }

    #[test]
    fn edits_give_what_a_rebuild_gives(states in prop::collection::vec(any_state(), 12 * 8),
                                       config in any_config(),
                                       edits in prop::collection::vec((0i32..13, 0i32..9, any_state()), 0..30)) {
        let frame = GridFrame::new(12, 8, 0.1, Pose::default()).unwrap();
        let mut each = states.iter();
        let mut grid = OccupancyGrid::from_fn(frame, |_| *each.next().unwrap());
        let mut map = SearchMap::new(&grid, config.clone()).unwrap();
        let edits: Vec<Edit> = edits.into_iter()
            .map(|(x, y, state)| Edit { cell: Cell::new(x, y), state }).collect();
        grid.apply(&edits);
        map.apply(&edits);
        let rebuilt = SearchMap::new(&grid, config).unwrap();
        prop_assert_eq!(map.blocked(), rebuilt.blocked());
        prop_assert_eq!(map.blocked_transposed(), rebuilt.blocked_transposed());
        prop_assert_eq!(map.obstacles(), rebuilt.obstacles());
        prop_assert_eq!(map.unknown(), rebuilt.unknown());
        prop_assert_eq!(map.unknown(), grid.unknown());
        prop_assert_eq!(map.penalised(), rebuilt.penalised());
    }

    /// Rows of several words, reaches up to more than a word, and edits that are far apart.
    #[test]
    fn edits_of_wide_maps_give_what_a_rebuild_gives(
        (width, height) in (100u64..330, 3u64..40), clearance_m in 0.0..8.0f64, expansion_cells in 0u32..4,
        occupied in prop::collection::vec((0i32..330, 0i32..40), 0..40),
        edits in prop::collection::vec(prop::collection::vec((0i32..330, 0i32..40, any_state()), 0..50), 1..4),
    ) {
        let frame = GridFrame::new(width, height, 0.1, Pose::default()).unwrap();
        let mut grid = OccupancyGrid::from_fn(frame, |cell| {
            if occupied.contains(&(cell.x, cell.y)) { CellState::Occupied } else { CellState::Free }
        });
        // Squared, because small clearances leave more cells free.
        let mut config = LayerConfig { clearance_m: clearance_m * clearance_m / 8.0, ..LayerConfig::default() };
        config.published.expansion_cells = expansion_cells;
        let mut map = SearchMap::new(&grid, config.clone()).unwrap();
        for edits in edits {
            // Half of them free occupied cells.
            let edits: Vec<Edit> = edits.iter().zip(again(&occupied)).enumerate()
                .map(|(index, (&(x, y, state), (ox, oy)))| if index % 2 == 0 {
                    Edit { cell: Cell::new(x, y), state }
                } else {
                    Edit { cell: Cell::new(ox, oy), state: CellState::Free }
                }).collect();
            grid.apply(&edits);
            map.apply(&edits);
            let rebuilt = SearchMap::new(&grid, config.clone()).unwrap();
            prop_assert_eq!(map.blocked(), rebuilt.blocked());
            prop_assert_eq!(map.blocked_transposed(), rebuilt.blocked_transposed());
            prop_assert_eq!(map.stops(), rebuilt.stops());
        }
    }

    #[test]
    fn indices_and_cells_are_inverse(x in -1i32..=70, y in -1i32..=3) {
        let map = SearchMap::new(&OccupancyGrid::all_free(
            GridFrame::new(70, 3, 1.0, Pose::default()).unwrap()), LayerConfig::default()).unwrap();
        let index = map.index(Cell::new(x, y));
        prop_assert_eq!(map.cell(index), Cell::new(x, y));
        prop_assert!(index.as_usize() < map.index_count());
    }
}
