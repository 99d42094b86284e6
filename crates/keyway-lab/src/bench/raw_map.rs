//! A MovingAI map as plain text, with the rules of its benchmark. It checks the paths of all
//! planners and shares no code with them, not even the reader of maps.

use keyway::map::Cell;
use keyway::search::CornerRule;

/// Rows of the file, the top one first.
pub struct RawMap {
    rows: Vec<Vec<u8>>,
}

impl RawMap {
    /// Reads the rows after the line `map` of a file's text. The reader checks that they are
    /// complete.
    pub fn new(text: &str) -> Self {
        let rows = text.lines().skip_while(|line| line.trim() != "map").skip(1);
        Self { rows: rows.map(|row| row.trim_end().as_bytes().to_vec()).collect() }
    }

    /// True if a cell, counted from the lower left, can be passed.
    pub(super) fn is_passable(&self, cell: Cell) -> bool {
        // Converts a row counted from the bottom to one counted from the top.
        let row = usize::try_from(cell.y).ok().and_then(|y| self.height().checked_sub(y + 1));
        let tile = row.and_then(|row| self.rows[row].get(usize::try_from(cell.x).ok()?));
        matches!(tile, Some(b'.' | b'G' | b'S'))
    }

    fn height(&self) -> usize {
        // Empty lines at the end are not rows.
        self.rows.iter().rposition(|row| !row.is_empty()).map_or(0, |last| last + 1)
    }

    /// Length of a path \[cells\]; `None` if it does not lead from `start` to `goal`, leaves the
    /// passable cells, contains a step of zero length, or cuts a corner that must not be cut.
    /// Legs between waypoints that are not neighbours are swept.
    pub(super) fn legal_length(
        &self,
        path: &[Cell],
        (start, goal): (Cell, Cell),
        corners: CornerRule,
    ) -> Option<f64> {
        let has_right_ends = path.first() == Some(&start) && path.last() == Some(&goal);
        if !has_right_ends || !self.is_passable(start) {
            return None;
        }
        let is_clear = |leg: &[Cell]| {
            leg[0] != leg[1] && swept(leg[0], leg[1], corners).all(|cell| self.is_passable(cell))
        };
        let length =
            |leg: &[Cell]| f64::from(leg[1].x - leg[0].x).hypot(f64::from(leg[1].y - leg[0].y));
        let sum = || path.windows(2).map(length).fold(0.0, |sum, length| sum + length);
        path.windows(2).all(is_clear).then(sum)
    }
}

/// The cells that must be passable for a straight leg from centre to centre: those whose interior
/// it crosses, and, if it passes a common corner of four cells, all four of them, unless corners
/// may be cut.
fn swept(from: Cell, to: Cell, corners: CornerRule) -> impl Iterator<Item = Cell> {
    // Sweeps the axis with more cells, so that there are at most two cells per column.
    let is_steep = (to.x - from.x).abs() < (to.y - from.y).abs();
    let turned = move |cell: Cell| if is_steep { Cell::new(cell.y, cell.x) } else { cell };
    let (a, b) = (turned(from), turned(to));
    let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
    let (dx, dy) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
    (a.x..=b.x).flat_map(move |x| {
        // Range of rows of a column, from the height at which the leg enters it to the height at
        // which it leaves. Heights are fractions with the denominator 2 dx.
        let height =
            |line: i32| (2 * i64::from(a.y) + 1) * dx + (2 * i64::from(line - a.x) - 1) * dy;
        let row = |height: i64| height.div_euclid(2 * dx);
        let is_corner = |height: i64| height.rem_euclid(2 * dx) == 0;
        let enter = if x == a.x { (2 * i64::from(a.y) + 1) * dx } else { height(x) };
        let leave = if x == b.x { (2 * i64::from(b.y) + 1) * dx } else { height(x + 1) };
        let (low, high) = (enter.min(leave), enter.max(leave));
        let (mut first, mut last) = if dx == 0 {
            (i64::from(a.y), i64::from(a.y))
        } else {
            // A height at a corner does not belong to the row above it, unless corners count.
            (row(low), if is_corner(high) && low < high { row(high) - 1 } else { row(high) })
        };
        if dx > 0 && corners == CornerRule::Forbid {
            last = row(high);
            first = if is_corner(low) { row(low) - 1 } else { first };
        }
        (first..=last).map(move |y| turned(Cell::new(x, y as i32)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(path: &[(i32, i32)]) -> Option<f64> {
        length_by(path, CornerRule::Forbid)
    }

    fn length_by(path: &[(i32, i32)], corners: CornerRule) -> Option<f64> {
        // (2, 1) is blocked; the map has Windows line endings.
        let text = "type octile\r\nheight 3\r\nwidth 4\r\nmap\r\n....\r\n.G@S\r\n...T\r\n\r\n";
        let path: Vec<Cell> = path.iter().map(|&(x, y)| Cell::new(x, y)).collect();
        let map = RawMap::new(text);
        map.legal_length(&path, (*path.first()?, *path.last()?), corners)
    }

    #[test]
    fn legal_paths_are_measured() {
        assert_eq!(length(&[(0, 0)]), Some(0.0));
        assert_eq!(length(&[(0, 0), (1, 0), (1, 1)]), Some(2.0));
        let expected = 2.0 + std::f64::consts::SQRT_2;
        let around = length(&[(0, 1), (1, 2), (2, 2), (3, 2)]);
        assert!((around.unwrap() - expected).abs() < 1e-12);
        assert_eq!(length(&[(3, 2), (3, 1)]), Some(1.0), "S is passable");
    }

    #[test]
    fn illegal_paths_are_found() {
        for (what, path) in [
            ("through an obstacle", vec![(1, 1), (2, 1)]),
            ("corner cut", vec![(1, 1), (2, 2)]),
            ("other corner cut", vec![(2, 0), (3, 1)]),
            ("leg through an obstacle", vec![(0, 0), (3, 2)]),
            ("leg along a corner", vec![(0, 2), (3, 0)]),
            ("standing still", vec![(0, 0), (0, 0)]),
            ("off the map", vec![(0, 0), (0, -1)]),
            ("above the map", vec![(0, 2), (0, 3)]),
            ("a tree", vec![(2, 0), (3, 0)]),
            ("starts in an obstacle", vec![(2, 1)]),
        ] {
            assert_eq!(length(&path), None, "{what}");
        }
        let map = RawMap::new("map\n...\n");
        let path = [Cell::new(0, 0), Cell::new(1, 0)];
        let judge = |path: &[Cell], goal| {
            map.legal_length(path, (Cell::new(0, 0), goal), CornerRule::Forbid)
        };
        assert_eq!(judge(&path, Cell::new(2, 0)), None, "wrong end");
        assert_eq!(judge(&[], Cell::new(0, 0)), None);
    }

    #[test]
    fn corners_may_be_cut_where_the_planner_may() {
        assert_eq!(length_by(&[(1, 1), (2, 2)], CornerRule::Allow), Some(2.0_f64.sqrt()));
        assert_eq!(length_by(&[(1, 1), (2, 1)], CornerRule::Allow), None);
    }

    /// Compares every leg within 7 x 7 cells with a geometric test of each single cell.
    #[test]
    fn swept_cells_are_those_that_a_leg_crosses() {
        for (dx, dy) in (-6..=6).flat_map(|dx| (-6..=6).map(move |dy| (dx, dy))) {
            let (from, to) = (Cell::new(10, 10), Cell::new(10 + dx, 10 + dy));
            for corners in [CornerRule::Forbid, CornerRule::Allow] {
                let mut found: Vec<Cell> = swept(from, to, corners).collect();
                found.sort_by_key(|cell| (cell.x, cell.y));
                let around = (0..=20).flat_map(|x| (0..=20).map(move |y| Cell::new(x, y)));
                let expected: Vec<Cell> =
                    around.filter(|&cell| is_crossed((dx, dy), from, cell, corners)).collect();
                assert_eq!(found, expected, "({dx}, {dy}) {corners:?}");
            }
        }
    }

    /// True if the leg meets the cell's square: its interior, or any of its corners. In a frame
    /// along the leg, a square is met if its corners lie on both sides of the leg's line and its
    /// extent along the leg overlaps that of the leg.
    fn is_crossed((dx, dy): (i32, i32), from: Cell, cell: Cell, corners: CornerRule) -> bool {
        let at = [(0, 0), (2, 0), (0, 2), (2, 2)]
            .map(|(cx, cy)| (2 * (cell.x - from.x) + cx - 1, 2 * (cell.y - from.y) + cy - 1));
        let across = at.map(|(x, y)| dx * y - dy * x);
        let (low, high) = (*across.iter().min().unwrap(), *across.iter().max().unwrap());
        let (right, left) = (2 * dx.max(0), 2 * dx.min(0));
        let (top, bottom) = (2 * dy.max(0), 2 * dy.min(0));
        let touches = |a: i32, b: i32, least: i32, most: i32| a < most && b > least;
        let in_box = touches(at[0].0, at[3].0, left.min(right) - 1, right.max(left) + 1)
            && touches(at[0].1, at[3].1, bottom - 1, top + 1);
        let within = if corners == CornerRule::Forbid && dx != 0 && dy != 0 {
            low <= 0 && high >= 0
        } else {
            low < 0 && high > 0 || (dx, dy) == (0, 0)
        };
        in_box && within
    }
}
