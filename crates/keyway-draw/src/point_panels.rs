//! Points of several series, each in a panel of its own with all others pale behind it: a scatter
//! plot, or rates with their intervals. However many series there are, each is seen, without
//! colours and symbols to be looked up.

use crate::axes::{BOTTOM_AXIS_PX, Scale, border, bottom_axis, left_axis, side_axis_px};
use crate::caption::Caption;
use crate::color::{GRID, Rgb, SERIES};
use crate::name_lines::NameLines;
use crate::svg::Svg;
use crate::ticks::Ticks;
use crate::writer::{Anchor, PathData, SvgWriter};
use std::collections::HashSet;

const WIDTH_PX: f64 = 510.0;
const EDGE_PX: f64 = 8.0;
/// Between two panels.
const GAP_PX: f64 = 14.0;
const OWN: Rgb = SERIES[0];
const OTHERS: Rgb = Rgb(0xc6, 0xc6, 0xc6);
const STRONG: Dot = Dot { color: OWN, width_px: 4.4, square_px: 1.0 };
const PALE: Dot = Dot { color: OTHERS, width_px: 3.2, square_px: 1.6 };
const HALF_CAP_PX: f64 = 3.0;

/// Series over the same axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPanels<'a> {
    /// The quantity along the lower axis, with its unit.
    pub x_label: &'a str,
    /// The quantity along the other axis, with its unit.
    pub y_label: &'a str,
    /// The ends of the upright axis; `None`: those of the points.
    pub y_ends: Option<(f64, f64)>,
    /// Whether a line leads from point to point of a series.
    pub are_joined: bool,
    /// The series, line by line.
    pub series: &'a [PointSeries<'a>],
    /// What is to be said below; empty for nothing.
    pub caption: &'a str,
}

/// A series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSeries<'a> {
    /// Its name, above its panel.
    pub name: &'a str,
    /// Its points; those with a number that is not finite are left out.
    pub points: &'a [ChartPoint],
}

/// A point of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChartPoint {
    /// Its place along the lower axis.
    pub x: f64,
    /// Its height.
    pub y: f64,
    /// Between what its true height lies.
    pub y_interval: Option<(f64, f64)>,
}

/// How points look.
struct Dot {
    color: Rgb,
    width_px: f64,
    /// Side of the squares that have one dot at most \[px\].
    square_px: f64,
}

/// Where the panels lie.
struct Layout {
    columns: usize,
    width_px: f64,
    height_px: f64,
    left_px: f64,
    /// Height of the names above a row of panels.
    name_px: f64,
}

/// Draws each series in a panel, with bars for what is known of its heights, and all others behind
/// it.
pub fn point_panels(chart: &PointPanels<'_>) -> Svg {
    let all = || chart.series.iter().flat_map(|series| points_of(series));
    let heights = all().flat_map(|point| {
        let (low, high) = point.y_interval.unwrap_or((point.y, point.y));
        [low, point.y, high]
    });
    let x_ends = ends(all().map(|point| point.x));
    let y_ends = chart.y_ends.unwrap_or_else(|| ends(heights));
    let y_ticks = Ticks::new(y_ends.0, y_ends.1, 5);
    let axis_px = side_axis_px(&y_ticks);
    let layout = Layout::new(chart.series, EDGE_PX + axis_px);
    let x_ticks = Ticks::new(x_ends.0, x_ends.1, (layout.width_px / 40.0) as usize);
    let mut out = SvgWriter::new();
    for (i, series) in chart.series.iter().enumerate() {
        let (left, top) = layout.corner(i);
        let x_scale = with_room(x_ends, left, left + layout.width_px);
        let y_scale = with_room(y_ends, top + layout.height_px, top);
        let middle = left + 0.5 * layout.width_px;
        layout.name(series).draw(&mut out, middle, top - 5.0, Anchor::Middle);
        draw_grid(&mut out, (x_scale, &x_ticks), (y_scale, &y_ticks));
        let others = [&chart.series[..i], &chart.series[i + 1..]].concat();
        draw_behind(&mut out, &others, chart.are_joined, (x_scale, y_scale));
        draw_own(&mut out, series, chart.are_joined, (x_scale, y_scale));
        border(&mut out, left, top, layout.width_px, layout.height_px);
        if i % layout.columns == 0 {
            left_axis(&mut out, y_scale, left, axis_px, &y_ticks, chart.y_label);
        }
        if i + layout.columns >= chart.series.len() {
            bottom_axis(&mut out, x_scale, top + layout.height_px, &x_ticks, chart.x_label);
        }
    }
    let bottom = layout.bottom_px(chart.series.len()) + BOTTOM_AXIS_PX + 8.0;
    let width = layout.left_px + WIDTH_PX + EDGE_PX + 8.0;
    let caption = Caption::new(chart.caption, width - 2.0 * EDGE_PX);
    caption.draw(&mut out, EDGE_PX, bottom);
    let width = width.max(caption.width_px() + 2.0 * EDGE_PX);
    Svg::page(width, bottom + caption.height_px() + EDGE_PX, out)
}

impl Layout {
    /// Two or three panels side by side, where there are as many.
    fn new(series: &[PointSeries<'_>], left_px: f64) -> Self {
        let panels = series.len();
        let columns = if panels == 4 { 2 } else { panels.clamp(1, 3) };
        let gaps_px = GAP_PX * (columns - 1) as f64;
        let width_px = (WIDTH_PX - gaps_px) / columns as f64;
        let height_px = if columns == 1 { 280.0 } else { 0.8 * width_px };
        let mut layout = Self { columns, width_px, height_px, left_px, name_px: 0.0 };
        let names = series.iter().map(|series| layout.name(series).height_px());
        layout.name_px = names.fold(0.0, f64::max) + 4.5;
        layout
    }

    /// No wider than a panel.
    fn name(&self, series: &PointSeries<'_>) -> NameLines {
        NameLines::new(series.name, self.width_px)
    }

    /// The upper left corner of a panel.
    fn corner(&self, index: usize) -> (f64, f64) {
        let (row, column) = (index / self.columns, index % self.columns);
        let left = self.left_px + column as f64 * (self.width_px + GAP_PX);
        (left, EDGE_PX + self.name_px + row as f64 * (self.height_px + self.name_px + 6.0))
    }

    /// The lower edge of the lowest panels.
    fn bottom_px(&self, panels: usize) -> f64 {
        self.corner(panels.saturating_sub(1)).1 + self.height_px
    }
}

fn points_of<'a>(series: &PointSeries<'a>) -> impl Iterator<Item = &'a ChartPoint> + use<'a> {
    series.points.iter().filter(|point| point.x.is_finite() && point.y.is_finite())
}

/// The smallest and the largest value, at least a little apart; from 0 where that is not far.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values = values.filter(|value| value.is_finite()).map(|value| (value, value));
    let ends = values.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)));
    match ends {
        None => (0.0, 1.0),
        Some((low, high)) if low == high => (low - 0.5, high + 0.5),
        Some((low, high)) if low >= 0.0 && low < 0.3 * high => (0.0, high),
        Some(ends) => ends,
    }
}

/// Points at the ends are not cut off.
fn with_room((low, high): (f64, f64), low_px: f64, high_px: f64) -> Scale {
    let room = 0.04 * (high - low);
    Scale { low: low - room, high: high + room, low_px, high_px }
}

fn draw_grid(
    out: &mut SvgWriter,
    (x_scale, x_ticks): (Scale, &Ticks),
    (y_scale, y_ticks): (Scale, &Ticks),
) {
    for &value in &x_ticks.values {
        let x = x_scale.px(value);
        let line = out.tag("line").between((x, y_scale.high_px), (x, y_scale.low_px));
        line.stroke(GRID, 0.7).leaf();
    }
    for &value in &y_ticks.values {
        let y = y_scale.px(value);
        let line = out.tag("line").between((x_scale.low_px, y), (x_scale.high_px, y));
        line.stroke(GRID, 0.7).leaf();
    }
}

/// Series as the ground of another one: their lines, or their points.
fn draw_behind(
    out: &mut SvgWriter,
    others: &[PointSeries<'_>],
    are_joined: bool,
    scales: (Scale, Scale),
) {
    if are_joined {
        for series in others {
            draw_line(out, series, OTHERS, scales);
        }
    } else {
        draw_dots(out, others, &PALE, scales);
    }
}

fn draw_own(
    out: &mut SvgWriter,
    series: &PointSeries<'_>,
    are_joined: bool,
    (x_scale, y_scale): (Scale, Scale),
) {
    if are_joined {
        draw_line(out, series, OWN, (x_scale, y_scale));
    }
    for point in points_of(series) {
        let Some((low, high)) = point.y_interval else { continue };
        let (x, low, high) = (x_scale.px(point.x), y_scale.px(low), y_scale.px(high));
        out.tag("line").between((x, low), (x, high)).stroke(OWN, 1.0).leaf();
        for y in [low, high] {
            let cap = out.tag("line").between((x - HALF_CAP_PX, y), (x + HALF_CAP_PX, y));
            cap.stroke(OWN, 1.0).leaf();
        }
    }
    draw_dots(out, &[*series], &STRONG, (x_scale, y_scale));
}

fn draw_line(
    out: &mut SvgWriter,
    series: &PointSeries<'_>,
    color: Rgb,
    (x_scale, y_scale): (Scale, Scale),
) {
    let place = |point: &ChartPoint| (x_scale.px(point.x), y_scale.px(point.y));
    let path = PathData::line(points_of(series).map(place));
    let tag = out.tag("path").attr("fill", "none").stroke(color, 1.2);
    tag.attr("stroke-linejoin", "round").attr("d", path.as_str()).leaf();
}

/// Dots are lines of no length with round ends, in one path. Of those that fall into the same
/// square only one is drawn: of many thousand points a picture is no larger, and looks the same.
fn draw_dots(
    out: &mut SvgWriter,
    series: &[PointSeries<'_>],
    dot: &Dot,
    (x_scale, y_scale): (Scale, Scale),
) {
    let (mut drawn, mut path) = (HashSet::new(), PathData::default());
    for point in series.iter().flat_map(points_of) {
        let (x, y) = (x_scale.px(point.x), y_scale.px(point.y));
        let square = [x, y].map(|px| (px / dot.square_px).round() as i64);
        if drawn.insert(square) {
            path.move_to((x, y));
            path.line_to((x, y));
        }
    }
    let tag = out.tag("path").attr("fill", "none").stroke(dot.color, dot.width_px);
    tag.attr("stroke-linecap", "round").attr("d", path.as_str()).leaf();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(series: &[PointSeries<'_>], are_joined: bool) -> String {
        let (x_label, y_label, y_ends) = ("clutter [%]", "reached [%]", Some((0.0, 100.0)));
        let caption = "A caption.";
        let chart = PointPanels { x_label, y_label, y_ends, are_joined, series, caption };
        point_panels(&chart).into_string()
    }

    fn point(x: f64) -> ChartPoint {
        ChartPoint { x, y: 50.0, y_interval: Some((40.0, 60.0)) }
    }

    /// Dots of the strong colour: those of the panels' own series.
    fn own_dots(svg: &str) -> usize {
        let mine = |line: &&str| line.contains("linecap") && line.contains(&OWN.to_string());
        svg.lines().filter(mine).map(|line| line.matches('M').count()).sum()
    }

    #[test]
    fn every_series_has_a_panel_with_the_others_behind() {
        let points = [point(1.0), point(2.0), point(2.0), ChartPoint { y: f64::NAN, ..point(3.0) }];
        let names = ["one & only", "b", "c", "d", "e"];
        let series = names.map(|name| PointSeries { name, points: &points });
        let svg = chart(&series, true);
        // The second of the two equal points is not seen, nor is the one that is none.
        assert_eq!(own_dots(&svg), 5 * 2);
        // Rows of three and two: the axes at the left of each row, and below each column.
        assert_eq!(
            (svg.matches("reached [%]").count(), svg.matches("clutter [%]").count()),
            (2, 3)
        );
        assert_eq!(svg.matches(&format!("stroke=\"{OTHERS}\"")).count(), 5 * 4);
        for text in ["one &amp; only", "A caption.", ">100<"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
        assert_eq!(svg, chart(&series, true));
    }

    #[test]
    fn a_hundred_thousand_points_make_no_large_file() {
        let points: Vec<ChartPoint> = (0..100_000)
            .map(|i| ChartPoint { x: f64::from(i % 1000), y: f64::from(i) / 1e3, y_interval: None })
            .collect();
        let svg = chart(&[PointSeries { name: "a", points: &points }], false);
        assert!(own_dots(&svg) > 10_000 && svg.len() < 2_000_000, "{}", svg.len());
        let once = vec![points[7]; 100_000];
        assert_eq!(own_dots(&chart(&[PointSeries { name: "a", points: &once }], false)), 1);
    }

    #[test]
    fn axes_by_hand() {
        assert_eq!(ends([3.0, 2.0, f64::NAN].into_iter()), (2.0, 3.0));
        assert_eq!(ends([3.0, 0.5].into_iter()), (0.0, 3.0));
        assert_eq!(ends([4.0].into_iter()), (3.5, 4.5));
        assert_eq!(ends(std::iter::empty()), (0.0, 1.0));
    }
}
