//! What the readers of images give: pixels, or what is wrong with them.

use super::TooManyCells;
use crate::map::FrameError;
use thiserror::Error;

/// What is wrong with an image. Rows and columns count from 0 at the top left.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// No bytes.
    #[error("the file is empty, expected a PGM (P2 or P5) or PNG image")]
    Empty,
    /// Another format.
    #[error("the file starts with \"{start}\", expected a PGM (P2 or P5) or PNG image")]
    Kind {
        /// The first bytes, escaped.
        start: String,
    },
    /// A number of the PGM header.
    #[error("line {line}: the {field} of the PGM header is {got}, expected {expected}")]
    Header {
        /// Line of the file, from 1.
        line: usize,
        /// Which number.
        field: &'static str,
        /// What was found there.
        got: String,
        /// What would be right.
        expected: &'static str,
    },
    /// A PGM file that is too short for its header.
    #[error("{width} x {height} pixels need at least {needed} bytes after the header, got {got}")]
    Truncated {
        /// Columns according to the header.
        width: u64,
        /// Rows according to the header.
        height: u64,
        /// The least number of bytes for that.
        needed: u128,
        /// Bytes after the header.
        got: usize,
    },
    /// A pixel of a PGM file.
    #[error(
        "the pixel in column {column}, row {row} from the top is {got}, expected 0 to {maximum}"
    )]
    Pixel {
        /// Its column.
        column: u64,
        /// Its row, from the top.
        row: u64,
        /// What was found there.
        got: String,
        /// The largest value, according to the header.
        maximum: u32,
    },
    /// A PNG file whose header claims more than any compression could deliver.
    #[error("{width} x {height} pixels cannot come from a PNG file of {got} bytes")]
    Implausible {
        /// Columns according to the header.
        width: u32,
        /// Rows according to the header.
        height: u32,
        /// Bytes of the file.
        got: usize,
    },
    /// A PNG file that cannot be decoded.
    #[error("not a sound PNG image: {0}; save it again")]
    Png(String),
    /// An image of a size, or a placement, that no grid can have.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// An image of more pixels than are to be read.
    #[error(transparent)]
    TooManyCells(#[from] TooManyCells),
}

/// An image whose pixels are values of cells, top row first.
pub(super) struct DecodedImage {
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) values: Vec<u8>,
}
