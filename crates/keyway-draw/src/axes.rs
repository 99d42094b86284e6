//! Draws axes around a panel.

use crate::axis::{Axis, GAP_PX, NAME_GAP_PX, NOTE_GAP_PX, ROWS_INSET_PX, TEXT_PX, TICK_PX};
use crate::color::INK;
use crate::name_lines::NameLines;
use crate::text::SMALL_TEXT_PX;
use crate::writer::{Anchor, SvgWriter, number};

/// Width of axes and ticks \[px\].
const LINE_PX: f64 = 0.8;
/// Height of digits as a share of the text size, to centre them on their tick.
const DIGIT_HEIGHT: f64 = 0.73;
const HALF_DIGIT_PX: f64 = 0.5 * DIGIT_HEIGHT * SMALL_TEXT_PX;

/// Height of everything below the panel that belongs to its lower axis \[px\].
pub(crate) const BOTTOM_AXIS_PX: f64 = TICK_PX + GAP_PX + SMALL_TEXT_PX + GAP_PX + TEXT_PX + 4.0;

/// A position on the page.
type Px = (f64, f64);

/// An axis with the positions of its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale<'a> {
    pub(crate) axis: &'a Axis,
    low_px: f64,
    high_px: f64,
}

impl<'a> Scale<'a> {
    pub(crate) const fn across(axis: &'a Axis, left_px: f64, right_px: f64) -> Self {
        Self { axis, low_px: left_px, high_px: right_px }
    }

    /// A vertical axis: categories run downwards, values upwards.
    pub(crate) const fn upright(axis: &'a Axis, top_px: f64, bottom_px: f64) -> Self {
        if axis.is_of_categories {
            Self { axis, low_px: top_px + ROWS_INSET_PX, high_px: bottom_px - ROWS_INSET_PX }
        } else {
            Self { axis, low_px: bottom_px, high_px: top_px }
        }
    }

    pub(crate) fn px(&self, value: f64) -> f64 {
        self.px_at(self.axis.fraction(value))
    }

    /// Like [`Self::px`], with values beyond the axis moved to its end.
    pub(crate) fn px_within(&self, value: f64) -> f64 {
        self.px_at(self.axis.fraction(value).clamp(0.0, 1.0))
    }

    fn px_at(&self, fraction: f64) -> f64 {
        self.low_px + (self.high_px - self.low_px) * fraction
    }

    /// Draws ticks with their texts: each from one position to another, with the text at a third
    /// one.
    fn draw_ticks(&self, out: &mut SvgWriter, anchor: Anchor, places: impl Fn(f64) -> [Px; 3]) {
        for (value, text) in &self.axis.marks {
            let [from, to, (x, base)] = places(self.px(*value));
            out.tag("line").between(from, to).stroke(INK, LINE_PX).leaf();
            out.label(x, base, SMALL_TEXT_PX, anchor, text);
        }
    }

    /// Draws the ticks, their texts and the label below a panel whose lower edge is at `y`.
    pub(crate) fn draw_below(&self, out: &mut SvgWriter, y: f64) {
        let base = y + TICK_PX + GAP_PX + DIGIT_HEIGHT * SMALL_TEXT_PX;
        self.draw_ticks(out, Anchor::Middle, |x| [(x, y), (x, y + TICK_PX), (x, base)]);
        if let Some(label) = &self.axis.label {
            out.label(self.middle_px(), y + BOTTOM_AXIS_PX - 4.0, TEXT_PX, Anchor::Middle, label);
        }
    }

    /// Draws the ticks, their texts and the label left of a panel whose left edge is at `x`;
    /// `width_px` is the space taken ([`Axis::side_px`], or more to align several panels).
    /// Categories have only names.
    pub(crate) fn draw_left(&self, out: &mut SvgWriter, x: f64, width_px: f64) {
        if self.axis.is_of_categories {
            self.draw_rows(out, &self.axis.names, x - NAME_GAP_PX, Anchor::End);
        } else {
            let (end, text) = (x - TICK_PX, x - TICK_PX - GAP_PX);
            let places = |y| [(end, y), (x, y), (text, y + HALF_DIGIT_PX)];
            self.draw_ticks(out, Anchor::End, places);
        }
        self.draw_upright_label(out, x - width_px + DIGIT_HEIGHT * TEXT_PX);
    }

    /// Draws the notes of categories right of a panel whose right edge is at `x`.
    pub(crate) fn draw_notes(&self, out: &mut SvgWriter, x: f64) {
        self.draw_rows(out, &self.axis.notes, x + NOTE_GAP_PX, Anchor::Start);
    }

    /// Draws each text in the middle of its row.
    fn draw_rows(&self, out: &mut SvgWriter, texts: &[NameLines], x: f64, anchor: Anchor) {
        for (text, (value, _)) in texts.iter().zip(&self.axis.marks) {
            let below = 0.36 * SMALL_TEXT_PX + 0.5 * (text.height_px() - NameLines::LINE_PX);
            text.draw(out, x, self.px(*value) + below, anchor);
        }
    }

    /// Like [`Self::draw_left`], on the right.
    pub(crate) fn draw_right(&self, out: &mut SvgWriter, x: f64) {
        let end = x + TICK_PX;
        let places = |y| [(x, y), (end, y), (end + GAP_PX, y + HALF_DIGIT_PX)];
        self.draw_ticks(out, Anchor::Start, places);
        self.draw_upright_label(out, x + self.axis.side_px() - 2.0);
    }

    fn middle_px(&self) -> f64 {
        0.5 * (self.low_px + self.high_px)
    }

    fn draw_upright_label(&self, out: &mut SvgWriter, x: f64) {
        let (y, Some(label)) = (self.middle_px(), &self.axis.label) else { return };
        let turn = format!("rotate(-90 {} {})", number(x), number(y));
        let tag = out.tag("text").at(x, y).num("font-size", TEXT_PX).anchor(Anchor::Middle);
        tag.attr("transform", &turn).text(label);
    }
}

/// Draws the border of a panel.
pub(crate) fn border(out: &mut SvgWriter, x: f64, y: f64, width: f64, height: f64) {
    out.tag("rect").at(x, y).size(width, height).attr("fill", "none").stroke(INK, LINE_PX).leaf();
}
