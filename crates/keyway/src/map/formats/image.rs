//! Maps as images: grey values of PGM (P2 and P5) and PNG files, top row first.

use super::rule::CellRule;
use super::{ImagePlacement, pgm, png};
use crate::map::{Cell, CellState, FrameError, GridFrame, OccupancyGrid};
use thiserror::Error;

/// The kinds of image that maps are written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageKind {
    /// Portable grey map, binary (P5): what map savers write.
    #[default]
    Pgm,
    /// Portable Network Graphics, 8-bit grey.
    Png,
}

impl ImageKind {
    /// The extension of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Pgm => "pgm",
            Self::Png => "png",
        }
    }
}

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
}

/// An image whose pixels are values of cells, top row first.
pub(super) struct DecodedImage {
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) values: Vec<u8>,
}

/// The grid that an image (PGM P2, P5 or PNG, told apart by content) gives under `rule`.
///
/// Memory is bounded by a small multiple of the length of the file, for compressed files by what
/// its compression can deliver.
///
/// # Errors
/// When the bytes are not such an image, or are not complete.
pub fn grid_from_image(
    bytes: &[u8],
    rule: &CellRule,
    placement: ImagePlacement,
) -> Result<OccupancyGrid, ImageError> {
    let image = if bytes.is_empty() {
        return Err(ImageError::Empty);
    } else if bytes.starts_with(b"P2") || bytes.starts_with(b"P5") {
        pgm::decode(bytes, rule)?
    } else if bytes.starts_with(png::SIGNATURE) {
        png::decode(bytes, rule)?
    } else {
        let start = bytes[..bytes.len().min(8)].escape_ascii().to_string();
        return Err(ImageError::Kind { start });
    };
    let ImagePlacement { resolution_m, origin } = placement;
    let frame = GridFrame::new(image.width, image.height, resolution_m, origin)?;
    Ok(rule.grid(frame, &image.values))
}

/// An image of the states of a grid in the grey values of Nav2's map saver: occupied 0, free 254,
/// unknown 205. Where the grid lies in the world is not kept.
pub fn image_from_grid(grid: &OccupancyGrid, kind: ImageKind) -> Vec<u8> {
    encode(grid.frame(), kind, |cell| match grid.state(cell) {
        Some(CellState::Occupied) => 0,
        Some(CellState::Free) => 254,
        Some(CellState::Unknown) | None => 205,
    })
}

/// An 8-bit grey image.
pub(super) fn encode(frame: &GridFrame, kind: ImageKind, grey: impl Fn(Cell) -> u8) -> Vec<u8> {
    let (width, height) = (frame.width(), frame.height());
    let mut greys = Vec::with_capacity(frame.cell_count() as usize);
    for y in (0..height as i32).rev() {
        greys.extend((0..width as i32).map(|x| grey(Cell::new(x, y))));
    }
    match kind {
        ImageKind::Pgm => pgm::encode(width, height, &greys),
        ImageKind::Png => png::encode(width, height, &greys),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<OccupancyGrid, ImageError> {
        grid_from_image(bytes, &CellRule::IMAGE, ImagePlacement::default())
    }

    #[test]
    fn other_kinds_are_named() {
        assert_eq!(read(b""), Err(ImageError::Empty));
        let error = read(b"GIF89a\x01\x00\x02").unwrap_err();
        assert!(matches!(error, ImageError::Kind { .. }));
        assert_eq!(
            error.to_string(),
            "the file starts with \"GIF89a\\x01\\x00\", expected a PGM (P2 or P5) or PNG image"
        );
        assert!(matches!(read(b"P6 1 1 255\nabc"), Err(ImageError::Kind { .. })));
        assert!(matches!(read(b"P"), Err(ImageError::Kind { .. })));
    }

    #[test]
    fn placement_is_checked() {
        let placement = ImagePlacement { resolution_m: f64::NAN, ..ImagePlacement::default() };
        let error = grid_from_image(b"P5 1 1 255\n\0", &CellRule::IMAGE, placement).unwrap_err();
        assert!(matches!(error, ImageError::Frame(FrameError::Resolution(_))));
        assert!(error.to_string().contains("resolution must be a number"));
    }

    #[test]
    fn both_kinds_keep_the_states() {
        let grid = OccupancyGrid::from_ascii(&["#.?", "..#"]);
        for kind in [ImageKind::Pgm, ImageKind::Png] {
            assert_eq!(read(&image_from_grid(&grid, kind)).unwrap(), grid);
        }
        let pgm = image_from_grid(&grid, ImageKind::Pgm);
        assert_eq!(pgm, b"P5\n3 2\n255\n\x00\xfe\xcd\xfe\xfe\x00");
    }
}
