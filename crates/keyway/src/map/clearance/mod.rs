//! Exact Euclidean distances from points and lines to the nearest obstacle square.

mod cubics;
mod curves;
mod expanded;
mod scan;

pub use curves::ClearanceBounds;

use crate::geometry::{Point, Polyline, Segment, Square};
use crate::map::cell::floor_to_i32;
use crate::map::layers::dilation::CLEARANCE_TOLERANCE;
use crate::map::{BitGrid, Cell, GridFrame};

/// Tolerance \[cells\]: a line that enters a square by less than this touches its border, because
/// coordinates such as 1/3 are rounded.
pub(in crate::map) const TOUCH_TOLERANCE_CELLS: f64 = 1e-9;

/// Distance queries on the obstacle cells of a map, in world coordinates.
///
/// Distances are measured to the obstacle cells' *squares*: 0 on a square's border and inside.
/// The area outside the map does not count as an obstacle for a distance, but no line and no
/// footprint may leave the map. A query reads only the rows within its reach, 64 cells at a time.
#[derive(Clone, Copy, Debug)]
pub struct Clearance<'a> {
    pub(in crate::map) frame: &'a GridFrame,
    pub(in crate::map) obstacles: &'a BitGrid,
}

/// Reason why a segment is not clear.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Obstruction {
    /// The segment comes too close to the map's border, or leaves the map.
    Border,
    /// The segment comes too close to an obstacle square \[cells\].
    Obstacle(Square),
}

impl<'a> Clearance<'a> {
    /// Distances to the set bits of `obstacles`, a grid of `frame`'s size.
    pub const fn new(frame: &'a GridFrame, obstacles: &'a BitGrid) -> Self {
        Self { frame, obstacles }
    }

    /// Geometry of the map: size, resolution and origin.
    pub const fn frame(&self) -> &'a GridFrame {
        self.frame
    }

    /// The obstacle cells.
    pub const fn obstacles(&self) -> &'a BitGrid {
        self.obstacles
    }

    /// Distance from a point to the nearest obstacle square \[m\]; `reach_m` if none is nearer
    /// than that. A non-finite position has no clearance: 0.
    pub fn of_point(&self, point: Point, reach_m: f64) -> f64 {
        if !point.is_finite() {
            return 0.0;
        }
        let (grid, reach) =
            (self.frame.grid_from_world(point), reach_m / self.frame.resolution_m());
        self.within_m(self.of_grid_point(grid, reach, |_| {}), (reach.powi(2).sqrt(), reach_m))
    }

    /// The obstacle square nearest to a point, if one is nearer than `reach` \[cells\].
    pub(crate) fn nearest_square(&self, grid: Point, reach: f64) -> Option<Square> {
        let mut nearest = None;
        self.of_grid_point(grid, reach, |square| nearest = Some(square));
        nearest
    }

    /// Distance from a point to the nearest square, up to a reach \[cells\]. Calls `nearer` for
    /// each square that is nearer than all before it.
    fn of_grid_point(&self, grid: Point, reach: f64, mut nearer: impl FnMut(Square)) -> f64 {
        let mut best_sq = reach.powi(2);
        let row = floor_to_i32(grid.y).clamp(0, self.obstacles.height() as i32 - 1);
        let column = floor_to_i32(grid.x);
        let reach = best_sq.sqrt();
        let all =
            self.obstacles.columns(floor_to_i32(grid.x - reach), floor_to_i32(grid.x + reach));
        // Rows in order of their distance, alternately above and below.
        for step in 0.. {
            let mut in_reach = false;
            let rows = [row.saturating_add(step), row.saturating_sub(step)];
            for &y in &rows[..if step == 0 { 1 } else { 2 }] {
                let dy = (f64::from(y) - grid.y).max(grid.y - f64::from(y) - 1.0).max(0.0);
                if dy * dy >= best_sq || !self.has_rows_beyond(y, row) {
                    continue;
                }
                in_reach = true;
                if all.is_some_and(|columns| !self.obstacles.any_in_columns(y, &columns)) {
                    continue;
                }
                let half = (best_sq - dy * dy).sqrt();
                let (from, to) = (floor_to_i32(grid.x - half), floor_to_i32(grid.x + half));
                let right = self.obstacles.first_one_in_span(y, column, to);
                let left = self.obstacles.last_one_in_span(y, from, column);
                for x in right.into_iter().chain(left) {
                    let square = square(x, y);
                    let distance_sq = square.distance_sq_to_point(grid);
                    if distance_sq < best_sq {
                        best_sq = distance_sq;
                        nearer(square);
                    }
                }
            }
            if !in_reach {
                break;
            }
        }
        best_sq.sqrt()
    }

    /// Converts a distance \[cells\] to metres if it is less than the reach, which is given in
    /// cells and in metres. Otherwise it returns the reach itself, to the last digit: callers
    /// tell by it that no obstacle is near.
    pub(in crate::map) fn within_m(&self, distance: f64, (reach, reach_m): (f64, f64)) -> f64 {
        if distance < reach { (distance * self.frame.resolution_m()).min(reach_m) } else { reach_m }
    }

    /// True while row `y`, reached from `start` outwards, has grid rows at or beyond it.
    fn has_rows_beyond(&self, y: i32, start: i32) -> bool {
        let height = self.obstacles.height() as i32;
        if y >= start && y < height {
            return true;
        }
        y <= start && y >= 0
    }

    /// Distance from a segment to the nearest obstacle square \[m\]; `reach_m` if none is nearer
    /// than that.
    pub fn of_segment(&self, segment: Segment, reach_m: f64) -> f64 {
        // The clearances of the end points limit the reach of the scan.
        let near_m = self.of_point(segment.b, self.of_point(segment.a, reach_m));
        self.of_segment_within(segment, near_m)
    }

    /// Like [`Self::of_segment`], but always scans up to the full reach.
    pub(in crate::map) fn of_segment_within(&self, segment: Segment, reach_m: f64) -> f64 {
        let grid = self.to_grid(segment);
        let mut best_sq = (reach_m / self.frame.resolution_m()).powi(2);
        let reach = best_sq.sqrt();
        let (along, length) = (grid.b - grid.a, grid.length());
        self.scan(grid, reach, |square| {
            // Most squares are ruled out by their distance from the segment's line.
            let middle = square.corner + Point::new(0.5, 0.5) - grid.a;
            let from_line = along.cross(middle).abs() - 0.5 * (along.x.abs() + along.y.abs());
            if from_line <= best_sq.sqrt() * length {
                best_sq = best_sq.min(grid.distance_sq_to_square(square));
            }
            best_sq > 0.0
        });
        self.within_m(best_sq.sqrt(), (reach, reach_m))
    }

    /// Distance from a line to the nearest obstacle square \[m\]; `None` if the map has no
    /// obstacle or the line no point.
    pub fn of_line(&self, line: &Polyline) -> Option<f64> {
        // Turns are often near obstacles: their clearance limits the reach of the scans.
        let turns = line.merged();
        let near_turns =
            turns.points().iter().fold(f64::INFINITY, |near, &turn| self.of_point(turn, near));
        // The clearance of the turns is infinite only if the map has no obstacle.
        let nearer = |nearest, segment| self.of_segment(segment, nearest);
        near_turns.is_finite().then(|| line.segments().fold(near_turns, nearer))
    }

    /// True when the segment stays inside the map and keeps `clearance_m` from every obstacle
    /// square. For a clearance of 0 the segment may touch a square's corner or edge, but neither
    /// enter a square nor slip between two squares that share the touched corner or edge.
    pub fn is_clear(&self, segment: Segment, clearance_m: f64) -> bool {
        self.obstruction(segment, clearance_m).is_none()
    }

    /// The reason why a segment is not clear ([`Self::is_clear`]); of several obstacles, one near
    /// its first end.
    pub(crate) fn obstruction(&self, segment: Segment, clearance_m: f64) -> Option<Obstruction> {
        if !self.is_on_map(segment, clearance_m) {
            return Some(Obstruction::Border);
        }
        let grid = self.to_grid(segment);
        let margin = self.margin(clearance_m);
        // A margin whose square underflows to 0 does not count.
        let found = if margin * margin > 0.0 {
            self.first_within(grid, margin)
        } else {
            self.first_crossed(grid)
        };
        found.map(Obstruction::Obstacle)
    }

    /// The first square that a segment in grid coordinates enters or slips past.
    fn first_crossed(&self, grid: Segment) -> Option<Square> {
        self.first_that(grid, 0.0, |square| enters(grid, square) || self.slips_past(grid, square))
    }

    /// True if a segment in grid coordinates crosses no obstacle; touching is allowed as in
    /// [`Self::is_clear`]. A segment that begins inside a square is always allowed, because the
    /// test cannot tell leaving the square from entering it.
    pub(in crate::map) fn crosses_nothing(&self, grid: Segment) -> bool {
        let begin = Segment::new(grid.a, grid.a);
        self.first_crossed(grid).is_none()
            || self.first_that(begin, 0.0, |square| enters(begin, square)).is_some()
    }

    /// True if a segment stays inside the map and keeps a clearance from its border.
    pub(crate) fn is_on_map(&self, segment: Segment, clearance_m: f64) -> bool {
        let (grid, margin) = (self.to_grid(segment), self.margin(clearance_m));
        self.is_inside(grid.a, margin) && self.is_inside(grid.b, margin)
    }

    /// The margin that a clearance requires \[cells\].
    pub(crate) fn margin(&self, clearance_m: f64) -> f64 {
        clearance_m / self.frame.resolution_m() * (1.0 - CLEARANCE_TOLERANCE)
    }

    /// An obstacle square nearer to a segment than a distance; of several, one near its first
    /// end.
    pub(crate) fn obstacle_within(&self, segment: Segment, distance_m: f64) -> Option<Square> {
        let distance = distance_m / self.frame.resolution_m();
        if distance > 0.0 { self.first_within(self.to_grid(segment), distance) } else { None }
    }

    fn first_within(&self, grid: Segment, distance: f64) -> Option<Square> {
        let limit_sq = distance * distance;
        self.first_that(grid, distance, |square| grid.distance_sq_to_square(square) < limit_sq)
    }

    /// The first square within reach \[cells\] for which `holds` is true.
    fn first_that(
        &self,
        grid: Segment,
        reach: f64,
        holds: impl Fn(Square) -> bool,
    ) -> Option<Square> {
        let mut found = None;
        self.scan(grid, reach, |square| {
            found = holds(square).then_some(square);
            found.is_none()
        });
        found
    }

    /// True when a disc of `radius_m` around a point lies inside the map and does not come nearer
    /// than that to any obstacle square; for a radius of 0 the point may lie on a square's border.
    pub fn is_clear_point(&self, point: Point, radius_m: f64) -> bool {
        self.is_clear(Segment::new(point, point), radius_m)
    }

    /// Distance from a point to the map's border \[m\]; negative outside the map.
    pub fn to_border(&self, point: Point) -> f64 {
        self.grid_to_border(self.frame.grid_from_world(point)) * self.frame.resolution_m()
    }

    /// Distance from a point in grid coordinates to the map's border \[cells\].
    pub(in crate::map) fn grid_to_border(&self, grid: Point) -> f64 {
        let (width, height) = (f64::from(self.frame.width()), f64::from(self.frame.height()));
        grid.x.min(grid.y).min(width - grid.x).min(height - grid.y)
    }

    /// True for a point that lies at least `margin` \[cells\] inside the map.
    pub(in crate::map) fn is_inside(&self, grid: Point, margin: f64) -> bool {
        let slack = margin - TOUCH_TOLERANCE_CELLS;
        grid.x >= slack
            && grid.y >= slack
            && grid.x <= f64::from(self.frame.width()) - slack
            && grid.y <= f64::from(self.frame.height()) - slack
    }

    pub(crate) fn to_grid(self, segment: Segment) -> Segment {
        Segment::new(self.frame.grid_from_world(segment.a), self.frame.grid_from_world(segment.b))
    }

    /// True for a point \[cells\] in an obstacle square.
    pub(in crate::map) fn is_obstacle(&self, grid: Point) -> bool {
        self.obstacles.get(Cell::new(floor_to_i32(grid.x), floor_to_i32(grid.y)))
    }

    /// True if a segment that touches `touched` runs between it and another obstacle square.
    pub(in crate::map) fn slips_past(&self, segment: Segment, touched: Square) -> bool {
        let (x, y) = (touched.corner.x, touched.corner.y);
        let at = |dx: i32, dy: i32| self.obstacles.get(Cell::new(x as i32 + dx, y as i32 + dy));
        let near = |a: f64, b: f64| (a - b).abs() <= TOUCH_TOLERANCE_CELLS;
        let on_line = |p: Point| {
            segment.distance_sq_to_point(p) <= TOUCH_TOLERANCE_CELLS * TOUCH_TOLERANCE_CELLS
        };
        // Along an edge: the square on its other side. A wall that ends at the map's border
        // leaves no gap there, so cells outside the map count as solid.
        let beyond = |dx: i32, dy: i32| {
            let cell = Cell::new(x as i32 + dx, y as i32 + dy);
            !self.frame.contains(cell) || self.obstacles.get(cell)
        };
        let (a, b) = (segment.a, segment.b);
        let overlaps = |low: f64, a: f64, b: f64| {
            a.max(b) > low + TOUCH_TOLERANCE_CELLS && a.min(b) < low + 1.0 - TOUCH_TOLERANCE_CELLS
        };
        let is_upright = near(a.x, b.x) && overlaps(y, a.y, b.y);
        let is_level = near(a.y, b.y) && overlaps(x, a.x, b.x);
        if is_upright && ((near(a.x, x) && beyond(-1, 0)) || (near(a.x, x + 1.0) && beyond(1, 0)))
            || is_level && ((near(a.y, y) && beyond(0, -1)) || (near(a.y, y + 1.0) && beyond(0, 1)))
        {
            return true;
        }
        // At a corner: the square diagonally across.
        [(-1, -1), (1, -1), (1, 1), (-1, 1)].iter().any(|&(dx, dy)| {
            let corner = Point::new(x + f64::from(dx.max(0)), y + f64::from(dy.max(0)));
            at(dx, dy) && on_line(corner)
        })
    }
}

pub(in crate::map) fn square(x: i32, y: i32) -> Square {
    Square { corner: Point::new(f64::from(x), f64::from(y)) }
}

/// True if the segment enters the square's interior by more than the tolerance.
pub(in crate::map) fn enters(segment: Segment, square: Square) -> bool {
    let shrunk = 1.0 - 2.0 * TOUCH_TOLERANCE_CELLS;
    let inner = square.corner + Point::new(TOUCH_TOLERANCE_CELLS, TOUCH_TOLERANCE_CELLS);
    // The slab test of the unit square, on coordinates scaled to map the shrunk square onto it.
    let scale = |p: Point| (p - inner) * (1.0 / shrunk);
    Segment::new(scale(segment.a), scale(segment.b)).meets(Square { corner: Point::new(0.0, 0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{LayerConfig, OccupancyGrid, SearchMap};
    use proptest::prelude::*;

    fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    fn clear(map: &SearchMap, a: [f64; 2], b: [f64; 2], clearance_m: f64) -> bool {
        let there = Segment::new(a.into(), b.into());
        let back = Segment::new(b.into(), a.into());
        let clear = map.clearance().is_clear(there, clearance_m);
        assert_eq!(clear, map.clearance().is_clear(back, clearance_m), "direction matters");
        clear
    }

    #[test]
    fn touching_a_single_square_is_allowed_without_clearance() {
        let map = map(&["...", ".#.", "..."]);
        assert!(clear(&map, [0.0, 2.0], [3.0, 2.0], 0.0), "along the edge");
        assert!(clear(&map, [0.5, 1.5], [1.5, 2.5], 0.0), "past the corner");
        assert!(!clear(&map, [0.5, 1.5], [1.5, 2.5], 0.01));
        assert!(!clear(&map, [0.5, 1.0], [2.5, 2.0], 0.0), "through it");
        assert!(!clear(&map, [0.5, 1.5], [2.5, 1.5], 0.0));
    }

    #[test]
    fn no_line_slips_between_two_squares() {
        let diagonal = map(&["..#", ".#.", "..."]);
        assert!(!clear(&diagonal, [1.5, 2.5], [2.5, 1.5], 0.0));
        assert!(!clear(&diagonal, [1.2, 2.0], [2.8, 2.0], 0.0), "along an edge of both");
        assert!(clear(&diagonal, [0.0, 2.0], [1.8, 2.0], 0.0), "along an edge of one");
        let wall = map(&["...", ".#.", ".#."]);
        assert!(!clear(&wall, [0.5, 1.0], [2.5, 1.0], 0.0), "along the joint of a wall");
        assert!(clear(&wall, [1.0, 0.0], [1.0, 3.0], 0.0), "along its side");
        // One square on each side of the line, staggered: a line may touch both.
        let staggered = map(&["..#", "...", "#.."]);
        assert!(clear(&staggered, [0.0, 1.0], [3.0, 1.0], 0.0));
        let stairs = map(&["..#", ".#.", "#.."]);
        assert!(clear(&stairs, [0.0, 1.0], [1.0, 2.0], 0.0));
    }

    #[test]
    fn a_wall_has_no_hole_along_the_border() {
        let across = map(&["...", "###", "..."]);
        for x in [0.0, 3.0] {
            assert!(!clear(&across, [x, 0.5], [x, 2.5], 0.0));
        }
        assert!(clear(&across, [0.0, 0.5], [0.0, 1.0], 0.0), "up to the wall");
    }

    #[test]
    fn no_line_leaves_the_map() {
        let map = map(&["..", ".."]);
        assert!(clear(&map, [0.0, 0.0], [2.0, 2.0], 0.0));
        assert!(!clear(&map, [1.0, 1.0], [2.1, 1.0], 0.0));
        assert!(clear(&map, [1.0, 0.5], [1.0, 1.5], 0.5));
        assert!(!clear(&map, [1.0, 0.4], [1.0, 1.5], 0.5), "a footprint may not leave it either");
    }

    #[test]
    fn nothing_to_measure() {
        let empty = map(&["..", ".."]);
        let line = Polyline::new(vec![Point::new(0.5, 0.5), Point::new(1.5, 0.5)]);
        assert_eq!(empty.clearance().of_line(&line), None);
        assert_eq!(empty.clearance().of_line(&Polyline::default()), None);
        assert_eq!(empty.clearance().of_point(Point::new(0.5, 0.5), 3.0), 3.0);
        assert_eq!(map(&["#."]).clearance().of_point(Point::new(0.5, 0.5), 3.0), 0.0);
        let far = map(&["#."]);
        assert_eq!(far.clearance().of_point(Point::new(101.0, 0.5), f64::INFINITY), 100.0);
        assert_eq!(far.clearance().of_point(Point::new(0.5, 101.0), f64::INFINITY), 100.0);
        assert_eq!(far.clearance().of_point(Point::new(0.5, -100.0), f64::INFINITY), 100.0);
        assert_eq!(far.clearance().of_point(Point::new(1e300, 0.5), 3.0), 3.0);
    }

    proptest! {
        #[test]
        fn distances_agree_with_brute_force(occupied in prop::collection::vec(prop::bool::weighted(0.1), 80 * 9),
                                            a in (-1.0..9.0f64, -1.0..2.0f64), b in (-1.0..9.0f64, -1.0..2.0f64),
                                            yaw in -3.0..3.0f64, reach in 0.0..3.0f64, radius in 0.0..0.3f64) {
            let frame = GridFrame::new(80, 9, 0.1, Pose::new(1.0, -2.0, yaw)).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &occupied);
            let squares: Vec<Square> = frame.cells()
                .filter(|&c| grid.occupied().get(c)).map(|c| square(c.x, c.y)).collect();
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            let world = |(x, y): (f64, f64)| frame.world_from_grid(Point::new(x * 10.0, y * 10.0));
            let segment = Segment::new(world(a), world(b));
            let in_grid = Segment::new(frame.grid_from_world(segment.a), frame.grid_from_world(segment.b));
            let brute = |distance_sq: &dyn Fn(Square) -> f64| squares.iter()
                .map(|&s| distance_sq(s).sqrt() * 0.1).fold(f64::INFINITY, f64::min);
            let by_point = brute(&|s| s.distance_sq_to_point(in_grid.a));
            let by_segment = brute(&|s| in_grid.distance_sq_to_square(s));
            prop_assert!((clearance.of_point(segment.a, reach) - by_point.min(reach)).abs() < 1e-12);
            prop_assert!((clearance.of_segment(segment, reach) - by_segment.min(reach)).abs() < 1e-12);
            let nearest = clearance.nearest_square(in_grid.a, reach * 10.0);
            let nearest = nearest.map(|square| square.nearest_to(in_grid.a).distance(in_grid.a) * 0.1);
            prop_assert!((nearest.unwrap_or(reach) - by_point.min(reach)).abs() < 1e-12);
            match clearance.of_line(&Polyline::new(vec![segment.a, segment.b])) {
                Some(nearest) => prop_assert!((nearest - by_segment).abs() < 1e-12),
                None => prop_assert!(squares.is_empty()),
            }
            let inside = |p: Point| p.x >= radius * 10.0 && p.x <= 80.0 - radius * 10.0
                && p.y >= radius * 10.0 && p.y <= 9.0 - radius * 10.0;
            let expected = by_segment >= radius && inside(in_grid.a) && inside(in_grid.b);
            prop_assert_eq!(clearance.is_clear(segment, radius), expected);
        }

        #[test]
        fn an_unblocked_step_keeps_the_clearance(occupied in prop::collection::vec(prop::bool::weighted(0.08), 12 * 12),
                                                 clearance_m in 0.0..3.0f64) {
            let frame = GridFrame::new(12, 12, 1.0, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &occupied);
            let config = LayerConfig { clearance_m, ..LayerConfig::default() };
            let map = SearchMap::new(&grid, config).unwrap();
            for cell in frame.cells() {
                for (dx, dy) in [(1, 0), (0, 1), (1, 1), (1, -1)] {
                    let block = [(0, 0), (dx, 0), (0, dy), (dx, dy)];
                    if block.iter().any(|&(x, y)| !map.is_free(Cell::new(cell.x + x, cell.y + y))) {
                        continue;
                    }
                    let to = Cell::new(cell.x + dx, cell.y + dy);
                    let step = Segment::new(frame.world_from_cell(cell), frame.world_from_cell(to));
                    prop_assert!(map.clearance().is_clear(step, clearance_m), "{} to {}", cell, to);
                }
            }
        }
    }
}
