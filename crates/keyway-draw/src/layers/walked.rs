//! Area that a robot avoids because moving obstacles walk there.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::Rgb;
use crate::legend::{LegendEntry, LegendMark};
use keyway::geometry::Disc;

/// Area in which moving obstacles walk back and forth, and which a robot avoids. It is
/// translucent and does not enlarge the picture.
#[derive(Clone, Debug)]
pub struct WalkedGround<'a>(pub &'a [Disc]);

impl WalkedGround<'_> {
    const COLOR: Rgb = Rgb(0x94, 0x67, 0xbd);
    const OPACITY: &'static str = "0.25";
    /// The colour on white.
    const ON_FREE: Rgb = Rgb(0xe4, 0xd9, 0xef);
}

impl Layer for WalkedGround<'_> {
    fn depth(&self) -> Depth {
        Depth::Search
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        let drawable =
            |disc: &&Disc| disc.centre.is_finite() && (0.0..1e6).contains(&disc.radius_m);
        let mut discs = self.0.iter().filter(drawable).peekable();
        if discs.peek().is_none() {
            return;
        }
        // The discs overlap, so the opacity applies to their group.
        canvas.writer().tag("g").attr("opacity", Self::OPACITY).open();
        for disc in discs {
            let (x, y) = view.px_from_world(disc.centre);
            let circle = canvas.writer().tag("circle").round(x, y, disc.radius_m * view.px_per_m());
            circle.fill(Self::COLOR).leaf();
        }
        canvas.writer().close();
        canvas.explain(LegendEntry::new(
            "area avoided by the route",
            LegendMark::Area(Self::ON_FREE),
        ));
    }
}
