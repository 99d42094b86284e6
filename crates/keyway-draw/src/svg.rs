//! A finished picture, as text.

use crate::writer::{FONT_FAMILY, SvgWriter, number};

/// A picture as SVG text. Its size is in CSS pixels (96 per inch); it is self-contained.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Svg(String);

impl Svg {
    /// Creates a page of the given size \[px\] with a white background, filled by `body`.
    pub(crate) fn page(width_px: f64, height_px: f64, body: SvgWriter) -> Self {
        let mut page = open_page(width_px, height_px);
        page.tag("rect").attr("width", "100%").attr("height", "100%").attr("fill", "#fff").leaf();
        Self::filled(page, body)
    }

    /// Creates a page of the given size \[px\] without a background, to be drawn over another
    /// one.
    #[cfg(feature = "raster")]
    pub(crate) fn sheet(width_px: f64, height_px: f64, body: SvgWriter) -> Self {
        Self::filled(open_page(width_px, height_px), body)
    }

    fn filled(mut page: SvgWriter, body: SvgWriter) -> Self {
        // The default for text; shapes set their own colours.
        page.tag("g").fill(crate::color::INK).open();
        page.append(body);
        Self(page.finish())
    }

    /// Wraps SVG text from elsewhere; it is parsed only for rendering.
    pub const fn from_text(text: String) -> Self {
        Self(text)
    }

    /// Returns the text of an `.svg` file.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns the text of an `.svg` file.
    pub fn into_string(self) -> String {
        self.0
    }
}

fn open_page(width_px: f64, height_px: f64) -> SvgWriter {
    let (width, height) = (width_px.ceil(), height_px.ceil());
    let mut page = SvgWriter::new();
    page.tag("svg")
        .attr("xmlns", "http://www.w3.org/2000/svg")
        .size(width, height)
        .attr("viewBox", &format!("0 0 {} {}", number(width), number(height)))
        .attr("font-family", FONT_FAMILY)
        .open();
    page
}
