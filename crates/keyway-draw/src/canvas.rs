//! What a layer draws on: the plot area of a map picture, in pixels.

use crate::color::Rgb;
use crate::legend::{ColorBar, Entry};
use crate::outline::outline;
use crate::view::View;
use crate::writer::{PathData, SvgWriter, matrix_entry};
use keyway::geometry::Point;
use keyway::map::{Cell, OccupancyGrid};
use std::fmt::Write as _;

/// Longest text of one set of cells. A set with more corners is drawn coarser; no map file makes
/// the picture larger than a few of these.
const MAX_OUTLINE_BYTES: usize = 2_000_000;

/// Cells along the longer side of a picture: more than its PNG has pixels cannot be seen.
const MAX_SIDE_CELLS: i32 = 4096;

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Its colour.
    pub color: Rgb,
    /// Its width \[px\].
    pub width_px: f64,
    /// Lengths of dashes and gaps \[px\] as SVG writes them; empty for a solid line.
    pub dashes: &'static str,
}

/// The plot area while layers are drawn on it. What lies outside it is cut off.
#[derive(Debug)]
pub struct Canvas<'a> {
    map: &'a OccupancyGrid,
    view: View,
    pub(crate) body: SvgWriter,
    pub(crate) entries: Vec<Entry>,
    pub(crate) bars: Vec<ColorBar>,
}

impl<'a> Canvas<'a> {
    pub(crate) const fn new(map: &'a OccupancyGrid, view: View) -> Self {
        Self { map, view, body: SvgWriter::new(), entries: Vec::new(), bars: Vec::new() }
    }

    /// The map of the picture.
    pub const fn map(&self) -> &'a OccupancyGrid {
        self.map
    }

    /// From metres to pixels.
    pub const fn view(&self) -> &View {
        &self.view
    }

    /// For elements that this type has no method for, in pixels of the plot area.
    pub const fn writer(&mut self) -> &mut SvgWriter {
        &mut self.body
    }

    /// Lists something that was drawn. Say it only when there was something to draw.
    pub fn explain(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// Puts a colour bar beside the plot.
    pub fn explain_colors(&mut self, bar: ColorBar) {
        self.bars.push(bar);
    }

    /// Paints the cells of the map that are `inside`, and says whether there was one in view. Cells
    /// far below the size of a pixel are painted in blocks: a block is painted when one of its cells
    /// is, so that thin walls stay.
    pub fn cells(&mut self, color: Rgb, inside: impl Fn(Cell) -> bool) -> bool {
        let (first, end) = self.view.visible_cells(self.map.frame());
        let (width, height) = (end.x - first.x, end.y - first.y);
        let mut unit = 1;
        while width.max(height) / unit > MAX_SIDE_CELLS {
            unit *= 2;
        }
        loop {
            let block = |x: i32, y: i32| {
                let (x, y) = (first.x + x * unit, first.y + y * unit);
                let (x_end, y_end) = ((x + unit).min(end.x), (y + unit).min(end.y));
                (y..y_end).any(|y| (x..x_end).any(|x| inside(Cell::new(x, y))))
            };
            let (columns, rows) = ((width + unit - 1) / unit, (height + unit - 1) / unit);
            if let Some(path) = outline(columns, rows, block, MAX_OUTLINE_BYTES) {
                return self.cell_path(color, first, unit, &path);
            }
            unit *= 2;
        }
    }

    /// Whether the picture shows unknown cells, or ground outside the map, which is not known either.
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
        let matrix = self.view.px_from_grid(self.map.frame(), first, unit).map(matrix_entry);
        self.body
            .tag("path")
            .attr("transform", &format!("matrix({})", matrix.join(" ")))
            .fill(color)
            .attr("d", path)
            .leaf();
        true
    }

    /// Draws a line through points in the world, interrupted at points that are not finite; says
    /// whether there was one. A single point is drawn as a dot.
    pub fn line(&mut self, points: &[Point], style: LineStyle) -> bool {
        let mut data = PathData::default();
        for part in points.split(|point| !point.is_finite()) {
            if let [first, rest @ ..] = part {
                data.move_to(self.view.px_from_world(*first));
                let rest = if rest.is_empty() { part } else { rest };
                for &point in rest {
                    data.line_to(self.view.px_from_world(point));
                }
            }
        }
        self.path(&data, style)
    }

    /// Draws straight lines between the centres of cells; says whether there was one. Dashes are not
    /// used.
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

    /// Draws dots at the centres of cells; says whether there was one.
    pub fn dots(
        &mut self,
        cells: impl IntoIterator<Item = Cell>,
        radius_px: f64,
        color: Rgb,
    ) -> bool {
        let mut data = String::new();
        for cell in cells {
            // A line without length has round ends.
            let _ = write!(data, "M{} {}h0", cell.x, cell.y);
        }
        self.cell_lines(&data, color, 2.0 * radius_px)
    }

    /// Draws lines whose coordinates are cells, and say their centres.
    fn cell_lines(&mut self, data: &str, color: Rgb, width_px: f64) -> bool {
        if data.is_empty() {
            return false;
        }
        let frame = self.map.frame();
        let [a, b, c, d, e, f] = self.view.px_from_grid(frame, Cell::new(0, 0), 1);
        let matrix = [a, b, c, d, e + 0.5 * (a + c), f + 0.5 * (b + d)].map(matrix_entry);
        let width_cells = width_px / (self.view.px_per_m() * frame.resolution_m());
        self.body
            .tag("path")
            .attr("transform", &format!("matrix({})", matrix.join(" ")))
            .attr("fill", "none")
            .attr("stroke", &color.to_string())
            .attr("stroke-width", &matrix_entry(width_cells))
            .attr("stroke-linecap", "round")
            .attr("d", data)
            .leaf();
        true
    }

    /// Draws a line in pixels; says whether there was one.
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
