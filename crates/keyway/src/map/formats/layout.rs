//! Layouts of the samples of a pixel.

use super::rule::Pixel;

/// Layout of the samples of a pixel in memory.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) colours: usize,
    pub(super) alpha: bool,
    /// Two bytes a sample.
    pub(super) wide: bool,
}

impl Layout {
    /// Bytes of a pixel.
    pub(super) const fn pixel_bytes(self) -> usize {
        (self.colours + self.alpha as usize) * if self.wide { 2 } else { 1 }
    }

    /// The pixel of these bytes; `word` gives the sample of two bytes.
    pub(super) fn pixel(self, bytes: &[u8], word: fn([u8; 2]) -> u16) -> Pixel {
        let sample = |i: usize| {
            if self.wide {
                u32::from(word([bytes[2 * i], bytes[2 * i + 1]]))
            } else {
                u32::from(bytes[i])
            }
        };
        let sum: u32 = (0..self.colours).map(sample).sum();
        Pixel {
            rgb_sum: if self.colours == 1 { 3 * sum } else { sum },
            alpha: self.alpha.then(|| sample(self.colours)),
            white: if self.wide { 65_535 } else { 255 },
        }
    }
}
