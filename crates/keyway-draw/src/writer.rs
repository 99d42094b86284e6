//! Writer of SVG: tags, attributes, escaped text and short numbers. The same calls give the same
//! bytes.

use crate::color::Rgb;
use crate::line_style::LineStyle;
use std::fmt::Write as _;

/// Fonts of all pictures: the bundled one for PNG, and its nearest relatives for browsers without
/// it.
pub(crate) const FONT_FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// Writer of the elements of a picture in drawing order.
///
/// Every [`Tag`] ends in [`Tag::leaf`], [`Tag::text`] or [`Tag::open`]; the last of these needs a
/// [`Self::close`].
#[derive(Debug, Default)]
pub struct SvgWriter {
    out: String,
    open: Vec<&'static str>,
}

/// Alignment of a text relative to its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the position.
    Start,
    /// The text is centred at the position.
    Middle,
    /// The text ends at the position.
    End,
}

impl SvgWriter {
    /// Creates an empty piece of SVG.
    pub const fn new() -> Self {
        Self { out: String::new(), open: Vec::new() }
    }

    /// Begins an element.
    pub fn tag(&mut self, name: &'static str) -> Tag<'_> {
        self.out.push('<');
        self.out.push_str(name);
        Tag { writer: self, name }
    }

    /// Closes the element opened last.
    pub fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            let _ = writeln!(self.out, "</{name}>");
        }
    }

    /// Writes text of the given size \[px\] in the default colour, with its base line at `y`.
    pub fn label(&mut self, x: f64, y: f64, size_px: f64, anchor: Anchor, content: &str) {
        self.tag("text").at(x, y).num("font-size", size_px).anchor(anchor).text(content);
    }

    /// Adds the content of another writer.
    pub fn append(&mut self, other: Self) {
        self.raw(&other.finish());
    }

    /// Adds the text of a finished writer.
    pub(crate) fn raw(&mut self, finished: &str) {
        self.out.push_str(finished);
    }

    /// Returns the text, with every element closed.
    #[must_use]
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.out
    }
}

/// An element whose attributes are being written.
#[derive(Debug)]
#[must_use = "a tag has to be ended with leaf, open or text"]
pub struct Tag<'w> {
    writer: &'w mut SvgWriter,
    name: &'static str,
}

impl Tag<'_> {
    /// Writes an attribute with a text value, which is escaped.
    pub fn attr(self, name: &str, value: &str) -> Self {
        let _ = write!(self.writer.out, " {name}=\"{}\"", escape(value));
        self
    }

    /// Writes an attribute with a number, with at most three decimals; 0 if it is not finite.
    pub fn num(self, name: &str, value: f64) -> Self {
        let _ = write!(self.writer.out, " {name}=\"{}\"", number(value));
        self
    }

    /// Writes the attributes `x` and `y`.
    pub fn at(self, x: f64, y: f64) -> Self {
        self.num("x", x).num("y", y)
    }

    /// Writes the attributes `cx`, `cy` and `r`.
    pub fn round(self, cx: f64, cy: f64, r: f64) -> Self {
        self.num("cx", cx).num("cy", cy).num("r", r)
    }

    /// Writes the attributes `x1`, `y1`, `x2`, `y2`.
    pub fn between(self, from: (f64, f64), to: (f64, f64)) -> Self {
        self.num("x1", from.0).num("y1", from.1).num("x2", to.0).num("y2", to.1)
    }

    /// Writes the attributes `width` and `height`.
    pub fn size(self, width: f64, height: f64) -> Self {
        self.num("width", width).num("height", height)
    }

    /// Sets the fill colour; no outline.
    pub fn fill(self, color: Rgb) -> Self {
        self.attr("fill", &color.to_string())
    }

    /// Sets an outline of the given width \[px\]; leaves the fill as it is.
    pub fn stroke(self, color: Rgb, width_px: f64) -> Self {
        self.attr("stroke", &color.to_string()).num("stroke-width", width_px)
    }

    /// Sets an outline in the colour, width and dashes of a line.
    pub(crate) fn line_style(self, style: LineStyle) -> Self {
        self.stroke(style.color, style.width_px).attr("stroke-dasharray", style.dashes)
    }

    /// Sets the alignment of a text relative to its position.
    pub fn anchor(self, anchor: Anchor) -> Self {
        match anchor {
            Anchor::Start => self,
            Anchor::Middle => self.attr("text-anchor", "middle"),
            Anchor::End => self.attr("text-anchor", "end"),
        }
    }

    /// Sets a transform by a matrix with the entries of SVG.
    pub(crate) fn matrix(self, entries: [f64; 6]) -> Self {
        self.attr("transform", &format!("matrix({})", entries.map(matrix_entry).join(" ")))
    }

    /// Ends an element without content.
    pub fn leaf(self) {
        self.writer.out.push_str("/>\n");
    }

    /// Ends the start tag; the following elements are inside this one until [`SvgWriter::close`].
    pub fn open(self) {
        self.writer.out.push_str(">\n");
        self.writer.open.push(self.name);
    }

    /// Ends an element with the given text, which is escaped.
    pub fn text(self, content: &str) {
        let _ = writeln!(self.writer.out, ">{}</{}>", escape(content), self.name);
    }
}

/// Formats a number with at most three decimals, without trailing zeros and without a negative
/// zero. Values that are not finite are invalid in SVG and become 0.
pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return "0".to_owned();
    }
    trimmed(format!("{value:.3}"))
}

/// Formats a matrix entry. Three decimals would shift the far end of a large map by whole pixels.
pub(crate) fn matrix_entry(value: f64) -> String {
    trimmed(format!("{value:.9}"))
}

fn trimmed(mut digits: String) -> String {
    if digits.contains('.') {
        digits.truncate(digits.trim_end_matches('0').trim_end_matches('.').len());
    }
    if digits == "-0" { "0".to_owned() } else { digits }
}

/// Returns the text with the special characters of XML replaced; characters that XML forbids are
/// left out.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {}
            _ => out.push(c),
        }
    }
    out
}

/// Data of an SVG `path` from points in pixels.
#[derive(Clone, Debug, Default)]
pub struct PathData(String);

impl PathData {
    /// Creates an open line through the points.
    pub fn line(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut data = Self::default();
        data.append(points);
        data
    }

    /// Adds an open line through the points.
    pub fn append(&mut self, points: impl IntoIterator<Item = (f64, f64)>) {
        for (i, point) in points.into_iter().enumerate() {
            if i == 0 { self.move_to(point) } else { self.line_to(point) }
        }
    }

    /// Begins a new line.
    pub fn move_to(&mut self, (x, y): (f64, f64)) {
        let _ = write!(self.0, "M{} {}", number(x), number(y));
    }

    /// Adds a straight segment.
    pub fn line_to(&mut self, (x, y): (f64, f64)) {
        let _ = write!(self.0, "L{} {}", number(x), number(y));
    }

    /// Closes the line to its beginning.
    pub fn close(&mut self) {
        self.0.push('Z');
    }

    /// Returns the value of the attribute `d`.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (-0.0004, "0"),
            (-0.0006, "-0.001"),
            (1.5, "1.5"),
            (100.0, "100"),
            (1e6 + 0.25, "1000000.25"),
            (2.0 / 3.0, "0.667"),
            (f64::NAN, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(matrix_entry(-0.012_345_678_9), "-0.012345679");
    }

    #[test]
    fn markup_in_text_is_escaped() {
        assert_eq!(escape("a<b & \"c\">'d'\u{1}"), "a&lt;b &amp; &quot;c&quot;&gt;&apos;d&apos;");
        let mut writer = SvgWriter::new();
        writer.tag("g").attr("id", "<\">").open();
        writer.label(1.0, 2.0, 10.0, Anchor::End, "<b>");
        assert_eq!(
            writer.finish(),
            "<g id=\"&lt;&quot;&gt;\">\n<text x=\"1\" y=\"2\" font-size=\"10\" \
             text-anchor=\"end\">&lt;b&gt;</text>\n</g>\n"
        );
    }
}
