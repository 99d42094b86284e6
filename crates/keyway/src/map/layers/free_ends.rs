//! Discs around start and goal in which only obstacles block.

use crate::map::Cell;
use crate::map::layers::dilation::CLEARANCE_TOLERANCE;

/// Cells around which clearance, expansion and constraint are lifted.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::map) struct FreeEnds {
    ends: Vec<Cell>,
    radius_cells: f64,
}

impl FreeEnds {
    /// Creates an empty set of ends.
    pub(in crate::map) const fn new(radius_cells: f64) -> Self {
        Self { ends: Vec::new(), radius_cells }
    }

    /// True if the centre of a cell lies in one of the discs.
    pub(in crate::map) fn contain(&self, cell: Cell) -> bool {
        let limit = self.radius_cells * (1.0 + CLEARANCE_TOLERANCE);
        self.ends.iter().any(|end| {
            let (dx, dy) = (f64::from(end.x - cell.x), f64::from(end.y - cell.y));
            dx * dx + dy * dy <= limit * limit
        })
    }

    /// True if one of the discs comes within `reach` columns and rows of a cell.
    pub(in crate::map) fn are_near(&self, cell: Cell, reach: i32) -> bool {
        let reach = self.reach() + reach;
        self.ends.iter().any(|end| {
            let (dx, dy) = (end.x.abs_diff(cell.x), end.y.abs_diff(cell.y));
            dx.max(dy) <= reach.unsigned_abs()
        })
    }

    /// Replaces the ends; returns the previous ones.
    pub(in crate::map) fn replace(&mut self, ends: Vec<Cell>) -> Vec<Cell> {
        std::mem::replace(&mut self.ends, ends)
    }

    /// The cells at the centres of the discs.
    pub(in crate::map) fn ends(&self) -> &[Cell] {
        &self.ends
    }

    /// Number of columns and rows that a disc covers to each side.
    pub(in crate::map) fn reach(&self) -> i32 {
        self.radius_cells.ceil() as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::SearchMap;
    use crate::map::{
        CellState, Edit, GridFrame, LayerConfig, OccupancyGrid, PublishedConstraints,
    };
    use proptest::prelude::*;

    fn drawing(map: &SearchMap) -> Vec<String> {
        let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
        let letter = |x, y| if map.is_free(Cell::new(x, y)) { '.' } else { '#' };
        let row = |y| (0..width).map(|x| letter(x, y)).collect();
        (0..height).rev().map(row).collect()
    }

    /// One obstacle, expanded by a cell; a disc of radius 1 frees the end and its side neighbours.
    #[test]
    fn a_disc_by_hand() {
        let grid = OccupancyGrid::from_ascii(&[".....", ".....", "..#..", ".....", "....."]);
        let published = PublishedConstraints { expansion_cells: 1, ..PublishedConstraints::NONE };
        let config = LayerConfig { published, free_ends_m: 1.0, ..LayerConfig::default() };
        let mut map = SearchMap::new(&grid, config).unwrap();
        let expanded = [".....", ".###.", ".###.", ".###.", "....."];
        assert_eq!(drawing(&map), expanded);
        map.free_ends(&[Cell::new(1, 2), Cell::new(9, 9)]);
        assert_eq!(drawing(&map), [".....", "..##.", "..##.", "..##.", "....."]);
        // Another end replaces it.
        map.free_ends(&[Cell::new(3, 3)]);
        assert_eq!(drawing(&map), [".....", ".#...", ".##..", ".###.", "....."]);
        assert_eq!(map.revision(), 2);
        map.free_ends(&[]);
        assert_eq!(drawing(&map), expanded);
    }

    fn any_state() -> impl Strategy<Value = CellState> {
        prop_oneof![
            6 => Just(CellState::Free),
            1 => Just(CellState::Occupied),
            1 => Just(CellState::Unknown)
        ]
    }

    fn any_config() -> impl Strategy<Value = LayerConfig> {
        (0.0..0.3f64, 0u32..3, 0.0..3.5f64, 0.0..0.4f64).prop_map(|(clearance, e, l1, free)| {
            LayerConfig {
                clearance_m: clearance,
                published: PublishedConstraints {
                    expansion_cells: e,
                    l1_constraint: l1,
                    reference_cell_m: 0.1,
                },
                free_ends_m: free,
                ..LayerConfig::default()
            }
        })
    }

    fn any_cells() -> impl Strategy<Value = Vec<Cell>> {
        prop::collection::vec((0i32..12, 0i32..8).prop_map(|(x, y)| Cell::new(x, y)), 0..4)
    }

    proptest! {
        #[test]
        fn edits_give_what_a_rebuild_gives(
            states in prop::collection::vec(any_state(), 12 * 8), config in any_config(),
            before in any_cells(), ends in any_cells(),
            edits in prop::collection::vec((0i32..13, 0i32..9, any_state()), 0..30),
        ) {
            let frame = GridFrame::new(12, 8, 0.1, Pose::default()).unwrap();
            let mut each = states.iter();
            let mut grid = OccupancyGrid::from_fn(frame, |_| *each.next().unwrap());
            let mut map = SearchMap::new(&grid, config.clone()).unwrap();
            let edits: Vec<Edit> = edits.into_iter()
                .map(|(x, y, state)| Edit { cell: Cell::new(x, y), state }).collect();
            map.free_ends(&before);
            map.apply(&edits[..edits.len() / 2]);
            map.free_ends(&ends);
            map.apply(&edits[edits.len() / 2..]);
            grid.apply(&edits);
            let bare = SearchMap::new(&grid, LayerConfig { free_ends_m: 0.0, ..config.clone() }).unwrap();
            let mut rebuilt = SearchMap::new(&grid, config.clone()).unwrap();
            rebuilt.free_ends(&ends);
            prop_assert_eq!(map.blocked(), rebuilt.blocked());
            prop_assert_eq!(map.blocked_transposed(), rebuilt.blocked_transposed());
            prop_assert_eq!(map.stops(), rebuilt.stops());
            prop_assert_eq!(map.fingerprint(), rebuilt.fingerprint());
            // The result also follows the rule, cell by cell.
            for cell in frame.cells() {
                let in_disc = config.free_ends_m > 0.0 && ends.iter().any(|end| {
                    f64::from(end.x - cell.x).hypot(f64::from(end.y - cell.y)) * 0.1
                        <= config.free_ends_m + 1e-9
                });
                let free = if in_disc { !map.obstacles().get(cell) } else { bare.is_free(cell) };
                prop_assert_eq!(map.is_free(cell), free, "{}", cell);
            }
        }
    }
}
