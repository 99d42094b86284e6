//! Disc obstacles in their true shape.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{OBSTACLE, Rgb};
use crate::legend::{LegendEntry, LegendMark};
use crate::marks::hatched_disc;
use crate::view::Extent;
use keyway::geometry::Disc;

/// Hatched discs.
#[derive(Clone, Debug)]
pub struct HatchedDiscs<'a> {
    all: &'a [Disc],
    label: String,
    color: Rgb,
}

impl<'a> HatchedDiscs<'a> {
    /// Creates hatched discs in a colour.
    pub fn new(discs: &'a [Disc], label: impl Into<String>, color: Rgb) -> Self {
        Self { all: discs, label: label.into(), color }
    }

    /// Creates the static obstacles that are in the world but not on the map.
    pub fn unknown_obstacles(discs: &'a [Disc]) -> Self {
        Self::new(discs, "unknown obstacle", OBSTACLE)
    }

    /// Creates the moving obstacles, at their positions at one time.
    pub fn moving_obstacles(discs: &'a [Disc]) -> Self {
        Self::new(discs, "moving obstacle", OBSTACLE)
    }

    /// Returns the discs that can be drawn: finite, and not of negative size.
    fn drawable(&self) -> impl Iterator<Item = &Disc> {
        self.all.iter().filter(|disc| disc.is_valid())
    }
}

impl Layer for HatchedDiscs<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn extend(&self, extent: &mut Extent) {
        self.drawable().for_each(|disc| extent.include_disc(disc.centre, disc.radius_m));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        for disc in self.drawable() {
            let radius = disc.radius_m * view.px_per_m();
            let centre = view.px_from_world(disc.centre);
            hatched_disc(canvas.writer(), centre, radius, self.color);
            canvas.discs.push((centre, radius));
        }
        if self.drawable().next().is_some() {
            canvas
                .explain(LegendEntry::new(self.label.clone(), LegendMark::HatchedDisc(self.color)));
        }
    }
}
