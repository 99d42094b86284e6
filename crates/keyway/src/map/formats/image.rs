//! Maps as images: grey values of PGM (P2 and P5) and PNG files, top row first.

use super::decoded_image::ImageError;
use super::rule::CellRule;
use super::{DEFAULT_MAX_CELLS, ImagePlacement, check_size, pgm, png, png_fault};
use crate::map::{Cell, CellState, GridFrame, OccupancyGrid};

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

/// The grid that an image (PGM P2, P5 or PNG, told apart by content) of at most [`DEFAULT_MAX_CELLS`]
/// gives under `rule`.
///
/// Memory is bounded by a small multiple of the length of the file, for compressed files by what
/// its compression can deliver.
///
/// # Errors
/// When the bytes are not such an image, or are not complete; when it has too many pixels.
pub fn grid_from_image(
    bytes: &[u8],
    rule: &CellRule,
    placement: ImagePlacement,
) -> Result<OccupancyGrid, ImageError> {
    grid_of_at_most(DEFAULT_MAX_CELLS, bytes, rule, placement)
}

/// The columns and rows that the header announces, if this beginning of a file has it all.
pub(super) fn size_of_image(head: &[u8]) -> Option<(u64, u64)> {
    if pgm::is_pgm(head) { pgm::size(head) } else { png_fault::size(head) }
}

/// The same with another limit.
pub(super) fn grid_of_at_most(
    max_cells: u64,
    bytes: &[u8],
    rule: &CellRule,
    placement: ImagePlacement,
) -> Result<OccupancyGrid, ImageError> {
    if let Some(size) = size_of_image(bytes) {
        check_size::<ImageError>(size, max_cells)?;
    }
    let image = if bytes.is_empty() {
        return Err(ImageError::Empty);
    } else if pgm::is_pgm(bytes) {
        pgm::decode(bytes, rule)?
    } else if bytes.starts_with(png_fault::SIGNATURE) {
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
    use crate::map::FrameError;

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
