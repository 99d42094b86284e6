//! Netpbm images of bits, greys and colours: plain (P1, P2, P3) and binary (P4, P5, P6).
//!
//! Comments may appear wherever white space may, in plain files among the pixels too.

use super::decoded_image::{DecodedImage, ImageError};
use super::rule::{Pixel, Translator};
use crate::map::MAX_CELLS;

/// Allowed sizes of a side; a map of a single row or column may have [`MAX_CELLS`].
const SIDE: &str = "a whole number from 1 to 2147483648";

pub(super) fn encode(width: u32, height: u32, greys: &[u8]) -> Vec<u8> {
    let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
    bytes.extend_from_slice(greys);
    bytes
}

/// Kinds of samples.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Samples {
    Bits,
    Greys,
    Colours,
}

/// Kind of samples from the first two bytes, and true for a plain (text) file.
fn kind(bytes: &[u8]) -> Option<(Samples, bool)> {
    let &[b'P', digit, ..] = bytes else { return None };
    match digit {
        b'1' | b'4' => Some((Samples::Bits, digit == b'1')),
        b'2' | b'5' => Some((Samples::Greys, digit == b'2')),
        b'3' | b'6' => Some((Samples::Colours, digit == b'3')),
        _ => None,
    }
}

pub(super) fn is_pnm(bytes: &[u8]) -> bool {
    kind(bytes).is_some()
}

/// The columns and rows that the header announces, if it can be read.
pub(super) fn size(bytes: &[u8]) -> Option<(u64, u64)> {
    let mut text = Scanner { bytes, at: 2, line: 1 };
    let width = text.header("width", MAX_CELLS, SIDE).ok()?;
    Some((width, text.header("height", MAX_CELLS, SIDE).ok()?))
}

/// Raster parameters from the header.
struct Raster {
    samples: Samples,
    width: u64,
    height: u64,
    maximum: u32,
}

impl Raster {
    fn pixels(&self) -> u128 {
        u128::from(self.width) * u128::from(self.height)
    }

    /// Number of samples of a pixel.
    fn count(&self) -> usize {
        if self.samples == Samples::Colours { 3 } else { 1 }
    }

    /// Minimum size of a plain raster \[bytes\].
    fn least_text_bytes(&self) -> u128 {
        match self.samples {
            // Digits of bits need no separators.
            Samples::Bits => self.pixels(),
            // Others take a digit and a separator, except for the last.
            _ => self.pixels().saturating_mul(2 * self.count() as u128) - 1,
        }
    }

    /// Size of a binary raster \[bytes\].
    fn bytes(&self) -> u128 {
        match self.samples {
            Samples::Bits => u128::from(self.width.div_ceil(8)) * u128::from(self.height),
            _ => self.pixels().saturating_mul((self.count() * self.sample_bytes()) as u128),
        }
    }

    fn sample_bytes(&self) -> usize {
        if self.maximum < 256 { 1 } else { 2 }
    }

    /// Converts samples to a pixel. In bitmaps, 1 is black.
    fn pixel(&self, samples: &[u32]) -> Pixel {
        match *samples {
            [bit] if self.samples == Samples::Bits => Pixel::grey(1 - bit, 1),
            [grey] => Pixel::grey(grey, self.maximum),
            _ => Pixel { rgb_sum: samples.iter().sum(), alpha: None, white: self.maximum },
        }
    }

    fn bad_pixel(&self, got: &[u8], index: u64) -> ImageError {
        let (column, row) = (index % self.width, index / self.width);
        ImageError::Pixel { column, row, got: shown(got), maximum: self.maximum }
    }
}

/// Decodes an image; `bytes` must pass [`is_pnm`].
pub(super) fn decode(bytes: &[u8], cells: &mut Translator<'_>) -> Result<DecodedImage, ImageError> {
    let (samples, is_text) = kind(bytes).unwrap_or((Samples::Greys, true));
    let mut text = Scanner { bytes, at: 2, line: 1 };
    let width = text.header("width", MAX_CELLS, SIDE)?;
    let height = text.header("height", MAX_CELLS, SIDE)?;
    let maximum = match samples {
        Samples::Bits => 1,
        _ => text.header("largest value", 65_535, "a whole number from 1 to 65535")? as u32,
    };
    let raster = Raster { samples, width, height, maximum };
    let needed = if is_text { raster.least_text_bytes() } else { raster.bytes() };
    if !is_text {
        text.end_header(needed);
    }
    let rest = &bytes[text.at..];
    if (rest.len() as u128) < needed {
        return Err(ImageError::Truncated { width, height, needed, got: rest.len() });
    }
    let mut values = Vec::with_capacity(raster.pixels() as usize);
    let sink = |pixel| values.push(cells.value(pixel));
    match (is_text, samples) {
        (true, _) => read_text(&mut text, &raster, sink)?,
        (false, Samples::Bits) => read_bits(&rest[..needed as usize], &raster, sink),
        (false, _) => read_samples(&rest[..needed as usize], &raster, sink)?,
    }
    Ok(DecodedImage { width, height, values })
}

fn read_text(
    text: &mut Scanner<'_>,
    raster: &Raster,
    mut sink: impl FnMut(Pixel),
) -> Result<(), ImageError> {
    let mut samples = [0; 3];
    for index in 0..raster.pixels() as u64 {
        let own = &mut samples[..raster.count()];
        for sample in own.iter_mut() {
            let word = if raster.samples == Samples::Bits { text.digit() } else { text.word() };
            let read = number(word, raster.maximum);
            *sample = read.ok_or_else(|| raster.bad_pixel(word, index))?;
        }
        sink(raster.pixel(own));
    }
    Ok(())
}

/// Reads packed bits; each row begins at a byte boundary.
fn read_bits(bytes: &[u8], raster: &Raster, mut sink: impl FnMut(Pixel)) {
    for row in bytes.chunks_exact(raster.width.div_ceil(8) as usize) {
        for column in 0..raster.width as usize {
            sink(raster.pixel(&[u32::from(row[column / 8] >> (7 - column % 8) & 1)]));
        }
    }
}

fn read_samples(
    bytes: &[u8],
    raster: &Raster,
    mut sink: impl FnMut(Pixel),
) -> Result<(), ImageError> {
    let mut samples = [0; 3];
    for (index, pixel) in bytes.chunks_exact(raster.count() * raster.sample_bytes()).enumerate() {
        let own = &mut samples[..raster.count()];
        for (sample, bytes) in own.iter_mut().zip(pixel.chunks_exact(raster.sample_bytes())) {
            *sample = bytes.iter().fold(0, |sample, &byte| sample << 8 | u32::from(byte));
            if *sample > raster.maximum {
                return Err(raster.bad_pixel(sample.to_string().as_bytes(), index as u64));
            }
        }
        sink(raster.pixel(own));
    }
    Ok(())
}

fn number(word: &[u8], maximum: u32) -> Option<u32> {
    digits(word).filter(|&n| n <= u64::from(maximum)).map(|n| n as u32)
}

fn digits(word: &[u8]) -> Option<u64> {
    // `parse` alone would accept a sign.
    if !word.iter().all(u8::is_ascii_digit) {
        return None;
    }
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Escapes and shortens a word for an error message.
fn shown(word: &[u8]) -> String {
    if word.is_empty() {
        return "missing".to_owned();
    }
    let cut = if word.len() > 24 { "..." } else { "" };
    format!("\"{}{cut}\"", word[..word.len().min(24)].escape_ascii())
}

struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Scanner<'a> {
    /// The next word, after white space and comments; empty at the end of the file.
    fn word(&mut self) -> &'a [u8] {
        let mut comment = false;
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'\n' | b'\r' => comment = false,
                b'#' => comment = true,
                _ if comment || is_space(byte) => {}
                _ => break,
            }
            self.line += usize::from(byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&b| is_space(b) || b == b'#').unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// The next word of one character: digits of bits need no separators.
    fn digit(&mut self) -> &'a [u8] {
        let word = self.word();
        self.at -= word.len().saturating_sub(1);
        &word[..word.len().min(1)]
    }

    fn header(
        &mut self,
        field: &'static str,
        maximum: u64,
        expected: &'static str,
    ) -> Result<u64, ImageError> {
        let word = self.word();
        let number = digits(word).filter(|n| (1..=maximum).contains(n));
        let line = self.line;
        number.ok_or_else(|| ImageError::Header { line, field, got: shown(word), expected })
    }

    /// Skips the single white space that ends the header of a binary file, and a comment before
    /// it.
    fn end_header(&mut self, raster: u128) {
        if self.bytes.get(self.at) == Some(&b'#') {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
            self.at += length.unwrap_or(rest.len());
        }
        self.at = (self.at + 1).min(self.bytes.len());
        // Editors that rewrite line endings leave two bytes. The second could be a pixel as well;
        // it is not if exactly the pixels remain after it.
        let rest = &self.bytes[self.at..];
        let crlf = self.bytes[self.at - 1] == b'\r' && rest.first() == Some(&b'\n');
        if crlf && rest.len() as u128 == raster.saturating_add(1) {
            self.at += 1;
        }
    }
}

const fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

#[cfg(test)]
mod tests {
    use super::super::rule::{CellRule, MapMode};
    use super::*;

    /// The values of a file in raw mode.
    fn raw(bytes: &[u8]) -> Result<(u64, u64, Vec<u8>), ImageError> {
        let rule = CellRule { mode: MapMode::Raw, ..CellRule::IMAGE };
        let mut cells = Translator::new(&rule);
        decode(bytes, &mut cells).map(|image| (image.width, image.height, image.values))
    }

    #[test]
    fn binary_and_plain() {
        assert_eq!(
            raw(b"P5 3 2 255\n\x00\x01\x02\x03\x04\x05"),
            Ok((3, 2, vec![0, 1, 2, 3, 4, 5]))
        );
        assert_eq!(raw(b"P2\n1 2\n255\n7 8"), Ok((1, 2, vec![7, 8])));
        assert_eq!(raw(b"P5 1 1 255\nA trailing bytes"), Ok((1, 1, vec![65])));
    }

    #[test]
    fn comments_and_line_ends() {
        let plain = b"P2# one\r\n#two\r\n 2#\n\x0b1 # three\r255\r\n1# 9\n#\n2 #";
        assert_eq!(raw(plain), Ok((2, 1, vec![1, 2])));
        assert_eq!(raw(b"P5\r\n2 1\r\n255\r\n\x01\x02"), Ok((2, 1, vec![1, 2])));
        assert_eq!(raw(b"P5 2 1 255#rest of line\n\x01\x02"), Ok((2, 1, vec![1, 2])));
        // One white space only: the line feed is a pixel, and so is a number sign.
        assert_eq!(raw(b"P5 2 1 255\r\n#"), Ok((2, 1, vec![10, 35])));
    }

    #[test]
    fn every_maximum_is_white() {
        // 20 of 51 is 100 of 255; 1000 of 2550 too, in two bytes, the high one first.
        assert_eq!(raw(b"P2 1 1 51 20"), Ok((1, 1, vec![100])));
        assert_eq!(raw(b"P5 1 1 2550\n\x03\xe8"), Ok((1, 1, vec![100])));
        assert_eq!(raw(b"P2 2 1 65535 0 25700"), Ok((2, 1, vec![0, 100])));
        assert_eq!(raw(b"P2 2 1 1 0 1"), Ok((2, 1, vec![0, 255])));
    }

    #[test]
    fn bits_and_colours() {
        // Each row of bits begins at a byte boundary; 1 is black.
        let first = [255, 255, 0, 255, 255, 255, 255, 255, 0, 255];
        let bits = [&first[..], &[0; 9], &[255]].concat();
        assert_eq!(raw(b"P4 10 2\n\x20\x80\xff\x80"), Ok((10, 2, bits.clone())));
        assert_eq!(raw(b"P1 # c\n10 2\n0010000010\n11111 1111#\n0"), Ok((10, 2, bits)));
        assert_eq!(raw(b"P6 2 1 255\n\x00\x1e\x3c\x09\x09\x09"), Ok((2, 1, vec![30, 9])));
        assert_eq!(raw(b"P3 2 1 51 0 6 12\n20 20 20"), Ok((2, 1, vec![30, 100])));
        assert_eq!(raw(b"P6 1 1 2550\n\x03\xe8\x03\xe8\x03\xe8"), Ok((1, 1, vec![100])));
        for (bytes, text) in [
            (&b"P4 9 1\n\0"[..], "9 x 1 pixels need at least 2 bytes after the header, got 1"),
            (b"P1 3 1 10", "the pixel in column 2, row 0 from the top is missing, expected 0 to 1"),
            (b"P1 3 1 102", "the pixel in column 2, row 0 from the top is \"2\", expected 0 to 1"),
            (b"P6 1 1 255\n\0\0", "1 x 1 pixels need at least 3 bytes after the header, got 2"),
            (
                b"P6 2 1 9\n\0\0\0\0\0\x0a",
                "the pixel in column 1, row 0 from the top is \"10\", expected 0 to 9",
            ),
            (
                b"P3 1 1 9 1 2 x",
                "the pixel in column 0, row 0 from the top is \"x\", expected 0 to 9",
            ),
        ] {
            assert_eq!(raw(bytes).unwrap_err().to_string(), text);
        }
    }

    #[test]
    fn bad_headers() {
        let cases: [(&[u8], usize, &str, &str); 10] = [
            (b"P5", 1, "width", "missing"),
            (b"P5\n0 3 255\n", 2, "width", "\"0\""),
            (b"P5\n-1 3 255\n", 2, "width", "\"-1\""),
            (b"P5 +1 3 255\n", 1, "width", "\"+1\""),
            (b"P5\n# c\n3 x 255\n", 3, "height", "\"x\""),
            (b"P5 99999999999999999999999 3 255\n", 1, "width", "\"99999999999999999999999\""),
            (b"P5 3 2147483649 255\n", 1, "height", "\"2147483649\""),
            (b"P5 3 3 0\n", 1, "largest value", "\"0\""),
            (b"P5 3 3 65536\n", 1, "largest value", "\"65536\""),
            (b"P5 3 \xff 255\n", 1, "height", "\"\\xff\""),
        ];
        for (bytes, at, name, text) in cases {
            let error = raw(bytes).unwrap_err();
            let ImageError::Header { line, field, got, .. } = &error else { panic!("{error}") };
            assert_eq!((*line, *field, got.as_str()), (at, name, text));
            let start = format!("line {at}: the {name} of the header is {text}, expected a whole");
            assert!(error.to_string().starts_with(&start), "{error}");
            assert!(error.to_string().contains("number from 1 to "), "{error}");
        }
        assert!(SIDE.ends_with(&MAX_CELLS.to_string()));
    }

    #[test]
    fn truncated_data() {
        let cases: [(&[u8], u128, usize); 5] = [
            (b"P5 3 2 255\n\0\0\0\0\0", 6, 5),
            (b"P5 3 2 256\n\0\0\0\0\0\0", 12, 6),
            (b"P5 2000000000 2000000000 255\n", 4_000_000_000_000_000_000, 0),
            (b"P5 3 2 255", 6, 0),
            (b"P2 2 2 255 1 1 1", 7, 6),
        ];
        for (bytes, least, have) in cases {
            let error = raw(bytes).unwrap_err();
            let ImageError::Truncated { needed, got, .. } = error else { panic!("{error}") };
            assert_eq!((needed, got), (least, have), "{}", bytes.escape_ascii());
            assert!(error.to_string().contains(&format!("at least {least} bytes")), "{error}");
        }
        let huge = b"P2 2147483648 2147483648 255 0";
        assert!(matches!(raw(huge), Err(ImageError::Truncated { .. })));
    }

    #[test]
    fn pixels_that_are_not_in_range() {
        let cases: [(&[u8], u64, u64, &str); 5] = [
            (b"P5 2 2 9\n\x00\x01\x02\x0a", 1, 1, "\"10\""),
            (b"P2 2 2 9\n0 1 10 2", 0, 1, "\"10\""),
            (b"P2 2 1 9\n0 x", 1, 0, "\"x\""),
            (b"P2 1 1 9\n-1", 0, 0, "\"-1\""),
            (b"P2 2 2 9\n1 1 #aaaaaaaaa", 0, 1, "missing"),
        ];
        for (bytes, x, y, text) in cases {
            let error = raw(bytes).unwrap_err();
            let ImageError::Pixel { column, row, got, .. } = &error else { panic!("{error}") };
            assert_eq!((*column, *row, got.as_str()), (x, y, text));
            assert_eq!(
                error.to_string(),
                format!("the pixel in column {x}, row {y} from the top is {text}, expected 0 to 9")
            );
        }
    }
}
