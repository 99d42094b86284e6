//! Charts: panels over a common axis, with a title, a legend and a caption.

use crate::axes::{BOTTOM_AXIS_PX, Scale, border};
use crate::axis::Axis;
use crate::caption::{Caption, EDGE_PX, HEAD_PX, draw_title};
use crate::legend::{Legend, LegendEntry};
use crate::name_lines::NameLines;
use crate::plot::{Plot, PlotArea};
use crate::svg::Svg;
use crate::writer::{Anchor, SvgWriter};

/// Distance between panels side by side \[px\].
pub(crate) const COLUMN_GAP_PX: f64 = 14.0;
/// Distance between the lower axis and the legend \[px\].
const LEGEND_GAP_PX: f64 = 8.0;

/// A chart: one or several panels over a common lower axis, with titles, legend and caption.
///
/// ```
/// use keyway_draw::{Axis, Chart, ChartPoint, series_style};
///
/// let squares = (0..=10).map(f64::from).map(|x| ChartPoint::new(x, x * x));
/// let chart = Chart::new(Axis::linear(0.0, 10.0, 5).label("side [m]"), 420.0, 170.0)
///     .title("Squares")
///     .panel(Axis::linear(0.0, 100.0, 5).label("area [m\u{b2}]"), move |plot| {
///         plot.line(squares.clone(), series_style(0));
///     });
/// assert!(chart.svg().as_str().contains("Squares"));
/// ```
#[must_use]
pub struct Chart<'a> {
    title: String,
    caption: String,
    entries: Vec<LegendEntry>,
    x_axis: Axis,
    names: Vec<String>,
    panels: Vec<(Axis, Draw<'a>)>,
    columns: usize,
    width_px: f64,
    height_px: f64,
    pub(crate) margins: Margins,
}

type Draw<'a> = Box<dyn Fn(&mut Plot<'_>) + 'a>;

/// Space around and between the panels \[px\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Margins {
    /// Distance between panels below each other.
    pub(crate) row_gap_px: f64,
    /// Distance between the lower axis and the caption, except for the legend.
    pub(crate) caption_gap_px: f64,
    /// Space right of the panels that the caption may use; at least the notes of categories.
    pub(crate) beside: f64,
    /// Margin right of everything.
    pub(crate) right_px: f64,
}

impl Margins {
    pub(crate) const DEFAULT: Self =
        Self { row_gap_px: 14.0, caption_gap_px: 12.0, beside: 0.0, right_px: EDGE_PX + 8.0 };
    /// Margins for rows with names and notes.
    pub(crate) const ROWS: Self = Self { caption_gap_px: 6.0, right_px: EDGE_PX, ..Self::DEFAULT };
}

impl<'a> Chart<'a> {
    /// Creates a chart of panels of the given width and height \[px\] over an axis. With a
    /// vertical axis of categories, the panels are as high as these need.
    pub const fn new(x_axis: Axis, width_px: f64, height_px: f64) -> Self {
        Self {
            title: String::new(),
            caption: String::new(),
            entries: Vec::new(),
            x_axis,
            names: Vec::new(),
            panels: Vec::new(),
            columns: 1,
            width_px,
            height_px,
            margins: Margins::DEFAULT,
        }
    }

    /// Sets the title above the panels; empty for none.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Sets the caption, which is wrapped; empty for none.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    /// Sets the legend, below the panels.
    pub fn legend(self, entries: impl IntoIterator<Item = LegendEntry>) -> Self {
        Self { entries: entries.into_iter().collect(), ..self }
    }

    /// Sets names above the panels, and arranges them in `columns` columns. Only the first panel
    /// of each row shows its vertical axis, which should be the same for all.
    pub fn side_by_side(self, columns: usize, names: &[&str]) -> Self {
        let names = names.iter().map(|&name| name.to_owned()).collect();
        Self { columns: columns.max(1), names, ..self }
    }

    /// Adds a panel; `draw` draws over the grid.
    pub fn panel(mut self, y_axis: Axis, draw: impl Fn(&mut Plot<'_>) + 'a) -> Self {
        self.panels.push((y_axis, Box::new(draw)));
        self
    }

    /// Draws the chart.
    pub fn svg(&self) -> Svg {
        let layout = Layout::new(self);
        let count = self.panels.len().max(1);
        let (first, last) = (layout.area(0), layout.area(count - 1));
        let (left, right) = (first.left_px, layout.area(count.min(self.columns) - 1).right_px);
        let mut out = SvgWriter::new();
        for i in 0..self.panels.len() {
            self.draw_panel(&mut out, &layout, i);
        }
        if self.panels.is_empty() {
            Scale::across(&self.x_axis, left, right).draw_below(&mut out, last.bottom_px);
        }
        let title_right = draw_title(&mut out, &self.title, left, right - left);
        let below = last.bottom_px + BOTTOM_AXIS_PX;
        let legend = Legend::new(&self.entries, right - left);
        legend.draw(&mut out, left, below + LEGEND_GAP_PX);
        let notes = self.panels.iter().map(|(axis, _)| axis.notes_px());
        let beside = notes.fold(self.margins.beside, f64::max);
        let right = (right + beside).max(left + legend.width_px()).max(title_right);
        let caption = Caption::new(&self.caption, right - EDGE_PX);
        let caption_y = below + self.margins.caption_gap_px + legend.height_px();
        caption.draw(&mut out, EDGE_PX, caption_y);
        let right = right.max(EDGE_PX + caption.width_px()) + self.margins.right_px;
        Svg::page(right, caption_y + caption.height_px() + EDGE_PX, out)
    }

    fn draw_panel(&self, out: &mut SvgWriter, layout: &Layout<'_>, index: usize) {
        let (area, (y_axis, draw)) = (layout.area(index), &self.panels[index]);
        let PlotArea { left_px, top_px, right_px, bottom_px } = area;
        if let Some(name) = layout.names.get(index) {
            name.draw(out, 0.5 * (left_px + right_px), top_px - 5.0, Anchor::Middle);
        }
        let x_scale = Scale::across(&self.x_axis, left_px, right_px);
        let y_scale = Scale::upright(y_axis, top_px, bottom_px);
        let mut plot = Plot { out, x_scale, y_scale, area };
        plot.draw_grid();
        draw(&mut plot);
        border(out, left_px, top_px, right_px - left_px, bottom_px - top_px);
        if index.is_multiple_of(self.columns) {
            y_scale.draw_left(out, left_px, layout.axis_px);
        }
        y_scale.draw_notes(out, right_px);
        if index + self.columns >= self.panels.len() {
            x_scale.draw_below(out, bottom_px);
        }
    }
}

/// Layout of the panels.
struct Layout<'a> {
    chart: &'a Chart<'a>,
    names: Vec<NameLines>,
    /// Height of the name above each panel.
    name_px: f64,
    /// Width of the vertical axis.
    axis_px: f64,
    /// Height of each panel.
    height_px: f64,
}

impl<'a> Layout<'a> {
    fn new(chart: &'a Chart<'a>) -> Self {
        let names = chart.names.iter().map(|name| NameLines::new(name, chart.width_px));
        let names: Vec<NameLines> = names.collect();
        let name_px = names.iter().map(|name| name.height_px() + 0.5).fold(0.0, f64::max);
        let axes = || chart.panels.iter().map(|(axis, _)| axis);
        let axis_px = axes().map(Axis::side_px).fold(0.0, f64::max);
        let lengths_px = axes().filter_map(Axis::length_px);
        let height_px = lengths_px.reduce(f64::max).unwrap_or(chart.height_px);
        Self { chart, names, name_px, axis_px, height_px }
    }

    fn area(&self, index: usize) -> PlotArea {
        let Chart { columns, width_px, margins, .. } = self.chart;
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        let head_px = if self.chart.title.is_empty() { 4.0 } else { HEAD_PX };
        let pitch_px = self.name_px + self.height_px + margins.row_gap_px;
        let top_px = EDGE_PX + head_px + self.name_px + row * pitch_px;
        let left_px = EDGE_PX + self.axis_px + column * (width_px + COLUMN_GAP_PX);
        let (right_px, bottom_px) = (left_px + width_px, top_px + self.height_px);
        PlotArea { left_px, top_px, right_px, bottom_px }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LineStyle;
    use crate::legend::LegendMark;

    fn size_px(svg: &Svg) -> [f64; 2] {
        ["width", "height"].map(|side| {
            let (_, rest) = svg.as_str().split_once(&format!("{side}=\"")).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        })
    }

    fn chart(panels: usize) -> Chart<'static> {
        let axis = || Axis::linear(0.0, 1.0, 2);
        let chart = Chart::new(axis().label("x [m]"), 120.0, 80.0);
        (0..panels).fold(chart, |chart, _| chart.panel(axis().label("y [m]"), |_| {}))
    }

    #[test]
    fn every_part_that_is_asked_for_is_there() {
        let entry = LegendEntry::new("an <entry>", LegendMark::Line(LineStyle::LIMIT));
        let svg = chart(2).title("A title").caption("A caption.").legend([entry]).svg();
        for text in ["A title", "A caption.", "an &lt;entry&gt;", "x [m]", "y [m]"] {
            assert!(svg.as_str().contains(&format!(">{text}</text>")), "{text}");
        }
        // One lower axis, and a vertical one for each panel.
        let count = |text: &str| svg.as_str().matches(text).count();
        assert_eq!((count("x [m]"), count("y [m]")), (1, 2));
        let [width, height] = size_px(&svg);
        let [bare_width, bare_height] = size_px(&chart(2).svg());
        assert!(width == bare_width && height > bare_height + 30.0);
    }

    #[test]
    fn panels_stand_below_each_other_or_side_by_side() {
        let [width, height] = size_px(&chart(1).svg());
        assert_eq!(size_px(&chart(3).svg()), [width, height + 2.0 * 94.0]);
        // Two in a row: a lower axis below each column, a vertical one at the left of each row.
        let svg = chart(3).side_by_side(2, &["a", "b", "c"]).svg();
        let count = |text: &str| svg.as_str().matches(text).count();
        assert_eq!((count("x [m]"), count("y [m]"), count(">b<")), (2, 2, 1));
        assert_eq!(size_px(&svg)[0], width + 134.0);
        assert!(size_px(&chart(0).side_by_side(0, &[]).svg()) < [width, height]);
    }
}
