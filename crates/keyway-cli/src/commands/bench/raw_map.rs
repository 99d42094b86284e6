//! A MovingAI map as plain text, and the rules of its benchmark: the judge of all planners. It
//! shares nothing with them, not even the reader of maps.

use keyway::map::Cell;

/// Rows of the file, the top one first.
pub(super) struct RawMap {
    rows: Vec<Vec<u8>>,
}

impl RawMap {
    /// The rows after the line `map`. That they are whole is the reader's business.
    pub(super) fn new(text: &str) -> Self {
        let rows = text.lines().skip_while(|line| line.trim() != "map").skip(1);
        Self { rows: rows.map(|row| row.trim_end().as_bytes().to_vec()).collect() }
    }

    /// Whether a cell, counted from the lower left, can be passed.
    pub(super) fn is_passable(&self, cell: Cell) -> bool {
        // From the bottom to from the top.
        let row = usize::try_from(cell.y).ok().and_then(|y| self.height().checked_sub(y + 1));
        let tile = row.and_then(|row| self.rows[row].get(usize::try_from(cell.x).ok()?));
        matches!(tile, Some(b'.' | b'G' | b'S'))
    }

    fn height(&self) -> usize {
        // Empty lines at the end are no rows.
        self.rows.iter().rposition(|row| !row.is_empty()).map_or(0, |last| last + 1)
    }

    /// Length of a path \[cells\], or `None` when it does not lead from `start` to `goal`, leaves the
    /// passable cells, jumps, or cuts a corner.
    pub(super) fn legal_length(&self, path: &[Cell], start: Cell, goal: Cell) -> Option<f64> {
        let has_right_ends = path.first() == Some(&start) && path.last() == Some(&goal);
        if !has_right_ends || !self.is_passable(start) {
            return None;
        }
        path.windows(2).map(|step| self.step_length(step[0], step[1])).sum()
    }

    fn step_length(&self, from: Cell, to: Cell) -> Option<f64> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let corners_are_free = self.is_passable(Cell::new(to.x, from.y))
            && self.is_passable(Cell::new(from.x, to.y));
        if !self.is_passable(to) || !corners_are_free {
            return None;
        }
        match dx * dx + dy * dy {
            1 => Some(1.0),
            2 => Some(std::f64::consts::SQRT_2),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(path: &[(i32, i32)]) -> Option<f64> {
        // (2, 1) is blocked; the map is written with the line ends of Windows.
        let text = "type octile\r\nheight 3\r\nwidth 4\r\nmap\r\n....\r\n.G@S\r\n...T\r\n\r\n";
        let path: Vec<Cell> = path.iter().map(|&(x, y)| Cell::new(x, y)).collect();
        let map = RawMap::new(text);
        map.legal_length(&path, *path.first()?, *path.last()?)
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
            ("jump", vec![(0, 0), (2, 0)]),
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
        assert_eq!(map.legal_length(&path, Cell::new(0, 0), Cell::new(2, 0)), None, "wrong end");
        assert_eq!(map.legal_length(&[], Cell::new(0, 0), Cell::new(0, 0)), None);
    }
}
