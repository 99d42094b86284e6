//! The classic jump points of \[Harabor2011\], without corner cutting: a node and a direction ->
//! the next node in that direction.
//!
//! A scan walks from a node in one of the 8 directions and ends at the first of these cells:
//! - one of the *targets*, cells given from outside;
//! - on a straight scan, a cell beside which a side opens: the side neighbour of the previous cell
//!   is blocked and that of the cell itself is free. As no corner is cut, the robot must take this
//!   one more step before it can turn;
//! - on a diagonal scan, a cell from which a straight scan in one of the diagonal's two directions
//!   finds a node. A diagonal step needs a free 2 x 2 block, so no side opens beside it.
//!
//! A diagonal is walked cell by cell; straight scans read 64 cells at a time.

use super::marks::Marks;
use crate::map::{BitGrid, Cell, SearchMap};

use crate::search::bit_scan::{next_one, previous_one};

/// One of the 8 directions: columns and rows of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Direction {
    pub(super) dx: i32,
    pub(super) dy: i32,
}

impl Direction {
    /// East first, counter-clockwise.
    pub(super) const ALL: [Self; 8] = [
        Self::new(1, 0),
        Self::new(1, 1),
        Self::new(0, 1),
        Self::new(-1, 1),
        Self::new(-1, 0),
        Self::new(-1, -1),
        Self::new(0, -1),
        Self::new(1, -1),
    ];

    pub(super) const fn new(dx: i32, dy: i32) -> Self {
        Self { dx, dy }
    }

    /// The direction between two cells on the same straight or diagonal line; `None` if they are
    /// equal.
    pub(super) fn between(from: Cell, to: Cell) -> Option<Self> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        (from != to).then_some(Self::new(dx.signum(), dy.signum()))
    }

    const fn is_diagonal(self) -> bool {
        self.dx != 0 && self.dy != 0
    }

    /// The cell one step away.
    pub(super) const fn step(self, from: Cell) -> Cell {
        Cell::new(from.x + self.dx, from.y + self.dy)
    }

    const fn step_back(self, from: Cell) -> Cell {
        Cell::new(from.x - self.dx, from.y - self.dy)
    }
}

/// The result of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scan {
    /// The last cell visited; the start cell of the scan if no step is possible.
    pub(super) end: Cell,
    /// The next node, if any: it lies at `end`, or there is none in this direction.
    pub(super) node: Option<Cell>,
}

/// Scans on a map.
#[derive(Clone, Copy)]
pub(super) struct Jumps<'m> {
    pub(super) map: &'m SearchMap,
    pub(super) targets: &'m Marks,
}

impl Jumps<'_> {
    /// Scans from a cell in one direction.
    pub(super) fn scan(&self, from: Cell, direction: Direction) -> Scan {
        if direction.is_diagonal() {
            self.scan_diagonal(from, direction)
        } else {
            self.scan_straight(from, direction)
        }
    }

    fn scan_diagonal(&self, from: Cell, direction: Direction) -> Scan {
        let Direction { dx, dy } = direction;
        let parts = [Direction::new(dx, 0), Direction::new(0, dy)];
        let mut at = from;
        while self.may_step(at, direction) {
            at = direction.step(at);
            let turns = |part| self.scan_straight(at, part).node.is_some();
            if self.targets.contains(at) || parts.into_iter().any(turns) {
                return Scan { end: at, node: Some(at) };
            }
        }
        Scan { end: at, node: None }
    }

    /// True if a diagonal step cuts no corner.
    fn may_step(&self, from: Cell, Direction { dx, dy }: Direction) -> bool {
        [(dx, 0), (0, dy), (dx, dy)]
            .into_iter()
            .all(|(dx, dy)| self.map.is_free(Direction::new(dx, dy).step(from)))
    }

    fn scan_straight(&self, from: Cell, direction: Direction) -> Scan {
        let stops = self.map.stops();
        let (rows, columns) = (self.targets.rows(), self.targets.columns());
        // For scans along a column, columns and rows are exchanged.
        let turned = Cell::new(from.y, from.x);
        let end = match (direction.dx, direction.dy) {
            (1, _) => first_after(stops.east.row(from.y), rows, from),
            (-1, _) => last_before(stops.west.row(from.y), rows, from),
            (_, 1) => first_after(stops.north.row(from.x), columns, turned),
            _ => last_before(stops.south.row(from.x), columns, turned),
        };
        let end = if direction.dx == 0 { Cell::new(from.x, end) } else { Cell::new(end, from.y) };
        if self.map.is_free(end) {
            Scan { end, node: Some(end) }
        } else {
            Scan { end: direction.step_back(end), node: None }
        }
    }

    /// The directions in which to expand a node that was reached in direction `arrival`; all of
    /// them for a root, which has no arrival.
    ///
    /// Natural directions: straight on; after a diagonal its two components as well. Forced
    /// directions, after a straight scan: to the side that opens, and diagonally to that side.
    /// Every other neighbour is reached at the same cost from the previous cell, without the node.
    pub(super) fn onward(
        &self,
        at: Cell,
        arrival: Option<Direction>,
    ) -> impl Iterator<Item = Direction> {
        Direction::ALL
            .into_iter()
            .filter(move |&to| arrival.is_none_or(|arrival| self.is_onward(at, arrival, to)))
    }

    fn is_onward(&self, at: Cell, arrival: Direction, to: Direction) -> bool {
        if arrival.is_diagonal() {
            return [0, arrival.dx].contains(&to.dx) && [0, arrival.dy].contains(&to.dy);
        }
        let along = to.dx * arrival.dx + to.dy * arrival.dy;
        let side = Direction::new(to.dx - along * arrival.dx, to.dy - along * arrival.dy);
        let is_ahead = to == arrival;
        let is_beside = along >= 0 && side != Direction::new(0, 0);
        is_ahead || (is_beside && self.opens(at, arrival, side))
    }

    /// True if a side opens beside a cell: the side neighbour of the previous cell is blocked, and
    /// that of the cell itself is free.
    fn opens(&self, at: Cell, arrival: Direction, side: Direction) -> bool {
        let before = arrival.step_back(at);
        !self.map.is_free(side.step(before)) && self.map.is_free(side.step(at))
    }
}

/// The first column after the cell's with a stop or a target in its row.
fn first_after(stops: &[u64], targets: &BitGrid, Cell { x, y }: Cell) -> i32 {
    let stop = next_one(stops, bit(x)) as i32 - 1;
    targets.first_one_in_span(y, x + 1, stop).unwrap_or(stop)
}

/// The last column before the cell's with a stop or a target in its row.
fn last_before(stops: &[u64], targets: &BitGrid, Cell { x, y }: Cell) -> i32 {
    let stop = previous_one(stops, bit(x)) as i32 - 1;
    targets.last_one_in_span(y, stop, x - 1).unwrap_or(stop)
}

/// The bit of a column in a padded row.
const fn bit(x: i32) -> usize {
    (x + 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    const EAST: Direction = Direction::new(1, 0);
    const NORTH_EAST: Direction = Direction::new(1, 1);
    const NORTH: Direction = Direction::new(0, 1);
    const WEST: Direction = Direction::new(-1, 0);

    /// Row 4 is on top, row 0 at the bottom.
    const ROWS: [&str; 5] = [
        "......", //
        "......", //
        "..#...", //
        "......", //
        "......",
    ];

    fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    fn targets(map: &SearchMap, cells: &[(i32, i32)]) -> Marks {
        let mut marks = Marks::default();
        marks.start(map);
        for &(x, y) in cells {
            marks.mark(Cell::new(x, y));
        }
        marks
    }

    /// Scans with these targets; returns the end cell, and true if it is a node.
    fn scan(from: (i32, i32), direction: Direction, cells: &[(i32, i32)]) -> (i32, i32, bool) {
        let map = map(&ROWS);
        let jumps = Jumps { map: &map, targets: &targets(&map, cells) };
        let Scan { end, node } = jumps.scan(Cell::new(from.0, from.1), direction);
        assert!(node.is_none_or(|node| node == end));
        (end.x, end.y, node.is_some())
    }

    #[test]
    fn a_straight_scan_ends_one_step_behind_the_obstacle() {
        // Below the obstacle in column 2: the north side opens in column 3.
        assert_eq!(scan((0, 1), EAST, &[]), (3, 1, true));
        assert_eq!(scan((5, 1), WEST, &[]), (1, 1, true));
        // No side opens along row 0, or behind the last jump point of row 1.
        assert_eq!(scan((0, 0), EAST, &[]), (5, 0, false));
        assert_eq!(scan((3, 1), EAST, &[]), (5, 1, false));
        // Before the obstacle, and next to it.
        assert_eq!(scan((2, 0), NORTH, &[]), (2, 1, false));
        assert_eq!(scan((2, 1), NORTH, &[]), (2, 1, false));
    }

    #[test]
    fn a_diagonal_scan_ends_where_one_may_turn() {
        // From (1, 1) the scan to the east finds (3, 1).
        assert_eq!(scan((0, 0), NORTH_EAST, &[]), (1, 1, true));
        // From (3, 1) the scan to the north finds (3, 3).
        assert_eq!(scan((2, 0), NORTH_EAST, &[]), (3, 1, true));
        // Neither (4, 1) nor (5, 2) sees a node.
        assert_eq!(scan((3, 0), NORTH_EAST, &[]), (5, 2, false));
        // (3, 2) is free, but the step would cut the obstacle's corner.
        assert_eq!(scan((2, 1), NORTH_EAST, &[]), (2, 1, false));
    }

    #[test]
    fn targets_end_scans() {
        assert_eq!(scan((0, 0), EAST, &[(4, 0), (3, 0)]), (3, 0, true));
        assert_eq!(scan((0, 1), EAST, &[(4, 1)]), (3, 1, true));
        assert_eq!(scan((5, 1), WEST, &[(4, 1), (5, 1)]), (4, 1, true));
        assert_eq!(scan((0, 0), NORTH, &[(0, 3), (1, 2)]), (0, 3, true));
        // On the diagonal, and beside it.
        assert_eq!(scan((3, 0), NORTH_EAST, &[(5, 2)]), (5, 2, true));
        assert_eq!(scan((3, 0), NORTH_EAST, &[(4, 4)]), (4, 1, true));
        // A target behind the start cell of the scan is not ahead.
        assert_eq!(scan((2, 0), EAST, &[(1, 0), (2, 0)]), (5, 0, false));
    }

    #[test]
    fn onward_by_hand() {
        let map = map(&ROWS);
        let jumps = Jumps { map: &map, targets: &targets(&map, &[]) };
        let onward = |x, y, arrival| -> Vec<(i32, i32)> {
            let to = jumps.onward(Cell::new(x, y), arrival);
            to.map(|Direction { dx, dy }| (dx, dy)).collect()
        };
        assert_eq!(onward(0, 0, None).len(), 8);
        // Eastwards below the obstacle: the north has opened; the south was never blocked.
        assert_eq!(onward(3, 1, Some(EAST)), [(1, 0), (1, 1), (0, 1)]);
        assert_eq!(onward(2, 1, Some(EAST)), [(1, 0)]);
        assert_eq!(onward(1, 1, Some(NORTH_EAST)), [(1, 0), (1, 1), (0, 1)]);
        // The map's border does not count as the end of an obstacle.
        assert_eq!(onward(3, 0, Some(EAST)), [(1, 0)]);
        assert_eq!(onward(1, 3, Some(NORTH)), [(1, 0), (1, 1), (0, 1)]);
    }
}
