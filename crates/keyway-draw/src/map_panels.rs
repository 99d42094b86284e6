//! One map many times, each time with something else on it: small multiples.

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
/// Panels that are higher than wide are larger, as long as they are not slimmer than this.
const MAX_SLIMNESS: f64 = 3.0;
/// Panels stand side by side as long as they are not wider together than this \[px\]; many of them
/// than that.
const ROW_PX: f64 = 840.0;
const LONG_ROW_PX: f64 = 1120.0;
const MANY_PANELS: usize = 10;
/// Between panels \[px\].
const GAP_PX: f64 = 18.0;
/// Between a panel and its title \[px\].
const TITLE_GAP_PX: f64 = 6.0;
/// A narrow panel's legend may be wider than the panel \[px\].
const MIN_LEGEND_PX: f64 = 120.0;
/// Cells along the longer side of a panel: more than its PNG has pixels cannot be seen.
const MAX_SIDE_CELLS: i32 = 1024;

/// Panels with the same map, side by side and below each other, so that many lines can be told
/// apart.
///
/// Each panel has a title and a legend of its own; what all panels show is explained once, below
/// them. Colour bars have no place here and are left out.
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
    /// What all panels show, and the title of the whole.
    pub const fn new(common: MapPicture<'a>) -> Self {
        Self { common, panels: Vec::new(), caption: String::new() }
    }

    /// What is to be said below.
    #[must_use]
    pub fn caption(self, text: impl Into<String>) -> Self {
        Self { caption: text.into(), ..self }
    }

    /// Adds a panel with what it alone shows.
    #[must_use]
    pub fn panel(mut self, title: impl Into<String>, layers: Vec<Box<dyn Layer + 'a>>) -> Self {
        self.panels.push(Panel { title: title.into(), layers });
        self
    }

    /// The picture.
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

    /// One for all panels: what one of them shows is in view.
    fn view(&self) -> View {
        let mut extent = Extent::default();
        let own = self.panels.iter().flat_map(|panel| &panel.layers);
        self.common.layers.iter().chain(own).for_each(|layer| layer.extend(&mut extent));
        let of_side = |side_px: f64| {
            View::new(self.common.region.extent(self.common.map, extent, side_px), side_px)
        };
        let view = of_side(PANEL_PX);
        // A narrow panel takes its width for its legend anyway.
        let slimness = (view.height_px() / view.width_px()).clamp(1.0, MAX_SLIMNESS);
        of_side(PANEL_PX * slimness.sqrt())
    }

    /// All that is drawn over the ground of a panel.
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

/// Writes what all panels stand on, to be used by its name. The name comes from the content:
/// several pictures can then stand in one page.
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

/// A panel without its ground.
#[derive(Default)]
struct Drawn<'a> {
    title: &'a str,
    body: SvgWriter,
    /// What the panel alone shows.
    own: Vec<LegendEntry>,
    /// What all panels show.
    common: Vec<LegendEntry>,
}

impl Drawn<'_> {
    fn legend(&self, view: &View) -> Legend<'_> {
        Legend::new(&self.own, view.width_px().max(MIN_LEGEND_PX))
    }

    /// No wider than the panel, so that neighbours and axes have their room.
    fn title(&self, view: &View) -> NameLines {
        NameLines::new(self.title, view.width_px().max(MIN_LEGEND_PX))
    }
}

/// Where the panels stand.
struct Grid {
    view: View,
    count: usize,
    columns: usize,
    /// Width of a panel with its legend, and from there to the next one \[px\].
    cell_px: f64,
    gap_px: f64,
    x_axis: Axis,
    y_axis: Axis,
    /// Left edge of the plot areas of the first column \[px\].
    left: f64,
    /// Upper edges of the rows, and the lower edge of the last one \[px\].
    tops: Vec<f64>,
    /// Room for the titles of each row \[px\].
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
        // The last number below a panel and the first one below the next stand side by side.
        let gap_px = GAP_PX.max(view.width_px() + x_axis.widest_px() + 6.0 - cell_px);
        let fitting = ((row_px + gap_px) / (cell_px + gap_px)) as usize;
        let rows = count.div_ceil(fitting.clamp(1, count.max(1)));
        // As many in every row as can be.
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
        // A nested `svg` cuts off what lies outside; unlike a clip path it needs no name.
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
