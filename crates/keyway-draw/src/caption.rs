//! Title above a picture, and caption below it.

use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::writer::{Anchor, SvgWriter};

/// Margin at the edge of the page \[px\].
pub(crate) const EDGE_PX: f64 = 8.0;
/// Size of the title \[px\].
const TITLE_PX: f64 = 13.5;
/// Height of the title with the space below it \[px\].
pub(crate) const HEAD_PX: f64 = TITLE_PX + 10.0;
const ROW_PX: f64 = 14.5;

/// Draws a title above the content that begins at `left`, centred if it fits; returns its right
/// edge \[px\], 0 without a title.
pub(crate) fn draw_title(out: &mut SvgWriter, title: &str, left: f64, width_px: f64) -> f64 {
    if title.is_empty() {
        return 0.0;
    }
    let title_px = text_width_px(title, TITLE_PX);
    let x = left + 0.5 * (width_px - title_px).max(0.0);
    out.label(x, EDGE_PX + TITLE_PX - 1.0, TITLE_PX, Anchor::Start, title);
    x + title_px
}

/// A text, wrapped to a width.
pub(crate) struct Caption {
    lines: Vec<String>,
}

impl Caption {
    /// Breaks a text at spaces; a word that is wider than a line has its own line.
    pub(crate) fn new(text: &str, width_px: f64) -> Self {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            let fits = |line: &&mut String| {
                text_width_px(&format!("{line} {word}"), SMALL_TEXT_PX) <= width_px
            };
            match lines.last_mut().filter(fits) {
                Some(line) => line.extend([" ", word]),
                None => lines.push(word.to_owned()),
            }
        }
        Self { lines }
    }

    pub(crate) fn height_px(&self) -> f64 {
        self.lines.len() as f64 * ROW_PX
    }

    pub(crate) fn width_px(&self) -> f64 {
        self.lines.iter().map(|line| text_width_px(line, SMALL_TEXT_PX)).fold(0.0, f64::max)
    }

    /// Draws the text with its upper left corner at (x, y).
    pub(crate) fn draw(&self, out: &mut SvgWriter, x: f64, y: f64) {
        for (line, i) in self.lines.iter().zip(1..) {
            let base = y + f64::from(i) * ROW_PX - 4.0;
            out.label(x, base, SMALL_TEXT_PX, Anchor::Start, line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_no_wider_than_they_may_be() {
        let text = "some words and averyverylongword ".repeat(8);
        let caption = Caption::new(&text, 120.0);
        assert!(caption.width_px() <= 120.0 && caption.lines.len() > 8);
        assert_eq!(caption.lines.join(" "), text.trim());
        assert_eq!(Caption::new("", 100.0).height_px(), 0.0);
    }
}
