//! The cells at which a shortest path from a cell may turn first.
//!
//! As in a jump point search \[Harabor2011\] a path runs diagonally, then straight, until it turns
//! at the end of an obstacle beside it. Here scans pass such jump points and continue behind them.
//! Each is a separate find, at which the path turns to that side and does not go straight on. That
//! determines the directions in which it continues, and so a lower bound of its length.

use crate::map::{BitGrid, Cell, DiagonalEvents, SearchMap};
use crate::search::Cost;
use crate::search::bit_scan::{is_set, next_one, previous_one};

/// A cell at which paths turn, reached by a diagonal and then a straight run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub(super) at: Cell,
    /// The cost of the path to it.
    pub(super) cost: Cost,
    /// The straight direction of arrival, as a step.
    pub(super) ahead: (i32, i32),
    /// True if paths may turn to the left, and to the right.
    pub(super) opens: [bool; 2],
}

/// Scans from the cells of one map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'m> {
    blocked: &'m [u64],
    blocked_turned: &'m [u64],
    /// Scan stops towards east, north, west, south.
    stops: [&'m [u64]; 4],
    cramped: &'m [u64],
    diagonals: &'m DiagonalEvents,
    stride: usize,
    turned_stride: usize,
}

/// East, north, west, south.
pub(super) const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

impl<'m> Sight<'m> {
    pub(super) fn new(map: &'m SearchMap, diagonals: &'m DiagonalEvents) -> Self {
        let stops = map.stops();
        Self {
            blocked: map.blocked().words(),
            blocked_turned: map.blocked_transposed().words(),
            stops: [&stops.east, &stops.north, &stops.west, &stops.south].map(BitGrid::words),
            cramped: stops.cramped.words(),
            diagonals,
            stride: map.blocked().stride(),
            turned_stride: map.blocked_transposed().stride(),
        }
    }

    /// Calls `found` for the turns straight ahead of `from`, which was reached by `diagonal`
    /// steps, until it returns false.
    pub(super) fn along(
        &self,
        from: Cell,
        direction: usize,
        diagonal: u64,
        mut found: impl FnMut(Turn) -> bool,
    ) {
        let ahead = STEPS[direction];
        let begin = self.bit(from, direction);
        let mut bit = begin;
        loop {
            bit = scan(self.stops[direction], bit, direction < 2);
            if is_set(self.blocked_for(direction), bit) {
                return;
            }
            let straight = bit.abs_diff(begin);
            let (x, y) = (ahead.0 * straight as i32, ahead.1 * straight as i32);
            let at = Cell::new(from.x + x, from.y + y);
            let cost = Cost::new(straight as u64, diagonal);
            let left = (-ahead.1, ahead.0);
            let opens = [left, (-left.0, -left.1)].map(|side| self.opens(at, ahead, side));
            if !found(Turn { at, cost, ahead, opens }) {
                return;
            }
        }
    }

    /// Calls `visit` for the cells of the diagonal after straight direction `quarter` at which a
    /// scan may find something, with the steps to them, until it returns false.
    pub(super) fn diagonal(
        &self,
        from: Cell,
        quarter: usize,
        mut visit: impl FnMut(Cell, u64) -> bool,
    ) {
        let (a, b) = (STEPS[quarter], STEPS[(quarter + 1) % 4]);
        let step = (a.0 + b.0, a.1 + b.1);
        let (mut at, mut steps) = (from, 0);
        while self.is_diagonal_free(at, step) {
            let count = steps_to_event(self.diagonals, at, quarter);
            at = moved(at, (step.0 * count, step.1 * count));
            steps += count as u64;
            if !visit(at, steps) {
                return;
            }
        }
    }

    /// True if the cell beside `at` is free and the one before that is blocked.
    fn opens(&self, at: Cell, ahead: (i32, i32), side: (i32, i32)) -> bool {
        let beside = moved(at, side);
        let before = Cell::new(beside.x - ahead.0, beside.y - ahead.1);
        is_set(self.blocked, self.bit(before, 0)) && !is_set(self.blocked, self.bit(beside, 0))
    }

    fn blocked_for(&self, direction: usize) -> &'m [u64] {
        if direction.is_multiple_of(2) { self.blocked } else { self.blocked_turned }
    }

    /// The bit of a cell in the grids of a direction.
    fn bit(&self, cell: Cell, direction: usize) -> usize {
        let (x, y) = ((cell.x + 1) as usize, (cell.y + 1) as usize);
        if direction.is_multiple_of(2) { y * self.stride + x } else { x * self.turned_stride + y }
    }

    fn is_diagonal_free(&self, at: Cell, step: (i32, i32)) -> bool {
        let (low_x, low_y) = (at.x + step.0.min(0), at.y + step.1.min(0));
        !is_set(self.cramped, self.bit(Cell::new(low_x, low_y), 0))
    }
}

/// The quadrant in which `to` lies as seen from `from`: 0 between east and north, then
/// counter-clockwise.
pub(super) fn quarter_towards(from: Cell, to: Cell) -> usize {
    match (to.x >= from.x, to.y >= from.y) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    }
}

fn moved(cell: Cell, step: (i32, i32)) -> Cell {
    Cell::new(cell.x + step.0, cell.y + step.1)
}

/// The next set bit after `at`, or the last one before it; the padding always has one.
pub(super) fn scan(words: &[u64], at: usize, is_up: bool) -> usize {
    if is_up { next_one(words, at) } else { previous_one(words, at) }
}

/// The number of steps to the next event cell of a diagonal: towards north-east, north-west,
/// south-west or south-east. The first step must be free.
fn steps_to_event(events: &DiagonalEvents, from: Cell, quarter: usize) -> i32 {
    let (words, at) = match quarter {
        0 => (events.words::<true, true>(), events.bit::<true, true>(from)),
        1 => (events.words::<false, true>(), events.bit::<false, true>(from)),
        2 => (events.words::<false, false>(), events.bit::<false, false>(from)),
        _ => (events.words::<true, false>(), events.bit::<true, false>(from)),
    };
    let is_eastwards = quarter == 0 || quarter == 3;
    scan(words, at, is_eastwards).abs_diff(at) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    const ROWS: [&str; 4] = [".........", ".#....#..", ".........", "...#....."];

    fn with_sight<T>(ask: impl FnOnce(&Sight<'_>) -> T) -> T {
        let grid = OccupancyGrid::from_ascii(&ROWS);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let diagonals = map.diagonal_events();
        ask(&Sight::new(&map, &diagonals))
    }

    #[test]
    fn scans_pass_the_turns() {
        let turns = with_sight(|sight| {
            let mut turns = Vec::new();
            sight.along(Cell::new(0, 1), 0, 2, |turn| {
                assert_eq!((turn.ahead, turn.cost.diagonal), ((1, 0), 2));
                turns.push((turn.at.x, turn.cost.straight, turn.opens));
                true
            });
            turns
        });
        // Beyond the obstacles above at column 1, below at column 3, above at column 6.
        let (left, right) = ([true, false], [false, true]);
        assert_eq!(turns, [(2, 2, left), (4, 4, right), (7, 7, left)]);
    }

    #[test]
    fn diagonals_stop_where_there_is_something_to_see() {
        let visited = with_sight(|sight| {
            let mut visited = Vec::new();
            sight.diagonal(Cell::new(4, 0), 0, |at, steps| {
                visited.push((at.x, at.y, steps));
                true
            });
            visited
        });
        // From (5, 1) a turn is seen to the east; one step further the obstacle blocks the
        // diagonal.
        assert_eq!(visited, [(5, 1, 1)]);
    }
}
