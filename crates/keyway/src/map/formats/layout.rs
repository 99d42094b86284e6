//! Layouts of the samples of a pixel.

use super::rule::Pixel;

/// Layout of the samples of a pixel in memory.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) colours: usize,
    pub(super) alpha: bool,
    /// True for two bytes per sample.
    pub(super) wide: bool,
}

impl Layout {
    /// Number of bytes of a pixel.
    pub(super) const fn pixel_bytes(self) -> usize {
        (self.colours + self.alpha as usize) * if self.wide { 2 } else { 1 }
    }

    /// Converts bytes to a pixel; `word` converts the two bytes of a wide sample.
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
