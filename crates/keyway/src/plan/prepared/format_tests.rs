//! Prepared maps as bytes: a written map is read back, and nothing else is accepted.

use super::super::{GlobalPlanner, Plan, Prepared};
use super::*;
use crate::map::{CellState, Edit, LayerConfig, OccupancyGrid};
use crate::search::{Query, Workspace};

const ROWS: [&str; 6] = ["......", ".##.#.", "....#.", ".#....", "...##.", "......"];

fn map(rows: &[&str]) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
}

/// Plans between all cells: whatever the tables contain, this must terminate.
fn plan_everywhere(prepared: &Prepared, map: &SearchMap) -> Vec<Plan> {
    let mut workspace = Workspace::default();
    let mut plans = Vec::new();
    for start in map.frame().cells().filter(|&cell| map.is_free(cell)) {
        for goal in map.frame().cells().filter(|&cell| map.is_free(cell)) {
            let mut plan = Plan::default();
            let query = Query::new(start, goal);
            // Wrong tables may hide a path, so the result is ignored.
            let _ = prepared.plan_into(map, &query, &mut workspace, None, &mut plan);
            plans.push(plan);
        }
    }
    plans
}

#[test]
fn the_same_after_writing_and_reading() {
    let map = map(&ROWS);
    let prepared = Prepared::build(&map).unwrap();
    let bytes = prepared.to_bytes();
    assert_eq!(bytes, Prepared::build(&map).unwrap().to_bytes(), "the same bytes each time");
    let again = Prepared::from_bytes(&bytes, &map).unwrap();
    assert_eq!(
        (&again.labels, &again.cells, &again.nodes),
        (&prepared.labels, &prepared.cells, &prepared.nodes)
    );
    assert_eq!(again.to_bytes(), bytes);
    assert_eq!(plan_everywhere(&again, &map), plan_everywhere(&prepared, &map));
}

#[test]
fn every_flipped_bit_and_every_cut_is_seen() {
    let map = map(&ROWS);
    let bytes = Prepared::build(&map).unwrap().to_bytes();
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            assert!(Prepared::from_bytes(&damaged, &map).is_err(), "bit {bit} of byte {at}");
        }
        assert!(Prepared::from_bytes(&bytes[..at], &map).is_err(), "cut at {at}");
    }
    let longer = [&bytes[..], &[0]].concat();
    let error = Prepared::from_bytes(&longer, &map).unwrap_err();
    let (found, expected) = (longer.len() as u64, bytes.len() as u64);
    assert_eq!(error, PreparedFormatError::Length { found, expected });
}

/// Hostile numbers under a correct checksum.
#[test]
fn no_number_is_trusted() {
    let map = map(&ROWS);
    let bytes = Prepared::build(&map).unwrap().to_bytes();
    let (mut refused, mut kept) = (0, 0);
    for at in (8..bytes.len() - CHECKSUM_BYTES).step_by(4) {
        for hostile in [0, 1, 2, 7, 0x7fff_ffff, 0xffff_fff0, u32::MAX] {
            let mut forged = bytes.clone();
            forged[at..at + 4].copy_from_slice(&u32::to_le_bytes(hostile));
            let content = forged.len() - CHECKSUM_BYTES;
            let sum = checksum(&forged[..content]);
            forged[content..].copy_from_slice(&sum.to_le_bytes());
            match Prepared::from_bytes(&forged, &map) {
                Ok(prepared) => {
                    plan_everywhere(&prepared, &map);
                    kept += 1;
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 10 * kept, "{refused} refused, {kept} kept");
}

#[test]
fn one_cell_makes_another_map() {
    let grid = OccupancyGrid::from_ascii(&ROWS);
    let bytes = Prepared::build(&map(&ROWS)).unwrap().to_bytes();
    for cell in grid.frame().cells() {
        let mut other = map(&ROWS);
        let is_free = other.is_free(cell);
        let state = if is_free { CellState::Occupied } else { CellState::Free };
        other.apply(&[Edit { cell, state }]);
        let error = Prepared::from_bytes(&bytes, &other).unwrap_err();
        assert_eq!(error, PreparedFormatError::OtherMap, "{cell}");
    }
}
