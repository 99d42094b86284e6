//! Unknown obstacles on the route: connected sensed cells that are not on the known map.

use super::route_nodes::RouteNode;
use crate::geometry::Point;
use crate::map::{BitGrid, Cell, Clearance, GridFrame};

/// An unknown obstacle on the route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unknown {
    /// Arc length of the first node of the route that is too near to it \[m\].
    pub(super) along_m: f64,
    /// `x_ob`: the mean of the centres of its sensed cells \[m\].
    pub(super) centre: Point,
}

/// Connected cells. Their memory is kept from cycle to cycle.
#[derive(Debug)]
pub(super) struct Cluster {
    members: BitGrid,
    /// The members, in the order in which they were found.
    cells: Vec<Cell>,
}

impl Default for Cluster {
    fn default() -> Self {
        Self { members: BitGrid::new(0, 0, false), cells: Vec::new() }
    }
}

/// Parameters of the search for an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<'a> {
    /// The cells that were sensed.
    pub(super) sensed: Clearance<'a>,
    /// An obstacle nearer to a node than this is on the route \[m\].
    pub(super) clearance_m: f64,
    /// Position of the robot; only cells near it are considered \[m\].
    pub(super) robot: Point,
    /// Distance from the robot within which cells are considered \[m\].
    pub(super) range_m: f64,
}

impl Cluster {
    /// The obstacle on the first of these nodes that is not free. Of several sensed cells, the
    /// one nearest to the node counts.
    pub(super) fn first_on(
        &mut self,
        nodes: impl Iterator<Item = RouteNode>,
        search: &Search<'_>,
    ) -> Option<Unknown> {
        let mut found = nodes.filter_map(|node| Some((node.along_m, search.nearest(node.point)?)));
        let (along_m, seed) = found.next()?;
        Some(Unknown { along_m, centre: self.fill(seed, search) })
    }

    /// True if a cell belongs to the obstacle.
    pub(super) fn contains(&self, cell: Cell) -> bool {
        self.members.get(cell)
    }

    /// Collects all sensed cells that are connected with one of them, by an edge or a corner;
    /// returns the mean of their centres. The first one counts at any distance.
    fn fill(&mut self, seed: Cell, search: &Search<'_>) -> Point {
        let (frame, sensed) = (search.sensed.frame(), search.sensed.obstacles());
        self.clear(frame);
        self.members.set(seed, true);
        self.cells.push(seed);
        let (mut next, mut sum) = (0, Point::default());
        while let Some(&cell) = self.cells.get(next) {
            next += 1;
            sum = sum + frame.world_from_cell(cell);
            for (dx, dy) in NEIGHBOURS {
                let beside = Cell::new(cell.x + dx, cell.y + dy);
                let is_near =
                    || frame.world_from_cell(beside).distance(search.robot) <= search.range_m;
                if sensed.get(beside) && is_near() && self.members.set(beside, true) {
                    self.cells.push(beside);
                }
            }
        }
        sum * (1.0 / self.cells.len() as f64)
    }

    fn clear(&mut self, frame: &GridFrame) {
        for cell in self.cells.drain(..) {
            self.members.set(cell, false);
        }
        if (self.members.width(), self.members.height()) != (frame.width(), frame.height()) {
            self.members = BitGrid::new(frame.width(), frame.height(), false);
        }
    }
}

const NEIGHBOURS: [(i32, i32); 8] =
    [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

impl Search<'_> {
    /// The sensed cell whose square is nearest to a point, if one is nearer than the clearance.
    /// Ties go to the lowest, then the leftmost.
    fn nearest(&self, point: Point) -> Option<Cell> {
        let reach_m = self.clearance_m;
        let nearest_m = self.sensed.of_point(point, reach_m);
        if nearest_m >= reach_m {
            return None;
        }
        let frame = self.sensed.frame();
        let (grid, cell_m) = (frame.grid_from_world(point), frame.resolution_m());
        let reach = nearest_m / cell_m + 1e-9;
        let beside = |corner: i32, at: f64| {
            (f64::from(corner) - at).max(at - f64::from(corner) - 1.0).max(0.0)
        };
        // A square begins up to a cell before it comes within reach.
        let first = |at: f64| (at - reach - 1.0).floor() as i32;
        let last = |at: f64| (at + reach).floor() as i32;
        (first(grid.y)..=last(grid.y)).find_map(|y| {
            let mut row = self.sensed.obstacles().ones_in_span(y, first(grid.x), last(grid.x));
            let is_nearest = |&x: &i32| libm::hypot(beside(x, grid.x), beside(y, grid.y)) <= reach;
            row.find(is_nearest).map(|x| Cell::new(x, y))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::OccupancyGrid;

    fn node(x: f64, y: f64) -> RouteNode {
        RouteNode { point: Point::new(x, y), along_m: x }
    }

    #[test]
    fn connected_cells_by_hand() {
        let map = OccupancyGrid::from_ascii(&["......#.", "...#....", "..#..#..", "........"]);
        let sensed = Clearance::new(map.frame(), map.occupied());
        let robot = Point::new(0.5, 0.5);
        let search = Search { sensed, clearance_m: 0.8, robot, range_m: 9.0 };
        let mut cluster = Cluster::default();
        let route = |y: f64| (0..8).map(move |x| node(f64::from(x) + 0.5, y));
        // (2, 1) and (3, 2) touch at a corner; the node at 1.5 m keeps 0.71 m from (2, 1).
        let both = Unknown { along_m: 1.5, centre: Point::new(3.0, 2.0) };
        assert_eq!(cluster.first_on(route(0.5), &search), Some(both));
        assert!(cluster.contains(Cell::new(3, 2)) && !cluster.contains(Cell::new(5, 1)));
        // Here it keeps 0.9 m, and the next one 0.75 m.
        let lower = Unknown { along_m: 2.5, ..both };
        assert_eq!(cluster.first_on(route(0.25), &search), Some(lower));
        let narrow = Search { clearance_m: 0.5, ..search };
        assert_eq!(cluster.first_on(route(0.5), &narrow), None, "exactly the clearance is enough");
        // Farther on, only the other one is found.
        let alone = Unknown { along_m: 4.5, centre: Point::new(5.5, 1.5) };
        assert_eq!(cluster.first_on(route(0.5).skip(4), &search), Some(alone));
        // The second cell of the pair is 3.61 m away.
        let short = Search { range_m: 3.5, ..search };
        let one = Unknown { along_m: 1.5, centre: Point::new(2.5, 1.5) };
        assert_eq!(cluster.first_on(route(0.5), &short), Some(one));
        assert!(!cluster.contains(Cell::new(3, 2)), "forgotten");
    }

    #[test]
    fn the_nearest_cell_counts() {
        let map = OccupancyGrid::from_ascii(&["#......", ".......", "......#"]);
        let sensed = Clearance::new(map.frame(), map.occupied());
        let search = Search { sensed, clearance_m: 9.0, robot: Point::default(), range_m: 99.0 };
        assert_eq!(search.nearest(Point::new(3.0, 1.6)), Some(Cell::new(0, 2)));
        assert_eq!(search.nearest(Point::new(4.0, 1.5)), Some(Cell::new(6, 0)));
        assert_eq!(search.nearest(Point::new(3.5, 1.5)), Some(Cell::new(6, 0)), "the lowest");
        assert_eq!(search.nearest(Point::new(6.2, 0.9)), Some(Cell::new(6, 0)), "inside it");
    }
}
