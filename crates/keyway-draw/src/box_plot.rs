//! Box plots: how values are spread, for several groups over one axis.

use crate::axes::{BOTTOM_AXIS_PX, SMALL_TEXT_PX, Scale, TITLE_PX, border, bottom_axis};
use crate::caption::Caption;
use crate::color::{GRID, INK, Rgb};
use crate::name_lines::NameLines;
use crate::svg::Svg;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, SvgWriter};
use keyway_sim::metrics::statistics::{Sample, Summary};

const WIDTH_PX: f64 = 420.0;
const ROW_PX: f64 = 30.0;
const HALF_BOX_PX: f64 = 8.5;
const HALF_CAP_PX: f64 = 4.5;
const RING_PX: f64 = 2.2;
const EDGE_PX: f64 = 8.0;
/// A longer name has several lines.
const NAME_PX: f64 = 150.0;
const TICK_PX: f64 = 4.0;
/// Between a name and the plot.
const NAME_GAP_PX: f64 = 8.0;
const INTERVALS: usize = 7;
/// Light enough for the marks within it, and for a page in grey.
const BOX: Rgb = Rgb(0xcf, 0xdf, 0xee);
/// A whisker is no longer than this many times its box.
const REACH: f64 = 1.5;

/// Groups of values over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxPlot<'a> {
    /// A title above the plot; empty for none.
    pub title: &'a str,
    /// The quantity, with its unit.
    pub label: &'a str,
    /// The groups, top one first.
    pub groups: &'a [BoxGroup<'a>],
    /// What is to be said below; empty for nothing.
    pub caption: &'a str,
}

/// A group of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxGroup<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its values; `None`: it has none.
    pub values: Option<&'a Sample>,
    /// What stands at the other end of its row, such as the number of its values.
    pub note: &'a str,
}

/// Draws box plots: a box from the lower to the upper quartile with a line at the median and a
/// cross at the mean, whiskers to the farthest values within 1.5 box lengths of it, and a ring for
/// each value beyond.
pub fn box_plot(plot: &BoxPlot<'_>) -> Svg {
    let top = EDGE_PX + if plot.title.is_empty() { 4.0 } else { TITLE_PX + 10.0 };
    let names: Vec<NameLines> =
        plot.groups.iter().map(|group| NameLines::new(group.name, NAME_PX)).collect();
    let row_px = names.iter().map(|name| name.height_px() + 6.0).fold(ROW_PX, f64::max);
    let bottom = top + plot.groups.len() as f64 * row_px + 8.0;
    let names_px = names.iter().map(NameLines::width_px).fold(0.0, f64::max);
    let left = EDGE_PX + names_px + NAME_GAP_PX;
    let right = left + WIDTH_PX;
    let (low, high) = range(plot.groups);
    let x_scale = Scale { low, high, low_px: left, high_px: right };
    let ticks = Ticks::new(low, high, INTERVALS);
    let mut out = SvgWriter::new();
    for &value in &ticks.values {
        let x = x_scale.px(value);
        out.tag("line").between((x, top), (x, bottom)).stroke(GRID, 0.7).leaf();
    }
    for (i, (group, name)) in plot.groups.iter().zip(&names).enumerate() {
        let y = top + 4.0 + (i as f64 + 0.5) * row_px;
        out.tag("line").between((left - TICK_PX, y), (left, y)).stroke(INK, 1.0).leaf();
        // The middle line, or both of them, beside the tick.
        let base = y + 0.36 * SMALL_TEXT_PX + 0.5 * (name.height_px() - NameLines::LINE_PX);
        name.draw(&mut out, left - NAME_GAP_PX, base, Anchor::End);
        if let Some(values) = group.values {
            draw_box(&mut out, values, x_scale, y);
        }
        out.label(right + 6.0, y + 0.36 * SMALL_TEXT_PX, SMALL_TEXT_PX, Anchor::Start, group.note);
    }
    border(&mut out, left, top, WIDTH_PX, bottom - top);
    bottom_axis(&mut out, x_scale, bottom, &ticks, plot.label);
    let title_px = text_width_px(plot.title, TITLE_PX);
    if !plot.title.is_empty() {
        let x = left + 0.5 * (WIDTH_PX - title_px).max(0.0);
        out.label(x, EDGE_PX + TITLE_PX - 1.0, TITLE_PX, Anchor::Start, plot.title);
    }
    let note_px = |group: &BoxGroup<'_>| text_width_px(group.note, SMALL_TEXT_PX);
    let notes_px = plot.groups.iter().map(note_px).fold(0.0, f64::max);
    let width = (right + 6.0 + notes_px).max(left + title_px) + EDGE_PX;
    let caption = Caption::new(plot.caption, width - 2.0 * EDGE_PX);
    let caption_y = bottom + BOTTOM_AXIS_PX + 6.0;
    caption.draw(&mut out, EDGE_PX, caption_y);
    let width = width.max(caption.width_px() + 2.0 * EDGE_PX);
    Svg::page(width, caption_y + caption.height_px() + EDGE_PX, out)
}

/// The axis: all values, with room at both ends; from 0 where that is not far.
fn range(groups: &[BoxGroup<'_>]) -> (f64, f64) {
    let samples = groups.iter().filter_map(|group| group.values);
    let ends = samples.filter_map(|sample| {
        let values = sample.values();
        Some((*values.first()?, *values.last()?))
    });
    let ends = ends.reduce(|(low, high), (first, last)| (low.min(first), high.max(last)));
    let Some((low, high)) = ends else { return (0.0, 1.0) };
    let room = if high > low { 0.04 * (high - low) } else { 0.5 };
    let low = if low >= 0.0 && low < 0.5 * high { 0.0 } else { low - room };
    (low, high + room)
}

fn draw_box(out: &mut SvgWriter, sample: &Sample, scale: Scale, y: f64) {
    let Summary { lower_quartile, median, upper_quartile, mean, .. } = sample.summary();
    let (low, high) = whiskers(sample);
    for (end, side) in [(low, lower_quartile), (high, upper_quartile)] {
        let (x, from) = (scale.px(end), scale.px(side));
        out.tag("line").between((from, y), (x, y)).stroke(INK, 1.0).leaf();
        let cap = ((x, y - HALF_CAP_PX), (x, y + HALF_CAP_PX));
        out.tag("line").between(cap.0, cap.1).stroke(INK, 1.0).leaf();
    }
    let (left, right) = (scale.px(lower_quartile), scale.px(upper_quartile));
    let shape = out.tag("rect").at(left, y - HALF_BOX_PX).size(right - left, 2.0 * HALF_BOX_PX);
    shape.fill(BOX).stroke(INK, 1.0).leaf();
    let x = scale.px(median);
    out.tag("line").between((x, y - HALF_BOX_PX), (x, y + HALF_BOX_PX)).stroke(INK, 2.4).leaf();
    let x = scale.px(mean);
    for (dx, dy) in [(3.0, 3.0), (3.0, -3.0)] {
        out.tag("line").between((x - dx, y - dy), (x + dx, y + dy)).stroke(INK, 1.1).leaf();
    }
    // What falls on the same pixel is not drawn again.
    let mut before = f64::NAN;
    for &value in sample.values().iter().filter(|&&value| value < low || value > high) {
        let x = scale.px(value);
        if (x - before).abs() < 0.5 {
            continue;
        }
        before = x;
        let ring = out.tag("circle").round(x, y, RING_PX).attr("fill", "none");
        ring.stroke(INK, 0.9).leaf();
    }
}

/// The farthest values within reach of the box.
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

    /// The plot is no wider for it, and its row as high as it needs.
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
