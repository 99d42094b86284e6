//! A name beside or above an element, in as many lines as it needs.

use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::writer::{Anchor, SvgWriter};

/// A name, wrapped to a width. Nothing is left out, so different names look different.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NameLines {
    lines: Vec<String>,
}

impl NameLines {
    /// Distance between lines \[px\].
    pub(crate) const LINE_PX: f64 = 12.5;

    /// Breaks a name at spaces; within a word only if it is wider than a line: after the
    /// characters that join its parts, or anywhere in a part that is wider than a line. The
    /// number of lines is minimal, and they are about equally long.
    pub(crate) fn new(name: &str, width_px: f64) -> Self {
        let filled = Self::filled(name, width_px);
        if filled.lines.len() < 2 {
            return filled;
        }
        let words = words(name);
        let widths_px = words.iter().map(|word| text_width_px(word.trim_end(), SMALL_TEXT_PX));
        // The smallest width with the same number of lines that breaks no further word.
        let (mut low, mut high) = (widths_px.fold(0.0, f64::max).min(width_px), width_px);
        while high - low > 1.0 {
            let middle = 0.5 * (low + high);
            let is_enough = Self::filled(name, middle).lines.len() <= filled.lines.len();
            *(if is_enough { &mut high } else { &mut low }) = middle;
        }
        Self::filled(name, high)
    }

    /// Takes the lines of a text as they are.
    pub(crate) fn of_lines(text: &str) -> Self {
        Self { lines: text.lines().map(str::to_owned).collect() }
    }

    /// Fills each line as far as possible.
    fn filled(name: &str, width_px: f64) -> Self {
        let fits = |text: &str| text_width_px(text.trim_end(), SMALL_TEXT_PX) <= width_px;
        let mut lines = vec![String::new()];
        for word in words(name) {
            for piece in pieces(&word, &fits) {
                match lines.last_mut() {
                    Some(line) if line.is_empty() || fits(&format!("{line}{piece}")) => {
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

    /// Draws the name with its lowest line on a base line.
    pub(crate) fn draw(&self, out: &mut SvgWriter, x: f64, base: f64, anchor: Anchor) {
        // The first line comes first in the file, too, so that screen readers read it first.
        for (line, above) in self.lines.iter().zip((0..self.lines.len()).rev()) {
            let y = base - above as f64 * Self::LINE_PX;
            out.label(x, y, SMALL_TEXT_PX, anchor, line.trim_end());
        }
    }
}

/// Splits a name into the parts between which a line may end: at spaces, but not before a sign,
/// such as a percent sign, nor around an equals sign.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in name.split_inclusive(' ') {
        let is_sign = !word.contains(char::is_alphanumeric);
        match words.last_mut() {
            Some(last) if is_sign || last.ends_with("= ") => last.push_str(word),
            _ => words.push(word.to_owned()),
        }
    }
    words
}

/// Splits a word into the parts between which it may be broken.
fn pieces(word: &str, fits: &dyn Fn(&str) -> bool) -> Vec<String> {
    if fits(word) {
        return vec![word.to_owned()];
    }
    let letters = |part: &str| -> Vec<String> { part.chars().map(String::from).collect() };
    let parts = word.split_inclusive(['/', '-', '_', '.']);
    parts.flat_map(|part| if fits(part) { vec![part.to_owned()] } else { letters(part) }).collect()
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

    /// No single word is below a full line.
    #[test]
    fn lines_are_about_equally_long() {
        let name = "search time of bidirectional-astar, lower than astar";
        let lines = NameLines::new(name, 250.0);
        assert_eq!(lines.lines, ["search time of bidirectional-astar, ", "lower than astar"]);
        let name = "clearance of density-astar, at least 0.000001 m";
        let lines = NameLines::new(name, 250.0);
        assert_eq!(lines.lines, ["clearance of density-astar, ", "at least 0.000001 m"]);
        assert_eq!(NameLines::new(name, 1000.0).lines, [name]);
        let name = "turns of accumulated g, X = 1.1, within 1 % of traditional";
        let lines = NameLines::new(name, 150.0);
        assert_eq!(
            lines.lines,
            ["turns of accumulated ", "g, X = 1.1, within ", "1 % of traditional"]
        );
        assert_eq!(words("X = 1.1, 20 % of"), ["X = 1.1, ", "20 % ", "of"]);
    }
}
