//! Bars with intervals and reference values, in rows over one axis.

use crate::chart::Margins;
use crate::color::INK;
use crate::ticks::span;
use crate::{Axis, Chart, ChartPoint, LineStyle, PathData, Plot, Rgb, Svg};

const WIDTH_PX: f64 = 380.0;
const ROW_PX: f64 = 28.0;
const HALF_BAR_PX: f64 = 7.0;
const HALF_CAP_PX: f64 = 4.5;
const HALF_MARK_PX: f64 = 5.0;
/// Distance from the end of the plot to the middle of a break, and between its two lines.
const BREAK_INSET_PX: f64 = 16.0;
const BREAK_GAP_PX: f64 = 4.0;
/// Maximum width of a name \[px\]; longer names have several lines.
const NAME_PX: f64 = 250.0;
const INTERVALS: usize = 7;
/// Width of grid lines \[px\]: stronger than usual, to lead the eye to the notes.
const GRID_PX: f64 = 0.8;
/// Ratio to the reach of all other rows from which on a bar is broken: they would have less than
/// a twenty-fifth of the axis.
const DWARFING: f64 = 25.0;
const BROKEN: &str = "A bar with a break continues beyond the axis; its values are beside it.";
/// Light enough for the marks over the bar, and for grey print.
const BAR: Rgb = Rgb(0xcf, 0xdf, 0xee);

/// Values with their intervals over one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalChart<'a> {
    /// The quantity, with its unit.
    pub label: &'a str,
    /// Range that the axis covers at least; `None`: that of its rows.
    pub ends: Option<(f64, f64)>,
    /// The values, top one first.
    pub rows: &'a [IntervalRow<'a>],
    /// Caption below the chart; empty for none.
    pub caption: &'a str,
}

/// A row of the chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalRow<'a> {
    /// Name of the row.
    pub name: &'a str,
    /// The value, drawn as a bar from 0; `None` if there is none.
    pub value: Option<f64>,
    /// Confidence interval of the value, drawn as whiskers.
    pub interval: Option<(f64, f64)>,
    /// Reference value, drawn as a diamond.
    pub reference: Option<f64>,
    /// Text at the other end of the row, such as its numbers; may have several lines.
    pub note: &'a str,
}

impl IntervalRow<'_> {
    /// Returns all finite numbers of the row.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let (low, high) = self.interval.unzip();
        let all = [self.value, self.reference, low, high].into_iter().flatten();
        all.filter(|value| value.is_finite())
    }

    /// Largest distance of its numbers from 0.
    fn reach(&self) -> f64 {
        self.numbers().map(f64::abs).fold(0.0, f64::max)
    }
}

/// Draws a bar from 0 to each value, with whiskers for its interval and a diamond for its
/// reference value. Numbers that are not finite are left out.
///
/// A bar that would leave no space for the others is broken: the axis ends with most of the rows,
/// and a break shows that the bar, or its whisker, continues. Its numbers belong in its note.
pub fn interval_chart(chart: &IntervalChart<'_>) -> Svg {
    let ends = ends(chart);
    let mut axis = Axis::linear(ends.0, ends.1, INTERVALS).label(chart.label).strong_zero();
    axis.grid_px = GRID_PX;
    let names = chart.rows.iter().map(|row| row.name);
    let notes = chart.rows.iter().map(|row| row.note);
    let mut rows = Axis::categories(names, NAME_PX).notes(notes);
    rows.row_px = ROW_PX;
    let is_broken = chart.rows.iter().any(|row| row.numbers().any(|value| is_beyond(value, ends)));
    let caption = [chart.caption, if is_broken { BROKEN } else { "" }].join(" ");
    let mut drawn = Chart::new(axis, WIDTH_PX, 0.0).caption(caption);
    drawn.margins = Margins::ROWS;
    drawn.panel(rows, |plot| draw_rows(plot, chart.rows, ends)).svg()
}

/// Returns the range of the axis: 0 and all shown values, up to the maximum reach of a row, with
/// a margin at both ends.
fn ends(chart: &IntervalChart<'_>) -> (f64, f64) {
    let longest = longest(chart.rows);
    let own = chart.rows.iter().flat_map(IntervalRow::numbers);
    let own = own.map(|value| value.clamp(-longest, longest));
    let needed = || span(own.chain([0.0]));
    let (low, high) = chart.ends.or_else(needed).unwrap_or_default();
    if low == high {
        return (-1.0, 1.0);
    }
    let room = 0.04 * (high - low);
    (if low < 0.0 { low - room } else { low }, if high > 0.0 { high + room } else { high })
}

/// Returns the maximum reach of a row: that of the longest of the rows that others dwarf. The
/// dwarfing rows are at most half of all.
fn longest(rows: &[IntervalRow<'_>]) -> f64 {
    let mut reaches: Vec<f64> = rows.iter().map(IntervalRow::reach).collect();
    reaches.sort_by(|a, b| b.total_cmp(a));
    let is_dwarfed = |&i: &usize| reaches[i] > 0.0 && reaches[i - 1] > DWARFING * reaches[i];
    (1..=rows.len() / 2).rfind(is_dwarfed).map_or(f64::INFINITY, |i| reaches[i])
}

fn is_beyond(value: f64, (low, high): (f64, f64)) -> bool {
    value < low || value > high
}

fn draw_rows(plot: &mut Plot<'_>, rows: &[IntervalRow<'_>], ends: (f64, f64)) {
    for (i, row) in rows.iter().enumerate() {
        draw_row(plot, row, i as f64, ends);
    }
}

fn draw_row(plot: &mut Plot<'_>, row: &IntervalRow<'_>, at: f64, ends: (f64, f64)) {
    if let Some(value) = row.value {
        let half = HALF_BAR_PX / (plot.y_px(1.0) - plot.y_px(0.0));
        plot.bar(ChartPoint::new(0.0, at - half), ChartPoint::new(value, at + half), BAR);
    }
    if let Some((low, high)) = row.interval {
        plot.interval(at, low, high, LineStyle::solid(INK, 1.6), HALF_CAP_PX);
    }
    let (area, y) = (plot.area(), plot.y_px(at));
    if row.numbers().any(|value| value < ends.0) {
        draw_break(plot, (area.left_px + BREAK_INSET_PX, y));
    }
    if row.numbers().any(|value| value > ends.1) {
        draw_break(plot, (area.right_px - BREAK_INSET_PX, y));
    }
    let is_within = |value: &f64| value.is_finite() && !is_beyond(*value, ends);
    if let Some(reference) = row.reference.filter(is_within) {
        let (x, half) = (plot.x_px(reference), HALF_MARK_PX);
        let mut mark = PathData::line([(x - half, y), (x, y - half), (x + half, y), (x, y + half)]);
        mark.close();
        let tag = plot.writer().tag("path").attr("fill", "#fff").stroke(INK, 1.4);
        tag.attr("d", mark.as_str()).leaf();
    }
}

/// Draws two slanted lines with a gap between them.
fn draw_break(plot: &mut Plot<'_>, (x, y): (f64, f64)) {
    let (half, slant, gap) = (HALF_BAR_PX + 2.0, 3.0, 0.5 * BREAK_GAP_PX);
    let [left, right] =
        [-gap, gap].map(|dx| [(x + dx - slant, y + half), (x + dx + slant, y - half)]);
    let ground = PathData::line([left[0], left[1], right[1], right[0]]);
    plot.writer().tag("path").attr("fill", "#fff").attr("d", ground.as_str()).leaf();
    for line in [left, right] {
        plot.segment(line, INK, 1.0);
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
        // The axis ends at 16, so the others keep their relative lengths; the long one extends to
        // the end.
        assert!(px[0] > 100.0 && px[2] > px[3] && px[3] > px[0], "{px:?}");
        assert!((px[1] / px[0] - 15.0 / 14.0).abs() < 1e-2, "{px:?}");
        assert!(svg.contains("beyond the axis") && svg.matches("<path").count() == 1);
        // To the other side, and only a whisker.
        let far = IntervalRow { interval: Some((-2e4, 5.0)), ..bar(1.0) };
        let svg = draw(&[bar(14.0), bar(15.0), far, bar(9.0)]);
        assert!(svg.contains("beyond the axis") && svg.matches("<path").count() == 1);
        assert!(bars_px(&svg).iter().all(|&px| px > 8.0));
    }

    #[test]
    fn nothing_is_broken_without_need() {
        for values in [
            // Legible; most are long, and one is short; the others are 0; a single one; none.
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
