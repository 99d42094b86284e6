//! Rendering of a picture to pixels.

use crate::svg::Svg;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, LazyLock};
use thiserror::Error;

/// Maximum side of a PNG \[px\]; a larger request is scaled down to it.
pub const MAX_PNG_SIDE_PX: u32 = 4096;

/// The font of all PNGs, so that they look the same on a machine without fonts.
static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(include_bytes!("../fonts/DejaVuSans.ttf").to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Arc::new(fonts)
});

/// Reason why a picture cannot be rendered.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The scale is not a positive, finite number.
    #[error("scale of a picture must be a positive number, got {0}")]
    Scale(f64),
    /// The text is not SVG.
    #[error("picture is not valid SVG: {0}")]
    Svg(String),
    /// A side would have no pixel, or there is not enough memory for the pixels.
    #[error("cannot render a picture of {width} x {height} pixels")]
    Size {
        /// Requested width \[px\].
        width: u32,
        /// Requested height \[px\].
        height: u32,
    },
    /// The pixels could not be written as PNG.
    #[error("cannot write PNG: {0}")]
    Png(String),
    /// The picture could not be written as PDF.
    #[cfg(feature = "pdf")]
    #[error("cannot write PDF: {0}")]
    Pdf(String),
    /// The frames could not be written as GIF.
    #[error("cannot write GIF: {0}")]
    Gif(String),
    /// A frame does not have the size of the animation.
    #[error("frames of an animation must have one size; got {width} x {height} pixels")]
    Frame {
        /// Width of the frame \[px\].
        width: u32,
        /// Height of the frame \[px\].
        height: u32,
    },
}

impl Svg {
    /// Returns the bytes of a PNG file with `scale` pixels per unit of the picture (1 for a
    /// screen, 3 for print at the picture's own size), fewer if a side would exceed
    /// [`MAX_PNG_SIDE_PX`].
    ///
    /// ```
    /// use keyway::map::OccupancyGrid;
    /// use keyway_draw::MapPicture;
    ///
    /// let map = OccupancyGrid::from_ascii(&[".....", ".###.", "....."]);
    /// let png = MapPicture::new(&map).svg().to_png(2.0)?;
    /// assert_eq!(&png[1..4], b"PNG");
    /// # Ok::<(), keyway_draw::DrawError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`DrawError`] if the scale is not positive, or the text is from elsewhere and not
    /// SVG.
    pub fn to_png(&self, scale: f64) -> Result<Vec<u8>, DrawError> {
        let pixels = self.to_pixels(scale)?;
        pixels.encode_png().map_err(|error| DrawError::Png(error.to_string()))
    }

    /// Renders the pixels of the picture; they are opaque.
    pub(crate) fn to_pixels(&self, scale: f64) -> Result<tiny_skia::Pixmap, DrawError> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(DrawError::Scale(scale));
        }
        let tree = self.tree()?;
        let (width, height) = (f64::from(tree.size().width()), f64::from(tree.size().height()));
        let scale = scale.min(f64::from(MAX_PNG_SIDE_PX) / width.max(height));
        let (columns, rows) = ((width * scale).round() as u32, (height * scale).round() as u32);
        let mut pixels = tiny_skia::Pixmap::new(columns, rows)
            .ok_or(DrawError::Size { width: columns, height: rows })?;
        // The page may end within the last pixels.
        pixels.fill(tiny_skia::Color::WHITE);
        let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        Ok(pixels)
    }

    /// Draws the picture over pixels that were rendered at the same scale.
    pub(crate) fn draw_over(
        &self,
        pixels: &mut tiny_skia::Pixmap,
        scale: f64,
    ) -> Result<(), DrawError> {
        let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&self.tree()?, transform, &mut pixels.as_mut());
        Ok(())
    }

    /// Longer side of the picture in its own units.
    pub(crate) fn longer_side(&self) -> Result<f64, DrawError> {
        let size = self.tree()?.size();
        Ok(f64::from(size.width().max(size.height())))
    }

    /// Parses the picture, with all text as outlines.
    pub(crate) fn tree(&self) -> Result<usvg::Tree, DrawError> {
        let options = usvg::Options {
            fontdb: Arc::clone(&FONTS),
            font_family: "DejaVu Sans".to_owned(),
            ..usvg::Options::default()
        };
        usvg::Tree::from_str(self.as_str(), &options)
            .map_err(|error| DrawError::Svg(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::writer::{Anchor, SvgWriter};

    /// Width and height in the header of a PNG file.
    fn png_size(png: &[u8]) -> (u32, u32) {
        let word = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        (word(16), word(20))
    }

    fn sample() -> Svg {
        let mut body = SvgWriter::new();
        body.label(10.0, 30.0, 20.0, Anchor::Start, "v < 1 & \u{3c9} \u{2212}2");
        Svg::page(200.0, 50.0, body)
    }

    #[test]
    fn png_has_the_size_asked_for() {
        assert_eq!(png_size(&sample().to_png(1.0).unwrap()), (200, 50));
        assert_eq!(png_size(&sample().to_png(2.5).unwrap()), (500, 125));
        assert_eq!(png_size(&sample().to_png(1e9).unwrap()), (4096, 1024));
    }

    #[test]
    fn text_is_drawn_from_the_bundled_font() {
        let tree = sample().tree().unwrap();
        let ink = tree.root().abs_bounding_box();
        assert!(ink.width() >= 200.0, "the white ground covers the page");
        let usvg::Node::Group(group) = &tree.root().children()[1] else { panic!("no group") };
        let usvg::Node::Text(text) = &group.children()[0] else { panic!("no text") };
        assert!(text.bounding_box().width() > 60.0);
    }

    #[test]
    fn refuses_what_cannot_be() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(sample().to_png(scale), Err(DrawError::Scale(_))));
        }
        assert!(matches!(sample().to_png(1e-6), Err(DrawError::Size { .. })));
        let broken = Svg::from_text("<svg".to_owned());
        assert!(matches!(broken.to_png(1.0), Err(DrawError::Svg(_))));
    }
}
