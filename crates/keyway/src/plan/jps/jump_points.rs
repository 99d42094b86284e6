//! Jump points without corner cutting: the nodes that a jump point search generates from a node.
//!
//! A diagonal step needs the whole 2 x 2 block free, so diagonal moves have no forced neighbours:
//! only straight scans end at jump points. The diagonal turning points between two straight jump
//! points never become nodes: a diagonal is walked once, both straight directions are scanned at
//! each of its cells, and the finds are generated with the expanded node as their parent
//! (\[Harabor2014\], "JPS (B+P)": block-based scanning and pruning of intermediate nodes).
//!
//! The goal need not stop the scans: a shortest path leaves its last jump point for the goal along
//! one diagonal and then straight, so one test in the direction of the goal is enough.

use crate::map::{Cell, CellIndex, DiagonalEvents, SearchMap};
use crate::search::bit_scan::{is_set, next_one, previous_one};
use crate::search::{Cost, pattern};

/// A set of the 8 directions, counter-clockwise from east: bit 0 east, 1 north-east, 2 north, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Directions(pub(super) u8);

/// A straight direction of arrival, as a number: 0 east, 1 north, 2 west, 3 south.
pub(super) type Arrival = u8;

/// A set of arrivals, bit k for arrival k.
pub(super) type Arrivals = u8;

const EAST: Arrival = 0;
const NORTH: Arrival = 1;
const WEST: Arrival = 2;
const SOUTH: Arrival = 3;

/// Receives the finds of a scan.
pub(super) trait JumpVisitor {
    /// Called for a jump point reached at path cost `g`. Returns its lowest known path cost.
    fn jump_point(&mut self, at: Place, arrival: Arrival, g: u64) -> u64;

    /// Called for the goal, reached at path cost `g`.
    fn goal(&mut self, g: u64);
}

/// A cell and the positions of its bit: in the rows, and in the transposed rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) cell: Cell,
    /// Its [`CellIndex`].
    pub(super) index: usize,
    turned: usize,
}

/// The cells of a diagonal that are events for a search.
pub(super) trait Diagonals: Copy {
    /// A position on a diagonal.
    type Bit;

    /// True if every cell counts as an event.
    const WALKS: bool;

    /// The position of a cell.
    fn bit<const TO_EAST: bool, const TO_NORTH: bool>(self, cell: Cell) -> Self::Bit;

    /// Advances to the next event; returns the steps to it.
    fn pass<const TO_EAST: bool, const TO_NORTH: bool>(self, bit: &mut Self::Bit) -> usize;
}

/// No known events: diagonals are walked cell by cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walked;

impl Diagonals for Walked {
    type Bit = ();
    const WALKS: bool = true;

    #[inline]
    fn bit<const TO_EAST: bool, const TO_NORTH: bool>(self, _: Cell) {}

    #[inline]
    fn pass<const TO_EAST: bool, const TO_NORTH: bool>(self, (): &mut ()) -> usize {
        1
    }
}

impl Diagonals for &DiagonalEvents {
    type Bit = usize;
    const WALKS: bool = false;

    #[inline]
    fn bit<const TO_EAST: bool, const TO_NORTH: bool>(self, cell: Cell) -> usize {
        DiagonalEvents::bit::<TO_EAST, TO_NORTH>(self, cell)
    }

    #[inline]
    fn pass<const TO_EAST: bool, const TO_NORTH: bool>(self, bit: &mut usize) -> usize {
        let words = self.words::<TO_EAST, TO_NORTH>();
        let next = if TO_EAST { next_one(words, *bit) } else { previous_one(words, *bit) };
        let steps = next.abs_diff(*bit);
        *bit = next;
        steps
    }
}

/// Scans of one map towards one goal.
#[derive(Clone, Copy, Debug)]
pub(super) struct JumpPoints<'m, D> {
    blocked: &'m [u64],
    blocked_turned: &'m [u64],
    east: &'m [u64],
    west: &'m [u64],
    north: &'m [u64],
    south: &'m [u64],
    cramped: &'m [u64],
    diagonals: D,
    stride: usize,
    turned_stride: usize,
    goal: Cell,
}

impl<'m, D: Diagonals> JumpPoints<'m, D> {
    pub(super) fn new(map: &'m SearchMap, goal: Cell, diagonals: D) -> Self {
        let stops = map.stops();
        Self {
            blocked: map.blocked().words(),
            blocked_turned: map.blocked_transposed().words(),
            east: stops.east.words(),
            west: stops.west.words(),
            north: stops.north.words(),
            south: stops.south.words(),
            cramped: stops.cramped.words(),
            diagonals,
            stride: map.blocked().stride(),
            turned_stride: map.blocked_transposed().stride(),
            goal,
        }
    }

    /// The place of a cell.
    pub(super) fn place(&self, index: CellIndex) -> Place {
        // Divisions of 32 bits are much faster than those of 64 bits.
        let (row, column) = (index.0 / self.stride as u32, index.0 % self.stride as u32);
        Place {
            cell: Cell::new(column as i32 - 1, row as i32 - 1),
            index: index.as_usize(),
            turned: column as usize * self.turned_stride + row as usize,
        }
    }

    /// Directions in which a shortest path may continue from a jump point reached from the given
    /// directions; all of them for a start, which has no arrival.
    ///
    /// After one arrival: straight on; and to a side and diagonally to that side, if the cell
    /// beside the previous one is blocked and the cell beside the jump point is free.
    pub(super) fn onward(&self, at: Place, arrivals: Arrivals) -> Directions {
        let pattern = pattern::around(self.blocked, self.stride, at.index);
        Directions(ONWARD[usize::from(arrivals)][pattern])
    }

    /// Visits every jump point in the given directions, and the goal if it is in sight.
    pub(super) fn scan(
        &self,
        from: Place,
        g: u64,
        directions: Directions,
        found: &mut impl JumpVisitor,
    ) {
        let (dx, dy) = (self.goal.x - from.cell.x, self.goal.y - from.cell.y);
        let goal_direction = direction_of(dx, dy);
        let steps_to_align = dx.abs().min(dy.abs());
        let mut left = directions.0;
        while left != 0 {
            let direction = left.trailing_zeros();
            left &= left - 1;
            let align = if direction == goal_direction { steps_to_align } else { i32::MAX };
            if align == 0 && self.sees_goal(from) {
                found.goal(g + self.straight_to_goal(from));
            }
            match direction {
                0 => _ = self.scan_row::<true>(from, g, found),
                1 => self.scan_diagonal::<true, true>(from, g, align, found),
                2 => _ = self.scan_column::<true>(from, g, found),
                3 => self.scan_diagonal::<false, true>(from, g, align, found),
                4 => _ = self.scan_row::<false>(from, g, found),
                5 => self.scan_diagonal::<false, false>(from, g, align, found),
                6 => _ = self.scan_column::<false>(from, g, found),
                _ => self.scan_diagonal::<true, false>(from, g, align, found),
            }
        }
    }

    /// Traverses a diagonal; after `align` steps the goal is straight ahead.
    #[inline]
    fn scan_diagonal<const TO_EAST: bool, const TO_NORTH: bool>(
        &self,
        from: Place,
        g: u64,
        align: i32,
        found: &mut impl JumpVisitor,
    ) {
        let (mut at, mut g, mut align) = (from, g, align);
        if !D::WALKS && align == 0 {
            align = i32::MAX;
        }
        let mut bit = self.diagonals.bit::<TO_EAST, TO_NORTH>(from.cell);
        while self.may_step::<TO_EAST, TO_NORTH>(at) {
            let (before, steps) = (at, self.diagonals.pass::<TO_EAST, TO_NORTH>(&mut bit));
            at = self.moved::<TO_EAST, TO_NORTH>(before, steps);
            g += steps as u64 * Cost::KEY_DIAGONAL;
            align = align.wrapping_sub(steps as i32);
            let is_aligned = if D::WALKS { align == 0 } else { align <= 0 };
            if is_aligned {
                let past = align.unsigned_abs();
                let place = self.moved::<TO_EAST, TO_NORTH>(before, steps - past as usize);
                if self.sees_goal(place) {
                    let g = g - u64::from(past) * Cost::KEY_DIAGONAL;
                    found.goal(g + self.straight_to_goal(place));
                }
                align = i32::MAX;
            }
            let is_dominated = self.scan_row::<TO_EAST>(at, g, found)
                || self.scan_column::<TO_NORTH>(at, g, found);
            if is_dominated {
                break;
            }
        }
    }

    /// True if the 2 x 2 cells that a diagonal step needs are free.
    #[inline]
    fn may_step<const TO_EAST: bool, const TO_NORTH: bool>(&self, at: Place) -> bool {
        let block = usize::from(!TO_EAST) + if TO_NORTH { 0 } else { self.stride };
        !is_set(self.cramped, at.index - block)
    }

    /// The place a number of steps along a diagonal.
    #[inline]
    fn moved<const TO_EAST: bool, const TO_NORTH: bool>(&self, at: Place, steps: usize) -> Place {
        let Place { cell, index, turned } = at;
        let (x, index, turned) = if TO_EAST {
            (cell.x + steps as i32, index + steps, turned + steps * self.turned_stride)
        } else {
            (cell.x - steps as i32, index - steps, turned - steps * self.turned_stride)
        };
        let (y, index, turned) = if TO_NORTH {
            (cell.y + steps as i32, index + steps * self.stride, turned + steps)
        } else {
            (cell.y - steps as i32, index - steps * self.stride, turned - steps)
        };
        Place { cell: Cell::new(x, y), index, turned }
    }

    /// Visits the jump point of a row, if any. True if the jump point is known to be so near to
    /// the start that the path over it to `from` is shorter than `g`: then no shortest path passes
    /// `from` with this cost.
    #[inline]
    fn scan_row<const TO_EAST: bool>(
        &self,
        from: Place,
        g: u64,
        found: &mut impl JumpVisitor,
    ) -> bool {
        let index = if TO_EAST {
            next_one(self.east, from.index)
        } else {
            previous_one(self.west, from.index)
        };
        if is_set(self.blocked, index) {
            return false;
        }
        let cells = index.abs_diff(from.index);
        let (x, turned) = if TO_EAST {
            (from.cell.x + cells as i32, from.turned + cells * self.turned_stride)
        } else {
            (from.cell.x - cells as i32, from.turned - cells * self.turned_stride)
        };
        let at = Place { cell: Cell::new(x, from.cell.y), index, turned };
        let cost = cells as u64 * Cost::KEY_STRAIGHT;
        let arrival = if TO_EAST { EAST } else { WEST };
        found.jump_point(at, arrival, g + cost) + cost < g
    }

    /// The same as `scan_row` along a column.
    #[inline]
    fn scan_column<const TO_NORTH: bool>(
        &self,
        from: Place,
        g: u64,
        found: &mut impl JumpVisitor,
    ) -> bool {
        let turned = if TO_NORTH {
            next_one(self.north, from.turned)
        } else {
            previous_one(self.south, from.turned)
        };
        if is_set(self.blocked_turned, turned) {
            return false;
        }
        let cells = turned.abs_diff(from.turned);
        let (y, index) = if TO_NORTH {
            (from.cell.y + cells as i32, from.index + cells * self.stride)
        } else {
            (from.cell.y - cells as i32, from.index - cells * self.stride)
        };
        let at = Place { cell: Cell::new(from.cell.x, y), index, turned };
        let cost = cells as u64 * Cost::KEY_STRAIGHT;
        let arrival = if TO_NORTH { NORTH } else { SOUTH };
        found.jump_point(at, arrival, g + cost) + cost < g
    }

    /// True if all cells up to the goal, which lies in the same row or column, are free.
    fn sees_goal(&self, from: Place) -> bool {
        let (dx, dy) = (self.goal.x - from.cell.x, self.goal.y - from.cell.y);
        let span = |at: usize, cells: i32| {
            let far = at.wrapping_add_signed(cells as isize);
            (at.min(far), at.max(far))
        };
        if dy == 0 {
            is_clear(self.blocked, span(from.index, dx))
        } else {
            is_clear(self.blocked_turned, span(from.turned, dy))
        }
    }

    fn straight_to_goal(&self, from: Place) -> u64 {
        let cells = self.goal.x.abs_diff(from.cell.x) + self.goal.y.abs_diff(from.cell.y);
        u64::from(cells) * Cost::KEY_STRAIGHT
    }
}

/// The direction of the first step of a path over (dx, dy) cells that is diagonal first.
fn direction_of(dx: i32, dy: i32) -> u32 {
    const BY_SIGNS: [[u32; 3]; 3] = [[5, 6, 7], [4, 8, 0], [3, 2, 1]];
    BY_SIGNS[(dy.signum() + 1) as usize][(dx.signum() + 1) as usize]
}

/// Onward directions for every set of arrivals and every pattern of blocked neighbours.
static ONWARD: [[u8; 512]; 16] = onward_directions();

const fn onward_directions() -> [[u8; 512]; 16] {
    let mut table = [[0; 512]; 16];
    let mut pattern = 0;
    while pattern < 512 {
        table[0][pattern] = 0xff;
        let mut arrivals = 1;
        while arrivals < 16 {
            let mut arrival = 0;
            while arrival < 4 {
                if arrivals >> arrival & 1 == 1 {
                    table[arrivals][pattern] |= onward_after(arrival, pattern);
                }
                arrival += 1;
            }
            arrivals += 1;
        }
        pattern += 1;
    }
    table
}

const fn onward_after(arrival: u32, pattern: usize) -> u8 {
    let ahead = 2 * arrival;
    // Ahead, ahead-left, left; and ahead-right, right.
    let mut relative: u8 = 0b0000_0001;
    if pattern::is_blocked(pattern, ahead + 3) && !pattern::is_blocked(pattern, ahead + 2) {
        relative |= 0b0000_0110;
    }
    if pattern::is_blocked(pattern, ahead + 5) && !pattern::is_blocked(pattern, ahead + 6) {
        relative |= 0b1100_0000;
    }
    relative.rotate_left(ahead)
}

/// True if no bit from `low` to `high` is set.
fn is_clear(words: &[u64], (low, high): (usize, usize)) -> bool {
    (low / 64..=high / 64).all(|word| {
        let from = if word == low / 64 { u64::MAX << (low % 64) } else { u64::MAX };
        let to = if word == high / 64 { u64::MAX >> (63 - high % 64) } else { u64::MAX };
        words[word] & from & to == 0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    const START_G: u64 = 10 * Cost::KEY_STRAIGHT;
    const ROWS: [&str; 4] = ["....", ".#..", "....", "...."];

    fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    #[derive(Default)]
    struct Finds {
        /// Column, row, arrival.
        jumps: Vec<(i32, i32, Arrival)>,
        places: Vec<Place>,
        goal: Option<u64>,
        known: u64,
    }

    impl JumpVisitor for Finds {
        fn jump_point(&mut self, at: Place, arrival: Arrival, g: u64) -> u64 {
            self.places.push(at);
            self.jumps.push((at.cell.x, at.cell.y, arrival));
            g.min(self.known)
        }
        fn goal(&mut self, g: u64) {
            self.goal = Some(g - START_G);
        }
    }

    fn scan(rows: &[&str], from: Cell, goal: Cell, directions: u8, known: u64) -> Finds {
        let map = map(rows);
        let jumps = JumpPoints::new(&map, goal, Walked);
        let mut finds = Finds { known, ..Finds::default() };
        let place = jumps.place(map.index(from));
        assert_eq!(place.cell, from);
        jumps.scan(place, START_G, Directions(directions), &mut finds);
        for place in &finds.places {
            assert_eq!(*place, jumps.place(map.index(place.cell)));
        }
        finds
    }

    fn jumps(from: Cell, directions: u8) -> Vec<(i32, i32, Arrival)> {
        scan(&ROWS, from, Cell::new(3, 3), directions, u64::MAX).jumps
    }

    #[test]
    fn a_straight_scan_stops_where_a_side_opens() {
        // Eastwards below the obstacle: beyond its far side, the north opens at column 2.
        assert_eq!(jumps(Cell::new(0, 1), 0b1), [(2, 1, EAST)]);
        // No side opens along the border, and the border is a dead end.
        assert_eq!(jumps(Cell::new(0, 0), 0b1), []);
        assert_eq!(jumps(Cell::new(3, 1), 0b1_0000), [(0, 1, WEST)]);
        assert_eq!(jumps(Cell::new(2, 0), 0b100), [(2, 3, NORTH)]);
        assert_eq!(jumps(Cell::new(2, 3), 0b100_0000), [(2, 1, SOUTH)]);
    }

    #[test]
    fn a_diagonal_scans_both_ways_at_each_cell() {
        // North-east from (0, 0): at (1, 1) east finds (2, 1), north is blocked; then the diagonal
        // ends, as the cell above (1, 1) is blocked.
        assert_eq!(jumps(Cell::new(0, 0), 0b10), [(2, 1, EAST)]);
    }

    #[test]
    fn a_diagonal_ends_where_a_shorter_way_is_known() {
        let rows = [".....", ".....", "..#..", ".....", "....."];
        let from = Cell::new(0, 0);
        let all = scan(&rows, from, Cell::new(4, 4), 0b10, u64::MAX).jumps;
        assert_eq!(all, [(3, 1, EAST), (1, 3, NORTH)]);
        // The jump point is 2 cells beyond the diagonal's first cell.
        let known = START_G + Cost::KEY_DIAGONAL - 2 * Cost::KEY_STRAIGHT;
        let dominated = scan(&rows, from, Cell::new(4, 4), 0b10, known - 1);
        assert_eq!(dominated.jumps, [(3, 1, EAST)], "column 1 is not scanned");
        let equal = scan(&rows, from, Cell::new(4, 4), 0b10, known);
        assert_eq!(equal.jumps, [(3, 1, EAST), (1, 3, NORTH)]);
    }

    #[test]
    fn the_goal_is_seen_along_a_diagonal_and_then_straight() {
        let ask = |from: (i32, i32), goal: (i32, i32), directions| {
            scan(&ROWS, Cell::new(from.0, from.1), Cell::new(goal.0, goal.1), directions, u64::MAX)
                .goal
        };
        assert_eq!(ask((2, 0), (3, 3), 0xff), Some(Cost::new(2, 1).key()));
        assert_eq!(ask((3, 3), (2, 0), 0xff), Some(Cost::new(2, 1).key()));
        assert_eq!(ask((0, 1), (1, 0), 0xff), Some(Cost::new(0, 1).key()));
        assert_eq!(ask((0, 3), (3, 3), 0xff), Some(Cost::new(3, 0).key()));
        assert_eq!(ask((0, 3), (0, 0), 0xff), Some(Cost::new(3, 0).key()));
        // Not in these directions, or behind the obstacle.
        assert_eq!(ask((2, 0), (3, 3), 0b1), None);
        assert_eq!(ask((0, 0), (2, 3), 0xff), None);
        assert_eq!(ask((0, 2), (3, 2), 0xff), None);
    }

    #[test]
    fn onward_directions_by_hand() {
        let map = map(&ROWS);
        let jumps = JumpPoints::new(&map, Cell::new(0, 0), Walked);
        let onward =
            |x, y, arrivals| jumps.onward(jumps.place(map.index(Cell::new(x, y))), arrivals);
        // East along row 1 to (2, 1): ahead, and to the left (north), which opens.
        assert_eq!(onward(2, 1, 1 << EAST), Directions(0b111));
        // South along column 0 to (0, 1): ahead, and to its left, the east.
        assert_eq!(onward(0, 1, 1 << SOUTH), Directions(0b1100_0001));
        assert_eq!(onward(2, 1, 1 << EAST | 1 << SOUTH), Directions(0b0111_0111));
        assert_eq!(onward(2, 1, 0), Directions(0xff));
    }
}
