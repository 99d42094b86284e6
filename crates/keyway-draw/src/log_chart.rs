//! Quantities against one another on logarithmic axes, in which a power is a straight line: charts
//! one above the other over one axis.

use crate::axes::{
    BOTTOM_AXIS_PX, Scale, TITLE_PX, border, marked_bottom_axis, marked_left_axis,
    marked_side_axis_px,
};
use crate::color::{GRID, SERIES};
use crate::legend::{Entry, Legend, Sample};
use crate::line_style::LineStyle;
use crate::svg::Svg;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, PathData, SvgWriter};

const WIDTH_PX: f64 = 420.0;
const PANEL_PX: f64 = 170.0;
const PANEL_GAP_PX: f64 = 16.0;
const EDGE_PX: f64 = 8.0;
const DOT_PX: f64 = 2.6;
/// With fewer marks an axis cannot be read.
const MIN_MARKS: usize = 3;
/// At most how many intervals an axis has whose marks are not powers of ten.
const EVEN_INTERVALS: usize = 5;
/// Line styles in addition to the colours, so that lines can be told apart without colour.
const DASHES: [&str; 4] = ["", "6 2.5", "2 2", "8 2.5 2 2.5"];

/// Charts over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogChart<'a> {
    /// A title above the charts; empty for none.
    pub title: &'a str,
    /// The quantity along the common axis, with its unit.
    pub x_label: &'a str,
    /// The charts, top one first.
    pub panels: &'a [LogPanel<'a>],
}

/// One chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogPanel<'a> {
    /// The quantity, with its unit.
    pub label: &'a str,
    /// Its lines; lines of the same place in all panels look the same.
    pub lines: &'a [LogLine<'a>],
}

/// A line of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogLine<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Its points; those with a number that is not positive and finite are left out.
    pub points: &'a [(f64, f64)],
}

/// Draws charts with logarithmic axes. Ticks are at every x that a line has, and at powers of ten;
/// where these are few, also between them.
pub fn log_chart(chart: &LogChart<'_>) -> Svg {
    let top = EDGE_PX + if chart.title.is_empty() { 4.0 } else { TITLE_PX + 10.0 };
    let heights = |i: usize| top + i as f64 * (PANEL_PX + PANEL_GAP_PX);
    let y_axes: Vec<Axis> = chart.panels.iter().map(|panel| Axis::of_values(panel.lines)).collect();
    let axis_px = y_axes.iter().map(|axis| marked_side_axis_px(&axis.marks)).fold(0.0, f64::max);
    let left = EDGE_PX + axis_px;
    let x_axis = Axis::of_places(chart.panels);
    let x_scale = x_axis.scale(left, left + WIDTH_PX);
    let mut out = SvgWriter::new();
    for (i, (panel, axis)) in chart.panels.iter().zip(&y_axes).enumerate() {
        let y_scale = axis.scale(heights(i) + PANEL_PX, heights(i));
        draw_panel(&mut out, panel, (&x_axis, x_scale), (axis, y_scale));
        marked_left_axis(&mut out, y_scale, left, axis_px, &axis.marks, panel.label);
    }
    let bottom = heights(chart.panels.len().max(1)) - PANEL_GAP_PX;
    marked_bottom_axis(&mut out, x_scale, bottom, &x_axis.marks, chart.x_label);
    let title_px = text_width_px(chart.title, TITLE_PX);
    if !chart.title.is_empty() {
        let x = left + 0.5 * (WIDTH_PX - title_px).max(0.0);
        out.label(x, EDGE_PX + TITLE_PX - 1.0, TITLE_PX, Anchor::Start, chart.title);
    }
    let entries = entries(chart.panels);
    let legend = Legend::new(&entries, WIDTH_PX);
    let legend_y = bottom + BOTTOM_AXIS_PX + 8.0;
    legend.draw(&mut out, left, legend_y);
    let width = left + WIDTH_PX.max(legend.width_px()).max(title_px) + EDGE_PX + 16.0;
    Svg::page(width, legend_y + legend.height_px() + EDGE_PX, out)
}

/// A logarithmic axis: its ends and marks, as logarithms to the base 10.
struct Axis {
    low: f64,
    high: f64,
    marks: Vec<(f64, String)>,
}

impl Axis {
    /// With a mark at every x.
    fn of_places(panels: &[LogPanel<'_>]) -> Self {
        let lines = panels.iter().flat_map(|panel| panel.lines);
        let mut places: Vec<f64> = lines.flat_map(drawable).map(|(x, _)| x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let (low, high) = log_range(&places);
        // Room for the dots at both ends.
        let room = 0.03 * (high - low);
        let marks = places.iter().map(|&x| (x.log10(), plain(x))).collect();
        Self { low: low - room, high: high + room, marks }
    }

    /// With marks at powers of ten, at 2 and 5 times them where the powers are few, and where these
    /// are few, too, at round numbers at equal distances.
    fn of_values(lines: &[LogLine<'_>]) -> Self {
        let values: Vec<f64> = lines.iter().flat_map(drawable).map(|(_, y)| y).collect();
        let (low, high) = log_range(&values);
        let room = 0.06 * (high - low);
        let (low, high) = (low - room, high + room);
        let powers = low.floor() as i32..=high.ceil() as i32;
        let times = |factors: &[f64]| -> Vec<f64> {
            let all =
                powers.clone().flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
            all.filter(|value| (low..=high).contains(&value.log10())).collect()
        };
        let is_short = high - low < 2.5;
        let candidates = [(!is_short).then(|| times(&[1.0])), Some(times(&[1.0, 2.0, 5.0]))];
        let enough = candidates.into_iter().flatten().find(|marks| marks.len() >= MIN_MARKS);
        let evenly = || Ticks::new(10f64.powf(low), 10f64.powf(high), EVEN_INTERVALS).values;
        let marks = enough.unwrap_or_else(evenly);
        let marks = marks.into_iter().map(|value| (value.log10(), plain(value))).collect();
        Self { low, high, marks }
    }

    const fn scale(&self, low_px: f64, high_px: f64) -> Scale {
        Scale { low: self.low, high: self.high, low_px, high_px }
    }
}

/// The logarithms of the smallest and the largest value, at least a little apart.
fn log_range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min).log10();
    let high = values.iter().copied().fold(0.0, f64::max).log10();
    match (low.is_finite(), high - low > 0.1) {
        (true, true) => (low, high),
        (true, false) => (low - 0.3, high + 0.3),
        (false, _) => (0.0, 1.0),
    }
}

/// A positive number without an exponent, as long as that is short.
fn plain(value: f64) -> String {
    if (1e-4..1e7).contains(&value) {
        // Twelve digits hide the rounding of powers.
        let text = format!("{value:.12}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.0e}")
}

fn drawable<'a>(line: &LogLine<'a>) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    let is_drawable = |value: f64| value > 0.0 && value.is_finite();
    line.points.iter().copied().filter(move |&(x, y)| is_drawable(x) && is_drawable(y))
}

fn style(index: usize) -> LineStyle {
    let color = SERIES[index % SERIES.len()];
    LineStyle { color, width_px: 1.4, dashes: DASHES[index % DASHES.len()] }
}

/// Each name once, in the style of its first line.
fn entries(panels: &[LogPanel<'_>]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for (i, line) in panels.iter().flat_map(|panel| panel.lines.iter().enumerate()) {
        if !entries.iter().any(|entry| entry.label == line.name) {
            entries.push(Entry::new(line.name, Sample::Line(style(i))));
        }
    }
    entries
}

fn draw_panel(
    out: &mut SvgWriter,
    panel: &LogPanel<'_>,
    (x_axis, x_scale): (&Axis, Scale),
    (y_axis, y_scale): (&Axis, Scale),
) {
    let (left, right) = (x_scale.low_px, x_scale.high_px);
    let (bottom, top) = (y_scale.low_px, y_scale.high_px);
    for (at, _) in &x_axis.marks {
        let x = x_scale.px(*at);
        out.tag("line").between((x, top), (x, bottom)).stroke(GRID, 0.7).leaf();
    }
    for (at, _) in &y_axis.marks {
        let y = y_scale.px(*at);
        out.tag("line").between((left, y), (right, y)).stroke(GRID, 0.7).leaf();
    }
    for (i, line) in panel.lines.iter().enumerate() {
        let px = |(x, y): (f64, f64)| (x_scale.px(x.log10()), y_scale.px(y.log10()));
        let points: Vec<(f64, f64)> = drawable(line).map(px).collect();
        let (path, style) = (PathData::line(points.iter().copied()), style(i));
        let tag = out.tag("path").attr("fill", "none").stroke(style.color, style.width_px);
        let tag = tag.attr("stroke-dasharray", style.dashes).attr("stroke-linejoin", "round");
        tag.attr("d", path.as_str()).leaf();
        for (x, y) in points {
            out.tag("circle").round(x, y, DOT_PX).fill(style.color).leaf();
        }
    }
    border(out, left, top, right - left, bottom - top);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(values: &[f64]) -> Vec<String> {
        let points: Vec<(f64, f64)> = values.iter().map(|&y| (1.0, y)).collect();
        let axis = Axis::of_values(&[LogLine { name: "a", points: &points }]);
        assert!(axis.low < axis.high);
        axis.marks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn marks_by_hand() {
        assert_eq!(marks(&[0.02, 300.0]), ["0.1", "1", "10", "100"]);
        assert_eq!(marks(&[90.0, 1100.0]), ["100", "200", "500", "1000"]);
        assert_eq!(marks(&[3.0]), ["2", "4", "6"]);
        // The peak memory of two planners on two maps [MB].
        assert_eq!(marks(&[13.9, 16.7, 28.7, 15.2]), ["15", "20", "25"]);
        assert_eq!(marks(&[100.0, 101.0]), ["50", "100", "200"]);
        // Two powers alone, but a long way.
        assert_eq!(marks(&[1.42, 251.0]), ["2", "5", "10", "20", "50", "100", "200"]);
        assert_eq!(marks(&[1e9, 1e12]), ["1e9", "1e10", "1e11", "1e12"]);
        assert_eq!(marks(&[0.0, f64::NAN, -1.0, f64::INFINITY]), ["1", "2", "5", "10"]);
    }

    #[test]
    fn a_power_is_a_straight_line() {
        let points: Vec<(f64, f64)> =
            (0..5).map(|i| f64::from(1 << i)).map(|x| (x, 3.0 * x * x)).collect();
        let lines = [LogLine { name: "square", points: &points }];
        let panels = [LogPanel { label: "y", lines: &lines }];
        let svg = log_chart(&LogChart { title: "T", x_label: "x", panels: &panels });
        let centre = |name: &str, text: &str| -> f64 {
            text.split(&format!("{name}=\""))
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .parse()
                .unwrap()
        };
        let dots: Vec<(f64, f64)> = svg
            .as_str()
            .split("<circle")
            .skip(1)
            .map(|dot| (centre("cx", dot), centre("cy", dot)))
            .collect();
        assert_eq!(dots.len(), 5);
        let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
        for pair in dots.windows(2) {
            assert!((slope(pair[0], pair[1]) - slope(dots[0], dots[4])).abs() < 0.01, "{dots:?}");
        }
        assert!(svg.as_str().contains(">square<") && svg.as_str().contains(">16<"));
    }

    #[test]
    fn nothing_to_draw() {
        for panels in [&[][..], &[LogPanel { label: "y", lines: &[] }]] {
            let svg = log_chart(&LogChart { title: "", x_label: "x", panels });
            assert!(!svg.as_str().contains("NaN"));
            #[cfg(feature = "raster")]
            assert!(svg.to_png(1.0).is_ok());
        }
    }
}
