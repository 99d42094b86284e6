use super::*;
use crate::geometry::Pose;
use crate::map::{CellState, Edit, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use proptest::prelude::*;

const BOTH: [Connectivity; 2] = [Connectivity::Four, Connectivity::Eight];

fn map(rows: &[&str]) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
}

/// Component numbers from a flood fill, cell by cell; `None` for blocked cells.
fn flooded(map: &SearchMap, connectivity: Connectivity) -> Vec<Option<u32>> {
    let width = map.frame().width() as i32;
    let index = |cell: Cell| (cell.y * width + cell.x) as usize;
    let mut labels = vec![None; map.frame().cell_count() as usize];
    let mut count = 0;
    for cell in map.frame().cells() {
        if !map.is_free(cell) || labels[index(cell)].is_some() {
            continue;
        }
        labels[index(cell)] = Some(count);
        let mut open = vec![cell];
        while let Some(at) = open.pop() {
            for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                let to = Cell::new(at.x + dx, at.y + dy);
                let joined = connectivity == Connectivity::Eight || dx == 0 || dy == 0;
                if joined && map.is_free(to) && labels[index(to)].is_none() {
                    labels[index(to)] = Some(count);
                    open.push(to);
                }
            }
        }
        count += 1;
    }
    labels
}

fn check(map: &SearchMap, connectivity: Connectivity) -> Result<(), TestCaseError> {
    let expected = flooded(map, connectivity);
    let components = map.components(connectivity);
    let mut sizes = vec![0; components.sizes().len()];
    for (cell, label) in map.frame().cells().zip(&expected) {
        prop_assert_eq!(map.component(cell, connectivity), *label, "{} {:?}", cell, connectivity);
        if let Some(label) = label {
            sizes[*label as usize] += 1;
        }
    }
    prop_assert_eq!(components.sizes(), sizes);
    Ok(())
}

fn any_map() -> impl Strategy<Value = SearchMap> {
    let size = prop_oneof![(1i32..15, 1i32..15), (50i32..200, 1i32..6)];
    (size, 1u32..70).prop_flat_map(|((width, height), percent)| {
        let cells = prop::collection::vec(
            prop::bool::weighted(f64::from(percent) / 100.0),
            (width * height) as usize,
        );
        cells.prop_map(move |occupied| {
            let frame = GridFrame::new(width as u64, height as u64, 1.0, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &occupied);
            SearchMap::new(&grid, LayerConfig::default()).unwrap()
        })
    })
}

#[test]
fn a_diagonal_gap_joins_eight_neighbours_only() {
    let map = map(&["..#", ".#.", "#.."]);
    assert_eq!(map.components(Connectivity::Four).sizes(), [3, 3]);
    assert_eq!(map.components(Connectivity::Eight).sizes(), [6]);
    assert_eq!(map.component(Cell::new(0, 2), Connectivity::Four), Some(1));
    assert_eq!(map.component(Cell::new(1, 1), Connectivity::Four), None);
    assert_eq!(map.component(Cell::new(-1, 0), Connectivity::Four), None);
    assert_eq!(map.component(Cell::new(0, i32::MAX), Connectivity::Four), None);
}

#[test]
fn the_largest_component() {
    let largest = |rows: &[&str]| map(rows).components(Connectivity::Four).largest();
    assert_eq!(largest(&["##", "##"]), None);
    assert_eq!(largest(&["..#.", ".###"]), Some(0));
    assert_eq!(largest(&["....", "####", "...#"]), Some(1));
    assert_eq!(largest(&["..#.."]), Some(0), "ties go to the first");
}

#[test]
fn a_comb_is_joined_late() {
    // Seven teeth become one component in the last row only.
    let tooth = ".#.#.#.#.#.#.";
    let map = map(&[".............", tooth, tooth, tooth]);
    assert_eq!(map.components(Connectivity::Four).sizes(), [34]);
}

#[test]
fn known_components_are_counted_and_forgotten() {
    let mut map = map(&["....", ".##.", "...."]);
    let (bare, same) = (map.memory_bytes(), map.clone());
    let components = map.components(Connectivity::Four).memory_bytes();
    assert!(components > 0);
    assert_eq!(map.memory_bytes(), bare + components);
    assert_eq!(map, same, "equality ignores what can be computed again");
    map.apply(&[Edit { cell: Cell::new(1, 1), state: CellState::Occupied }]);
    assert_eq!(map.memory_bytes(), bare + components, "nothing changed");
    map.apply(&[Edit { cell: Cell::new(0, 0), state: CellState::Occupied }]);
    assert_eq!(map.memory_bytes(), bare);
}

proptest! {
    #[test]
    fn components_are_those_of_a_flood_fill(map in any_map()) {
        for connectivity in BOTH {
            check(&map, connectivity)?;
        }
    }

    #[test]
    fn and_after_edits(mut map in any_map(), edits in prop::collection::vec((0i32..60, 0i32..15, any::<bool>()), 1..40)) {
        for connectivity in BOTH {
            map.components(connectivity);
        }
        for edits in edits.chunks(10) {
            let edits: Vec<Edit> = edits.iter().map(|&(x, y, set)| Edit {
                cell: Cell::new(x, y),
                state: if set { CellState::Occupied } else { CellState::Free },
            }).collect();
            map.apply(&edits);
            for connectivity in BOTH {
                check(&map, connectivity)?;
            }
        }
    }

    #[test]
    fn the_nearest_connected_cell(map in any_map(), ends in (0i32..200, 0i32..15, -9i32..220, -9i32..25)) {
        let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
        let from = Cell::new(ends.0 % width, ends.1 % height);
        let to = Cell::new(ends.2, ends.3);
        let clamped = Cell::new(to.x.clamp(0, width - 1), to.y.clamp(0, height - 1));
        for connectivity in BOTH {
            let labels = flooded(&map, connectivity);
            let label = labels[(from.y * width + from.x) as usize];
            let cells = map.frame().cells().zip(labels);
            let connected = cells.filter(|(_, l)| l.is_some() && *l == label).map(|(cell, _)| cell);
            let distance_sq = |c: Cell| (c.x - clamped.x).pow(2) + (c.y - clamped.y).pow(2);
            let expected = connected.min_by_key(|&c| (distance_sq(c), c.y, c.x));
            prop_assert_eq!(map.nearest_connected(from, to, connectivity), expected);
        }
    }
}
