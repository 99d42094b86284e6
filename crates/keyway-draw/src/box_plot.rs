//! Box plots: the distributions of several groups of values over one axis.

use crate::axis::TICK_PX;
use crate::chart::Margins;
use crate::color::INK;
use crate::ticks::span;
use crate::{Axis, Chart, Plot, Rgb, Svg};
use keyway_sim::metrics::statistics::{Sample, Summary};

const WIDTH_PX: f64 = 420.0;
const HALF_BOX_PX: f64 = 8.5;
const HALF_CAP_PX: f64 = 4.5;
const RING_PX: f64 = 2.2;
/// Maximum width of a name \[px\]; longer names have several lines.
const NAME_PX: f64 = 150.0;
const INTERVALS: usize = 7;
/// Light enough for the marks within the box, and for grey print.
const BOX: Rgb = Rgb(0xcf, 0xdf, 0xee);
/// Maximum length of a whisker, in lengths of its box.
const REACH: f64 = 1.5;

/// Groups of values over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxPlot<'a> {
    /// Title above the plot; empty for none.
    pub title: &'a str,
    /// The quantity, with its unit.
    pub label: &'a str,
    /// The groups, top one first.
    pub groups: &'a [BoxGroup<'a>],
    /// Caption below the plot; empty for none.
    pub caption: &'a str,
}

/// A group of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxGroup<'a> {
    /// Name of the group.
    pub name: &'a str,
    /// Values of the group; `None` if it has none.
    pub values: Option<&'a Sample>,
    /// Text at the other end of its row, such as the number of its values.
    pub note: &'a str,
}

/// Draws box plots: a box from the lower to the upper quartile with a line at the median and a
/// cross at the mean, whiskers to the farthest values within 1.5 box lengths of it, and a ring for
/// each value beyond.
pub fn box_plot(plot: &BoxPlot<'_>) -> Svg {
    let (low, high) = range(plot.groups);
    let names = plot.groups.iter().map(|group| group.name);
    let notes = plot.groups.iter().map(|group| group.note);
    let axis = Axis::linear(low, high, INTERVALS).label(plot.label);
    let mut chart = Chart::new(axis, WIDTH_PX, 0.0).title(plot.title).caption(plot.caption);
    chart.margins = Margins::ROWS;
    let rows = Axis::categories(names, NAME_PX).notes(notes);
    chart.panel(rows, |panel| draw_boxes(panel, plot.groups)).svg()
}

/// Returns the range of the axis: all values, with a margin at both ends; from 0 if that is near.
fn range(groups: &[BoxGroup<'_>]) -> (f64, f64) {
    let samples = groups.iter().filter_map(|group| group.values);
    let ends = span(samples.flat_map(|sample| sample.values().iter().copied()));
    let Some((low, high)) = ends else { return (0.0, 1.0) };
    let room = if high > low { 0.04 * (high - low) } else { 0.5 };
    let low = if low >= 0.0 && low < 0.5 * high { 0.0 } else { low - room };
    (low, high + room)
}

fn draw_boxes(plot: &mut Plot<'_>, groups: &[BoxGroup<'_>]) {
    for (i, group) in groups.iter().enumerate() {
        let (left, y) = (plot.area().left_px, plot.y_px(i as f64));
        plot.segment([(left - TICK_PX, y), (left, y)], INK, 1.0);
        if let Some(values) = group.values {
            draw_box(plot, values, y);
        }
    }
}

fn draw_box(plot: &mut Plot<'_>, sample: &Sample, y: f64) {
    let Summary { lower_quartile, median, upper_quartile, mean, .. } = sample.summary();
    let (low, high) = whiskers(sample);
    for (end, side) in [(low, lower_quartile), (high, upper_quartile)] {
        let (x, from) = (plot.x_px(end), plot.x_px(side));
        plot.segment([(from, y), (x, y)], INK, 1.0);
        plot.segment([(x, y - HALF_CAP_PX), (x, y + HALF_CAP_PX)], INK, 1.0);
    }
    let (left, right) = (plot.x_px(lower_quartile), plot.x_px(upper_quartile));
    let shape = plot.writer().tag("rect").at(left, y - HALF_BOX_PX);
    shape.size(right - left, 2.0 * HALF_BOX_PX).fill(BOX).stroke(INK, 1.0).leaf();
    let x = plot.x_px(median);
    plot.segment([(x, y - HALF_BOX_PX), (x, y + HALF_BOX_PX)], INK, 2.4);
    let x = plot.x_px(mean);
    for (dx, dy) in [(3.0, 3.0), (3.0, -3.0)] {
        plot.segment([(x - dx, y - dy), (x + dx, y + dy)], INK, 1.1);
    }
    // Values on the same pixel are drawn once.
    let mut before = f64::NAN;
    for &value in sample.values().iter().filter(|&&value| value < low || value > high) {
        let x = plot.x_px(value);
        if (x - before).abs() < 0.5 {
            continue;
        }
        before = x;
        let ring = plot.writer().tag("circle").round(x, y, RING_PX).attr("fill", "none");
        ring.stroke(INK, 0.9).leaf();
    }
}

/// Returns the farthest values within reach of the box.
fn whiskers(sample: &Sample) -> (f64, f64) {
    let Summary { lower_quartile, upper_quartile, .. } = sample.summary();
    let reach = REACH * (upper_quartile - lower_quartile);
    let is_near =
        |&&value: &&f64| (lower_quartile - reach..=upper_quartile + reach).contains(&value);
    let values = sample.values();
    let low = values.iter().find(is_near).copied().unwrap_or(lower_quartile);
    let high = values.iter().rfind(is_near).copied().unwrap_or(upper_quartile);
    // An interpolated quartile may lie beyond the farthest value within its reach.
    (low.min(lower_quartile), high.max(upper_quartile))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(values: &[f64]) -> Sample {
        Sample::new(values.to_vec()).unwrap()
    }

    #[test]
    fn whiskers_by_hand() {
        // Quartiles 2 and 4: the whiskers reach from -1 to 7.
        assert_eq!(whiskers(&sample(&[1.0, 2.0, 3.0, 4.0, 7.0])), (1.0, 7.0));
        assert_eq!(whiskers(&sample(&[-1.5, 2.0, 3.0, 4.0, 7.5])), (2.0, 4.0));
        assert_eq!(whiskers(&sample(&[5.0])), (5.0, 5.0));
        // The upper quartile is 3.25, between 1 and 10, which is beyond reach.
        assert_eq!(whiskers(&sample(&[1.0, 1.0, 1.0, 10.0])), (1.0, 3.25));
    }

    #[test]
    fn the_axis_begins_at_zero_where_that_is_near() {
        let range_of = |values: &[f64]| {
            let values = sample(values);
            range(&[BoxGroup { name: "a", values: Some(&values), note: "" }])
        };
        assert_eq!(range_of(&[1.0, 11.0]), (0.0, 11.4));
        assert_eq!(range_of(&[10.0, 11.0]), (9.96, 11.04));
        assert_eq!(range_of(&[7.0]), (6.5, 7.5));
        assert_eq!(range(&[]), (0.0, 1.0));
    }

    /// The plot does not become wider, and the row is as high as the name needs.
    #[test]
    fn long_names_have_several_lines() {
        let values = sample(&[1.0, 2.0]);
        let size = |name: &str| {
            let groups = ["a", name].map(|name| BoxGroup { name, values: Some(&values), note: "" });
            let svg =
                box_plot(&BoxPlot { title: "", label: "x [m]", groups: &groups, caption: "" });
            ["width", "height"].map(|side| {
                let from = svg.as_str().split_once(&format!("{side}=\"")).unwrap().1;
                from.split_once('"').unwrap().0.parse::<f64>().unwrap()
            })
        };
        let [width, height] = size("b");
        let name = "folder/with_many_words_in_it_and_more-of-them-behind-that.toml/".repeat(3);
        let [wide, high] = size(&name);
        assert!(
            wide < width + NAME_PX && high > height + 50.0,
            "{wide} x {high}, {width} x {height}"
        );
    }

    #[test]
    fn every_value_beyond_the_whiskers_is_a_ring() {
        let values = sample(&[1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 30.0, 40.0]);
        let none = BoxGroup { name: "b", values: None, note: "n = 0" };
        let groups = [BoxGroup { name: "a <1>", values: Some(&values), note: "n = 8" }, none];
        let plot = BoxPlot { title: "", label: "time [s]", groups: &groups, caption: "All runs." };
        let svg = box_plot(&plot);
        assert_eq!(svg.as_str().matches("<circle").count(), 2);
        for text in ["a &lt;1&gt;", "n = 8", "n = 0", "time [s]", "All runs."] {
            assert!(svg.as_str().contains(text), "{text}");
        }
        assert_eq!(svg, box_plot(&plot));
    }
}
