//! Points of several series, each in a separate panel with all others pale behind it: a scatter
//! plot, or rates with their intervals. Each series is visible, regardless of their number,
//! without a key of colours and symbols.

use crate::caption::EDGE_PX;
use crate::chart::{COLUMN_GAP_PX, Margins};
use crate::ticks::span;
use crate::{Axis, Chart, ChartPoint, LineStyle, Plot, Rgb, SERIES, Svg, Ticks};

const WIDTH_PX: f64 = 510.0;
const OWN: Rgb = SERIES[0];
const OTHERS: Rgb = Rgb(0xc6, 0xc6, 0xc6);
const LINE_PX: f64 = 1.2;
const HALF_CAP_PX: f64 = 3.0;
const MARGINS: Margins =
    Margins { row_gap_px: 10.0, caption_gap_px: 8.0, beside: 8.0, right_px: EDGE_PX };

/// Series over the same axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPanels<'a> {
    /// The quantity along the lower axis, with its unit.
    pub x_label: &'a str,
    /// The quantity along the other axis, with its unit.
    pub y_label: &'a str,
    /// Range of the vertical axis; `None`: that of the points.
    pub y_ends: Option<(f64, f64)>,
    /// True if lines join the points of a series.
    pub are_joined: bool,
    /// The series, in the order of the panels.
    pub series: &'a [PointSeries<'a>],
    /// Caption below the chart; empty for none.
    pub caption: &'a str,
}

/// A series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSeries<'a> {
    /// Name, above its panel.
    pub name: &'a str,
    /// Points; those with a number that is not finite are left out.
    pub points: &'a [ChartPoint],
}

/// Draws each series in a panel, with bars for the intervals of its heights, and all others
/// behind it.
pub fn point_panels(chart: &PointPanels<'_>) -> Svg {
    let all = || chart.series.iter().flat_map(points_of);
    let heights = all().flat_map(|point| {
        let (low, high) = point.y_interval.unwrap_or((point.y, point.y));
        [low, point.y, high]
    });
    let (width_px, height_px, columns) = panel_px(chart.series.len());
    let x_ends = ends(all().map(|point| point.x));
    let x_axis = with_room(x_ends, (width_px / 40.0) as usize).label(chart.x_label);
    let y_ends = chart.y_ends.unwrap_or_else(|| ends(heights));
    let y_axis = with_room(y_ends, 5).label(chart.y_label);
    let names: Vec<&str> = chart.series.iter().map(|series| series.name).collect();
    let mut drawn = Chart::new(x_axis, width_px, height_px)
        .caption(chart.caption)
        .side_by_side(columns, &names);
    drawn.margins = MARGINS;
    for (i, series) in chart.series.iter().enumerate() {
        let others = [&chart.series[..i], &chart.series[i + 1..]].concat();
        drawn = drawn.panel(y_axis.clone(), move |plot| {
            draw_behind(plot, &others, chart.are_joined);
            draw_own(plot, series, chart.are_joined);
        });
    }
    drawn.svg()
}

/// Returns the width and height of a panel \[px\], and the number of columns: at most three, and
/// two for four panels.
fn panel_px(panels: usize) -> (f64, f64, usize) {
    let columns = if panels == 4 { 2 } else { panels.clamp(1, 3) };
    let gaps_px = COLUMN_GAP_PX * (columns - 1) as f64;
    let width_px = (WIDTH_PX - gaps_px) / columns as f64;
    (width_px, if columns == 1 { 280.0 } else { 0.8 * width_px }, columns)
}

fn points_of<'a>(series: &PointSeries<'a>) -> impl Iterator<Item = ChartPoint> + use<'a> {
    series.points.iter().copied().filter(|point| point.x.is_finite() && point.y.is_finite())
}

/// Returns the smallest and the largest value, at least a little apart; from 0 if that is near.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    match span(values) {
        None => (0.0, 1.0),
        Some((low, high)) if low == high => (low - 0.5, high + 0.5),
        Some((low, high)) if low >= 0.0 && low < 0.3 * high => (0.0, high),
        Some(ends) => ends,
    }
}

/// Returns an axis with margins, so that points at the ends are not clipped.
fn with_room((low, high): (f64, f64), max_intervals: usize) -> Axis {
    let room = 0.04 * (high - low);
    Axis::with_ticks(low - room, high + room, &Ticks::new(low, high, max_intervals))
}

/// Draws series behind another one: their lines, or their points.
fn draw_behind(plot: &mut Plot<'_>, others: &[PointSeries<'_>], are_joined: bool) {
    if are_joined {
        for series in others {
            plot.line(points_of(series), LineStyle::solid(OTHERS, LINE_PX));
        }
    } else {
        plot.dots(others.iter().flat_map(points_of), OTHERS, 3.2, 1.6);
    }
}

fn draw_own(plot: &mut Plot<'_>, series: &PointSeries<'_>, are_joined: bool) {
    if are_joined {
        plot.line(points_of(series), LineStyle::solid(OWN, LINE_PX));
    }
    for point in points_of(series) {
        if let Some((low, high)) = point.y_interval {
            plot.interval(point.x, low, high, LineStyle::solid(OWN, 1.0), HALF_CAP_PX);
        }
    }
    plot.dots(points_of(series), OWN, 4.4, 1.0);
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

    /// Counts the dots of the strong colour: those of the panels' own series.
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
        // The second of the two equal points is not visible, nor is the invalid one.
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
