//! Scans for obstacle squares near a segment: row by row along it, 64 cells at a time.

use crate::geometry::{Point, Segment, Square};
use crate::map::Clearance;
use crate::map::cell::floor_to_i32;
use crate::map::clearance::{TOUCH_TOLERANCE_CELLS, square};

/// Extra width of spans \[cells\]: far more than rounding can take off them.
const SLACK_CELLS: f64 = 0.01;

/// Distance beyond a clearance \[cells\] at which a shape certainly keeps it.
pub(in crate::map) const CERTAIN_CELLS: f64 = 1e-6;

/// Number of columns below which every square is tested individually.
const NARROW_CELLS: i32 = 24;

/// Segments that rise by less than this \[cells\] are treated as level.
const LEVEL_CELLS: f64 = 1e-6;

impl Clearance<'_> {
    /// Visits the obstacle squares that may lie within `reach` \[cells\] of the segment until
    /// `visit` returns false; returns true if it never did. Row by row from the first end on.
    pub(in crate::map) fn scan(
        &self,
        grid: Segment,
        reach: f64,
        mut visit: impl FnMut(Square) -> bool,
    ) -> bool {
        let near = Near::new(grid, reach + TOUCH_TOLERANCE_CELLS);
        let (first, last) = near.all_rows();
        let (first, last) = (first.max(0), last.min(self.obstacles.height() as i32 - 1));
        // Around a short segment most rows are empty, which two words show.
        let (from, to) = near.all_columns();
        let columns = self.obstacles.columns(from, to);
        let narrow = (to.saturating_sub(from) < NARROW_CELLS)
            .then(|| Around::new(grid, near.reach + SLACK_CELLS));
        let is_up = grid.a.y <= grid.b.y;
        let (mut next, step) = if is_up { (first, 1) } else { (last, -1) };
        while next >= first && next <= last {
            let y = next;
            next += step;
            if columns.is_some_and(|columns| !self.obstacles.any_in_columns(y, &columns)) {
                continue;
            }
            let goes_on = if let Some(around) = &narrow {
                self.obstacles.all_ones_in_span(y, from, to, |x| {
                    let square = square(x, y);
                    around.excludes(square) || visit(square)
                })
            } else {
                let (from, to) = near.columns(y);
                self.obstacles.all_ones_in_span(y, from, to, |x| visit(square(x, y)))
            };
            if !goes_on {
                return false;
            }
        }
        true
    }
}

impl Clearance<'_> {
    /// True if every segment within a triangle is certainly clear ([`Self::is_clear`]); false
    /// does not mean that one is not. Costs about as much as three segments.
    pub(crate) fn is_clear_triangle(&self, corners: [Point; 3], clearance_m: f64) -> bool {
        let margin = (clearance_m / self.frame.resolution_m()).max(0.0) + CERTAIN_CELLS;
        let corners = corners.map(|corner| self.frame.grid_from_world(corner));
        let [a, b, c] = corners;
        let edges = [Segment::new(a, b), Segment::new(b, c), Segment::new(c, a)];
        corners.iter().all(|&corner| self.is_inside(corner, margin))
            && self.scan_triangle(&edges, margin, |square| {
                let is_near = |edge: &Segment| edge.distance_sq_to_square(square) < margin * margin;
                !edges.iter().any(is_near) && !is_within(&edges, square)
            })
    }

    /// Visits the obstacle squares that may lie in a triangle or within `reach` \[cells\] of it
    /// until `visit` returns false; returns true if it never did.
    fn scan_triangle(
        &self,
        edges: &[Segment; 3],
        reach: f64,
        mut visit: impl FnMut(Square) -> bool,
    ) -> bool {
        let nears = edges.map(|edge| Near::new(edge, reach + TOUCH_TOLERANCE_CELLS));
        let rows = nears.iter().map(Near::all_rows);
        let (first, last) =
            rows.fold((i32::MAX, i32::MIN), |all, own| (all.0.min(own.0), all.1.max(own.1)));
        (first.max(0)..=last.min(self.obstacles.height() as i32 - 1)).all(|y| {
            // Squares in the triangle lie between its edges.
            let beside = nears.iter().filter(|near| near.has_row(y)).map(|near| near.columns(y));
            let (from, to) =
                beside.fold((i32::MAX, i32::MIN), |all, own| (all.0.min(own.0), all.1.max(own.1)));
            self.obstacles.all_ones_in_span(y, from, to, |x| visit(square(x, y)))
        })
    }
}

/// True if a square that no edge of a triangle crosses lies within the triangle.
fn is_within(edges: &[Segment; 3], square: Square) -> bool {
    let middle = square.corner + Point::new(0.5, 0.5);
    let side = |edge: &Segment| (edge.b - edge.a).cross(middle - edge.a);
    edges.iter().all(|edge| side(edge) > 0.0) || edges.iter().all(|edge| side(edge) < 0.0)
}

/// Quick rejection test for squares that are farther from a segment than a distance \[cells\], up
/// to rounding.
pub(in crate::map) struct Around {
    a: Point,
    along: Point,
    /// Limit of the distance of a square's centre from the segment's line, times the segment's
    /// length.
    off: f64,
    /// Bounding box for the lower left corners of squares within the distance.
    low: Point,
    high: Point,
}

impl Around {
    pub(in crate::map) fn new(Segment { a, b }: Segment, distance: f64) -> Self {
        let along = b - a;
        let off = distance * along.norm() + 0.5 * (along.x.abs() + along.y.abs());
        let low = Point::new(a.x.min(b.x) - distance - 1.0, a.y.min(b.y) - distance - 1.0);
        let high = Point::new(a.x.max(b.x) + distance, a.y.max(b.y) + distance);
        Self { a, along, off, low, high }
    }

    /// True only for a square that is farther; false does not mean that it is near.
    pub(in crate::map) fn excludes(&self, Square { corner }: Square) -> bool {
        let middle = corner + Point::new(0.5, 0.5) - self.a;
        corner.x < self.low.x
            || corner.x > self.high.x
            || corner.y < self.low.y
            || corner.y > self.high.y
            || self.along.cross(middle).abs() > self.off
    }
}

/// The area near a segment: within reach of its line, and of the part of it that is beside a row.
struct Near {
    a: Point,
    reach: f64,
    /// Row coordinates of the lower and the upper end.
    rows: (f64, f64),
    /// Columns per row along the segment; `None` for a level one.
    slope: Option<f64>,
    /// Column coordinates of the left and the right end.
    ends: (f64, f64),
    /// Largest distance along a row from a square's centre to the line.
    half_width: f64,
    /// The rows that are beside neither end: there the line alone determines the near columns.
    between: (f64, f64),
}

impl Near {
    fn new(Segment { a, b }: Segment, reach: f64) -> Self {
        let along = b - a;
        let rise = along.y.abs();
        let slope = (rise > LEVEL_CELLS).then(|| along.x / along.y);
        // A square extends to the side of a line by half the width of its projection on the
        // normal.
        let half_shadow = 0.5 * (along.x.abs() + rise);
        let half_width = (reach * along.norm() + half_shadow) / rise + SLACK_CELLS;
        let rows = (a.y.min(b.y), a.y.max(b.y));
        let between = (rows.0 + reach, rows.1 - reach - 1.0);
        Self { a, reach, rows, slope, ends: (a.x.min(b.x), a.x.max(b.x)), half_width, between }
    }

    /// The range of rows in which squares may be near.
    fn all_rows(&self) -> (i32, i32) {
        let margin = self.reach + SLACK_CELLS;
        whole(self.rows.0 - margin - 1.0, self.rows.1 + margin)
    }

    fn has_row(&self, y: i32) -> bool {
        let (first, last) = self.all_rows();
        (first..=last).contains(&y)
    }

    /// The range of columns in which squares may be near, for any row.
    fn all_columns(&self) -> (i32, i32) {
        let margin = self.reach + SLACK_CELLS;
        whole(self.ends.0 - margin - 1.0, self.ends.1 + margin)
    }

    /// The columns of row `y` in which squares may be near.
    fn columns(&self, y: i32) -> (i32, i32) {
        let Some(slope) = self.slope else { return self.all_columns() };
        let y = f64::from(y);
        let at = |row: f64| self.a.x + (row - self.a.y) * slope;
        let middle = at(y + 0.5) - 0.5;
        // Clipped at column 0. The slack exceeds the effect of rounding up and down.
        let left = (middle - self.half_width + 1.0).max(0.0) as i32;
        let right = (middle + self.half_width + 1.0).max(0.0) as i32 - 1;
        if y >= self.between.0 && y <= self.between.1 {
            return (left, right);
        }
        let margin = self.reach + SLACK_CELLS;
        let low = at((y - self.reach).clamp(self.rows.0, self.rows.1));
        let high = at((y + 1.0 + self.reach).clamp(self.rows.0, self.rows.1));
        let (from, to) = whole(low.min(high) - margin - 1.0, low.max(high) + margin);
        (from.max(left), to.min(right))
    }
}

/// The range of whole numbers between two numbers.
fn whole(from: f64, to: f64) -> (i32, i32) {
    let below = from as i32;
    (below.saturating_add(i32::from(f64::from(below) < from)), floor_to_i32(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{BitGrid, Cell, GridFrame};
    use proptest::prelude::*;

    #[test]
    fn rounding_down() {
        let cases = [(1.5, 1), (1.0, 1), (-0.5, -1), (-1.0, -1), (f64::NAN, 0)];
        for (value, expected) in cases {
            assert_eq!(floor_to_i32(value), expected, "{value}");
        }
        assert_eq!((floor_to_i32(1e300), floor_to_i32(-1e300)), (i32::MAX, i32::MIN));
        assert_eq!(whole(-1.5, 1.5), (-1, 1));
        assert_eq!(whole(1.0, -1e300), (1, i32::MIN));
    }

    #[test]
    fn an_obstacle_within_a_triangle_is_in_the_way() {
        let frame = GridFrame::new(9, 9, 1.0, Pose::default()).unwrap();
        let triangle = [[0.5, 0.5], [8.5, 0.5], [4.5, 8.5]].map(Point::from);
        let is_clear = |cell: Cell| {
            let mut obstacles = BitGrid::new(9, 9, false);
            obstacles.set(cell, true);
            Clearance::new(&frame, &obstacles).is_clear_triangle(triangle, 0.2)
        };
        // Far from all edges, on one, and outside.
        assert!(!is_clear(Cell::new(4, 3)) && !is_clear(Cell::new(4, 0)));
        assert!(is_clear(Cell::new(0, 8)) && is_clear(Cell::new(8, 4)));
    }

    proptest! {
        /// All squares within reach are visited, and few others: none farther than a cell's
        /// diagonal beyond it.
        #[test]
        fn visits_what_is_within_reach(a in (-3.0..83.0f64, -3.0..12.0f64), b in (-3.0..83.0f64, -3.0..12.0f64),
                                       level in prop_oneof![Just(1.0), Just(0.0), Just(1e-7), Just(1e-5)],
                                       upright in prop_oneof![Just(1.0), 0.0..1.0f64, Just(0.0), Just(1e-9)],
                                       reach in prop_oneof![Just(0.0), 0.0..5.0f64]) {
            let (width, height) = (80, 9);
            let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
            let mut obstacles = BitGrid::new(width as u32, height as u32, false);
            for cell in frame.cells() {
                obstacles.set(cell, true);
            }
            let clearance = Clearance::new(&frame, &obstacles);
            let a = Point::from([a.0, a.1]);
            let b = Point::new(a.x + (b.0 - a.x) * upright, a.y + (b.1 - a.y) * level);
            let segment = Segment::new(a, b);
            let mut visited = Vec::new();
            clearance.scan(segment, reach, |square| {
                visited.push(Cell::new(square.corner.x as i32, square.corner.y as i32));
                true
            });
            for cell in frame.cells() {
                let distance = segment.distance_sq_to_square(square(cell.x, cell.y)).sqrt();
                let is_visited = visited.contains(&cell);
                prop_assert!(is_visited || distance > reach, "{cell} is not visited");
                prop_assert!(!is_visited || distance < 1.5 * reach + 1.5, "{cell} is visited");
            }
            // Order: from the first end on.
            let rows: Vec<i32> = visited.iter().map(|cell| cell.y).collect();
            let is_in_order = if a.y <= b.y { rows.is_sorted() } else { rows.iter().rev().is_sorted() };
            prop_assert!(is_in_order);
        }

        /// Every segment in a clear triangle is clear, and a triangle that keeps slightly more
        /// than the clearance is clear.
        #[test]
        fn clear_triangles(cells in prop::collection::vec(prop::bool::weighted(0.05), 16 * 12),
                           corners in prop::array::uniform3((-1.0..17.0f64, -1.0..13.0f64)),
                           flat in prop_oneof![Just(1.0), Just(0.0)], thin in prop_oneof![Just(1.0), Just(0.0), Just(1e-3)],
                           within in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 20),
                           clearance_m in prop_oneof![Just(0.0), 0.0..2.0f64]) {
            let frame = GridFrame::new(16, 12, 1.0, Pose::default()).unwrap();
            let mut obstacles = BitGrid::new(16, 12, false);
            let occupied: Vec<Cell> = frame.cells().zip(cells).filter(|&(_, is)| is).map(|(cell, _)| cell).collect();
            for &cell in &occupied {
                obstacles.set(cell, true);
            }
            let clearance = Clearance::new(&frame, &obstacles);
            let [a, b, c] = corners.map(|(x, y)| Point::new(x, corners[0].1 + (y - corners[0].1) * flat));
            let triangle = [a, b, a.lerp(b, 0.4) + (c - a) * thin];
            let inside = |(s, t): (f64, f64)| {
                let [a, b, c] = triangle;
                a.lerp(b, s).lerp(c, t)
            };
            let is_clear = clearance.is_clear_triangle(triangle, clearance_m);
            let ends: Vec<Point> = within.iter().copied().map(inside).chain(triangle).collect();
            let segments: Vec<Segment> = ends.windows(2).map(|pair| Segment::new(pair[0], pair[1])).collect();
            if is_clear {
                for &segment in &segments {
                    prop_assert!(clearance.is_clear(segment, clearance_m), "{segment:?}");
                }
            } else {
                // An obstacle is near an edge, or in the triangle.
                let [a, b, c] = triangle;
                let edges = [[a, b], [b, c], [c, a]].map(|[a, b]| Segment::new(a, b));
                let is_near = |&cell: &Cell| {
                    let square = square(cell.x, cell.y);
                    edges.iter().any(|edge| edge.distance_sq_to_square(square).sqrt() < clearance_m + 1e-5)
                        || is_within(&edges, square)
                };
                let is_off = triangle.iter().any(|&at| clearance.to_border(at) < clearance_m + 1e-5);
                prop_assert!(is_off || occupied.iter().any(is_near));
            }
        }
    }
}
