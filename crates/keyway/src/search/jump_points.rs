//! Jump points without corner cutting: what a jump point search generates from a node.
//!
//! A diagonal step needs the whole 2 x 2 block free, so diagonal moves have no forced neighbours: only
//! straight scans end at jump points. The diagonal turning points between two straight jump points
//! never become nodes: a diagonal is walked once, both straight directions are scanned at each of its
//! cells, and what they find is generated with the expanded node as its parent (\[Harabor2014\], "JPS
//! (B+P)": block-based scanning and pruning of intermediate nodes).

use super::Cost;
use crate::map::{BitGrid, Cell, SearchMap};

/// A set of the 8 directions, counter-clockwise from east: bit 0 east, 1 north-east, 2 north, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Directions(pub(crate) u8);

/// A straight direction of arrival, as a number: 0 east, 1 north, 2 west, 3 south.
pub(crate) type Arrival = u8;

impl Directions {
    /// From a start every direction is open.
    pub(crate) const ALL: Self = Self(0xff);
}

/// A jump point that was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Jump {
    pub(crate) to: Cell,
    pub(crate) arrival: Arrival,
    /// The leg's length, as a [`Cost::key`]: a diagonal part, then a straight one.
    pub(crate) cost: u64,
}

/// Scans of one map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JumpPoints<'m> {
    map: &'m SearchMap,
    blocked: &'m BitGrid,
}

impl<'m> JumpPoints<'m> {
    pub(crate) fn new(map: &'m SearchMap) -> Self {
        Self { map, blocked: map.blocked() }
    }

    /// Directions in which a shortest path may go on from a jump point reached in direction
    /// `arrival`: straight on, and where the cell beside the one before it was blocked and the one
    /// beside it is free, to that side and diagonally there.
    pub(crate) fn onward(&self, at: Cell, arrival: Arrival) -> Directions {
        let (ahead_x, ahead_y) = STRAIGHT[arrival as usize];
        let (left_x, left_y) = (-ahead_y, ahead_x);
        let opens = |x: i32, y: i32| {
            let beside = Cell::new(at.x + x, at.y + y);
            let before = Cell::new(beside.x - ahead_x, beside.y - ahead_y);
            self.blocked.get(before) && !self.blocked.get(beside)
        };
        // Ahead, ahead-left, left; and ahead-right, right.
        let mut relative = 0b0000_0001;
        if opens(left_x, left_y) {
            relative |= 0b0000_0110;
        }
        if opens(-left_x, -left_y) {
            relative |= 0b1100_0000;
        }
        Directions(u8::rotate_left(relative, 2 * u32::from(arrival)))
    }

    /// Calls `found` for every jump point of the given directions.
    pub(crate) fn scan(&self, from: Cell, directions: Directions, mut found: impl FnMut(Jump)) {
        let mut left = directions.0;
        while left != 0 {
            let direction = left.trailing_zeros() as u8;
            left &= left - 1;
            if direction.is_multiple_of(2) {
                self.scan_straight(from, direction / 2, 0, &mut found);
            } else {
                self.scan_diagonal(from, direction / 2, &mut found);
            }
        }
    }

    /// The cost of the way straight to the goal, diagonal part first, if it is free.
    pub(crate) fn shot(&self, from: Cell, goal: Cell) -> Option<u64> {
        let (dx, dy) = (goal.x - from.x, goal.y - from.y);
        let (step_x, step_y) = (dx.signum(), dy.signum());
        let mut at = from;
        for _ in 0..dx.abs().min(dy.abs()) {
            if !self.is_diagonal_free(at, step_x, step_y) {
                return None;
            }
            at = Cell::new(at.x + step_x, at.y + step_y);
        }
        let is_free = if at.y == goal.y {
            let (low, high) = (at.x.min(goal.x), at.x.max(goal.x));
            !self.blocked.any_in_span(at.y, low, high)
        } else {
            let (low, high) = (at.y.min(goal.y), at.y.max(goal.y));
            !self.map.blocked_transposed().any_in_span(at.x, low, high)
        };
        is_free.then(|| Cost::octile(dx.unsigned_abs(), dy.unsigned_abs()).key())
    }

    /// The diagonal between the straight directions `quarter` and the next one.
    fn scan_diagonal(&self, from: Cell, quarter: Arrival, found: &mut impl FnMut(Jump)) {
        let next = (quarter + 1) % 4;
        let (a, b) = (STRAIGHT[quarter as usize], STRAIGHT[next as usize]);
        let (step_x, step_y) = (a.0 + b.0, a.1 + b.1);
        let mut at = from;
        let mut cost = 0;
        while self.is_diagonal_free(at, step_x, step_y) {
            at = Cell::new(at.x + step_x, at.y + step_y);
            cost += Cost::KEY_DIAGONAL;
            self.scan_straight(at, quarter, cost, found);
            self.scan_straight(at, next, cost, found);
        }
    }

    fn is_diagonal_free(&self, at: Cell, step_x: i32, step_y: i32) -> bool {
        // The columns at and beside the cell are two neighbouring bits of two rows.
        let low = at.x.min(at.x + step_x);
        let pair = |y| two_bits(self.blocked.row(y), low);
        pair(at.y) | pair(at.y + step_y) == 0
    }

    fn scan_straight(
        &self,
        from: Cell,
        direction: Arrival,
        cost: u64,
        found: &mut impl FnMut(Jump),
    ) {
        let stops = self.map.stops();
        let (line, along) =
            if direction.is_multiple_of(2) { (from.y, from.x) } else { (from.x, from.y) };
        let (row, blocked) = match direction {
            0 => (stops.east.row(line), self.blocked.row(line)),
            1 => (stops.north.row(line), self.map.blocked_transposed().row(line)),
            2 => (stops.west.row(line), self.blocked.row(line)),
            _ => (stops.south.row(line), self.map.blocked_transposed().row(line)),
        };
        let at = (along + 1) as usize;
        let stop = if direction < 2 { next_one(row, at) } else { previous_one(row, at) };
        if blocked[stop / 64] >> (stop % 64) & 1 == 1 {
            return;
        }
        let to = stop as i32 - 1;
        let to =
            if direction.is_multiple_of(2) { Cell::new(to, line) } else { Cell::new(line, to) };
        let cost = cost + stop.abs_diff(at) as u64 * Cost::KEY_STRAIGHT;
        found(Jump { to, arrival: direction, cost });
    }
}

/// Steps of the straight directions.
const STRAIGHT: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// The bits of columns `low` and `low + 1` of a padded row.
fn two_bits(row: &[u64], low: i32) -> u64 {
    let bit = (low + 1) as usize;
    let (word, shift) = (bit / 64, bit % 64);
    let first = row[word] >> shift;
    let second = if shift == 63 { row[word + 1] << 1 } else { first };
    (first & 1) | (second & 2)
}

/// The first set bit after `at`; the padding always has one.
fn next_one(row: &[u64], at: usize) -> usize {
    let mut word = at / 64;
    // Two shifts, as one by 64 is not defined.
    let mut bits = row[word] & (u64::MAX << (at % 64) << 1);
    while bits == 0 {
        word += 1;
        bits = row[word];
    }
    word * 64 + bits.trailing_zeros() as usize
}

/// The last set bit before `at`; the padding always has one.
fn previous_one(row: &[u64], at: usize) -> usize {
    let mut word = at / 64;
    let mut bits = row[word] & !(u64::MAX << (at % 64));
    while bits == 0 {
        word -= 1;
        bits = row[word];
    }
    word * 64 + 63 - bits.leading_zeros() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    fn jumps(rows: &[&str], from: Cell, directions: u8) -> Vec<(i32, i32, Arrival)> {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap();
        let mut found = Vec::new();
        JumpPoints::new(&map).scan(from, Directions(directions), |jump| {
            let (dx, dy) = (jump.to.x.abs_diff(from.x), jump.to.y.abs_diff(from.y));
            assert_eq!(jump.cost, Cost::octile(dx, dy).key());
            found.push((jump.to.x, jump.to.y, jump.arrival));
        });
        found
    }

    #[test]
    fn a_straight_scan_stops_where_a_side_opens() {
        let rows = ["....", ".#..", "....", "...."];
        // Eastwards below the obstacle: its far side opens above column 2.
        assert_eq!(jumps(&rows, Cell::new(0, 1), 0b1), [(2, 1, 0)]);
        // Along the border nothing opens, and the border is a dead end.
        assert_eq!(jumps(&rows, Cell::new(0, 0), 0b1), []);
        assert_eq!(jumps(&rows, Cell::new(3, 1), 0b1_0000), [(0, 1, 2)]);
    }

    #[test]
    fn a_diagonal_scans_both_ways_at_each_cell() {
        let rows = ["....", ".#..", "....", "...."];
        // North-east from (0, 0): at (1, 1) east finds (2, 1), north is blocked; then the diagonal
        // ends, as the cell above (1, 1) is blocked.
        assert_eq!(jumps(&rows, Cell::new(0, 0), 0b10), [(2, 1, 0)]);
    }

    #[test]
    fn onward_directions() {
        let map = SearchMap::new(
            &OccupancyGrid::from_ascii(&["....", ".#..", "....", "...."]),
            LayerConfig::default(),
        )
        .unwrap();
        let jumps = JumpPoints::new(&map);
        // East along row 1 to (2, 1): ahead, and to the left (north) where it opens.
        assert_eq!(jumps.onward(Cell::new(2, 1), 0), Directions(0b111));
        // South along column 0 to (0, 1): ahead, and to its left, the east.
        assert_eq!(jumps.onward(Cell::new(0, 1), 3), Directions(0b1100_0001));
    }
}
