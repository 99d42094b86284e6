//! A picture of a map with its layers, axes and legend.

use crate::axes::{BOTTOM_AXIS_PX, Scale, border};
use crate::axis::Axis;
use crate::canvas::Canvas;
use crate::caption::{EDGE_PX, HEAD_PX, draw_title};
use crate::color::{FREE, OCCUPIED, UNKNOWN};
use crate::layers::{Depth, Layer};
use crate::legend::{ColorBar, Legend, LegendEntry, LegendMark};
use crate::svg::Svg;
use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::text_table::TextTable;
use crate::ticks::Ticks;
use crate::view::{Extent, Region, View};
use crate::writer::SvgWriter;
use keyway::map::OccupancyGrid;

/// Default length of the plot area's longer side \[px\]: the text is readable if the picture is
/// printed as wide as a column.
const DEFAULT_SIDE_PX: f64 = 520.0;
/// Ratio of height to width from which on the legend is beside the plot.
const TALL: f64 = 1.25;
/// Distance between the parts of the page \[px\].
const GAP_PX: f64 = 14.0;
/// Maximum number of cells along the longer side of a picture: more than its PNG has pixels would
/// not be visible.
const MAX_SIDE_CELLS: i32 = 4096;
/// Longest colour bar \[px\].
const MAX_BAR_PX: f64 = 360.0;
/// Target distance between two ticks \[px\].
const TICK_DISTANCE_PX: f64 = 48.0;

/// A picture of a map in world coordinates: free cells are white, occupied ones nearly black,
/// unknown ones and everything outside the map grey. Layers are drawn over it in the order of
/// their [`Depth`](crate::layers::Depth).
pub struct MapPicture<'a> {
    pub(crate) map: &'a OccupancyGrid,
    pub(crate) layers: Vec<Box<dyn Layer + 'a>>,
    pub(crate) region: Region,
    pub(crate) title: String,
    table: TextTable,
    side_px: f64,
    max_side_cells: i32,
}

impl<'a> MapPicture<'a> {
    /// Creates a picture of the map alone.
    pub fn new(map: &'a OccupancyGrid) -> Self {
        Self {
            map,
            layers: Vec::new(),
            region: Region::default(),
            title: String::new(),
            table: TextTable::new(),
            side_px: DEFAULT_SIDE_PX,
            max_side_cells: MAX_SIDE_CELLS,
        }
    }

    /// Adds a layer over the map.
    #[must_use]
    pub fn with(mut self, layer: impl Layer + 'a) -> Self {
        self.layers.push(Box::new(layer));
        self
    }

    /// Adds a boxed layer over the map.
    #[must_use]
    pub fn with_boxed(mut self, layer: Box<dyn Layer + 'a>) -> Self {
        self.layers.push(layer);
        self
    }

    /// Sets the part of the world that is shown.
    #[must_use]
    pub fn region(self, region: Region) -> Self {
        Self { region, ..self }
    }

    /// Sets the title above the picture.
    #[must_use]
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Sets the table below the picture.
    #[must_use]
    pub fn table(self, table: TextTable) -> Self {
        Self { table, ..self }
    }

    /// Sets the length of the plot area's longer side \[px\], 100 to 4000. Text does not grow
    /// with it.
    #[must_use]
    pub fn side_px(self, side_px: f64) -> Self {
        let side_px = if side_px.is_nan() { DEFAULT_SIDE_PX } else { side_px };
        Self { side_px: side_px.clamp(100.0, 4000.0), ..self }
    }

    /// Draws cells in blocks, at most this many along the longer side.
    #[cfg(feature = "raster")]
    pub(crate) fn max_side_cells(self, max_side_cells: i32) -> Self {
        Self { max_side_cells, ..self }
    }

    /// Draws the picture.
    pub fn svg(&self) -> Svg {
        Page::new(&self.title, self.canvas(self.view(), Depth::Ground)).svg(&self.table)
    }

    /// Draws the picture in the layout of another one, so that both have the same size and the
    /// same legend, as frames of an animation.
    pub fn svg_in(&self, layout: &Layout) -> Svg {
        self.page_in(self.canvas(layout.view, Depth::Ground), layout)
    }

    /// Draws the page of a canvas with the legend of a layout.
    fn page_in(&self, mut canvas: Canvas<'_>, layout: &Layout) -> Svg {
        canvas.entries.clone_from(&layout.entries);
        canvas.bars.clone_from(&layout.bars);
        Page::new(&self.title, canvas).svg(&self.table)
    }

    /// Draws the page with the base only (the map and its tints), its cells in blocks, at most
    /// this many along the longer side.
    #[cfg(feature = "raster")]
    pub(crate) fn ground_in(&self, layout: &Layout, max_side_cells: i32) -> Svg {
        let mut canvas = Canvas::new(self.map, layout.view, max_side_cells);
        draw_map(&mut canvas);
        let tints = self.layers.iter().filter(|layer| layer.depth() < Depth::Search);
        tints.for_each(|layer| layer.draw(&mut canvas));
        self.page_in(canvas, layout)
    }

    /// Draws only the layers above the base, without a page, to be drawn over [`Self::ground_in`]
    /// of the same layout, which is then drawn once for many pictures.
    #[cfg(feature = "raster")]
    pub(crate) fn over_ground_in(&self, layout: &Layout) -> Svg {
        Page::new(&self.title, self.canvas(layout.view, Depth::Search)).over_ground()
    }

    /// Returns the layout of the picture.
    pub fn layout(&self) -> Layout {
        let canvas = self.canvas(self.view(), Depth::Ground);
        Layout { view: *canvas.view(), entries: canvas.entries, bars: canvas.bars }
    }

    /// Returns the same layout with the legend entries of further pictures, each once.
    #[cfg(feature = "raster")]
    pub(crate) fn layout_with<'b>(&self, others: impl Iterator<Item = MapPicture<'b>>) -> Layout {
        let mut layout = self.layout();
        for other in others {
            for entry in other.canvas(layout.view, Depth::Search).entries {
                if !layout.entries.contains(&entry) {
                    layout.entries.push(entry);
                }
            }
        }
        layout
    }

    fn view(&self) -> View {
        let mut extent = Extent::default();
        self.layers.iter().for_each(|layer| layer.extend(&mut extent));
        View::new(self.region.extent(self.map, extent, self.side_px), self.side_px)
    }

    /// Draws the map with all layers, from a depth on.
    fn canvas(&self, view: View, from: Depth) -> Canvas<'a> {
        let mut canvas = Canvas::new(self.map, view, self.max_side_cells);
        if from == Depth::Ground {
            draw_map(&mut canvas);
        }
        let layers = self.layers.iter().map(AsRef::as_ref);
        let mut layers: Vec<&dyn Layer> = layers.filter(|layer| layer.depth() >= from).collect();
        // The sort is stable: layers that were added first stay behind.
        layers.sort_by_key(|layer| layer.depth());
        for layer in layers {
            layer.draw(&mut canvas);
        }
        canvas
    }
}

/// View and legend of a picture.
#[derive(Clone, Debug)]
pub struct Layout {
    view: View,
    entries: Vec<LegendEntry>,
    bars: Vec<ColorBar>,
}

/// Paints free and occupied cells; the background shows unknown ones.
pub(crate) fn draw_map(canvas: &mut Canvas<'_>) {
    let map = canvas.map();
    let (occupied, unknown) = (map.occupied(), map.unknown());
    if canvas.cells(FREE, |cell| !occupied.get(cell) && !unknown.get(cell)) {
        canvas.explain(LegendEntry::new("free", LegendMark::Area(FREE)));
    }
    if canvas.cells(OCCUPIED, |cell| occupied.get(cell)) {
        canvas.explain(LegendEntry::new("occupied", LegendMark::Area(OCCUPIED)));
    }
    if canvas.shows_unknown() {
        canvas.explain(LegendEntry::new("unknown", LegendMark::Area(UNKNOWN)));
    }
}

/// The parts of the page and their positions.
struct Page<'a> {
    title: &'a str,
    canvas: Canvas<'a>,
    x_axis: Axis,
    y_axis: Axis,
    /// Upper left corner of the plot area.
    left: f64,
    top: f64,
}

impl<'a> Page<'a> {
    fn new(title: &'a str, canvas: Canvas<'a>) -> Self {
        let (x_axis, y_axis) = map_axes(canvas.view());
        let left = EDGE_PX + y_axis.side_px();
        let top = EDGE_PX + if title.is_empty() { 2.0 } else { HEAD_PX };
        Self { title, canvas, x_axis, y_axis, left, top }
    }

    fn svg(mut self, table: &TextTable) -> Svg {
        let view = *self.canvas.view();
        let (width, height) = (view.width_px(), view.height_px());
        let mut out = SvgWriter::new();
        self.draw_plot(&mut out);
        let right = self.draw_bars(&mut out);
        let bottom = self.top + height + BOTTOM_AXIS_PX;
        let entries = std::mem::take(&mut self.canvas.entries);
        let (page_width, page_height) = if height > TALL * width {
            let legend = Legend::new(&entries, 0.0);
            legend.draw(&mut out, right + GAP_PX, self.top);
            let page_width = right + GAP_PX + legend.width_px();
            (page_width, bottom.max(self.top + legend.height_px()))
        } else {
            // As wide as the picture is anyway, but with a minimum width.
            let legend = Legend::new(&entries, (right - self.left).max(300.0));
            legend.draw(&mut out, self.left, bottom + 8.0);
            let page_width = right.max(self.left + legend.width_px());
            (page_width, bottom + 8.0 + legend.height_px())
        };
        let page_width = page_width.max(draw_title(&mut out, self.title, self.left, width));
        let table_px = table.height_px();
        table.draw(&mut out, self.left, page_height + GAP_PX);
        let page_width = page_width.max(self.left + table.width_px());
        let page_height = page_height + if table_px > 0.0 { GAP_PX + table_px } else { 0.0 };
        Svg::page(page_width + EDGE_PX, page_height + EDGE_PX, out)
    }

    /// Draws the plot alone, without a background.
    #[cfg(feature = "raster")]
    fn over_ground(mut self) -> Svg {
        let view = *self.canvas.view();
        let mut out = SvgWriter::new();
        out.tag("svg").at(self.left, self.top).size(view.width_px(), view.height_px()).open();
        out.append(std::mem::take(&mut self.canvas.body));
        Svg::sheet(self.left + view.width_px(), self.top + view.height_px(), out)
    }

    fn draw_plot(&mut self, out: &mut SvgWriter) {
        let view = *self.canvas.view();
        let (width, height) = (view.width_px(), view.height_px());
        // A nested `svg` clips its content; unlike a clip path it needs no name.
        out.tag("svg").at(self.left, self.top).size(width, height).open();
        out.tag("rect").size(width, height).fill(UNKNOWN).leaf();
        out.append(std::mem::take(&mut self.canvas.body));
        out.close();
        border(out, self.left, self.top, width, height);
        let bottom = self.top + height;
        Scale::across(&self.x_axis, self.left, self.left + width).draw_below(out, bottom);
        let y_scale = Scale::upright(&self.y_axis, self.top, bottom);
        y_scale.draw_left(out, self.left, self.y_axis.side_px());
    }

    /// Draws the colour bars; returns the right edge of everything drawn.
    fn draw_bars(&self, out: &mut SvgWriter) -> f64 {
        let view = self.canvas.view();
        let mut right = self.left + view.width_px();
        let height = view.height_px().min(MAX_BAR_PX);
        for bar in &self.canvas.bars {
            let x = right + GAP_PX;
            bar.draw(out, x, self.top, height);
            right = x + bar.width_px(height);
        }
        // The last number below the plot may extend beyond it.
        let last = self.x_axis.marks.last();
        let last = last.map_or(0.0, |(_, text)| text_width_px(text, SMALL_TEXT_PX));
        right.max(self.left + view.width_px() + 0.5 * last)
    }
}

/// Returns the axes x and y, whose ticks have the same step, coarse enough for their numbers to
/// be side by side.
pub(crate) fn map_axes(view: &View) -> (Axis, Axis) {
    let (min, max) = view.corners();
    let side_px = view.width_px().max(view.height_px());
    let mut distance = TICK_DISTANCE_PX;
    loop {
        let intervals = ((side_px / distance) as usize).max(1);
        let long = (max.x - min.x).max(max.y - min.y);
        let step = Ticks::new(0.0, long, intervals).step;
        let axis = |low, high| Axis::with_ticks(low, high, &Ticks::with_step(low, high, step));
        let x_axis = axis(min.x, max.x).label("x [m]");
        if x_axis.widest_px() + 10.0 <= step * view.px_per_m() || intervals == 1 {
            return (x_axis, axis(min.y, max.y).label("y [m]"));
        }
        distance *= 1.25;
    }
}
