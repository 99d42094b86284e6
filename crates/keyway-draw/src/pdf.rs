//! Pictures as PDF, for LaTeX.

use crate::raster::DrawError;
use crate::svg::Svg;
use svg2pdf::usvg;

impl Svg {
    /// Returns the bytes of a PDF file with one page of the picture's size, as vector graphics with
    /// embedded text.
    ///
    /// ```
    /// use keyway::map::OccupancyGrid;
    /// use keyway_draw::MapPicture;
    ///
    /// let map = OccupancyGrid::from_ascii(&[".....", ".###.", "....."]);
    /// let pdf = MapPicture::new(&map).svg().to_pdf()?;
    /// assert_eq!(&pdf[..5], b"%PDF-");
    /// # Ok::<(), keyway_draw::DrawError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`DrawError`] if the text is from elsewhere and not SVG.
    pub fn to_pdf(&self) -> Result<Vec<u8>, DrawError> {
        let mut options = usvg::Options::default();
        let fonts = options.fontdb_mut();
        fonts.load_font_data(include_bytes!("../fonts/DejaVuSans.ttf").to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        let tree = usvg::Tree::from_str(self.as_str(), &options);
        let tree = tree.map_err(|error| DrawError::Svg(error.to_string()))?;
        // A unit of the picture is a CSS pixel, 96 of which are an inch.
        let page = svg2pdf::PageOptions { dpi: 96.0 };
        svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page)
            .map_err(|error| DrawError::Pdf(error.to_string()))
    }
}
