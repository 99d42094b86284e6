//! A line of text in a corner of the plot.

use super::{Depth, Layer};
use crate::axis::TEXT_PX;
use crate::canvas::Canvas;
use crate::color::FREE;
use crate::text::text_width_px;
use crate::writer::Anchor;

/// Text in the upper left corner of the plot, such as the time of a frame.
#[derive(Clone, Debug)]
pub struct Caption(
    /// The text.
    pub String,
);

impl Layer for Caption {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let (width, height) = (text_width_px(&self.0, TEXT_PX) + 10.0, TEXT_PX + 8.0);
        let ground = canvas.writer().tag("rect").at(4.0, 4.0).size(width, height).fill(FREE);
        ground.leaf();
        canvas.writer().label(9.0, 6.0 + TEXT_PX, TEXT_PX, Anchor::Start, &self.0);
    }
}
