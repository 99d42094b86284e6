//! Quantities on logarithmic axes, on which a power is a straight line: charts one above the
//! other over one axis.

use crate::caption::EDGE_PX;
use crate::chart::Margins;
use crate::{Axis, Chart, ChartPoint, LegendEntry, LegendMark, Plot, Svg, series_style};

const DOT_PX: f64 = 2.6;
const MARGINS: Margins =
    Margins { row_gap_px: 16.0, caption_gap_px: 8.0, right_px: EDGE_PX + 16.0, ..Margins::DEFAULT };

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
    /// Its lines; lines of the same index in all panels have the same style.
    pub lines: &'a [LogLine<'a>],
}

/// A line of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogLine<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Points of the line; those with a number that is not positive and finite are left out.
    pub points: &'a [(f64, f64)],
}

/// Draws charts with logarithmic axes. Ticks are at every x of the lines, and at powers of ten;
/// if these are few, also between them.
pub fn log_chart(chart: &LogChart<'_>) -> Svg {
    let values = |lines: &[LogLine<'_>], value: fn(ChartPoint) -> f64| -> Vec<f64> {
        lines.iter().flat_map(drawable).map(value).collect()
    };
    let places: Vec<f64> =
        chart.panels.iter().flat_map(|panel| values(panel.lines, |point| point.x)).collect();
    let x_axis = Axis::powers_at(&places).label(chart.x_label);
    let drawn = Chart::new(x_axis, 420.0, 170.0).title(chart.title);
    let mut drawn = drawn.legend(entries(chart.panels));
    drawn.margins = MARGINS;
    for panel in chart.panels {
        let y_axis = Axis::powers(&values(panel.lines, |point| point.y)).label(panel.label);
        drawn = drawn.panel(y_axis, |plot| draw_lines(plot, panel.lines));
    }
    drawn.svg()
}

fn drawable<'a>(line: &LogLine<'a>) -> impl Iterator<Item = ChartPoint> + use<'a> {
    let is_drawable = |value: f64| value > 0.0 && value.is_finite();
    let points = line.points.iter().filter(move |(x, y)| is_drawable(*x) && is_drawable(*y));
    points.map(|&(x, y)| ChartPoint::new(x, y))
}

/// Returns each name once, in the style of its first line.
fn entries(panels: &[LogPanel<'_>]) -> Vec<LegendEntry> {
    let mut entries: Vec<LegendEntry> = Vec::new();
    for (i, line) in panels.iter().flat_map(|panel| panel.lines.iter().enumerate()) {
        if !entries.iter().any(|entry| entry.label == line.name) {
            entries.push(LegendEntry::new(line.name, LegendMark::Line(series_style(i))));
        }
    }
    entries
}

fn draw_lines(plot: &mut Plot<'_>, lines: &[LogLine<'_>]) {
    for (i, line) in lines.iter().enumerate() {
        let style = series_style(i);
        plot.line(drawable(line), style);
        for point in drawable(line) {
            plot.dot(point, style.color, DOT_PX);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
