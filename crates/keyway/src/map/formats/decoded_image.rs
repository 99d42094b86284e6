//! Results of the image readers: pixels or errors.

use super::TooManyCells;
use crate::map::FrameError;
use thiserror::Error;

/// The supported formats.
#[cfg(feature = "images")]
const KINDS: &str = "a PGM, PPM, PBM, PNG, BMP, GIF, JPEG or TIFF image";
#[cfg(not(feature = "images"))]
const KINDS: &str = "a PGM, PPM, PBM or PNG image; save it as one of these";

/// Error in an image. Rows and columns count from 0 at the top left.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// An empty file.
    #[error("the file is empty, expected {KINDS}")]
    Empty,
    /// An unsupported format.
    #[error("the file starts with \"{start}\", expected {KINDS}")]
    Kind {
        /// The first bytes, escaped.
        start: String,
    },
    /// A wrong number in the header of a PNM file.
    #[error("line {line}: the {field} of the header is {got}, expected {expected}")]
    Header {
        /// Line of the file, from 1.
        line: usize,
        /// Name of the number.
        field: &'static str,
        /// Text found there.
        got: String,
        /// Expected value.
        expected: &'static str,
    },
    /// A PNM file that is too short for its header.
    #[error("{width} x {height} pixels need at least {needed} bytes after the header, got {got}")]
    Truncated {
        /// Columns according to the header.
        width: u64,
        /// Rows according to the header.
        height: u64,
        /// Minimum number of bytes for this size.
        needed: u128,
        /// Bytes after the header.
        got: usize,
    },
    /// A wrong pixel of a PNM file.
    #[error(
        "the pixel in column {column}, row {row} from the top is {got}, expected 0 to {maximum}"
    )]
    Pixel {
        /// Column of the pixel.
        column: u64,
        /// Row of the pixel, from the top.
        row: u64,
        /// Value found there.
        got: String,
        /// The largest allowed value, from the header.
        maximum: u32,
    },
    /// A compressed file whose header claims more pixels than any compression could deliver.
    #[error("a file of {got} bytes cannot hold {width} x {height} pixels")]
    Implausible {
        /// Columns according to the header.
        width: u32,
        /// Rows according to the header.
        height: u32,
        /// Bytes of the file.
        got: usize,
    },
    /// A PNG file that cannot be decoded.
    #[error("not a valid PNG image: {0}; export it again")]
    Png(String),
    /// An image of another format that cannot be decoded.
    #[error("this {kind} image cannot be read as a map; save it as PNG")]
    Unreadable {
        /// The format.
        kind: &'static str,
    },
    /// An image with a size or placement that is not valid for a grid.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// An image with more pixels than the limit.
    #[error(transparent)]
    TooManyCells(#[from] TooManyCells),
}

/// An image whose pixels are values of cells, top row first.
pub(super) struct DecodedImage {
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) values: Vec<u8>,
}
