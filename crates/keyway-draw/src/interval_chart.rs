//! Bars with their intervals, one below the other over one axis, and what they are compared with.

use crate::axes::{BOTTOM_AXIS_PX, SMALL_TEXT_PX, Scale, border, bottom_axis};
use crate::caption::Caption;
use crate::color::{GRID, INK, QUIET, Rgb};
use crate::name_lines::NameLines;
use crate::svg::Svg;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, PathData, SvgWriter};

const WIDTH_PX: f64 = 380.0;
const ROW_PX: f64 = 28.0;
const HALF_BAR_PX: f64 = 7.0;
const HALF_CAP_PX: f64 = 4.5;
const HALF_MARK_PX: f64 = 5.0;
/// From the end of the plot to the middle of a break, and between its two lines.
const BREAK_INSET_PX: f64 = 16.0;
const BREAK_GAP_PX: f64 = 4.0;
const EDGE_PX: f64 = 8.0;
/// A longer name has several lines.
const NAME_PX: f64 = 250.0;
const NAME_GAP_PX: f64 = 8.0;
const INTERVALS: usize = 7;
/// What is this many times as long as all other rows leaves less than a twenty-fifth of the axis
/// for them.
const DWARFING: f64 = 25.0;
const BROKEN: &str = "What has a break goes on beyond the axis; its numbers stand beside it.";
/// Light enough for the marks over it, and for a page in grey.
const BAR: Rgb = Rgb(0xcf, 0xdf, 0xee);

/// Values with their intervals over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalChart<'a> {
    /// The quantity, with its unit.
    pub label: &'a str,
    /// What the axis is to hold; `None`: what its rows need.
    pub ends: Option<(f64, f64)>,
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
    /// What stands at the other end of its row, such as its numbers; may have several lines.
    pub note: &'a str,
}

impl IntervalRow<'_> {
    /// All its numbers.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let (low, high) = self.interval.unzip();
        let all = [self.value, self.reference, low, high].into_iter().flatten();
        all.filter(|value| value.is_finite())
    }

    /// How far it reaches from 0.
    fn reach(&self) -> f64 {
        self.numbers().map(f64::abs).fold(0.0, f64::max)
    }
}

/// Draws a bar from 0 to each value with whiskers for its interval, and a diamond where it is
/// compared with something. Numbers that are not finite are left out.
///
/// A bar that would leave no room for the others is broken: the axis ends where most of the rows
/// end, and a break says that the bar, or its whisker, goes on. Its numbers belong in its note.
pub fn interval_chart(chart: &IntervalChart<'_>) -> Svg {
    let top = EDGE_PX + 4.0;
    let names: Vec<NameLines> =
        chart.rows.iter().map(|row| NameLines::new(row.name, NAME_PX)).collect();
    let notes = chart.rows.iter().map(|row| note_px(row.note).1);
    let row_px = names.iter().map(NameLines::height_px).chain(notes);
    let row_px = row_px.map(|height_px| height_px + 6.0).fold(ROW_PX, f64::max);
    let bottom = top + chart.rows.len() as f64 * row_px + 8.0;
    let names_px = names.iter().map(NameLines::width_px).fold(0.0, f64::max);
    let left = EDGE_PX + names_px + NAME_GAP_PX;
    let right = left + WIDTH_PX;
    let (low, high) = ends(chart);
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
        draw_note(&mut out, row.note, (right + 6.0, y));
    }
    border(&mut out, left, top, WIDTH_PX, bottom - top);
    bottom_axis(&mut out, scale, bottom, &ticks, chart.label);
    let notes_px = chart.rows.iter().map(|row| note_px(row.note).0).fold(0.0, f64::max);
    let width = right + 6.0 + notes_px + EDGE_PX;
    let is_broken = chart.rows.iter().any(|row| row.numbers().any(|value| is_beyond(value, scale)));
    let caption = [chart.caption, if is_broken { BROKEN } else { "" }].join(" ");
    let caption = Caption::new(&caption, width - 2.0 * EDGE_PX);
    let caption_y = bottom + BOTTOM_AXIS_PX + 6.0;
    caption.draw(&mut out, EDGE_PX, caption_y);
    let width = width.max(caption.width_px() + 2.0 * EDGE_PX);
    Svg::page(width, caption_y + caption.height_px() + EDGE_PX, out)
}

/// Width and height of a note \[px\].
fn note_px(note: &str) -> (f64, f64) {
    let widths = note.lines().map(|line| text_width_px(line, SMALL_TEXT_PX));
    (widths.fold(0.0, f64::max), note.lines().count() as f64 * NameLines::LINE_PX)
}

/// In the middle of its row.
fn draw_note(out: &mut SvgWriter, note: &str, (x, y): (f64, f64)) {
    let first = y + 0.36 * SMALL_TEXT_PX - 0.5 * (note_px(note).1 - NameLines::LINE_PX);
    for (line, i) in note.lines().zip(0..) {
        let base = first + f64::from(i) * NameLines::LINE_PX;
        out.label(x, base, SMALL_TEXT_PX, Anchor::Start, line);
    }
}

/// The axis: 0 and all that is shown, as far as a row may reach, with room at both ends.
fn ends(chart: &IntervalChart<'_>) -> (f64, f64) {
    let longest = longest(chart.rows);
    let own = chart.rows.iter().flat_map(IntervalRow::numbers);
    let own = own.map(|value| value.clamp(-longest, longest));
    let (low, high) = chart.ends.unwrap_or_else(|| {
        own.fold((0.0, 0.0), |(low, high), value| (value.min(low), value.max(high)))
    });
    if low == high {
        return (-1.0, 1.0);
    }
    let room = 0.04 * (high - low);
    (if low < 0.0 { low - room } else { low }, if high > 0.0 { high + room } else { high })
}

/// How far a row may reach: as far as the longest of those that others dwarf, which are at most
/// half of all.
fn longest(rows: &[IntervalRow<'_>]) -> f64 {
    let mut reaches: Vec<f64> = rows.iter().map(IntervalRow::reach).collect();
    reaches.sort_by(|a, b| b.total_cmp(a));
    let is_dwarfed = |&i: &usize| reaches[i] > 0.0 && reaches[i - 1] > DWARFING * reaches[i];
    (1..=rows.len() / 2).rfind(is_dwarfed).map_or(f64::INFINITY, |i| reaches[i])
}

fn is_beyond(value: f64, scale: Scale) -> bool {
    value < scale.low || value > scale.high
}

fn draw_row(out: &mut SvgWriter, row: &IntervalRow<'_>, scale: Scale, y: f64) {
    let finite = |value: &f64| value.is_finite();
    let px = |value: f64| scale.px(value.clamp(scale.low, scale.high));
    if let Some(value) = row.value.filter(finite) {
        let [from, to] = [0.0_f64.min(value), 0.0_f64.max(value)].map(px);
        let bar = out.tag("rect").at(from, y - HALF_BAR_PX).size(to - from, 2.0 * HALF_BAR_PX);
        bar.fill(BAR).stroke(INK, 0.8).leaf();
    }
    if let Some((low, high)) = row.interval.filter(|(low, high)| finite(low) && finite(high)) {
        out.tag("line").between((px(low), y), (px(high), y)).stroke(INK, 1.6).leaf();
        for end in [low, high].into_iter().filter(|&end| !is_beyond(end, scale)) {
            let x = px(end);
            let cap = out.tag("line").between((x, y - HALF_CAP_PX), (x, y + HALF_CAP_PX));
            cap.stroke(INK, 1.6).leaf();
        }
    }
    if row.numbers().any(|value| value < scale.low) {
        draw_break(out, (scale.low_px + BREAK_INSET_PX, y));
    }
    if row.numbers().any(|value| value > scale.high) {
        draw_break(out, (scale.high_px - BREAK_INSET_PX, y));
    }
    if let Some(reference) =
        row.reference.filter(|&value| finite(&value) && !is_beyond(value, scale))
    {
        let (x, half) = (scale.px(reference), HALF_MARK_PX);
        let mut mark = PathData::line([(x - half, y), (x, y - half), (x + half, y), (x, y + half)]);
        mark.close();
        out.tag("path").attr("fill", "#fff").stroke(INK, 1.4).attr("d", mark.as_str()).leaf();
    }
}

/// Two slanted lines with nothing between them.
fn draw_break(out: &mut SvgWriter, (x, y): (f64, f64)) {
    let (half, slant, gap) = (HALF_BAR_PX + 2.0, 3.0, 0.5 * BREAK_GAP_PX);
    let [left, right] =
        [-gap, gap].map(|dx| [(x + dx - slant, y + half), (x + dx + slant, y - half)]);
    let ground = PathData::line([left[0], left[1], right[1], right[0]]);
    out.tag("path").attr("fill", "#fff").attr("d", ground.as_str()).leaf();
    for [from, to] in [left, right] {
        out.tag("line").between(from, to).stroke(INK, 1.0).leaf();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: IntervalRow<'_> =
        IntervalRow { name: "a", value: None, interval: None, reference: None, note: "" };

    fn chart<'a>(rows: &'a [IntervalRow<'a>]) -> IntervalChart<'a> {
        IntervalChart { label: "change [%]", ends: None, rows, caption: "How it was made." }
    }

    fn draw(rows: &[IntervalRow<'_>]) -> String {
        interval_chart(&chart(rows)).into_string()
    }

    fn bar(value: f64) -> IntervalRow<'static> {
        IntervalRow { value: Some(value), ..EMPTY }
    }

    #[test]
    fn the_axis_holds_all_and_zero() {
        let ends_of = |rows: &[IntervalRow<'_>]| ends(&chart(rows));
        let row = IntervalRow { value: Some(-0.5), interval: Some((-0.75, -0.25)), ..EMPTY };
        assert_eq!(ends_of(&[row]), (-0.78, 0.0));
        let row = IntervalRow { reference: Some(0.25), ..row };
        assert_eq!(ends_of(&[row, EMPTY]), (-0.79, 0.29));
        assert_eq!(ends_of(&[IntervalRow { value: Some(f64::NAN), ..EMPTY }]), (-1.0, 1.0));
        let rows = [row];
        let share = IntervalChart { ends: Some((0.0, 100.0)), ..chart(&rows) };
        assert_eq!(ends(&share), (0.0, 104.0));
    }

    #[test]
    fn every_part_that_is_there_is_drawn() {
        let full = IntervalRow {
            name: "length <of> all",
            value: Some(2.0),
            interval: Some((1.0, 3.0)),
            reference: Some(4.0),
            note: "2.0 (1.0 to 3.0)\nn = 8",
        };
        let (all, none) = (draw(&[full]), draw(&[EMPTY]));
        let diamonds = |svg: &str| svg.matches("<path").count();
        let bars = |svg: &str| svg.matches(&BAR.to_string()).count();
        assert_eq!([diamonds(&all), bars(&all), diamonds(&none), bars(&none)], [1, 1, 0, 0]);
        let texts = [
            "length &lt;of&gt; all",
            ">2.0 (1.0 to 3.0)<",
            ">n = 8<",
            "change [%]",
            ">How it was made.<",
        ];
        for text in texts {
            assert!(all.contains(text), "{text}");
        }
        assert!(!draw(&[IntervalRow { value: Some(f64::INFINITY), ..full }]).contains("inf"));
    }

    /// Widths of all bars \[px\].
    fn bars_px(svg: &str) -> Vec<f64> {
        let bars = svg.split("<rect").filter(|tag| tag.contains(&BAR.to_string()));
        let width = |tag: &str| tag.split("width=\"").nth(1)?.split('"').next()?.parse().ok();
        bars.filter_map(width).collect()
    }

    #[test]
    fn a_bar_that_dwarfs_the_others_is_broken() {
        let clipped = IntervalRow { interval: Some((53_000.0, 99_000.0)), ..bar(72_000.0) };
        let svg = draw(&[bar(14.0), bar(-15.0), clipped, bar(16.0)]);
        let px = bars_px(&svg);
        // The axis ends at 16, so the others keep their lengths to each other; the long one fills
        // it up to the end.
        assert!(px[0] > 100.0 && px[2] > px[3] && px[3] > px[0], "{px:?}");
        assert!((px[1] / px[0] - 15.0 / 14.0).abs() < 1e-2, "{px:?}");
        assert!(svg.contains("beyond the axis") && svg.matches("<path").count() == 1);
        // To the other side, and a whisker alone.
        let far = IntervalRow { interval: Some((-2e4, 5.0)), ..bar(1.0) };
        let svg = draw(&[bar(14.0), bar(15.0), far, bar(9.0)]);
        assert!(svg.contains("beyond the axis") && svg.matches("<path").count() == 1);
        assert!(bars_px(&svg).iter().all(|&px| px > 8.0));
    }

    #[test]
    fn nothing_is_broken_without_need() {
        for values in [
            // Legible; most are long, and one is short; the others are 0; one alone; none.
            &[14.0, -15.0, 300.0, 16.0][..],
            &[70.0, 30.0, 0.8],
            &[70.0, 0.0, 0.0, 0.0],
            &[7e4],
            &[],
        ] {
            let rows: Vec<IntervalRow<'_>> = values.iter().map(|&value| bar(value)).collect();
            assert_eq!(longest(&rows), f64::INFINITY, "{values:?}");
            assert!(!draw(&rows).contains("beyond"), "{values:?}");
        }
        // Half of them, and two at a time.
        assert_eq!(longest(&[bar(7e4), bar(-5.0)]), 5.0);
        assert_eq!(longest(&[bar(7e4), bar(-5.0), bar(400.0), bar(2.0)]), 5.0);
    }
}
