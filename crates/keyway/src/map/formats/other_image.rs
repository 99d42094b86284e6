//! BMP, GIF, JPEG and TIFF images: maps drawn with other programs.

use super::cell_limit::check_size;
use super::decoded_image::{DecodedImage, ImageError};
use super::layout::Layout;
use super::rule::{Pixel, Translator};
use ::image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// An image format with its name.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    format: ImageFormat,
    name: &'static str,
}

/// Detects the format of a file by its first bytes.
pub(super) fn kind(bytes: &[u8]) -> Option<Kind> {
    let format = ::image::guess_format(bytes).ok()?;
    let name = match format {
        ImageFormat::Bmp => "BMP",
        ImageFormat::Gif => "GIF",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::Tiff => "TIFF",
        _ => return None,
    };
    Some(Kind { format, name })
}

/// Largest allowed ratio of a map's memory to its file: GIF compression reaches at most 10,923.
const MAX_RATIO: u64 = 1 << 14;

/// Memory that a decoder may hold in addition to the pixels: tables, and the pixels of a part of
/// the image.
const SLACK_BYTES: u64 = 64 << 20;

pub(super) fn decode(
    bytes: &[u8],
    Kind { format, name }: Kind,
    max_cells: u64,
    cells: &mut Translator<'_>,
) -> Result<DecodedImage, ImageError> {
    let unreadable = || ImageError::Unreadable { kind: name };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // No limits until the size is known.
    reader.no_limits();
    let mut decoder = reader.into_decoder().map_err(|_| unreadable())?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (u64::from(width), u64::from(height));
    check_size::<ImageError>((width, height), max_cells)?;
    let layout = layout(decoder.color_type()).ok_or_else(unreadable)?;
    let total_bytes = decoder.total_bytes();
    let can_hold = (bytes.len() as u64).saturating_mul(MAX_RATIO).saturating_add(SLACK_BYTES);
    if total_bytes > can_hold {
        let (width, height) = decoder.dimensions();
        return Err(ImageError::Implausible { width, height, got: bytes.len() });
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(total_bytes.saturating_mul(2).saturating_add(SLACK_BYTES));
    decoder.set_limits(limits).map_err(|_| unreadable())?;
    // Zeroed memory that only the decoder writes, so a file that ends early takes no memory.
    let mut samples = vec![0; usize::try_from(total_bytes).map_err(|_| unreadable())?];
    decoder.read_image(&mut samples).map_err(|_| unreadable())?;
    let pixels = samples.chunks_exact(layout.pixel_bytes());
    // In a GIF no pixel has an alpha value of its own: one colour may be transparent.
    let is_opaque = format == ImageFormat::Gif && pixels.clone().all(|pixel| pixel[3] == 255);
    let pixel = |samples| {
        let pixel: Pixel = layout.pixel(samples, u16::from_ne_bytes);
        if is_opaque { Pixel { alpha: None, ..pixel } } else { pixel }
    };
    cells.doubts.is_lossy = format == ImageFormat::Jpeg;
    let values = pixels.map(|samples| cells.value(pixel(samples))).collect();
    Ok(DecodedImage { width, height, values })
}

/// The layout of an image with this colour type.
fn layout(colour: ColorType) -> Option<Layout> {
    let (colours, alpha, wide) = match colour {
        ColorType::L8 => (1, false, false),
        ColorType::La8 => (1, true, false),
        ColorType::Rgb8 => (3, false, false),
        ColorType::Rgba8 => (3, true, false),
        ColorType::L16 => (1, false, true),
        ColorType::La16 => (1, true, true),
        ColorType::Rgb16 => (3, false, true),
        ColorType::Rgba16 => (3, true, true),
        _ => return None,
    };
    Some(Layout { colours, alpha, wide })
}

#[cfg(test)]
mod tests {
    use super::super::rule::{CellRule, MapMode};
    use super::*;
    use ::image::{DynamicImage, GrayImage, RgbImage, RgbaImage};
    use proptest::prelude::*;

    fn written(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn read(bytes: &[u8], mode: MapMode, max_cells: u64) -> Result<Vec<u8>, ImageError> {
        let rule = CellRule { mode, ..CellRule::IMAGE };
        let kind = kind(bytes).unwrap();
        decode(bytes, kind, max_cells, &mut Translator::new(&rule)).map(|image| image.values)
    }

    const FORMATS: [ImageFormat; 4] =
        [ImageFormat::Bmp, ImageFormat::Gif, ImageFormat::Jpeg, ImageFormat::Tiff];

    /// Blocks of 16 x 16 pixels, in which JPEG changes nothing relevant.
    fn grey() -> DynamicImage {
        let grey = |x, y| ::image::Luma([[0, 254, 205][(x / 16 + y / 16) as usize % 3]]);
        GrayImage::from_fn(48, 32, grey).into()
    }

    #[test]
    fn every_format_is_read() {
        let states: Vec<u8> =
            (0..32 * 48).map(|i| [100, 0, 255][(i % 48 / 16 + i / 48 / 16) % 3]).collect();
        for format in FORMATS {
            for image in [grey(), grey().to_rgb8().into()] {
                let image: DynamicImage =
                    if format == ImageFormat::Gif { image.to_rgba8().into() } else { image };
                let bytes = written(&image, format);
                let states_read = read(&bytes, MapMode::Trinary, 48 * 32).unwrap();
                assert!(states_read == states, "{format:?}");
                let refused = read(&bytes, MapMode::Trinary, 48 * 32 - 1).unwrap_err();
                assert!(matches!(refused, ImageError::TooManyCells(_)), "{refused}");
            }
        }
    }

    #[test]
    fn greys_of_jpeg_are_doubtful() {
        for format in FORMATS {
            let image: DynamicImage = grey().to_rgb8().into();
            let image = if format == ImageFormat::Gif { image.to_rgba8().into() } else { image };
            let bytes = written(&image, format);
            let mut cells = Translator::new(&CellRule::IMAGE);
            decode(&bytes, kind(&bytes).unwrap(), 1 << 20, &mut cells).unwrap();
            assert_eq!(cells.doubts.is_lossy, format == ImageFormat::Jpeg);
        }
    }

    #[test]
    fn sizes_beyond_the_content_are_refused() {
        let mut gif = written(&grey().to_rgba8().into(), ImageFormat::Gif);
        // The size of the canvas, of which the pixels may fill a part.
        gif[6..10].copy_from_slice(&[0, 0x40, 0, 0x40]);
        let error = read(&gif, MapMode::Trinary, 1 << 29).unwrap_err().to_string();
        let expected = format!("a file of {} bytes cannot hold 16384 x 16384 pixels", gif.len());
        assert_eq!(error, expected);
    }

    #[test]
    fn colours_are_averaged_and_alpha_counts_where_there_is_some() {
        let rgb = RgbImage::from_raw(2, 1, vec![0, 30, 60, 9, 9, 9]).unwrap();
        assert_eq!(read(&written(&rgb.into(), ImageFormat::Bmp), MapMode::Raw, 9), Ok(vec![30, 9]));
        let wide = ::image::ImageBuffer::from_raw(2, 1, vec![25_700_u16, 0]).unwrap();
        let wide = written(&DynamicImage::ImageLuma16(wide), ImageFormat::Tiff);
        assert_eq!(read(&wide, MapMode::Raw, 9), Ok(vec![100, 0]));
        let opaque = [205, 205, 205, 255, 0, 0, 0, 255];
        let clear = [205, 205, 205, 0, 0, 0, 0, 255];
        let rgba = |pixels: [u8; 8]| -> DynamicImage {
            RgbaImage::from_raw(2, 1, pixels.to_vec()).unwrap().into()
        };
        let states = |image, format| read(&written(&image, format), MapMode::Trinary, 9).unwrap();
        assert_eq!(states(rgba(opaque), ImageFormat::Gif), [255, 100]);
        // As in PNG files.
        assert_eq!(states(rgba(opaque), ImageFormat::Tiff), [0, 100]);
        assert_eq!(states(rgba(clear), ImageFormat::Tiff), [255, 100]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn no_other_image_panics(format in 0..4_usize, at in any::<prop::sample::Index>(),
                           value: u8, cut in any::<prop::sample::Index>(), garbage: Vec<u8>) {
            let image: DynamicImage = grey().to_rgba8().into();
            let image = if format == 2 { image.to_rgb8().into() } else { image };
            let sound = written(&image, FORMATS[format]);
            let mut edited = sound.clone();
            let at = at.index(sound.len());
            edited[at] = value;
            let start = [&sound[..sound.len().min(16)], &garbage].concat();
            for bytes in [&edited, &sound[..cut.index(sound.len())], &start] {
                if let Some(kind) = kind(bytes) {
                    let mut cells = Translator::new(&CellRule::IMAGE);
                    let _ = decode(bytes, kind, 1 << 20, &mut cells);
                }
            }
        }
    }
}
