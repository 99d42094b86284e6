//! Bars with their intervals, one below the other over one axis, and what they are compared with.

use crate::axes::{BOTTOM_AXIS_PX, SMALL_TEXT_PX, Scale, border, bottom_axis};
use crate::caption::Caption;
use crate::color::{GRID, INK, QUIET, Rgb};
use crate::name_lines::NameLines;
use crate::svg::Svg;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, PathData, SvgWriter};

const WIDTH_PX: f64 = 420.0;
const ROW_PX: f64 = 28.0;
const HALF_BAR_PX: f64 = 7.0;
const HALF_CAP_PX: f64 = 4.5;
const HALF_MARK_PX: f64 = 5.0;
const EDGE_PX: f64 = 8.0;
/// A longer name has several lines.
const NAME_PX: f64 = 250.0;
const NAME_GAP_PX: f64 = 8.0;
const INTERVALS: usize = 7;
/// Light enough for the marks over it, and for a page in grey.
const BAR: Rgb = Rgb(0xcf, 0xdf, 0xee);

/// Values with their intervals over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalChart<'a> {
    /// The quantity, with its unit.
    pub label: &'a str,
    /// The values, top one first.
    pub rows: &'a [IntervalRow<'a>],
    /// What is to be said below; empty for nothing.
    pub caption: &'a str,
}

/// A value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalRow<'a> {
    /// Its name.
    pub name: &'a str,
    /// The value: a bar from 0. `None`: there is none.
    pub value: Option<f64>,
    /// Between what the true one lies: whiskers.
    pub interval: Option<(f64, f64)>,
    /// What it is compared with: a diamond.
    pub reference: Option<f64>,
    /// What stands at the other end of its row.
    pub note: &'a str,
}

/// Draws a bar from 0 to each value with whiskers for its interval, and a diamond where it is compared with something. Numbers
/// that are not finite are left out.
pub fn interval_chart(chart: &IntervalChart<'_>) -> Svg {
    let top = EDGE_PX + 4.0;
    let names: Vec<NameLines> =
        chart.rows.iter().map(|row| NameLines::new(row.name, NAME_PX)).collect();
    let row_px = names.iter().map(|name| name.height_px() + 6.0).fold(ROW_PX, f64::max);
    let bottom = top + chart.rows.len() as f64 * row_px + 8.0;
    let names_px = names.iter().map(NameLines::width_px).fold(0.0, f64::max);
    let left = EDGE_PX + names_px + NAME_GAP_PX;
    let right = left + WIDTH_PX;
    let (low, high) = ends(chart.rows);
    let scale = Scale { low, high, low_px: left, high_px: right };
    let ticks = Ticks::new(low, high, INTERVALS);
    let mut out = SvgWriter::new();
    for &value in &ticks.values {
        let (x, color) = (scale.px(value), if value == 0.0 { QUIET } else { GRID });
        out.tag("line").between((x, top), (x, bottom)).stroke(color, 0.8).leaf();
    }
    for (i, (row, name)) in chart.rows.iter().zip(&names).enumerate() {
        let y = top + 4.0 + (i as f64 + 0.5) * row_px;
        let base = y + 0.36 * SMALL_TEXT_PX + 0.5 * (name.height_px() - NameLines::LINE_PX);
        name.draw(&mut out, left - NAME_GAP_PX, base, Anchor::End);
        draw_row(&mut out, row, scale, y);
        out.label(right + 6.0, y + 0.36 * SMALL_TEXT_PX, SMALL_TEXT_PX, Anchor::Start, row.note);
    }
    border(&mut out, left, top, WIDTH_PX, bottom - top);
    bottom_axis(&mut out, scale, bottom, &ticks, chart.label);
    let note_px = |row: &IntervalRow<'_>| text_width_px(row.note, SMALL_TEXT_PX);
    let notes_px = chart.rows.iter().map(note_px).fold(0.0, f64::max);
    let width = right + 6.0 + notes_px + EDGE_PX;
    let caption = Caption::new(chart.caption, width - 2.0 * EDGE_PX);
    let caption_y = bottom + BOTTOM_AXIS_PX + 6.0;
    caption.draw(&mut out, EDGE_PX, caption_y);
    let width = width.max(caption.width_px() + 2.0 * EDGE_PX);
    Svg::page(width, caption_y + caption.height_px() + EDGE_PX, out)
}

/// The axis: all that is shown and 0, with room at both ends.
fn ends(rows: &[IntervalRow<'_>]) -> (f64, f64) {
    let of_row = |row: &IntervalRow<'_>| {
        let (low, high) = row.interval.unzip();
        [row.value, row.reference, low, high]
    };
    let all = rows.iter().flat_map(of_row).flatten().filter(|value| value.is_finite());
    let (low, high) = all.fold((0.0, 0.0), |(low, high), value| (value.min(low), value.max(high)));
    if low == high {
        return (-1.0, 1.0);
    }
    let room = 0.04 * (high - low);
    (if low < 0.0 { low - room } else { low }, if high > 0.0 { high + room } else { high })
}

fn draw_row(out: &mut SvgWriter, row: &IntervalRow<'_>, scale: Scale, y: f64) {
    let finite = |value: &f64| value.is_finite();
    if let Some(value) = row.value.filter(finite) {
        let [from, to] = [0.0_f64.min(value), 0.0_f64.max(value)].map(|end| scale.px(end));
        let bar = out.tag("rect").at(from, y - HALF_BAR_PX).size(to - from, 2.0 * HALF_BAR_PX);
        bar.fill(BAR).stroke(INK, 0.8).leaf();
    }
    if let Some((low, high)) = row.interval.filter(|(low, high)| finite(low) && finite(high)) {
        let [low, high] = [low, high].map(|end| scale.px(end));
        out.tag("line").between((low, y), (high, y)).stroke(INK, 1.6).leaf();
        for x in [low, high] {
            let cap = out.tag("line").between((x, y - HALF_CAP_PX), (x, y + HALF_CAP_PX));
            cap.stroke(INK, 1.6).leaf();
        }
    }
    if let Some(reference) = row.reference.filter(finite) {
        let (x, half) = (scale.px(reference), HALF_MARK_PX);
        let mut mark = PathData::line([(x - half, y), (x, y - half), (x + half, y), (x, y + half)]);
        mark.close();
        out.tag("path").attr("fill", "#fff").stroke(INK, 1.4).attr("d", mark.as_str()).leaf();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: IntervalRow<'_> =
        IntervalRow { name: "a", value: None, interval: None, reference: None, note: "" };

    #[test]
    fn the_axis_holds_all_and_zero() {
        let row = IntervalRow { value: Some(-0.5), interval: Some((-0.75, -0.25)), ..EMPTY };
        assert_eq!(ends(&[row]), (-0.78, 0.0));
        let row = IntervalRow { reference: Some(0.25), ..row };
        assert_eq!(ends(&[row, EMPTY]), (-0.79, 0.29));
        assert_eq!(ends(&[IntervalRow { value: Some(f64::NAN), ..EMPTY }]), (-1.0, 1.0));
    }

    #[test]
    fn every_part_that_is_there_is_drawn() {
        let full = IntervalRow {
            name: "length <of> all",
            value: Some(2.0),
            interval: Some((1.0, 3.0)),
            reference: Some(4.0),
            note: "n = 8",
        };
        let draw = |rows: &[IntervalRow<'_>]| {
            let chart = IntervalChart { label: "change [%]", rows, caption: "How it was made." };
            interval_chart(&chart).into_string()
        };
        let (all, none) = (draw(&[full]), draw(&[EMPTY]));
        let diamonds = |svg: &str| svg.matches("<path").count();
        let bars = |svg: &str| svg.matches(&BAR.to_string()).count();
        assert_eq!([diamonds(&all), bars(&all), diamonds(&none), bars(&none)], [1, 1, 0, 0]);
        for text in ["length &lt;of&gt; all", "n = 8", "change [%]", "How it was made."] {
            assert!(all.contains(text), "{text}");
        }
        assert!(!draw(&[IntervalRow { value: Some(f64::INFINITY), ..full }]).contains("inf"));
    }
}
