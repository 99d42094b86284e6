//! Diagnosis of a missing path between two cells: passages that are too narrow, or separate parts
//! of the map.
//!
//! The *room* of a cell is the distance from its centre to the nearest obstacle or to the border;
//! a cell is free for a clearance if its room is at least that. Two cells are thus connected up
//! to some clearance, and separated beyond it: the room at the bottleneck of the widest path.
//! This is the room of some cell, a whole number as a squared distance in half cells, and is
//! found exactly, by bisection.
//!
//! # Cost
//! A distance field, and the components of the map for each of about 15 steps: for use after a
//! search has failed, not in every cycle. 4 bytes per cell in addition to the field.

use crate::given::Computed;
use crate::map::layers::components::Components;
use crate::map::layers::hindrance::rounded_down;
use crate::map::layers::narrowest::Rooms;
use crate::map::{BitGrid, Cell, Connectivity, DistanceField, FieldConfig, SearchMap};
use std::fmt::{Display, Formatter, Result};

/// Reason why no path joins two free cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Separation {
    /// All passages between them are too narrow for the clearance.
    TooNarrow {
        /// [`crate::map::LayerConfig::clearance_m`] \[m\].
        clearance_m: f64,
        /// The largest clearance with which they are connected \[m\]. It is that of the centres
        /// of cells, so it may be up to half a cell less than the passage allows.
        widest_m: f64,
        /// The bottleneck of the widest path: first and last cell of the first one.
        narrowest: [Cell; 2],
    },
    /// They lie in different parts of the map, whatever the clearance.
    Apart {
        /// Cells of the start's part.
        start_cells: u32,
        /// Cells of the goal's part.
        goal_cells: u32,
        /// True if steps that cut corners ([`crate::search::CornerRule::Allow`]) connect the two
        /// with the configured clearance.
        meet_at_corners: bool,
    },
}

impl Display for Separation {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::TooNarrow { clearance_m, widest_m, narrowest: [from, to] } => {
                write!(
                    f,
                    "no path exists from the start to the goal for a radius of {} m; the largest \
                     feasible radius is {} m, limited by the clearance at the ",
                    Computed(clearance_m),
                    rounded_down(widest_m)
                )?;
                if from == to {
                    return write!(f, "centre of cell ({}, {})", from.x, from.y);
                }
                let (x, y) = (to.x, to.y);
                write!(f, "centres of cells ({}, {}) to ({x}, {y})", from.x, from.y)
            }
            Self::Apart { start_cells, goal_cells, meet_at_corners } => {
                let (rule, meet) = if meet_at_corners {
                    (" without cutting corners", ", which touch only at corners of cells")
                } else {
                    ("", "")
                };
                write!(
                    f,
                    "no path exists from the start to the goal for any radius{rule}: they lie in \
                     separate parts of the map, of {start_cells} and {goal_cells} cells{meet}"
                )
            }
        }
    }
}

impl SearchMap {
    /// Reason why the steps of `connectivity` do not connect two free cells; `None` if they do,
    /// or if one of them is not free.
    pub fn separation(
        &self,
        start: Cell,
        goal: Cell,
        connectivity: Connectivity,
    ) -> Option<Separation> {
        let (from, to) =
            (self.component(start, connectivity)?, self.component(goal, connectivity)?);
        if from == to {
            return None;
        }
        let clearance_m = self.config().clearance_m;
        let (base, rooms) = (self.blocked_without_clearance(), self.rooms());
        if let Some(least) = self.widest_room(&base, &rooms, [start, goal], connectivity) {
            let widest_m = self.metres(least);
            let open: Vec<u32> = self
                .frame()
                .cells()
                .zip(&rooms)
                .map(|(cell, &room)| if base.get(cell) { 0 } else { room })
                .collect();
            let width = self.frame().width() as usize;
            let narrowest =
                Rooms { of_cells: &open, width, least }.narrowest([start, goal], connectivity);
            return Some(Separation::TooNarrow { clearance_m, widest_m, narrowest });
        }
        let parts = Components::new(&self.blocked_without_clearance(), connectivity);
        let cells_of = |cell| parts.sizes()[parts.of_free(cell) as usize];
        let with_corners = [start, goal].map(|cell| self.component(cell, Connectivity::Eight));
        Some(Separation::Apart {
            start_cells: cells_of(start),
            goal_cells: cells_of(goal),
            meet_at_corners: with_corners[0] == with_corners[1],
        })
    }

    /// The largest clearance with which the steps of `connectivity` connect two cells \[m\], with
    /// everything else in the config unchanged: the room at the bottleneck of the widest path.
    /// Infinite if no clearance can separate them (in the same disc of
    /// [`crate::map::LayerConfig::free_ends_m`]); `None` if they are separated even without a
    /// clearance.
    pub fn widest_clearance_m(
        &self,
        start: Cell,
        goal: Cell,
        connectivity: Connectivity,
    ) -> Option<f64> {
        let (base, rooms) = (self.blocked_without_clearance(), self.rooms());
        let room = self.widest_room(&base, &rooms, [start, goal], connectivity)?;
        Some(self.metres(room))
    }

    /// Converts a room (squared half cells) to a distance \[m\].
    fn metres(&self, room: u32) -> f64 {
        if room == UNBOUNDED {
            return f64::INFINITY;
        }
        f64::from(room).sqrt() * 0.5 * self.frame().resolution_m()
    }

    /// The largest room that leaves two cells connected; `None` if they never are.
    fn widest_room(
        &self,
        base: &BitGrid,
        rooms: &[u32],
        [start, goal]: [Cell; 2],
        connectivity: Connectivity,
    ) -> Option<u32> {
        let width = self.frame().width() as usize;
        let joined = |least: u32| {
            let mut blocked = base.clone();
            for (y, row) in (0..).zip(rooms.chunks_exact(width)) {
                for (x, _) in (0..).zip(row).filter(|(_, room)| **room < least) {
                    blocked.set(Cell::new(x, y), true);
                }
            }
            let parts = Components::new(&blocked, connectivity);
            let are_free = !blocked.get(start) && !blocked.get(goal);
            are_free && parts.of_free(start) == parts.of_free(goal)
        };
        if !joined(0) {
            return None;
        }
        // Above the largest room only the discs are free.
        let is_bounded = |room: &u32| *room != UNBOUNDED;
        let mut without = rooms.iter().copied().filter(is_bounded).max().unwrap_or(0) + 1;
        if joined(without) {
            return Some(UNBOUNDED);
        }
        let mut with = 0;
        while with + 1 < without {
            let middle = with.midpoint(without);
            if joined(middle) {
                with = middle;
            } else {
                without = middle;
            }
        }
        Some(with)
    }

    /// Room of each cell, row by row: the squared distance from its centre to the nearest
    /// obstacle or to the border, in half cells.
    fn rooms(&self) -> Vec<u32> {
        let frame = self.frame();
        let field = DistanceField::new(frame, self.obstacles(), &FieldConfig::default());
        let room = |cell: Cell| {
            if self.free_ends.contain(cell) && !self.obstacles().get(cell) {
                return UNBOUNDED;
            }
            let (right, up) =
                (frame.width() as i32 - 1 - cell.x, frame.height() as i32 - 1 - cell.y);
            let border = u64::from(2 * cell.x.min(cell.y).min(right).min(up).unsigned_abs() + 1);
            let obstacle = field.half_cells_sq(cell).unwrap_or_default();
            u64::from(obstacle).min(border * border) as u32
        };
        frame.cells().map(room).collect()
    }

    /// Cells that are blocked for any reason other than the clearance.
    fn blocked_without_clearance(&self) -> BitGrid {
        let (frame, zones) = (self.frame(), &self.neighbourhoods);
        let mut blocked = BitGrid::new(frame.width(), frame.height(), true);
        let zone = zones.expansion.clone().union(&zones.constraint);
        zone.stamp_all(self.obstacles(), &mut blocked);
        for cell in frame.cells().filter(|&cell| self.free_ends.contain(cell)) {
            blocked.set(cell, self.obstacles().get(cell));
        }
        blocked
    }
}

/// Room of a cell that is free for any clearance.
const UNBOUNDED: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{CellState, GridFrame, LayerConfig, OccupancyGrid, PublishedConstraints};
    use proptest::prelude::*;

    /// A door of three cells of 0.3 m: a radius of 0.45 m fits through it, and beside the border,
    /// too.
    #[test]
    fn a_door_by_hand() {
        let frame = GridFrame::new(20, 9, 0.3, Pose::default()).unwrap();
        let is_wall = |cell: Cell| cell.x == 10 && !(3..=5).contains(&cell.y);
        let wall = |cell| if is_wall(cell) { CellState::Occupied } else { CellState::Free };
        let grid = OccupancyGrid::from_fn(frame, wall);
        let map = |clearance_m| {
            SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap()
        };
        let (start, goal) = (Cell::new(4, 4), Cell::new(15, 4));
        let found = map(0.6).separation(start, goal, Connectivity::Four);
        let Some(Separation::TooNarrow { clearance_m: 0.6, widest_m, narrowest }) = found else {
            panic!("{found:?}")
        };
        assert!((widest_m - 0.45).abs() < 1e-12);
        assert_eq!(narrowest, [Cell::new(10, 4); 2]);
        assert_eq!(map(widest_m).separation(start, goal, Connectivity::Four), None);
        let text = found.unwrap().to_string();
        assert!(
            text.ends_with("for a radius of 0.6 m; the largest feasible radius is 0.45 m, limited by the clearance at the centre of cell (10, 4)"),
            "{text}"
        );
    }

    /// A door of 0.40 m has eight cells of 5 cm: no cell's centre is in its middle.
    #[test]
    fn a_door_with_an_even_number_of_cells() {
        let frame = GridFrame::new(40, 30, 0.05, Pose::default()).unwrap();
        let is_wall = |cell: Cell| (20..24).contains(&cell.x) && !(10..18).contains(&cell.y);
        let wall = |cell| if is_wall(cell) { CellState::Occupied } else { CellState::Free };
        let config = LayerConfig { clearance_m: 0.18, ..LayerConfig::default() };
        let map = SearchMap::new(&OccupancyGrid::from_fn(frame, wall), config).unwrap();
        let found = map.separation(Cell::new(8, 8), Cell::new(32, 8), Connectivity::Four);
        let Some(Separation::TooNarrow { widest_m, narrowest: [from, to], .. }) = found else {
            panic!("{found:?}")
        };
        assert!((widest_m - 0.175).abs() < 1e-12);
        assert!((from.x, to.x) == (20, 23) && from.y == to.y && (13..=14).contains(&from.y));
        let text = found.unwrap().to_string();
        assert!(
            text.contains(
                "the largest feasible radius is 0.175 m, limited by the clearance at the centres of cells (20, 1"
            ),
            "{text}"
        );
    }

    #[test]
    fn parts_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["..#...", "..#...", "..#..#"]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let found = map.separation(Cell::new(0, 0), Cell::new(3, 0), Connectivity::Four);
        let apart = |start_cells, goal_cells, meet_at_corners| {
            Some(Separation::Apart { start_cells, goal_cells, meet_at_corners })
        };
        assert_eq!(found, apart(6, 8, false));
        let same = map.separation(Cell::new(0, 0), Cell::new(1, 2), Connectivity::Four);
        assert_eq!(same, None);
        assert_eq!(map.separation(Cell::new(0, 0), Cell::new(2, 0), Connectivity::Four), None);

        let grid = OccupancyGrid::from_ascii(&["..#..", "..#..", "##...", "....."]);
        let of = |clearance_m, connectivity| {
            let config = LayerConfig { clearance_m, ..LayerConfig::default() };
            let map = SearchMap::new(&grid, config).unwrap();
            map.separation(Cell::new(1, 2), Cell::new(4, 0), connectivity)
        };
        let corner = of(0.0, Connectivity::Four);
        assert_eq!((corner, of(0.0, Connectivity::Eight)), (apart(4, 12, true), None));
        let text = corner.unwrap().to_string();
        assert!(
            text.starts_with(
                "no path exists from the start to the goal for any radius without cutting corners: "
            ),
            "{text}"
        );
        assert!(
            text.ends_with("of 4 and 12 cells, which touch only at corners of cells"),
            "{text}"
        );
        let walled = OccupancyGrid::from_ascii(&["..#..", "..#..", "###..", "....."]);
        let map = SearchMap::new(&walled, LayerConfig::default()).unwrap();
        let wall = map.separation(Cell::new(0, 3), Cell::new(4, 0), Connectivity::Four);
        assert_eq!(wall, apart(4, 11, false));
    }

    proptest! {
        #[test]
        fn as_by_trying_every_clearance(
            walls in prop::collection::vec(prop::bool::weighted(0.2), 12 * 9),
            ends in prop::array::uniform4(0i32..9), is_eight: bool,
            expansion_cells in 0u32..2, free_ends_m in prop_oneof![Just(0.0), Just(0.5)],
        ) {
            let frame = GridFrame::new(12, 9, 0.4, Pose::default()).unwrap();
            let state = |cell: Cell| {
                let is_wall = walls[(cell.y * 12 + cell.x) as usize];
                if is_wall { CellState::Occupied } else { CellState::Free }
            };
            let grid = OccupancyGrid::from_fn(frame, state);
            let [start, goal] = [Cell::new(ends[0], ends[1]), Cell::new(ends[2] + 3, ends[3])];
            let connectivity = if is_eight { Connectivity::Eight } else { Connectivity::Four };
            let map = |clearance_m| {
                let published = PublishedConstraints { expansion_cells, ..PublishedConstraints::NONE };
                let config = LayerConfig { clearance_m, free_ends_m, published, ..LayerConfig::default() };
                let mut map = SearchMap::new(&grid, config).unwrap();
                map.free_ends(&[start, goal]);
                map
            };
            let joins = |clearance_m: f64| {
                let map = map(clearance_m);
                let part = |cell| map.component(cell, connectivity);
                part(start).is_some() && part(start) == part(goal)
            };
            // Every distance that a cell of such a map can have, and one greater than all of
            // them.
            let mut all: Vec<u32> = (0..=24).flat_map(|a| (0..=24).map(move |b| a * a + b * b)).collect();
            all.sort_unstable();
            all.dedup();
            let metres = |half_cells_sq: u32| f64::from(half_cells_sq).sqrt() * 0.2;
            let expected = all.iter().rev().map(|&sq| metres(sq)).find(|&clearance_m| joins(clearance_m));
            let expected = expected.map(|best| if joins(100.0) { f64::INFINITY } else { best });
            prop_assert_eq!(map(0.0).widest_clearance_m(start, goal, connectivity), expected);
        }
    }
}
