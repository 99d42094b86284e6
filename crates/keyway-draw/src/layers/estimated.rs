//! A robot's estimate of moving obstacles.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::Rgb;
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::marks::time_mark;
use keyway::sense::Mover;

/// Estimated moving obstacles: the area that each may cover, the position of its centre in a
/// second at constant velocity, and the number of its track ([`Mover::id`]). They do not enlarge
/// the picture.
#[derive(Clone, Debug)]
pub struct EstimatedMovers<'a>(pub &'a [Mover]);

impl EstimatedMovers<'_> {
    const STYLE: LineStyle =
        LineStyle { color: Rgb(0xd5, 0x5e, 0x00), width_px: 1.6, dashes: "4 2" };

    /// Prediction time of the stroke \[s\].
    const AHEAD_S: f64 = 1.0;

    /// Distance from the area to the middle of the number above it \[px\].
    const ABOVE_PX: f64 = 9.0;
}

impl Layer for EstimatedMovers<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        let numbers = |mover: &Mover| [mover.now().centre, mover.velocity_mps];
        let drawable = |mover: &&Mover| {
            let radius_m = mover.now().radius_m;
            numbers(mover).iter().all(|point| point.is_finite()) && (0.0..1e6).contains(&radius_m)
        };
        let mut is_empty = true;
        for mover in self.0.iter().filter(drawable) {
            let now = mover.now();
            let (x, y) = view.px_from_world(now.centre);
            let outline = canvas.writer().tag("circle").attr("fill", "none");
            let radius_px = now.radius_m * view.px_per_m();
            outline.round(x, y, radius_px).line_style(Self::STYLE).leaf();
            let ahead = now.centre + mover.velocity_mps * Self::AHEAD_S;
            canvas.line(&[now.centre, ahead], Self::STYLE);
            let place = (x, y - radius_px - Self::ABOVE_PX);
            time_mark(canvas.writer(), place, &format!("track {}", mover.id), Self::STYLE.color);
            is_empty = false;
        }
        if !is_empty {
            canvas.explain(LegendEntry::new(
                "tracked moving obstacle, up to 1 s ahead",
                LegendMark::Line(Self::STYLE),
            ));
        }
    }
}
