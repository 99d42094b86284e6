//! The graph of corner cells in sight of each other.

use super::corners::Corners;
use super::sight::{STEPS, scan};
use crate::map::{BitGrid, Cell, SearchMap};
use crate::search::Cost;
use crate::search::bit_scan::is_set;

/// An edge of the graph of corner cells, from the node that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) to: u32,
    pub(super) key: u64,
}

/// The graph of corner cells, numbered by [`Corners::number`]. Each is joined with those that are
/// *directly reachable* from it \[Uras2013\]: no path to it is longer than the octile distance,
/// and none of that length meets another corner cell. A shortest path between two corner cells is
/// such a path or a sequence of them.
pub(super) fn corner_graph(map: &SearchMap, corners: &Corners) -> Vec<Vec<Edge>> {
    let scanner = Scanner::new(map, corners);
    corners.iter().map(|corner| scanner.edges(corner)).collect()
}

/// Scans that end at any corner cell, from either side.
pub(super) struct Scanner<'m> {
    corners: &'m Corners,
    cramped: &'m BitGrid,
    /// Blocked and corner cells; then the same with columns and rows exchanged.
    stops: BitGrid,
    stops_transposed: BitGrid,
}

/// The end of a straight scan, and the number of its steps (at least one).
#[derive(Clone, Copy)]
struct Scan {
    stop: Cell,
    steps: u32,
}

impl<'m> Scanner<'m> {
    pub(super) fn new(map: &'m SearchMap, corners: &'m Corners) -> Self {
        let mut stops = map.blocked().clone();
        stops.merge(corners.cells());
        let stops_transposed = stops.transposed();
        Self { corners, cramped: &map.stops().cramped, stops, stops_transposed }
    }

    /// The edges of a corner cell: see [`corner_graph`].
    pub(super) fn edges(&self, corner: Cell) -> Vec<Edge> {
        let mut edges = Vec::new();
        self.in_sight(corner, |at, cost| {
            edges.push(Edge { to: self.corners.number(at) as u32, key: cost.key() });
        });
        edges
    }

    /// Calls `found` for every directly reachable corner cell, with the path's length.
    fn in_sight(&self, from: Cell, mut found: impl FnMut(Cell, Cost)) {
        let straight: [Scan; 4] = std::array::from_fn(|direction| self.scan(from, direction));
        for (quarter, scan) in straight.iter().enumerate() {
            if self.corners.contains(scan.stop) {
                found(scan.stop, Cost::new(u64::from(scan.steps), 0));
            }
            let limits = [*scan, straight[(quarter + 1) % 4]].map(|scan| scan.steps - 1);
            self.in_quarter(from, quarter, limits, &mut found);
        }
    }

    /// Walks the diagonal of a quadrant. Scans to either side of it reach no further than the
    /// shortest previous one on that side.
    fn in_quarter(
        &self,
        from: Cell,
        quarter: usize,
        mut limits: [u32; 2],
        found: &mut impl FnMut(Cell, Cost),
    ) {
        let sides = [quarter, (quarter + 1) % 4];
        let (a, b) = (STEPS[sides[0]], STEPS[sides[1]]);
        let step = (a.0 + b.0, a.1 + b.1);
        let (mut at, mut diagonal) = (from, 0);
        while self.is_diagonal_free(at, step) {
            at = Cell::new(at.x + step.0, at.y + step.1);
            diagonal += 1;
            if self.corners.contains(at) {
                found(at, Cost::new(0, diagonal));
                return;
            }
            for (side, limit) in sides.into_iter().zip(&mut limits).filter(|(_, l)| **l > 0) {
                let scan = self.scan(at, side);
                if scan.steps <= *limit {
                    *limit = scan.steps - 1;
                    if self.corners.contains(scan.stop) {
                        found(scan.stop, Cost::new(u64::from(scan.steps), diagonal));
                    }
                }
            }
        }
    }

    fn is_diagonal_free(&self, at: Cell, step: (i32, i32)) -> bool {
        let (x, y) = (at.x + step.0.min(0), at.y + step.1.min(0));
        let bit = (y + 1) as usize * self.cramped.stride() + (x + 1) as usize;
        !is_set(self.cramped.words(), bit)
    }

    fn scan(&self, from: Cell, direction: usize) -> Scan {
        let is_row = direction.is_multiple_of(2);
        let (grid, line, along) = if is_row {
            (&self.stops, from.y, from.x)
        } else {
            (&self.stops_transposed, from.x, from.y)
        };
        let at = (along + 1) as usize;
        let stop = scan(grid.row(line), at, direction < 2);
        let along = stop as i32 - 1;
        let cell = if is_row { Cell::new(along, line) } else { Cell::new(line, along) };
        Scan { stop: cell, steps: stop.abs_diff(at) as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    /// The definition: all octile paths between two cells are free, and no corner cell lies on
    /// one.
    fn is_direct(map: &SearchMap, corners: &Corners, from: Cell, to: Cell) -> bool {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let (sign_x, sign_y) = (dx.signum(), dy.signum());
        let straight = if dx.abs() > dy.abs() { (sign_x, 0) } else { (0, sign_y) };
        let diagonals = dx.abs().min(dy.abs());
        let straights = dx.abs().max(dy.abs()) - diagonals;
        let at = |d: i32, s: i32| {
            Cell::new(from.x + d * sign_x + s * straight.0, from.y + d * sign_y + s * straight.1)
        };
        let free = |cell: Cell| map.is_free(cell);
        (0..=diagonals).flat_map(|d| (0..=straights).map(move |s| (d, s))).all(|(d, s)| {
            let cell = at(d, s);
            let is_end = cell == from || cell == to;
            let beside = Cell::new(cell.x + sign_x, cell.y);
            let above = Cell::new(cell.x, cell.y + sign_y);
            let steps = d == diagonals || (free(beside) && free(above));
            free(cell) && steps && (is_end || !corners.contains(cell))
        })
    }

    #[test]
    fn edges_are_what_the_definition_says() {
        let maps: [&[&str]; 4] = [
            &["......", ".##.#.", "....#.", ".#....", "...##.", "......"],
            &["..........", "..#....#..", "..........", ".....#....", ".#........", "........#."],
            &["....#....", "....#....", ".........", "....#....", "##.###.##", "........."],
            &["...", ".#.", "..."],
        ];
        for rows in maps {
            let grid = OccupancyGrid::from_ascii(rows);
            let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
            let corners = Corners::new(&map);
            let cells: Vec<Cell> = corners.iter().collect();
            for (node, edges) in corner_graph(&map, &corners).iter().enumerate() {
                let from = cells[node];
                let mut found: Vec<Cell> = edges.iter().map(|e| cells[e.to as usize]).collect();
                found.sort_unstable();
                let is_expected = |&to: &Cell| to != from && is_direct(&map, &corners, from, to);
                let mut expected: Vec<Cell> = cells.iter().copied().filter(is_expected).collect();
                expected.sort_unstable();
                assert_eq!(found, expected, "{from} of {rows:?}");
                for edge in edges {
                    let to = cells[edge.to as usize];
                    let way = Cost::octile(to.x.abs_diff(from.x), to.y.abs_diff(from.y));
                    assert_eq!(edge.key, way.key());
                }
            }
        }
    }
}
