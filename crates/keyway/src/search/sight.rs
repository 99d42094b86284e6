//! Line of sight between the centres of two cells, exact.
//!
//! The line crosses the grid row by row, and a run of cells in each row. One test decides about up
//! to 64 cells of a run. Rows are taken along the line's longer axis, on the transposed map if
//! that is the vertical one. So a line of n rows costs n tests, and long runs one more test per 64
//! cells.
//!
//! # Cells on the line
//! A line between two centres meets a row's border at one point, which lies inside a column or is
//! a corner of four cells. Through a corner it passes diagonally from one cell into the next, like
//! a diagonal step, and the corner rule applies to the two cells beside it: under
//! [`CornerRule::Forbid`] both must be free, under [`CornerRule::Allow`] they do not count. Cells
//! whose interior the line crosses must be free in any case.
//!
//! Only integers are compared, so the result is exact, and the same in both directions.

use super::CornerRule;
use crate::map::{BitGrid, Cell, SearchMap};

/// The line-of-sight test between cells of a map.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'m> {
    blocked: &'m BitGrid,
    transposed: &'m BitGrid,
    corners: CornerRule,
}

impl<'m> Sight<'m> {
    /// Creates the test for a map under a corner rule.
    pub const fn new(map: &'m SearchMap, corners: CornerRule) -> Self {
        Self { blocked: map.blocked(), transposed: map.blocked_transposed(), corners }
    }

    /// True if the straight line between the centres of two cells of the map is free. For
    /// neighbours this is the case if and only if there is a step from one to the other.
    pub fn is_free(&self, a: Cell, b: Cell) -> bool {
        let is_steep = a.y.abs_diff(b.y) > a.x.abs_diff(b.x);
        let turned = |cell: Cell| Cell::new(cell.y, cell.x);
        let (blocked, a, b) =
            if is_steep { (self.transposed, turned(a), turned(b)) } else { (self.blocked, a, b) };
        let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
        is_line_free(blocked, left, right, self.corners)
    }
}

/// True if the line from `left` to `right`, at most as high as it is wide, is free.
fn is_line_free(blocked: &BitGrid, left: Cell, right: Cell, corners: CornerRule) -> bool {
    let width = left.x.abs_diff(right.x) as usize;
    let height = left.y.abs_diff(right.y) as usize;
    let words = blocked.words();
    let stride = blocked.stride().cast_signed();
    let to_next_row = if right.y > left.y { stride } else { -stride };
    // The bit of the line's column 0 in the current row, and the first column of the row's run.
    let mut row = (left.y + 1) as usize * blocked.stride() + (left.x + 1) as usize;
    let mut first = 0;
    for crossing in Crossings::new(width, height) {
        // The last column of this row's run, and the first column of the next row's run.
        let (last, next) = match (crossing.is_corner, corners) {
            (true, CornerRule::Forbid) => (crossing.column, crossing.column - 1),
            (true, CornerRule::Allow) => (crossing.column - 1, crossing.column),
            (false, _) => (crossing.column, crossing.column),
        };
        if !is_run_free(words, row + first, row + last) {
            return false;
        }
        first = next;
        row = row.wrapping_add_signed(to_next_row);
    }
    is_run_free(words, row + first, row + width)
}

/// A crossing of a line from one row into the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Crossing {
    /// The column, counted from the first column of the line.
    column: usize,
    /// True if it is the corner between that column and the one before.
    is_corner: bool,
}

/// The crossings of a line of `width` columns and `height` rows, at most as high as it is wide.
///
/// With the origin in the centre of its first cell, the line leaves row k at x = width (2k + 1) /
/// (2 height). This is in column floor(x + 1/2), or, if the remainder is 0, on the border before
/// that column. From row to row x grows by width / height.
struct Crossings {
    rows_left: usize,
    /// x + 1/2, in units of 1 / (2 height): its floor, and the remainder.
    column: usize,
    rest: usize,
    /// 2 height.
    unit: usize,
    /// width / height: its floor, and the remainder, in units.
    slope: usize,
    slope_rest: usize,
}

impl Crossings {
    fn new(width: usize, height: usize) -> Self {
        // A level line has no crossings, so any divisor is valid.
        let divisor = height.max(1);
        let unit = 2 * divisor;
        Self {
            rows_left: height,
            column: (width + height) / unit,
            rest: (width + height) % unit,
            unit,
            slope: width / divisor,
            slope_rest: 2 * (width % divisor),
        }
    }
}

impl Iterator for Crossings {
    type Item = Crossing;

    fn next(&mut self) -> Option<Crossing> {
        self.rows_left = self.rows_left.checked_sub(1)?;
        let crossing = Crossing { column: self.column, is_corner: self.rest == 0 };
        self.column += self.slope;
        self.rest += self.slope_rest;
        if self.rest >= self.unit {
            self.rest -= self.unit;
            self.column += 1;
        }
        Some(crossing)
    }
}

/// True if no bit from `first` to `last` is set.
fn is_run_free(words: &[u64], mut first: usize, last: usize) -> bool {
    loop {
        let words = &words[first / 64..first / 64 + 2];
        let both = u128::from(words[1]) << 64 | u128::from(words[0]);
        let bits = (both >> (first % 64)) as u64;
        let count = last + 1 - first;
        if count <= 64 {
            return bits << (64 - count) == 0;
        }
        if bits != 0 {
            return false;
        }
        first += 64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{CellState, GridFrame, LayerConfig, OccupancyGrid};
    use CornerRule::{Allow, Forbid};
    use proptest::prelude::*;

    fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    fn sees(rows: &[&str], corners: CornerRule, a: (i32, i32), b: (i32, i32)) -> bool {
        let map = map(rows);
        Sight::new(&map, corners).is_free(Cell::new(a.0, a.1), Cell::new(b.0, b.1))
    }

    #[test]
    fn crossings_by_hand() {
        let of = |width, height| {
            let crossings = Crossings::new(width, height);
            crossings.map(|c| (c.column, c.is_corner)).collect::<Vec<_>>()
        };
        assert_eq!(of(3, 0), []);
        // Half-way, in the middle of column 1.
        assert_eq!(of(2, 1), [(1, false)]);
        // Half-way, at x = 1.5: the corner before column 2.
        assert_eq!(of(3, 1), [(2, true)]);
        // At x = 5/4 and x = 15/4.
        assert_eq!(of(5, 2), [(1, false), (4, false)]);
        assert_eq!(of(2, 2), [(1, true), (2, true)]);
    }

    #[test]
    fn past_a_cell_and_through_it() {
        // From (0, 0) to (2, 1) the line crosses (1, 0) and (1, 1), and no other cell.
        for corners in [Forbid, Allow] {
            assert!(sees(&["#..", "..#"], corners, (0, 0), (2, 1)));
            assert!(!sees(&["##.", "..."], corners, (0, 0), (2, 1)));
            assert!(!sees(&["...", ".#."], corners, (2, 1), (0, 0)));
        }
    }

    #[test]
    fn through_a_corner() {
        // From (0, 0) to (3, 1) it passes the corner of (1, 0), (2, 0), (1, 1) and (2, 1).
        for rows in [[".#..", "...."], ["....", "..#."], [".#..", "..#."]] {
            assert!(!sees(&rows, Forbid, (0, 0), (3, 1)));
            assert!(sees(&rows, Allow, (0, 0), (3, 1)));
        }
        assert!(sees(&["#...", "...#"], Forbid, (0, 0), (3, 1)));
    }

    #[test]
    fn a_cell_sees_itself_and_where_it_can_step() {
        let map = map(&[".#.", "...", "..#"]);
        let at = Cell::new(1, 1);
        let visible = |corners: CornerRule| {
            let sight = Sight::new(&map, corners);
            let all = (0..9).map(|i| Cell::new(i % 3, i / 3));
            all.filter(|&to| sight.is_free(at, to)).map(|to| (to.x, to.y)).collect::<Vec<_>>()
        };
        assert_eq!(visible(Forbid), [(0, 0), (1, 0), (0, 1), (1, 1), (2, 1)]);
        assert_eq!(visible(Allow), [(0, 0), (1, 0), (0, 1), (1, 1), (2, 1), (0, 2), (2, 2)]);
    }

    /// The definition: the segment meets no blocked cell's open square, and, if corners are not
    /// cut, passes through no corner of a blocked cell. Lengths are doubled, so centres are odd
    /// numbers.
    fn sees_by_geometry(map: &SearchMap, corners: CornerRule, a: Cell, b: Cell) -> bool {
        let double = |cell: Cell| [i64::from(2 * cell.x + 1), i64::from(2 * cell.y + 1)];
        let (a2, b2) = (double(a), double(b));
        let side_of =
            |x: i64, y: i64| (b2[0] - a2[0]) * (y - a2[1]) - (b2[1] - a2[1]) * (x - a2[0]);
        for y in a.y.min(b.y)..=a.y.max(b.y) {
            for x in a.x.min(b.x)..=a.x.max(b.x) {
                let (x2, y2) = (i64::from(2 * x), i64::from(2 * y));
                // The box of the segment covers the cell's, so only the segment's line can
                // separate them.
                let sides = [(0, 0), (2, 0), (0, 2), (2, 2)].map(|(i, j)| side_of(x2 + i, y2 + j));
                let is_left = sides.iter().all(|&side| side >= 0) && a != b;
                let is_right = sides.iter().all(|&side| side <= 0) && a != b;
                let is_met = match corners {
                    Allow => !is_left && !is_right,
                    // A corner on the line touches all four cells around it.
                    Forbid => !is_left && !is_right || sides.contains(&0),
                };
                if is_met && !map.is_free(Cell::new(x, y)) {
                    return false;
                }
            }
        }
        true
    }

    fn random_map(width: u64, height: u64, seed: u64, one_in: u64) -> SearchMap {
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        let mut state = seed | 1;
        let grid = OccupancyGrid::from_fn(frame, |_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            if (state >> 20).is_multiple_of(one_in) { CellState::Occupied } else { CellState::Free }
        });
        SearchMap::new(&grid, LayerConfig::default()).unwrap()
    }

    #[test]
    fn every_pair_on_small_maps() {
        let (mut free, mut cut) = (0, 0);
        for seed in 1..60 {
            let map = random_map(9, 8, seed * 77, 5 + seed % 7);
            for (a, b) in (0..72).flat_map(|a| (0..72).map(move |b| (a, b))) {
                let (a, b) = (Cell::new(a % 9, a / 9), Cell::new(b % 9, b / 9));
                let [forbid, allow] = [Forbid, Allow].map(|corners| {
                    let found = Sight::new(&map, corners).is_free(a, b);
                    assert_eq!(found, sees_by_geometry(&map, corners, a, b), "{a} {b} {corners:?}");
                    found
                });
                free += u32::from(forbid);
                cut += u32::from(allow && !forbid);
            }
        }
        assert!(free > 10_000 && cut > 1000, "{free} {cut}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

        /// A line with one blocked cell near it, on maps with several words per row: all slopes
        /// and lengths.
        #[test]
        fn a_cell_near_the_line(a in (0i32..200, 0i32..140), b in (0i32..200, 0i32..140), seed: u64,
                                allow: bool, near in 0i32..=1000, off in (-1i32..=1, -1i32..=1)) {
            let corners = if allow { Allow } else { Forbid };
            let (a, b) = (Cell::new(a.0, a.1), Cell::new(b.0, b.1));
            let along = |a: i32, b: i32| a + (b - a) * near / 1000;
            let cell = Cell::new(along(a.x, b.x) + off.0, along(a.y, b.y) + off.1);
            let mut map = random_map(200, 140, seed, 4000);
            map.apply(&[crate::map::Edit { cell, state: CellState::Occupied }]);
            let sight = Sight::new(&map, corners);
            let expected = sees_by_geometry(&map, corners, a, b);
            prop_assert_eq!(sight.is_free(a, b), expected, "{} {} {}", a, b, cell);
            prop_assert_eq!(sight.is_free(b, a), expected);
        }

        /// Level and nearly level lines, with runs that begin and end at word boundaries.
        #[test]
        fn long_runs(left in 0i32..140, length in 0i32..260, rows in (0i32..3, 0i32..3),
                     blocked in (0i32..400, 0i32..3), turned: bool, allow: bool) {
            let corners = if allow { Allow } else { Forbid };
            let turn = |x, y| if turned { Cell::new(y, x) } else { Cell::new(x, y) };
            let (width, height) = if turned { (3, 400) } else { (400, 3) };
            let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
            let mut map = SearchMap::new(&OccupancyGrid::all_free(frame), LayerConfig::default()).unwrap();
            let cell = turn(blocked.0, blocked.1);
            map.apply(&[crate::map::Edit { cell, state: CellState::Occupied }]);
            let (a, b) = (turn(left, rows.0), turn(left + length, rows.1));
            let expected = sees_by_geometry(&map, corners, a, b);
            prop_assert_eq!(Sight::new(&map, corners).is_free(a, b), expected, "{} {} {}", a, b, cell);
        }
    }
}
