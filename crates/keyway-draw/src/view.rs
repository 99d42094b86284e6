//! The part of the world that a picture shows, and its transform to the page.

use keyway::geometry::Point;
use keyway::map::{Cell, GridFrame, OccupancyGrid};

/// Minimum ratio of the sides of a picture; a corridor has space beside it.
const MIN_SIDE_RATIO: f64 = 0.2;
/// Margin around layers \[px\]: start, goal and robot are at the ends of paths.
const MARKER_PX: f64 = 11.0;

/// The part of the world that a picture of a map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Region {
    /// The cells that are not unknown, and all layers, with a small margin. Maps from mapping
    /// runs are often mostly unknown.
    #[default]
    Known,
    /// The whole map, and all layers.
    Whole,
    /// The rectangle between two points \[m\]; everything outside is clipped.
    Window(Point, Point),
}

/// A rectangle in the world that grows with its content.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    corners: Corners,
    /// Corners of the elements with a size in pixels.
    marks: Corners,
}

/// Lower left and upper right corner; `None` without a point.
type Corners = Option<(Point, Point)>;

/// Returns the smallest rectangle that also contains a point; one that is not finite is ignored.
fn joined(corners: Corners, point: Point) -> Corners {
    if !point.is_finite() {
        return corners;
    }
    let (min, max) = corners.unwrap_or((point, point));
    Some((
        Point::new(min.x.min(point.x), min.y.min(point.y)),
        Point::new(max.x.max(point.x), max.y.max(point.y)),
    ))
}

impl Extent {
    /// Includes a point, with space for a marker there; one that is not finite is ignored.
    pub fn include(&mut self, point: Point) {
        self.corners = joined(self.corners, point);
        self.marks = joined(self.marks, point);
    }

    /// Includes a disc, which has its size in the world; one that is not finite is ignored.
    pub fn include_disc(&mut self, centre: Point, radius_m: f64) {
        let radius = Point::new(radius_m, radius_m);
        for corner in [centre + radius, centre - radius] {
            self.corners = joined(self.corners, corner);
        }
    }

    /// Returns the lower left and upper right corner; `None` if it is empty.
    pub const fn corners(&self) -> Option<(Point, Point)> {
        self.corners
    }

    fn include_corners(&mut self, other: Corners) {
        for point in other.iter().flat_map(|&(min, max)| [min, max]) {
            self.corners = joined(self.corners, point);
        }
    }

    fn longer_side(self) -> f64 {
        self.corners.map_or(0.0, |(min, max)| (max.x - min.x).max(max.y - min.y))
    }

    fn clipped_to(self, other: Self) -> Self {
        let (Some((min, max)), Some((low, high))) = (self.corners, other.corners) else {
            return self;
        };
        let corners = Some((
            Point::new(min.x.max(low.x), min.y.max(low.y)),
            Point::new(max.x.min(high.x), max.y.min(high.y)),
        ));
        Self { corners, ..self }
    }

    /// Returns the rectangle with a margin on all sides.
    fn grown(self, margin_m: f64) -> Self {
        Self { corners: grown(self.corners, margin_m), ..self }
    }
}

/// Returns a rectangle with a margin on all sides.
fn grown(corners: Corners, margin_m: f64) -> Corners {
    let margin = Point::new(margin_m, margin_m);
    corners.map(|(min, max)| (min - margin, max + margin))
}

impl Region {
    /// Returns the rectangle to show in a picture of `side_px`, given the extent of the layers.
    pub(crate) fn extent(self, map: &OccupancyGrid, layers: Extent, side_px: f64) -> Extent {
        let whole = map_extent(map.frame());
        let mut shown = match self {
            Self::Window(a, b) => {
                let mut window = Extent::default();
                window.include(a);
                window.include(b);
                return if window.corners.is_some() { window } else { whole };
            }
            Self::Whole => whole,
            Self::Known => known_extent(map),
        };
        if shown.corners.is_none() {
            shown = whole;
        }
        shown.include_corners(layers.corners);
        let marker_m = MARKER_PX * shown.longer_side() / side_px;
        let marks = grown(layers.marks, marker_m);
        shown.include_corners(marks);
        // A margin shows that nothing was clipped; beyond the map there is nothing to show.
        let mut room = whole;
        room.include_corners(layers.corners);
        room.include_corners(marks);
        let margin = (0.03 * shown.longer_side()).max(2.0 * map.frame().resolution_m());
        shown.grown(margin).clipped_to(room)
    }
}

fn map_extent(frame: &GridFrame) -> Extent {
    let mut extent = Extent::default();
    let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
    for (x, y) in [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)] {
        extent.include(frame.world_from_grid(Point::new(x, y)));
    }
    extent
}

/// Returns the smallest rectangle around all cells that are not unknown.
fn known_extent(map: &OccupancyGrid) -> Extent {
    let frame = map.frame();
    let mut extent = Extent::default();
    for y in 0..frame.height() as i32 {
        let is_known = |&x: &i32| !map.unknown().get(Cell::new(x, y));
        let mut columns = 0..frame.width() as i32;
        let Some(first) = columns.find(is_known) else { continue };
        let last = columns.rfind(is_known).unwrap_or(first);
        for (x, y) in [(first, y), (first, y + 1), (last + 1, y), (last + 1, y + 1)] {
            extent.include(frame.world_from_grid(Point::new(f64::from(x), f64::from(y))));
        }
    }
    extent
}

/// Transform from the world (metres, y up) to the plot area (pixels, y down, (0, 0) the upper
/// left corner).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    min: Point,
    max: Point,
    px_per_m: f64,
}

impl View {
    /// Creates a view of a rectangle of the world whose longer side is `side_px` long. A
    /// rectangle without area is widened.
    pub(crate) fn new(extent: Extent, side_px: f64) -> Self {
        let (min, max) = extent.corners.unwrap_or((Point::new(0.0, 0.0), Point::new(1.0, 1.0)));
        let (width, height) = (max.x - min.x, max.y - min.y);
        let long = width.max(height);
        let long = if long > 0.0 && long.is_finite() { long } else { 1.0 };
        let widen = |side: f64| 0.5 * (MIN_SIDE_RATIO * long - side).max(0.0);
        let room = Point::new(widen(width), widen(height));
        Self { min: min - room, max: max + room, px_per_m: side_px / long }
    }

    /// Returns the lower left and upper right corner of the shown rectangle \[m\].
    pub const fn corners(&self) -> (Point, Point) {
        (self.min, self.max)
    }

    /// Pixels per metre.
    pub const fn px_per_m(&self) -> f64 {
        self.px_per_m
    }

    /// Width of the plot area \[px\].
    pub fn width_px(&self) -> f64 {
        (self.max.x - self.min.x) * self.px_per_m
    }

    /// Height of the plot area \[px\].
    pub fn height_px(&self) -> f64 {
        (self.max.y - self.min.y) * self.px_per_m
    }

    /// Returns the pixel of a point in the world.
    pub fn px_from_world(&self, world: Point) -> (f64, f64) {
        ((world.x - self.min.x) * self.px_per_m, (self.max.y - world.y) * self.px_per_m)
    }

    /// Returns the affine transform from grid coordinates to pixels, as SVG's matrix (a, b, c, d,
    /// e, f), for squares of `unit` cells beginning at `first`.
    pub(crate) fn px_from_grid(&self, frame: &GridFrame, first: Cell, unit: i32) -> [f64; 6] {
        let grid = Point::new(f64::from(first.x), f64::from(first.y));
        // Full sides, so that the far end of a large map is as exact as its origin.
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let px = |point: Point| self.px_from_world(frame.world_from_grid(point));
        let (origin, right, up) =
            (px(Point::new(0.0, 0.0)), px(Point::new(width, 0.0)), px(Point::new(0.0, height)));
        let start = px(grid);
        let unit = f64::from(unit);
        [
            (right.0 - origin.0) / width * unit,
            (right.1 - origin.1) / width * unit,
            (up.0 - origin.0) / height * unit,
            (up.1 - origin.1) / height * unit,
            start.0,
            start.1,
        ]
    }

    /// Returns the cells that may be visible: first, and last plus one, in both directions. Empty
    /// if the map is out of view.
    pub(crate) fn visible_cells(&self, frame: &GridFrame) -> (Cell, Cell) {
        let (min, max) = (self.min, self.max);
        let mut grid = Extent::default();
        for corner in [min, max, Point::new(min.x, max.y), Point::new(max.x, min.y)] {
            grid.include(frame.grid_from_world(corner));
        }
        let (low, high) = grid.corners.unwrap_or_default();
        let clamp = |value: f64, count: u32| value.clamp(0.0, f64::from(count)) as i32;
        let (width, height) = (frame.width(), frame.height());
        (
            Cell::new(clamp(low.x.floor(), width), clamp(low.y.floor(), height)),
            Cell::new(clamp(high.x.ceil(), width), clamp(high.y.ceil(), height)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Pose;
    use keyway::map::CellState;

    fn near(a: (f64, f64), b: (f64, f64)) -> bool {
        (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9
    }

    #[test]
    fn world_to_pixels() {
        let mut extent = Extent::default();
        extent.include(Point::new(-2.0, 1.0));
        extent.include(Point::new(8.0, 6.0));
        let view = View::new(extent, 500.0);
        assert_eq!((view.width_px(), view.height_px()), (500.0, 250.0));
        assert!(near(view.px_from_world(Point::new(-2.0, 6.0)), (0.0, 0.0)));
        assert!(near(view.px_from_world(Point::new(8.0, 1.0)), (500.0, 250.0)));
    }

    #[test]
    fn grid_to_pixels_agrees_with_the_frame() {
        for yaw in [0.0, 0.5, -2.1, std::f64::consts::FRAC_PI_2] {
            let frame = GridFrame::new(40, 30, 0.05, Pose::new(-3.0, 7.0, yaw)).unwrap();
            let view = View::new(map_extent(&frame), 600.0);
            let first = Cell::new(4, 6);
            let [a, b, c, d, e, f] = view.px_from_grid(&frame, first, 2);
            for (i, j) in [(0.0, 0.0), (3.0, 0.0), (2.0, 5.0)] {
                let grid = Point::new(4.0 + 2.0 * i, 6.0 + 2.0 * j);
                let expected = view.px_from_world(frame.world_from_grid(grid));
                assert!(near((a * i + c * j + e, b * i + d * j + f), expected), "yaw {yaw}");
            }
            assert_eq!(view.visible_cells(&frame), (Cell::new(0, 0), Cell::new(40, 30)));
        }
    }

    #[test]
    fn crops_to_what_is_known() {
        let frame = GridFrame::new(100, 100, 0.1, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| match (cell.x, cell.y) {
            (20..40, 30..80) => CellState::Free,
            _ => CellState::Unknown,
        });
        let (min, max) = Region::Known.extent(&map, Extent::default(), 500.0).corners().unwrap();
        assert!(near((min.x, min.y), (1.8, 2.8)) && near((max.x, max.y), (4.2, 8.2)));
        let mut far = Extent::default();
        far.include(Point::new(-5.0, 4.0));
        let (min, _) = Region::Known.extent(&map, far, 500.0).corners().unwrap();
        // From -5 m to the last known column at 4 m, and 11 of 500 pixels more.
        assert!((min.x + 5.0 + 9.0 * 11.0 / 500.0).abs() < 1e-9);
    }

    /// A robot half a metre from the border of its map, and not over it.
    #[test]
    fn what_has_its_size_in_the_world_needs_no_room_for_a_marker() {
        let frame = GridFrame::new(120, 65, 0.1, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
        let shown = |layers: Extent| Region::Known.extent(&map, layers, 520.0).corners().unwrap();
        let low_m = |layers: Extent| shown(layers).0.x;
        let mut robot = Extent::default();
        robot.include(Point::new(0.5, 3.0));
        robot.include_disc(Point::new(0.5, 3.0), 0.35);
        assert_eq!(shown(robot), map_extent(&frame).corners().unwrap());
        robot.include_disc(Point::new(0.5, 3.0), 0.75);
        assert_eq!(low_m(robot), -0.25, "what is beyond it is shown");
        let mut mark = Extent::default();
        mark.include(Point::new(0.1, 3.0));
        assert!(low_m(mark) < -0.1, "{}", low_m(mark));
    }

    #[test]
    fn degenerate_extents_have_area() {
        let mut point = Extent::default();
        point.include(Point::new(3.0, 3.0));
        point.include(Point::new(f64::NAN, 0.0));
        for extent in [Extent::default(), point] {
            let view = View::new(extent, 500.0);
            assert!(view.width_px() >= 99.0 && view.height_px() >= 99.0);
        }
        let mut line = Extent::default();
        line.include(Point::new(0.0, 0.0));
        line.include(Point::new(100.0, 0.1));
        assert!((View::new(line, 500.0).height_px() - 100.0).abs() < 1e-9);
    }
}
