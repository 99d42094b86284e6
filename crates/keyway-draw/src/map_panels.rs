//! Small multiples: one map in many panels with different layers.

use crate::axes::{BOTTOM_AXIS_PX, Scale, border};
use crate::axis::Axis;
use crate::canvas::Canvas;
use crate::caption::{Caption, EDGE_PX, HEAD_PX, draw_title};
use crate::color::UNKNOWN;
use crate::layers::{Depth, Layer};
use crate::legend::{Legend, LegendEntry};
use crate::map_picture::{MapPicture, draw_map, map_axes};
use crate::name_lines::NameLines;
use crate::svg::Svg;
use crate::view::{Extent, View};
use crate::writer::{Anchor, SvgWriter};

/// Longer side of a panel's plot area \[px\].
const PANEL_PX: f64 = 250.0;
/// Maximum ratio of height to width up to which tall panels are enlarged.
const MAX_SLIMNESS: f64 = 3.0;
/// Maximum width of a row of panels \[px\]; the larger one applies to many panels.
const ROW_PX: f64 = 840.0;
const LONG_ROW_PX: f64 = 1120.0;
const MANY_PANELS: usize = 10;
/// Distance between panels \[px\].
const GAP_PX: f64 = 18.0;
/// Distance between a panel and its title \[px\].
const TITLE_GAP_PX: f64 = 6.0;
/// Minimum width of a legend, which may be wider than a narrow panel \[px\].
const MIN_LEGEND_PX: f64 = 120.0;
/// Maximum number of cells along the longer side of a panel: more than its PNG has pixels would
/// not be visible.
const MAX_SIDE_CELLS: i32 = 1024;

/// Panels with the same map, in rows and columns, so that many lines can be distinguished.
///
/// Each panel has its own title and legend; layers of all panels are explained once, below them.
/// There is no space for colour bars, which are left out.
pub struct MapPanels<'a> {
    common: MapPicture<'a>,
    panels: Vec<Panel<'a>>,
    caption: String,
}

struct Panel<'a> {
    title: String,
    layers: Vec<Box<dyn Layer + 'a>>,
}

impl<'a> MapPanels<'a> {
    /// Creates panels from the layers of all panels, and the title of the whole.
    pub const fn new(common: MapPicture<'a>) -> Self {
        Self { common, panels: Vec::new(), caption: String::new() }
    }

    /// Sets the caption below the panels.
    #[must_use]
    pub fn caption(self, text: impl Into<String>) -> Self {
        Self { caption: text.into(), ..self }
    }

    /// Adds a panel with its own layers.
    #[must_use]
    pub fn panel(mut self, title: impl Into<String>, layers: Vec<Box<dyn Layer + 'a>>) -> Self {
        self.panels.push(Panel { title: title.into(), layers });
        self
    }

    /// Draws the picture.
    pub fn svg(&self) -> Svg {
        let view = self.view();
        let mut ground = Canvas::new(self.common.map, view, MAX_SIDE_CELLS);
        draw_map(&mut ground);
        let layers = self.common.layers.iter().filter(|layer| layer.depth() <= Depth::Tint);
        layers.for_each(|layer| layer.draw(&mut ground));
        let drawn: Vec<Drawn<'_>> = self.panels.iter().map(|one| self.drawn(one, view)).collect();
        let common = drawn.first().map_or(&[][..], |panel| &panel.common);
        let shared: Vec<LegendEntry> = ground.entries.iter().chain(common).cloned().collect();
        let grid = Grid::new(&view, &drawn, &self.common.title);
        let mut out = SvgWriter::new();
        draw_title(&mut out, &self.common.title, grid.left, grid.width_px());
        let ground = define_ground(&mut out, ground.body);
        for (i, panel) in drawn.into_iter().enumerate() {
            grid.draw(&mut out, i, panel, &ground);
        }
        let legend = Legend::new(&shared, grid.width_px().max(300.0));
        legend.draw(&mut out, grid.left, grid.bottom());
        let right = grid.left + grid.width_px().max(legend.width_px());
        let caption = Caption::new(&self.caption, right - EDGE_PX);
        let caption_y = grid.bottom() + legend.height_px() + 8.0;
        caption.draw(&mut out, EDGE_PX, caption_y);
        let right = right.max(EDGE_PX + caption.width_px());
        let height = caption_y + caption.height_px() + EDGE_PX;
        Svg::page(right + EDGE_PX + GAP_PX, height, out)
    }

    /// Returns one view for all panels, which contains the layers of each.
    fn view(&self) -> View {
        let mut extent = Extent::default();
        let own = self.panels.iter().flat_map(|panel| &panel.layers);
        self.common.layers.iter().chain(own).for_each(|layer| layer.extend(&mut extent));
        let of_side = |side_px: f64| {
            View::new(self.common.region.extent(self.common.map, extent, side_px), side_px)
        };
        let view = of_side(PANEL_PX);
        // A narrow panel is as wide as its legend anyway.
        let slimness = (view.height_px() / view.width_px()).clamp(1.0, MAX_SLIMNESS);
        of_side(PANEL_PX * slimness.sqrt())
    }

    /// Draws all layers over the base map of a panel.
    fn drawn<'b>(&'b self, panel: &'b Panel<'a>, view: View) -> Drawn<'b> {
        let mut canvas = Canvas::new(self.common.map, view, MAX_SIDE_CELLS);
        let common = self.common.layers.iter().map(|layer| (false, layer));
        let own = panel.layers.iter().map(|layer| (true, layer));
        let mut layers: Vec<_> =
            common.filter(|(_, layer)| layer.depth() > Depth::Tint).chain(own).collect();
        layers.sort_by_key(|(_, layer)| layer.depth());
        let mut drawn = Drawn { title: &panel.title, ..Drawn::default() };
        for (is_own, layer) in layers {
            layer.draw(&mut canvas);
            let entries = if is_own { &mut drawn.own } else { &mut drawn.common };
            let new = canvas.entries.drain(..).filter(|entry| !entries.contains(entry));
            let new: Vec<LegendEntry> = new.collect();
            entries.extend(new);
        }
        Drawn { body: canvas.body, ..drawn }
    }
}

/// Writes the common base map, which is used by its name. The name is derived from the content,
/// so several pictures can be in one page.
fn define_ground(out: &mut SvgWriter, ground: SvgWriter) -> String {
    let text = ground.finish();
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let name = format!("ground-{:016x}", text.bytes().fold(0xcbf2_9ce4_8422_2325, mix));
    out.tag("defs").open();
    out.tag("g").attr("id", &name).open();
    out.raw(&text);
    out.close();
    out.close();
    name
}

/// A panel without its base map.
#[derive(Default)]
struct Drawn<'a> {
    title: &'a str,
    body: SvgWriter,
    /// Legend of the panel's own layers.
    own: Vec<LegendEntry>,
    /// Legend of the layers of all panels.
    common: Vec<LegendEntry>,
}

impl Drawn<'_> {
    fn legend(&self, view: &View) -> Legend<'_> {
        Legend::new(&self.own, view.width_px().max(MIN_LEGEND_PX))
    }

    /// Returns the title, no wider than the panel, so that it does not reach neighbours and axes.
    fn title(&self, view: &View) -> NameLines {
        NameLines::new(self.title, view.width_px().max(MIN_LEGEND_PX))
    }
}

/// Layout of the panels.
struct Grid {
    view: View,
    count: usize,
    columns: usize,
    /// Width of a panel with its legend, and the gap to the next one \[px\].
    cell_px: f64,
    gap_px: f64,
    x_axis: Axis,
    y_axis: Axis,
    /// Left edge of the plot areas of the first column \[px\].
    left: f64,
    /// Upper edges of the rows, and the lower edge of the last one \[px\].
    tops: Vec<f64>,
    /// Height of the titles of each row \[px\].
    heads_px: Vec<f64>,
}

impl Grid {
    fn new(view: &View, panels: &[Drawn<'_>], title: &str) -> Self {
        let (x_axis, y_axis) = map_axes(view);
        let width_px =
            |panel: &Drawn<'_>| panel.legend(view).width_px().max(panel.title(view).width_px());
        let cell_px = panels.iter().map(width_px).fold(view.width_px(), f64::max);
        let count = panels.len();
        let row_px = if count < MANY_PANELS { ROW_PX } else { LONG_ROW_PX };
        // The last number below a panel and the first one below the next are side by side.
        let gap_px = GAP_PX.max(view.width_px() + x_axis.widest_px() + 6.0 - cell_px);
        let fitting = ((row_px + gap_px) / (cell_px + gap_px)) as usize;
        let rows = count.div_ceil(fitting.clamp(1, count.max(1)));
        // Rows are filled as evenly as possible.
        let columns = count.div_ceil(rows.max(1)).max(1);
        let head = EDGE_PX + if title.is_empty() { 2.0 } else { HEAD_PX };
        let left = EDGE_PX + y_axis.side_px();
        let mut grid = Self {
            view: *view,
            count,
            columns,
            cell_px,
            gap_px,
            x_axis,
            y_axis,
            left,
            tops: vec![head],
            heads_px: Vec::new(),
        };
        for (row, panels) in panels.chunks(columns).enumerate() {
            let title = panels.iter().map(|panel| panel.title(view).height_px());
            grid.heads_px.push(title.fold(0.0, f64::max) + TITLE_GAP_PX);
            let legend = panels.iter().map(|panel| panel.legend(view).height_px());
            let axis = if grid.is_lowest(row) { BOTTOM_AXIS_PX } else { 0.0 };
            let height =
                grid.heads_px[row] + view.height_px() + axis + 4.0 + legend.fold(0.0, f64::max);
            grid.tops.push(grid.tops[row] + height + GAP_PX);
        }
        grid
    }

    /// True if there is no row below this one, which then has the x axis.
    const fn is_lowest(&self, row: usize) -> bool {
        (row + 1) * self.columns >= self.count
    }

    fn width_px(&self) -> f64 {
        self.columns as f64 * (self.cell_px + self.gap_px) - self.gap_px
    }

    fn bottom(&self) -> f64 {
        self.tops.last().copied().unwrap_or_default()
    }

    fn draw(&self, out: &mut SvgWriter, index: usize, panel: Drawn<'_>, ground: &str) {
        let (row, column) = (index / self.columns, index % self.columns);
        let (width, height) = (self.view.width_px(), self.view.height_px());
        let left = self.left + column as f64 * (self.cell_px + self.gap_px);
        let top = self.tops[row] + self.heads_px[row];
        let bottom = top + height;
        panel.title(&self.view).draw(out, left + 0.5 * width, top - TITLE_GAP_PX, Anchor::Middle);
        let legend_y = bottom + 4.0 + if self.is_lowest(row) { BOTTOM_AXIS_PX } else { 0.0 };
        panel.legend(&self.view).draw(out, left, legend_y);
        // A nested `svg` clips its content; unlike a clip path it needs no name.
        out.tag("svg").at(left, top).size(width, height).open();
        out.tag("rect").size(width, height).fill(UNKNOWN).leaf();
        out.tag("use").attr("href", &format!("#{ground}")).leaf();
        out.append(panel.body);
        out.close();
        border(out, left, top, width, height);
        if self.is_lowest(row) {
            Scale::across(&self.x_axis, left, left + width).draw_below(out, bottom);
        }
        if column == 0 {
            let scale = Scale::upright(&self.y_axis, top, bottom);
            scale.draw_left(out, left, self.y_axis.side_px());
        }
    }
}
