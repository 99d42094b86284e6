//! Canvas of the layers: the plot area of a map picture, in pixels.

use crate::color::Rgb;
use crate::legend::{ColorBar, LegendEntry};
use crate::line_style::LineStyle;
use crate::outline::outline;
use crate::view::View;
use crate::writer::{PathData, SvgWriter, matrix_entry};
use keyway::geometry::Point;
use keyway::map::{Cell, OccupancyGrid};
use std::fmt::Write as _;

/// Maximum text length of one set of cells. A set with more corners is drawn more coarsely; no
/// map file makes the picture larger than a few of these.
const MAX_OUTLINE_BYTES: usize = 2_000_000;

/// The visible part of a map's cells, in square blocks: single cells, or as many as fall on one
/// pixel of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    /// Lower left cell.
    first: Cell,
    /// The cell after the upper right one.
    end: Cell,
    /// Cells along the side of a block.
    unit: i32,
}

impl Blocks {
    pub(crate) const fn columns(&self) -> i32 {
        (self.end.x - self.first.x + self.unit - 1) / self.unit
    }

    pub(crate) const fn rows(&self) -> i32 {
        (self.end.y - self.first.y + self.unit - 1) / self.unit
    }

    /// Index of the block of a cell, counted row by row; `None` out of view.
    pub(crate) fn index(&self, cell: Cell) -> Option<usize> {
        let is_in = |at: i32, first: i32, end: i32| (first..end).contains(&at);
        let is_in_view =
            is_in(cell.x, self.first.x, self.end.x) && is_in(cell.y, self.first.y, self.end.y);
        is_in_view.then(|| {
            let (x, y) = ((cell.x - self.first.x) / self.unit, (cell.y - self.first.y) / self.unit);
            y as usize * self.columns() as usize + x as usize
        })
    }

    /// Returns the cells of a block.
    fn cells(&self, x: i32, y: i32) -> impl Iterator<Item = Cell> {
        let (x, y) = (self.first.x + x * self.unit, self.first.y + y * self.unit);
        let (x_end, y_end) = ((x + self.unit).min(self.end.x), (y + self.unit).min(self.end.y));
        (y..y_end).flat_map(move |y| (x..x_end).map(move |x| Cell::new(x, y)))
    }
}

/// The plot area on which layers are drawn. Everything outside it is clipped.
#[derive(Debug)]
pub struct Canvas<'a> {
    map: &'a OccupancyGrid,
    view: View,
    blocks: Blocks,
    pub(crate) body: SvgWriter,
    pub(crate) entries: Vec<LegendEntry>,
    pub(crate) bars: Vec<ColorBar>,
    /// Positions and radii \[px\] of shapes that a marker must not hide.
    pub(crate) discs: Vec<((f64, f64), f64)>,
}

impl<'a> Canvas<'a> {
    /// Creates a canvas that shows at most `max_side_cells` blocks of cells in a row: more than a
    /// picture has pixels would not be visible.
    pub(crate) fn new(map: &'a OccupancyGrid, view: View, max_side_cells: i32) -> Self {
        let (first, end) = view.visible_cells(map.frame());
        let mut unit = 1;
        while (end.x - first.x).max(end.y - first.y) / unit > max_side_cells {
            unit *= 2;
        }
        let blocks = Blocks { first, end, unit };
        let (entries, bars, discs) = (Vec::new(), Vec::new(), Vec::new());
        Self { map, view, blocks, body: SvgWriter::new(), entries, bars, discs }
    }

    /// Returns the cells in view.
    pub(crate) const fn blocks(&self) -> Blocks {
        self.blocks
    }

    /// Returns the map of the picture.
    pub const fn map(&self) -> &'a OccupancyGrid {
        self.map
    }

    /// Returns the transform from metres to pixels.
    pub const fn view(&self) -> &View {
        &self.view
    }

    /// Returns the writer, for elements without a method here, in pixels of the plot area.
    pub const fn writer(&mut self) -> &mut SvgWriter {
        &mut self.body
    }

    /// Adds an entry to the legend, once. Call it only if something was drawn.
    pub fn explain(&mut self, entry: LegendEntry) {
        if !self.entries.contains(&entry) {
            self.entries.push(entry);
        }
    }

    /// Adds a colour bar beside the plot.
    pub fn explain_colors(&mut self, bar: ColorBar) {
        self.bars.push(bar);
    }

    /// Paints the cells of the map that are `inside`, and returns true if any was in view. Cells
    /// far below the size of a pixel are painted in blocks: a block is painted if one of its
    /// cells is, so that thin walls remain visible.
    pub fn cells(&mut self, color: Rgb, inside: impl Fn(Cell) -> bool) -> bool {
        let blocks = self.blocks;
        let places = (0..blocks.rows()).flat_map(|y| (0..blocks.columns()).map(move |x| (x, y)));
        let set: Vec<bool> = places.map(|(x, y)| blocks.cells(x, y).any(&inside)).collect();
        self.paint(color, |index| set[index])
    }

    /// Paints those of [`Self::blocks`] that are `inside`, by their index, and returns true if
    /// there was any. The blocks are coarser if the outlines would be too long.
    pub(crate) fn paint(&mut self, color: Rgb, inside: impl Fn(usize) -> bool) -> bool {
        let blocks = self.blocks;
        let (columns, rows) = (blocks.columns(), blocks.rows());
        let mut coarser = 1;
        loop {
            let block = |x: i32, y: i32| {
                let (x, y) = (x * coarser, y * coarser);
                let (x_end, y_end) = ((x + coarser).min(columns), (y + coarser).min(rows));
                (y..y_end).any(|y| (x..x_end).any(|x| inside((y * columns + x) as usize)))
            };
            let part = |side: i32| (side + coarser - 1) / coarser;
            if let Some(path) = outline(part(columns), part(rows), block, MAX_OUTLINE_BYTES) {
                return self.cell_path(color, blocks.first, blocks.unit * coarser, &path);
            }
            coarser *= 2;
        }
    }

    /// True if the picture shows unknown cells, or the area outside the map, which is unknown,
    /// too.
    pub(crate) fn shows_unknown(&self) -> bool {
        let frame = self.map.frame();
        let (min, max) = self.view.corners();
        let corners = [min, max, Point::new(min.x, max.y), Point::new(max.x, min.y)];
        let slack = 1e-6;
        let reaches_out = corners.iter().any(|&corner| {
            let grid = frame.grid_from_world(corner);
            let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
            let beside = |value: f64, end: f64| value < -slack || value > end + slack;
            beside(grid.x, width) || beside(grid.y, height)
        });
        let (first, end) = self.view.visible_cells(frame);
        let unknown = self.map.unknown();
        reaches_out || (first.y..end.y).any(|y| unknown.any_in_span(y, first.x, end.x - 1))
    }

    fn cell_path(&mut self, color: Rgb, first: Cell, unit: i32, path: &str) -> bool {
        if path.is_empty() {
            return false;
        }
        let matrix = self.view.px_from_grid(self.map.frame(), first, unit);
        self.body.tag("path").matrix(matrix).fill(color).attr("d", path).leaf();
        true
    }

    /// Draws a line through points in the world, interrupted at points that are not finite;
    /// returns true if something was drawn. A single point is drawn as a dot.
    pub fn line(&mut self, points: &[Point], style: LineStyle) -> bool {
        let mut data = PathData::default();
        for part in points.split(|point| !point.is_finite()) {
            if let [first, rest @ ..] = part {
                let rest = if rest.is_empty() { part } else { rest };
                let all = std::iter::once(first).chain(rest);
                data.append(all.map(|&point| self.view.px_from_world(point)));
            }
        }
        self.path(&data, style)
    }

    /// Draws straight lines between the centres of cells; returns true if there was one. Dashes
    /// are not used.
    pub fn segments(
        &mut self,
        lines: impl IntoIterator<Item = (Cell, Cell)>,
        style: LineStyle,
    ) -> bool {
        let mut data = String::new();
        for (from, to) in lines {
            let _ = write!(data, "M{} {}l{} {}", from.x, from.y, to.x - from.x, to.y - from.y);
        }
        self.cell_lines(&data, style.color, style.width_px)
    }

    /// Draws dots at the centres of cells; returns true if there was one.
    pub fn dots(
        &mut self,
        cells: impl IntoIterator<Item = Cell>,
        radius_px: f64,
        color: Rgb,
    ) -> bool {
        let mut data = String::new();
        for cell in cells {
            // A line of length 0 has round ends.
            let _ = write!(data, "M{} {}h0", cell.x, cell.y);
        }
        self.cell_lines(&data, color, 2.0 * radius_px)
    }

    /// Draws lines whose coordinates are cells, from centre to centre.
    fn cell_lines(&mut self, data: &str, color: Rgb, width_px: f64) -> bool {
        if data.is_empty() {
            return false;
        }
        let frame = self.map.frame();
        let [a, b, c, d, e, f] = self.view.px_from_grid(frame, Cell::new(0, 0), 1);
        let matrix = [a, b, c, d, e + 0.5 * (a + c), f + 0.5 * (b + d)];
        let width_cells = width_px / (self.view.px_per_m() * frame.resolution_m());
        let (stroke, width) = (color.to_string(), matrix_entry(width_cells));
        let tag = self.body.tag("path").matrix(matrix).attr("fill", "none");
        let tag = tag.attr("stroke", &stroke).attr("stroke-width", &width);
        tag.attr("stroke-linecap", "round").attr("d", data).leaf();
        true
    }

    /// Draws a line in pixels; returns true if it was not empty.
    pub fn path(&mut self, data: &PathData, style: LineStyle) -> bool {
        if data.as_str().is_empty() {
            return false;
        }
        let mut tag =
            self.body.tag("path").attr("fill", "none").stroke(style.color, style.width_px);
        if style.dashes.is_empty() {
            tag = tag.attr("stroke-linecap", "round");
        } else {
            tag = tag.attr("stroke-dasharray", style.dashes);
        }
        tag.attr("stroke-linejoin", "round").attr("d", data.as_str()).leaf();
        true
    }
}
