//! Animations of pictures, as GIF and APNG.

mod apng;
mod gif;
mod palette;
mod player;
mod search;

pub use player::animate_frames;
pub use search::animate_search;

use crate::raster::DrawError;
use crate::svg::Svg;
use palette::{Palette, TRANSPARENT};
use resvg::tiny_skia::Pixmap;

/// Animation of pictures of one size, which loops.
///
/// Only the rectangle of each frame that changed is stored. The palette is that of one picture,
/// with at most 255 colours; any other colour becomes the nearest of these. The same input gives
/// the same bytes.
///
/// ```
/// use keyway::geometry::Point;
/// use keyway::map::OccupancyGrid;
/// use keyway_draw::layers::{GoalMark, StartMark};
/// use keyway_draw::{Animation, MapPicture};
///
/// let map = OccupancyGrid::from_ascii(&["...", ".#.", "..."]);
/// let (start, point) = (Point::new(0.5, 0.5), Point::new(2.5, 2.5));
/// let begin = || MapPicture::new(&map).with(StartMark(start));
/// let still = begin().with(GoalMark { point, tolerance_m: None });
/// let mut animation = Animation::new(&still.svg(), 1.0)?;
/// animation.push(&begin().svg_in(&still.layout()), 50)?;
/// animation.push(&still.svg(), 150)?;
/// assert_eq!(animation.frames(), 2);
/// assert_eq!(&animation.to_gif()?[..6], b"GIF89a");
/// assert_eq!(&animation.to_apng()?[1..4], b"PNG");
/// # Ok::<(), keyway_draw::DrawError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Animation {
    width: u16,
    height: u16,
    scale: f64,
    palette: Palette,
    frames: Vec<Frame>,
    /// The last complete frame.
    last: Vec<u8>,
}

/// Changed part of a picture, and the time for which the result is shown.
#[derive(Clone, Debug)]
struct Frame {
    left: u16,
    top: u16,
    width: u16,
    height: u16,
    /// Palette indices, row by row; [`TRANSPARENT`] for unchanged pixels.
    pixels: Vec<u8>,
    centiseconds: u16,
}

impl Animation {
    /// Creates an animation without frames, for pictures of the size and colours of `still`, with
    /// `scale` pixels per unit of it.
    ///
    /// # Errors
    /// As for [`Svg::to_png`].
    pub fn new(still: &Svg, scale: f64) -> Result<Self, DrawError> {
        let pixels = still.to_pixels(scale)?;
        // No side is longer than 4096.
        let (width, height) = (pixels.width() as u16, pixels.height() as u16);
        let palette = Palette::of(&pixels);
        Ok(Self { width, height, scale, palette, frames: Vec::new(), last: Vec::new() })
    }

    /// Shows a picture for this many hundredths of a second.
    ///
    /// # Errors
    /// Returns [`DrawError`] if the picture does not have the size of the animation.
    pub fn push(&mut self, picture: &Svg, centiseconds: u16) -> Result<(), DrawError> {
        self.push_pixels(&picture.to_pixels(self.scale)?, centiseconds)
    }

    /// Size \[px\].
    pub const fn size_px(&self) -> (u16, u16) {
        (self.width, self.height)
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Duration of one loop \[s\].
    pub fn duration_s(&self) -> f64 {
        self.frames.iter().map(|frame| f64::from(frame.centiseconds)).sum::<f64>() / 100.0
    }

    /// Returns the bytes of a GIF file.
    ///
    /// # Errors
    /// Returns [`DrawError`] if there is no frame.
    pub fn to_gif(&self) -> Result<Vec<u8>, DrawError> {
        gif::encode(self)
    }

    /// Returns the bytes of an APNG file: a PNG whose first frame is shown by viewers that do not
    /// play animations.
    ///
    /// # Errors
    /// Returns [`DrawError`] if there is no frame.
    pub fn to_apng(&self) -> Result<Vec<u8>, DrawError> {
        apng::encode(self)
    }

    fn push_pixels(&mut self, pixels: &Pixmap, centiseconds: u16) -> Result<(), DrawError> {
        let (width, height) = (pixels.width(), pixels.height());
        if (width, height) != (self.width.into(), self.height.into()) {
            return Err(DrawError::Frame { width, height });
        }
        let whole = self.palette.indices(pixels);
        match (changed(&whole, &self.last, usize::from(self.width)), self.frames.last_mut()) {
            (None, Some(last)) => {
                last.centiseconds = last.centiseconds.saturating_add(centiseconds);
            }
            (Some(frame), Some(_)) => self.frames.push(Frame { centiseconds, ..frame }),
            (_, None) => {
                let (width, height) = (self.width, self.height);
                let pixels = whole.clone();
                self.frames.push(Frame { left: 0, top: 0, width, height, pixels, centiseconds });
            }
        }
        self.last = whole;
        Ok(())
    }
}

/// Returns the smallest rectangle in which two pictures differ, with the differing pixels of
/// `new`.
fn changed(new: &[u8], old: &[u8], width: usize) -> Option<Frame> {
    let rows = || new.chunks(width).zip(old.chunks(width));
    let differs = |(new, old): (&[u8], &[u8])| new != old;
    let top = rows().position(differs)?;
    let height = rows().collect::<Vec<_>>().into_iter().rposition(differs)? + 1 - top;
    let changed_rows = || rows().skip(top).take(height);
    let pairs = |new: &[u8], old: &[u8]| -> Vec<bool> {
        new.iter().zip(old).map(|(new, old)| new != old).collect()
    };
    let (mut left, mut end) = (width, 0);
    for (new, old) in changed_rows() {
        let differing = pairs(new, old);
        let Some(first) = differing.iter().position(|&differs| differs) else { continue };
        left = left.min(first);
        end = end.max(differing.iter().rposition(|&differs| differs).map_or(0, |last| last + 1));
    }
    let kept = |(&new, &old): (&u8, &u8)| if new == old { TRANSPARENT } else { new };
    let pixels =
        changed_rows().flat_map(|(new, old)| new[left..end].iter().zip(&old[left..end]).map(kept));
    Some(Frame {
        left: left as u16,
        top: top as u16,
        width: (end - left) as u16,
        height: height as u16,
        pixels: pixels.collect(),
        centiseconds: 0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changed_is_kept() {
        const T: u8 = TRANSPARENT;
        let old = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let new = [0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 7, 0];
        let frame = changed(&new, &old, 4).unwrap();
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        assert_eq!(frame.pixels, [5, T, T, 7]);
        assert!(changed(&new, &new, 4).is_none());
    }
}
