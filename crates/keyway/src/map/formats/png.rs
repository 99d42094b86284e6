//! Portable Network Graphics of every colour type and depth.

use super::decoded_image::{DecodedImage, ImageError};
use super::layout::Layout;
use super::rule::Translator;
use crate::geometry::Pose;
use crate::map::GridFrame;
use ::png::{
    BitDepth, ColorType, Decoder, DecodingError, Encoder, InterlaceInfo, Limits, Reader,
    Transformations, expand_interlaced_row,
};
use std::io::Cursor;

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Largest ratio of the length of a deflate stream to its compressed form.
const MAX_DEFLATE_RATIO: u64 = 1032;
/// Allowance for small files: stream headers, and tables that are needed anyway.
const SLACK_BYTES: u64 = 1 << 16;

pub(super) fn encode(width: u32, height: u32, greys: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(greys));
    debug_assert!(written.is_ok(), "writing into memory cannot fail");
    bytes
}

pub(super) fn decode(bytes: &[u8], cells: &mut Translator<'_>) -> Result<DecodedImage, ImageError> {
    let can_hold =
        (bytes.len() as u64).saturating_mul(MAX_DEFLATE_RATIO).saturating_add(SLACK_BYTES);
    let limits = Limits { bytes: usize::try_from(can_hold).unwrap_or(usize::MAX) };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    // Converts palettes to colours, less than 8 bits to 8, and transparent colours to alpha.
    decoder.set_transformations(Transformations::EXPAND);

    let header = decoder.read_header_info().map_err(|error| broken(&error))?;
    let (width, height) = (header.width, header.height);
    let row_bits = u64::from(width) * header.bits_per_pixel() as u64;
    if row_bits.div_ceil(8).saturating_mul(u64::from(height)) > can_hold {
        return Err(ImageError::Implausible { width, height, got: bytes.len() });
    }
    // Checked before anything of that size is allocated.
    GridFrame::new(u64::from(width), u64::from(height), 1.0, Pose::default())?;

    let reader = decoder.read_info().map_err(|error| broken(&error))?;
    // The decoder looks colours up in a table built from the palette, and panics if an entry is
    // truncated.
    let palette = reader.info().palette.as_deref();
    let length = palette.map_or(3, <[u8]>::len);
    let is_sound = length.is_multiple_of(3) && (3..=3 * 256).contains(&length);
    if reader.info().color_type == ColorType::Indexed && !is_sound {
        let expected = "expected three for each of 1 to 256 colours";
        return Err(ImageError::Png(format!("its palette has {length} bytes, {expected}")));
    }
    let values = read_rows(reader, cells).map_err(|error| broken(&error))?;
    if values.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(ImageError::Png("its first frame is smaller than the image".to_owned()));
    }
    Ok(DecodedImage { width: u64::from(width), height: u64::from(height), values })
}

/// The columns and rows that the header announces; `None` without a header.
pub(super) fn size(bytes: &[u8]) -> Option<(u64, u64)> {
    let header = bytes.strip_prefix(SIGNATURE)?.get(4..)?.strip_prefix(b"IHDR")?;
    let (width, rest) = header.split_first_chunk()?;
    let height = rest.first_chunk()?;
    let [width, height] = [*width, *height].map(|side| u64::from(u32::from_be_bytes(side)));
    (width > 0 && height > 0).then_some((width, height))
}

/// The first sentence of the decoder's message, without checksums, and with a chunk's name only.
fn broken(error: &DecodingError) -> ImageError {
    let text = error.to_string();
    let sentence = text.split(". ").next().unwrap_or(&text).trim_end_matches('.');
    let chunk = sentence.split_once("ChunkType { type: ").and_then(|(before, chunk)| {
        let (name, rest) = chunk.split_once(',')?;
        let after = rest.split_once(" }")?.1;
        let fault = before.split_once(": expected 0x");
        let fault = fault.map_or(before.to_owned(), |(fault, _)| format!("{fault} in "));
        Some(format!("{fault}{name}{after}"))
    });
    ImageError::Png(chunk.unwrap_or_else(|| sentence.to_owned()))
}

/// The value of every pixel. Rows are translated as they are decoded, so that at most one byte
/// per pixel is held.
fn read_rows(
    mut reader: Reader<Cursor<&[u8]>>,
    cells: &mut Translator<'_>,
) -> Result<Vec<u8>, DecodingError> {
    let info = reader.info();
    let (width, height) = (info.width as usize, info.height as usize);
    if info.frame_control.is_some_and(|f| (f.width as usize, f.height as usize) != (width, height))
    {
        return Ok(Vec::new());
    }
    let interlaced = info.interlaced;
    let layout = layout(reader.output_color_type());
    // Rows in order let the vector grow with the data, which may end early.
    let mut values = if interlaced { vec![0; width * height] } else { Vec::new() };
    let mut row_values = Vec::with_capacity(width);
    while let Some(row) = reader.next_interlaced_row()? {
        let row_pixels = row.data().chunks_exact(layout.pixel_bytes());
        let row_of_values =
            row_pixels.map(|pixel| cells.value(layout.pixel(pixel, u16::from_be_bytes)));
        match row.interlace() {
            InterlaceInfo::Null(_) => values.extend(row_of_values),
            InterlaceInfo::Adam7(pass) => {
                row_values.clear();
                row_values.extend(row_of_values);
                expand_interlaced_row(&mut values, width, &row_values, pass, 8);
            }
        }
    }
    Ok(values)
}

/// The layout of an image with this colour type and depth.
fn layout((colour, depth): (ColorType, BitDepth)) -> Layout {
    let (colours, alpha) = match colour {
        // The decoder has turned palettes into colours.
        ColorType::Rgb | ColorType::Indexed => (3, false),
        ColorType::Rgba => (3, true),
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (1, true),
    };
    Layout { colours, alpha, wide: depth == BitDepth::Sixteen }
}

#[cfg(test)]
mod tests {
    use super::super::rule::{CellRule, MapMode};
    use super::*;
    use proptest::prelude::*;

    fn rule(mode: MapMode) -> CellRule {
        CellRule { mode, ..CellRule::IMAGE }
    }

    fn read(bytes: &[u8], mode: MapMode) -> Result<Vec<u8>, ImageError> {
        decode(bytes, &mut Translator::new(&rule(mode))).map(|image| image.values)
    }

    fn raw(bytes: &[u8]) -> Result<Vec<u8>, ImageError> {
        read(bytes, MapMode::Raw)
    }

    fn png(
        (width, height): (u32, u32),
        (colour, depth): (ColorType, BitDepth),
        data: &[u8],
        set_up: impl Fn(&mut Encoder<'_, &mut Vec<u8>>),
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        set_up(&mut encoder);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn every_depth_of_grey() {
        let grey = |depth, data: &[u8]| {
            raw(&png((2, 2), (ColorType::Grayscale, depth), data, |_| {})).unwrap()
        };
        assert_eq!(grey(BitDepth::One, &[0b0100_0000, 0b0000_0000]), [0, 255, 0, 0]);
        assert_eq!(grey(BitDepth::Two, &[0b0001_0000, 0b1100_0000]), [0, 85, 255, 0]);
        assert_eq!(grey(BitDepth::Four, &[0x05, 0x6f]), [0, 85, 255, 255]);
        assert_eq!(grey(BitDepth::Eight, &[0, 99, 100, 101]), [0, 99, 100, 255]);
        let wide = [0, 0, 0, 128, 0, 129, 100, 100];
        assert_eq!(grey(BitDepth::Sixteen, &wide), [0, 0, 1, 100]);
    }

    #[test]
    fn colours_are_averaged_and_palettes_looked_up() {
        let rgb = png((2, 1), (ColorType::Rgb, BitDepth::Eight), &[0, 30, 60, 9, 9, 9], |_| {});
        assert_eq!(raw(&rgb), Ok(vec![30, 9]));
        let palette = |encoder: &mut Encoder<'_, &mut Vec<u8>>| {
            encoder.set_palette(vec![0, 0, 0, 10, 20, 30, 100, 100, 100]);
            encoder.set_trns(vec![255, 0]);
        };
        let indexed = png((3, 1), (ColorType::Indexed, BitDepth::Two), &[0b0001_1000], palette);
        assert_eq!(raw(&indexed), Ok(vec![0, 20, 100]));
        let scaled = read(&indexed, MapMode::Scale).unwrap();
        assert_eq!(scaled, [100, 255, 91], "the second colour is transparent");
    }

    #[test]
    fn alpha() {
        let grey_alpha = (ColorType::GrayscaleAlpha, BitDepth::Eight);
        let bytes = png((4, 1), grey_alpha, &[0, 255, 0, 0, 255, 255, 255, 0], |_| {});
        let values = |mode| read(&bytes, mode).unwrap();
        // Alpha is a fourth channel here, not the second of two: opaque black has a mean of 1/4,
        // not 1/2.
        assert_eq!(values(MapMode::Trinary), [100, 100, 0, 255]);
        assert_eq!(values(MapMode::Scale), [100, 255, 0, 255]);
        let rgba = (ColorType::Rgba, BitDepth::Sixteen);
        let bytes = png((1, 1), rgba, &[0, 0, 0, 0, 0, 0, 255, 255], |_| {});
        assert_eq!(read(&bytes, MapMode::Trinary), Ok(vec![100]));
    }

    /// 5 x 3 pixels with grey 10 * row + column, interlaced.
    const INTERLACED: &[u8] =
        b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x05\x00\x00\
        \x00\x03\x08\x00\x00\x00\x01\x09\x5a\xaa\xb2\x00\x00\x00\x1e\x49\x44\x41\x54\x78\xda\x63\
        \x60\x60\x60\x61\x60\x62\x10\x11\x93\x60\x60\x64\x66\x10\x15\x67\xe0\xe2\xe6\xe1\xe5\x03\
        \x00\x06\x38\x00\xb5\xb6\x72\x48\x21\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

    #[test]
    fn interlaced() {
        let expected: Vec<u8> = (0..3).flat_map(|y| (0..5).map(move |x| 10 * y + x)).collect();
        assert_eq!(raw(INTERLACED), Ok(expected));
    }

    fn with_size(mut bytes: Vec<u8>, width: u32, height: u32) -> Vec<u8> {
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        with_checksum(bytes)
    }

    /// CRC-32 of kind and content, as the PNG specification defines it.
    fn checksum(kind_and_content: &[u8]) -> [u8; 4] {
        let shift = |sum: u32| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 };
        let byte = |sum: u32, &byte: &u8| (0..8).fold(sum ^ u32::from(byte), |sum, _| shift(sum));
        (!kind_and_content.iter().fold(u32::MAX, byte)).to_be_bytes()
    }

    /// Replaces the checksum of the header by the right one.
    fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
        let sum = checksum(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum);
        bytes
    }

    #[test]
    fn the_fault_is_named() {
        let whole = encode(2, 1, &[0, 255]);
        let named = |bytes: &[u8], fault_named: &str| {
            let expected = format!("not a valid PNG image: {fault_named}; export it again");
            assert_eq!(raw(bytes).unwrap_err().to_string(), expected);
        };
        // In the signature, in the data, and before the chunk that ends a file.
        for length in [10, 45, whole.len() - 12] {
            named(&whole[..length], "unexpected end of file");
        }
        let with = |index: usize| {
            let mut damaged = whole.clone();
            damaged[index] ^= 1;
            damaged
        };
        named(&with(42), "Corrupt deflate stream");
        named(&with(29), "CRC error in IHDR chunk");
        let mut later = whole.clone();
        later[12] = b'J';
        named(&later, "JHDR chunk appeared before IHDR chunk");
        let header = |index: usize, value, expected: &str| {
            let mut bytes = whole.clone();
            bytes[16 + index] = value;
            named(&with_checksum(bytes), expected);
        };
        header(3, 0, "Invalid image dimensions");
        header(8, 3, "Invalid bit depth 3");
        header(9, 5, "Invalid color type 5");
        header(10, 2, "Unknown compression method 2");
        header(12, 2, "Unknown interlace method 2");
    }

    #[test]
    fn sizes_beyond_the_content_are_refused_before_memory_is_asked_for() {
        let small = encode(2, 2, &[0; 4]);
        let huge = with_size(small.clone(), 1 << 30, 1 << 30);
        let error = raw(&huge).unwrap_err();
        assert!(matches!(error, ImageError::Implausible { .. }), "{error}");
        assert!(error.to_string().contains(" bytes cannot hold 1073741824 x 1073741824 pixels"));
        let tall = with_size(small.clone(), 1 << 16, 1 << 14);
        assert!(matches!(raw(&tall), Err(ImageError::Implausible { .. })));
        assert!(matches!(raw(&with_size(small.clone(), 3, 3)), Err(ImageError::Png(_))));
        assert!(matches!(raw(&with_size(small, 0, 3)), Err(ImageError::Png(_))));
    }

    #[test]
    fn truncated_and_damaged() {
        let bytes = encode(40, 40, &(0..=255).cycle().take(1600).collect::<Vec<u8>>());
        assert!(raw(&bytes).is_ok());
        for length in [8, 20, 33, 60, bytes.len() - 30] {
            let error = raw(&bytes[..length]).unwrap_err();
            assert!(error.to_string().starts_with("not a valid PNG image: "), "{error}");
        }
        let mut damaged = bytes;
        damaged[50] ^= 0xff;
        assert!(matches!(raw(&damaged), Err(ImageError::Png(_))));
    }

    type OwnChunk = ([u8; 4], Vec<u8>);

    /// A PNG of 4 x 1 pixels of this kind with these additional chunks, all with valid checksums.
    fn with_chunks((colour, depth): (u8, u8), others: &[OwnChunk]) -> Vec<u8> {
        let header = vec![0, 0, 0, 4, 0, 0, 0, 1, depth, colour, 0, 0, 0];
        // An unfiltered row of zeros, long enough for the widest pixels.
        let grey = encode(32, 1, &[0; 32]);
        let pixels = grey[41..grey.len() - 16].to_vec();
        let ends = [(*b"IHDR", header), (*b"IDAT", pixels), (*b"IEND", vec![])];
        let mut bytes = SIGNATURE.to_vec();
        for (kind, content) in ends[..1].iter().chain(others).chain(&ends[1..]) {
            bytes.extend((content.len() as u32).to_be_bytes());
            bytes.extend(kind.iter().chain(content));
            bytes.extend(checksum(&[&kind[..], content].concat()));
        }
        bytes
    }

    #[test]
    fn palettes_that_end_within_a_colour() {
        let indexed = |palette| raw(&with_chunks((3, 8), &[(*b"PLTE", palette)]));
        assert_eq!(indexed(vec![9, 9, 9]), Ok(vec![9; 4]));
        for bytes in [4, 5, 7, 767] {
            let text = indexed(vec![9; bytes]).unwrap_err().to_string();
            let expected = format!(
                "not a valid PNG image: its palette has {bytes} bytes, expected three for each of 1 to \
                 256 colours; export it again"
            );
            assert_eq!(text, expected);
        }
        // Palettes that are only suggestions (in images of other colour types) do not matter.
        assert_eq!(raw(&with_chunks((2, 8), &[(*b"PLTE", vec![9; 4])])), Ok(vec![0; 4]));
    }

    fn chunks() -> impl Strategy<Value = Vec<OwnChunk>> {
        let kinds = [
            b"PLTE", b"tRNS", b"sBIT", b"bKGD", b"gAMA", b"cHRM", b"sRGB", b"iCCP", b"acTL",
            b"fcTL", b"pHYs", b"tIME", b"cICP", b"mDCV", b"cLLI", b"eXIf", b"tEXt", b"zTXt",
            b"iTXt", b"fdAT",
        ];
        let kind = prop::sample::select(kinds.map(|kind| *kind).to_vec());
        prop::collection::vec((kind, prop::collection::vec(any::<u8>(), 0..40)), 0..5)
    }

    proptest! {
        #[test]
        fn no_chunk_panics(others in chunks(), palette in prop::option::of(0..800_usize)) {
            let palette = palette.map(|length| (*b"PLTE", vec![7; length]));
            let all: Vec<OwnChunk> = palette.into_iter().chain(others).collect();
            for colour in [0, 2, 3, 4, 6] {
                for depth in [1, 2, 4, 8, 16] {
                    let _ = raw(&with_chunks((colour, depth), &all));
                }
            }
        }
    }
}
