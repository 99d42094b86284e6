//! Axes with ticks and labels around a plot area.

use crate::color::INK;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, SvgWriter};

/// Size of tick labels and of the legend \[px\].
pub(crate) const SMALL_TEXT_PX: f64 = 11.0;
/// Size of axis labels \[px\].
pub(crate) const TEXT_PX: f64 = 12.0;
/// Size of the title \[px\].
pub(crate) const TITLE_PX: f64 = 13.5;
/// Width of axes and ticks \[px\].
const LINE_PX: f64 = 0.8;
const TICK_PX: f64 = 4.0;
const GAP_PX: f64 = 4.0;
/// Height of digits as a share of the text size, to centre them on their tick.
const DIGIT_HEIGHT: f64 = 0.73;

/// Height of everything below the plot area that belongs to its lower axis \[px\].
pub(crate) const BOTTOM_AXIS_PX: f64 = TICK_PX + GAP_PX + SMALL_TEXT_PX + GAP_PX + TEXT_PX + 4.0;

/// Values along an axis to pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) low_px: f64,
    pub(crate) high_px: f64,
}

impl Scale {
    pub(crate) fn px(&self, value: f64) -> f64 {
        let span = self.high - self.low;
        let fraction = if span == 0.0 { 0.5 } else { (value - self.low) / span };
        self.low_px + (self.high_px - self.low_px) * fraction
    }
}

/// Places along an axis, each with its text.
pub(crate) type Marks = [(f64, String)];

fn marks(ticks: &Ticks) -> Vec<(f64, String)> {
    ticks.values.iter().copied().zip(ticks.texts()).collect()
}

/// Ticks, their numbers and the label below a plot whose lower edge is at `y`.
pub(crate) fn bottom_axis(out: &mut SvgWriter, scale: Scale, y: f64, ticks: &Ticks, label: &str) {
    marked_bottom_axis(out, scale, y, &marks(ticks), label);
}

/// Like [`bottom_axis`], with any texts.
pub(crate) fn marked_bottom_axis(
    out: &mut SvgWriter,
    scale: Scale,
    y: f64,
    marks: &Marks,
    label: &str,
) {
    for (value, text) in marks {
        let x = scale.px(*value);
        out.tag("line").between((x, y), (x, y + TICK_PX)).stroke(INK, LINE_PX).leaf();
        let base = y + TICK_PX + GAP_PX + DIGIT_HEIGHT * SMALL_TEXT_PX;
        out.label(x, base, SMALL_TEXT_PX, Anchor::Middle, text);
    }
    let middle = 0.5 * (scale.low_px + scale.high_px);
    let base = y + BOTTOM_AXIS_PX - 4.0;
    out.label(middle, base, TEXT_PX, Anchor::Middle, label);
}

/// Width of everything beside the plot area that belongs to a left or right axis \[px\].
pub(crate) fn side_axis_px(ticks: &Ticks) -> f64 {
    marked_side_axis_px(&marks(ticks))
}

/// Like [`side_axis_px`], with any texts.
pub(crate) fn marked_side_axis_px(marks: &Marks) -> f64 {
    let width_px = |(_, text): &(f64, String)| text_width_px(text, SMALL_TEXT_PX);
    let widest_px = marks.iter().map(width_px).fold(0.0, f64::max);
    TICK_PX + GAP_PX + widest_px + 2.0 * GAP_PX + TEXT_PX
}

/// Ticks, their numbers and the label left of a plot whose left edge is at `x`; `width_px` is the
/// room taken ([`side_axis_px`], or more to align several plots).
pub(crate) fn left_axis(
    out: &mut SvgWriter,
    scale: Scale,
    x: f64,
    width_px: f64,
    ticks: &Ticks,
    label: &str,
) {
    marked_left_axis(out, scale, x, width_px, &marks(ticks), label);
}

/// Like [`left_axis`], with any texts.
pub(crate) fn marked_left_axis(
    out: &mut SvgWriter,
    scale: Scale,
    x: f64,
    width_px: f64,
    marks: &Marks,
    label: &str,
) {
    for (value, text) in marks {
        let y = scale.px(*value);
        out.tag("line").between((x - TICK_PX, y), (x, y)).stroke(INK, LINE_PX).leaf();
        let base = y + 0.5 * DIGIT_HEIGHT * SMALL_TEXT_PX;
        out.label(x - TICK_PX - GAP_PX, base, SMALL_TEXT_PX, Anchor::End, text);
    }
    let middle = 0.5 * (scale.low_px + scale.high_px);
    upright_label(out, x - width_px + DIGIT_HEIGHT * TEXT_PX, middle, label);
}

/// Like [`left_axis`], on the right.
pub(crate) fn right_axis(out: &mut SvgWriter, scale: Scale, x: f64, ticks: &Ticks, label: &str) {
    for (&value, text) in ticks.values.iter().zip(ticks.texts()) {
        let y = scale.px(value);
        out.tag("line").between((x, y), (x + TICK_PX, y)).stroke(INK, LINE_PX).leaf();
        let base = y + 0.5 * DIGIT_HEIGHT * SMALL_TEXT_PX;
        out.label(x + TICK_PX + GAP_PX, base, SMALL_TEXT_PX, Anchor::Start, &text);
    }
    let middle = 0.5 * (scale.low_px + scale.high_px);
    upright_label(out, x + side_axis_px(ticks) - 2.0, middle, label);
}

fn upright_label(out: &mut SvgWriter, x: f64, y: f64, label: &str) {
    let turn = format!("rotate(-90 {} {})", crate::writer::number(x), crate::writer::number(y));
    out.tag("text")
        .at(x, y)
        .num("font-size", TEXT_PX)
        .anchor(Anchor::Middle)
        .attr("transform", &turn)
        .text(label);
}

/// The border of a plot area.
pub(crate) fn border(out: &mut SvgWriter, x: f64, y: f64, width: f64, height: f64) {
    out.tag("rect").at(x, y).size(width, height).attr("fill", "none").stroke(INK, LINE_PX).leaf();
}
