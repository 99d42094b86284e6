//! A name beside or above what it belongs to, in as many lines as it needs.

use crate::axes::SMALL_TEXT_PX;
use crate::text::text_width_px;
use crate::writer::{Anchor, SvgWriter};

/// A name in lines of a width. Nothing of it is left out: names that differ look different.
pub(crate) struct NameLines {
    lines: Vec<String>,
}

impl NameLines {
    /// From line to line.
    pub(crate) const LINE_PX: f64 = 12.5;

    /// Broken behind the characters that join words, or anywhere in a word that is wider than a line.
    pub(crate) fn new(name: &str, width_px: f64) -> Self {
        let fits = |text: &str| text_width_px(text, SMALL_TEXT_PX) <= width_px;
        let mut lines = vec![String::new()];
        for word in name.split_inclusive(['/', '-', '_', '.', ' ']) {
            let pieces: Vec<String> = if fits(word.trim_end()) {
                vec![word.to_owned()]
            } else {
                word.chars().map(String::from).collect()
            };
            for piece in pieces {
                match lines.last_mut() {
                    Some(line)
                        if line.is_empty() || fits(&format!("{line}{}", piece.trim_end())) =>
                    {
                        line.push_str(&piece);
                    }
                    _ => lines.push(piece),
                }
            }
        }
        Self { lines }
    }

    pub(crate) fn height_px(&self) -> f64 {
        self.lines.len() as f64 * Self::LINE_PX
    }

    pub(crate) fn width_px(&self) -> f64 {
        let width_px = |line: &String| text_width_px(line.trim_end(), SMALL_TEXT_PX);
        self.lines.iter().map(width_px).fold(0.0, f64::max)
    }

    /// Draws it with its lowest line on a base line.
    pub(crate) fn draw(&self, out: &mut SvgWriter, x: f64, base: f64, anchor: Anchor) {
        for (line, above) in self.lines.iter().rev().zip(0..) {
            let y = base - f64::from(above) * Self::LINE_PX;
            out.label(x, y, SMALL_TEXT_PX, anchor, line.trim_end());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_broken_where_words_join() {
        let name = "experiments/key-point-fusion_with_other_weights";
        let lines = NameLines::new(name, 110.0);
        assert!(lines.width_px() <= 110.0 && lines.lines.len() == 3, "{:?}", lines.lines);
        assert_eq!(lines.lines.concat(), name);
        assert!(
            lines.lines.iter().all(|line| line.ends_with(['/', '-', '_', 's'])),
            "{:?}",
            lines.lines
        );
        assert_eq!(NameLines::new("astar-follow", 110.0).lines, ["astar-follow"]);
        let word = "w".repeat(40);
        let lines = NameLines::new(&word, 50.0);
        assert!(lines.width_px() <= 50.0 && lines.lines.concat() == word);
        assert_eq!(NameLines::new("", 50.0).lines, [""]);
    }
}
