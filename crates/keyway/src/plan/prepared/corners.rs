//! The cells at which shortest paths turn, and what of them can be reached straight from a cell.

use crate::map::{BitGrid, Cell, SearchMap};
use crate::search::Cost;

/// The corner cells of a map \[Uras2013, "subgoals"\]: free cells beside the corner of an obstacle,
/// with a diagonal neighbour that is blocked while the two cells between are free.
///
/// They are numbered row by row. Straight scans read one bit per cell, as those of a jump point
/// search do; here a scan stops at any corner cell, from whichever side it comes.
#[derive(Clone, Debug)]
pub(super) struct Corners {
    cells: BitGrid,
    /// Blocked and corner cells: where scans stop; and the same with columns and rows exchanged.
    stops: BitGrid,
    stops_transposed: BitGrid,
    /// Number of corner cells before each word of `cells`.
    before: Vec<u32>,
}

/// A corner cell in sight of another cell: the way there is a diagonal, then a straight run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sighting {
    pub(super) at: Cell,
    /// The way's length.
    pub(super) cost: Cost,
}

impl Corners {
    pub(super) fn new(map: &SearchMap) -> Self {
        let cells = corner_cells(map.blocked());
        let mut stops = map.blocked().clone();
        stops.merge(&cells);
        let stops_transposed = stops.transposed();
        let mut count = 0;
        let counted = cells.words().iter().map(|word| {
            let before = count;
            count += word.count_ones();
            before
        });
        Self { before: counted.collect(), cells, stops, stops_transposed }
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.cells.count_ones() as usize
    }

    /// All of them, in the order of their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = Cell> + '_ {
        let last = self.cells.width() as i32 - 1;
        (0..self.cells.height() as i32)
            .flat_map(move |y| self.cells.ones_in_span(y, 0, last).map(move |x| Cell::new(x, y)))
    }

    /// The number of a corner cell.
    pub(super) fn number(&self, corner: Cell) -> usize {
        let bit = (corner.y + 1) as usize * self.cells.stride() + (corner.x + 1) as usize;
        let lower = self.cells.words()[bit / 64] & !(u64::MAX << (bit % 64));
        (self.before[bit / 64] + lower.count_ones()) as usize
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let grids = [&self.cells, &self.stops, &self.stops_transposed];
        let grids: usize = grids.into_iter().map(BitGrid::memory_bytes).sum();
        grids + self.before.capacity() * size_of::<u32>()
    }

    /// What can be seen from a cell.
    pub(super) fn sight<'c>(&'c self, map: &'c SearchMap, from: Cell) -> Sight<'c> {
        let straight = std::array::from_fn(|direction| self.scan(from, direction));
        Sight { corners: self, blocked: map.blocked(), from, straight }
    }

    /// Calls `found` for every corner cell that is *directly reachable* from `from` \[Uras2013\]: no
    /// way to it is longer than the octile distance, and none of that length meets another corner
    /// cell. A shortest path between two cells is either such a way or can be put together from
    /// such ways between corner cells.
    pub(super) fn in_sight(&self, map: &SearchMap, from: Cell, mut found: impl FnMut(Sighting)) {
        let sight = self.sight(map, from);
        sight.along_straights(&mut found);
        for quarter in 0..4 {
            sight.in_quarter(quarter, |_, _| true, &mut found);
        }
    }

    pub(super) fn contains(&self, cell: Cell) -> bool {
        let bit = (cell.y + 1) as usize * self.cells.stride() + (cell.x + 1) as usize;
        self.cells.words()[bit / 64] >> (bit % 64) & 1 == 1
    }

    fn scan(&self, from: Cell, direction: usize) -> Scan {
        let is_row = direction % 2 == 0;
        let (grid, line, along) = if is_row {
            (&self.stops, from.y, from.x)
        } else {
            (&self.stops_transposed, from.x, from.y)
        };
        let (row, at) = (grid.row(line), (along + 1) as usize);
        let stop = if direction < 2 { next_one(row, at) } else { previous_one(row, at) };
        let along = stop as i32 - 1;
        let stop_cell = if is_row { Cell::new(along, line) } else { Cell::new(line, along) };
        Scan { stop: stop_cell, steps: stop.abs_diff(at) as u32 }
    }
}

/// The surroundings of a cell: its straight scans, from which those of the quarters between follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'c> {
    corners: &'c Corners,
    blocked: &'c BitGrid,
    from: Cell,
    straight: [Scan; 4],
}

impl Sight<'_> {
    /// Corner cells straight ahead.
    pub(super) fn along_straights(&self, mut found: impl FnMut(Sighting)) {
        for scan in self.straight.iter().filter(|scan| self.corners.contains(scan.stop)) {
            found(Sighting { at: scan.stop, cost: Cost::new(u64::from(scan.steps), 0) });
        }
    }

    /// Corner cells in a quarter: its diagonal is walked while `is_worth` says so of the cell that
    /// was reached and the steps taken; to both sides of it, scans reach no further than the shortest
    /// one before.
    pub(super) fn in_quarter(
        &self,
        quarter: usize,
        mut is_worth: impl FnMut(Cell, u64) -> bool,
        mut found: impl FnMut(Sighting),
    ) {
        let sides = [quarter, (quarter + 1) % 4];
        let mut limits = sides.map(|side| self.straight[side].steps - 1);
        let (a, b) = (STEPS[sides[0]], STEPS[sides[1]]);
        let (step_x, step_y) = (a.0 + b.0, a.1 + b.1);
        let (mut at, mut diagonal) = (self.from, 0);
        while is_diagonal_free(self.blocked, at, step_x, step_y) {
            at = Cell::new(at.x + step_x, at.y + step_y);
            diagonal += 1;
            if !is_worth(at, diagonal) {
                return;
            }
            if self.corners.contains(at) {
                found(Sighting { at, cost: Cost::new(0, diagonal) });
                return;
            }
            for (side, limit) in sides.into_iter().zip(&mut limits).filter(|(_, limit)| **limit > 0)
            {
                let scan = self.corners.scan(at, side);
                if scan.steps <= *limit {
                    *limit = scan.steps - 1;
                    if self.corners.contains(scan.stop) {
                        let cost = Cost::new(u64::from(scan.steps), diagonal);
                        found(Sighting { at: scan.stop, cost });
                    }
                }
            }
        }
    }
}

/// Where a straight scan ended, and after how many steps (at least one).
#[derive(Clone, Copy, Debug)]
struct Scan {
    stop: Cell,
    steps: u32,
}

/// East, north, west, south.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Whether the 2 x 2 block of a diagonal step is free.
fn is_diagonal_free(blocked: &BitGrid, at: Cell, step_x: i32, step_y: i32) -> bool {
    let low = (at.x.min(at.x + step_x) + 1) as usize;
    let (word, shift) = (low / 64, low % 64);
    let pair = |y: i32| {
        let first = (y + 1) as usize * blocked.stride() / 64 + word;
        let words = blocked.words();
        // Two shifts, as one by 64 is not defined.
        (words[first] >> shift | words[first + 1] << 1 << (63 - shift)) & 3
    };
    pair(at.y) | pair(at.y + step_y) == 0
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

/// Free cells with a blocked diagonal neighbour and free cells between, 64 at a time.
fn corner_cells(blocked: &BitGrid) -> BitGrid {
    let mut corners = BitGrid::new(blocked.width(), blocked.height(), false);
    for y in 0..blocked.height() as i32 {
        let rows = [blocked.row(y - 1), blocked.row(y), blocked.row(y + 1)];
        for word in 0..rows[1].len() {
            let [below, own, above] = rows.map(|row| Beside::of(row, word));
            // Over an own row that is free here and beside, the next row is free here and blocked
            // beside.
            let turns =
                |next: &Beside| !next.here & ((!own.right & next.right) | (!own.left & next.left));
            let found = !own.here & (turns(&above) | turns(&below));
            corners.set_word(y, word, found);
        }
    }
    corners
}

/// For each bit of a word its own value and those of its neighbours; beyond the row all is blocked.
struct Beside {
    left: u64,
    here: u64,
    right: u64,
}

impl Beside {
    fn of(row: &[u64], word: usize) -> Self {
        let here = row[word];
        let before = if word > 0 { row[word - 1] } else { u64::MAX };
        let after = row.get(word + 1).copied().unwrap_or(u64::MAX);
        Self { left: here << 1 | before >> 63, here, right: here >> 1 | after << 63 }
    }
}
