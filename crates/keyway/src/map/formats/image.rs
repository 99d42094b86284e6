//! Maps as images, top row first.

use super::decoded_image::{DecodedImage, ImageError};
#[cfg(feature = "images")]
use super::other_image;
use super::rule::{CellRule, Doubts, Translator};
use super::{DEFAULT_MAX_CELLS, ImagePlacement, check_size, png, pnm};
use crate::map::{Cell, CellState, GridFrame, OccupancyGrid};

/// Image formats in which maps are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageKind {
    /// Portable grey map, binary (P5), as written by map savers.
    #[default]
    Pgm,
    /// Portable Network Graphics, 8-bit grey.
    Png,
}

impl ImageKind {
    /// The file extension of this format.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Pgm => "pgm",
            Self::Png => "png",
        }
    }
}

/// Reads the grid from an image of at most [`DEFAULT_MAX_CELLS`] under `rule`: PGM, PPM, PBM or
/// PNG, with the feature `images` also BMP, GIF, JPEG and TIFF, detected by content.
///
/// Memory is bounded by a small multiple of the length of the file, for compressed files by the
/// largest possible compression.
///
/// # Errors
/// Returns [`ImageError`] if the bytes are not such an image, are incomplete, or have too many
/// pixels.
pub fn grid_from_image(
    bytes: &[u8],
    rule: &CellRule,
    placement: ImagePlacement,
) -> Result<OccupancyGrid, ImageError> {
    grid_of_at_most(DEFAULT_MAX_CELLS, bytes, rule, placement).map(|(grid, _)| grid)
}

/// The columns and rows that the header announces; `None` if the beginning of the file does not
/// contain the whole header.
pub(super) fn size_of_image(head: &[u8]) -> Option<(u64, u64)> {
    if pnm::is_pnm(head) { pnm::size(head) } else { png::size(head) }
}

/// Like [`grid_from_image`], with another limit; also returns likely mistakes.
pub(super) fn grid_of_at_most(
    max_cells: u64,
    bytes: &[u8],
    rule: &CellRule,
    placement: ImagePlacement,
) -> Result<(OccupancyGrid, Doubts), ImageError> {
    if let Some(size) = size_of_image(bytes) {
        check_size::<ImageError>(size, max_cells)?;
    }
    let mut cells = Translator::new(rule);
    let image = if bytes.is_empty() {
        return Err(ImageError::Empty);
    } else if pnm::is_pnm(bytes) {
        pnm::decode(bytes, &mut cells)?
    } else if bytes.starts_with(png::SIGNATURE) {
        png::decode(bytes, &mut cells)?
    } else {
        other(bytes, max_cells, &mut cells)?
    };
    let ImagePlacement { resolution_m, origin } = placement;
    let frame = GridFrame::new(image.width, image.height, resolution_m, origin)?;
    Ok((rule.grid(frame, &image.values), cells.doubts))
}

/// Reads an image of a format that map savers do not write.
#[cfg_attr(not(feature = "images"), expect(unused_variables))]
fn other(
    bytes: &[u8],
    max_cells: u64,
    cells: &mut Translator<'_>,
) -> Result<DecodedImage, ImageError> {
    #[cfg(feature = "images")]
    if let Some(kind) = other_image::kind(bytes) {
        return other_image::decode(bytes, kind, max_cells, cells);
    }
    let start = bytes[..bytes.len().min(8)].escape_ascii().to_string();
    Err(ImageError::Kind { start })
}

/// Writes the states of a grid as an image with the grey values of Nav2's map saver: occupied 0,
/// free 254, unknown 205. The pose of the grid in the world is not kept.
pub fn image_from_grid(grid: &OccupancyGrid, kind: ImageKind) -> Vec<u8> {
    encode(grid.frame(), kind, |cell| match grid.state(cell) {
        Some(CellState::Occupied) => 0,
        Some(CellState::Free) => 254,
        Some(CellState::Unknown) | None => 205,
    })
}

/// Writes the image of a grid for [`RosMap::for_grid`](super::RosMap::for_grid): its states as in
/// [`image_from_grid`], or for a grid with values the values themselves, all above 100 as
/// [`OccupancyGrid::UNKNOWN_VALUE`].
pub fn ros_map_image(grid: &OccupancyGrid, kind: ImageKind) -> Vec<u8> {
    let Some(values) = grid.values() else { return image_from_grid(grid, kind) };
    let width = grid.frame().width() as usize;
    encode(grid.frame(), kind, |Cell { x, y }| match values[y as usize * width + x as usize] {
        value @ 0..=100 => value,
        _ => OccupancyGrid::UNKNOWN_VALUE,
    })
}

/// Encodes an 8-bit grey image.
fn encode(frame: &GridFrame, kind: ImageKind, grey: impl Fn(Cell) -> u8) -> Vec<u8> {
    let (width, height) = (frame.width(), frame.height());
    let mut greys = Vec::with_capacity(frame.cell_count() as usize);
    for y in (0..height as i32).rev() {
        greys.extend((0..width as i32).map(|x| grey(Cell::new(x, y))));
    }
    match kind {
        ImageKind::Pgm => pnm::encode(width, height, &greys),
        ImageKind::Png => png::encode(width, height, &greys),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::FrameError;

    fn read(bytes: &[u8]) -> Result<OccupancyGrid, ImageError> {
        grid_from_image(bytes, &CellRule::IMAGE, ImagePlacement::default())
    }

    #[test]
    fn other_kinds_are_named() {
        assert_eq!(read(b""), Err(ImageError::Empty));
        let error = read(b"RIFF\x01\x00WEBP").unwrap_err();
        assert!(matches!(error, ImageError::Kind { .. }));
        let expected = "the file starts with \"RIFF\\x01\\x00WE\", expected a PGM, PPM, PBM";
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(matches!(read(b"P7 1 1 255\nabc"), Err(ImageError::Kind { .. })));
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
