//! At most 255 colours for a picture.

use resvg::tiny_skia::Pixmap;
use std::collections::HashMap;

type Color = [u8; 3];

/// Palette index for no colour: the pixel keeps its previous colour.
pub(super) const TRANSPARENT: u8 = 255;

/// Colours, and their indices.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    colors: Vec<Color>,
    /// Indices that were looked up before.
    known: HashMap<Color, u8>,
}

impl Palette {
    /// Returns the colours of a picture, frequent ones first. If there are more than 255, a
    /// colour is left out if a more frequent one is within a tolerance, which grows until the
    /// rest fit.
    pub(super) fn of(pixels: &Pixmap) -> Self {
        let mut counts: HashMap<Color, u32> = HashMap::new();
        for color in colors(pixels) {
            *counts.entry(color).or_default() += 1;
        }
        let mut by_count: Vec<(u32, Color)> = counts.into_iter().map(|(c, n)| (n, c)).collect();
        by_count.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut tolerance_sq = 0;
        loop {
            if let Some(colors) = pick(&by_count, tolerance_sq) {
                return Self { colors, known: HashMap::new() };
            }
            tolerance_sq = 2 * tolerance_sq + 4;
        }
    }

    /// Returns the palette indices of a picture's pixels, row by row.
    pub(super) fn indices(&mut self, pixels: &Pixmap) -> Vec<u8> {
        // Neighbouring pixels are mostly equal.
        let mut last = ([0, 0, 0], self.nearest([0, 0, 0]));
        let place = |color: Color| {
            if color != last.0 {
                last = (color, self.place(color));
            }
            last.1
        };
        colors(pixels).map(place).collect()
    }

    /// Returns all colours as red, green, blue; the transparent entry is the last.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.colors.concat();
        bytes.resize(3 * (usize::from(TRANSPARENT) + 1), 0);
        bytes
    }

    fn place(&mut self, color: Color) -> u8 {
        if let Some(&place) = self.known.get(&color) {
            return place;
        }
        let place = self.nearest(color);
        self.known.insert(color, place);
        place
    }

    fn nearest(&self, color: Color) -> u8 {
        let by_distance = |&(_, other): &(usize, &Color)| distance_sq(color, *other);
        self.colors.iter().enumerate().min_by_key(by_distance).map_or(0, |(i, _)| i as u8)
    }
}

/// Picks colours such that each colour of the picture is within the tolerance of one of them;
/// `None` if that takes too many.
fn pick(by_count: &[(u32, Color)], tolerance_sq: u32) -> Option<Vec<Color>> {
    let mut picked: Vec<Color> = Vec::new();
    for &(_, color) in by_count {
        if !picked.iter().any(|&other| distance_sq(color, other) <= tolerance_sq) {
            if picked.len() == usize::from(TRANSPARENT) {
                return None;
            }
            picked.push(color);
        }
    }
    Some(picked)
}

fn colors(pixels: &Pixmap) -> impl Iterator<Item = Color> {
    pixels.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
}

fn distance_sq(a: Color, b: Color) -> u32 {
    a.iter().zip(b).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequent_colours_stay_and_rare_ones_move_a_little() {
        // 300 greens and blues, once each, in a white picture.
        let mut pixels = Pixmap::new(40, 40).unwrap();
        for (i, pixel) in pixels.data_mut().chunks_mut(4).enumerate() {
            let color = if i < 300 { [0, (i / 2) as u8, (i % 2) as u8] } else { [255; 3] };
            pixel.copy_from_slice(&[color[0], color[1], color[2], 255]);
        }
        let mut palette = Palette::of(&pixels);
        assert!(palette.colors.len() <= 255);
        assert_eq!(palette.colors[0], [255; 3], "the most frequent one");
        let places = palette.indices(&pixels);
        for (color, &place) in colors(&pixels).zip(&places) {
            // 2^2 suffices for neighbouring colours to merge.
            assert!(distance_sq(color, palette.colors[usize::from(place)]) <= 4);
        }
        assert_eq!(palette.bytes().len(), 768);
    }
}
