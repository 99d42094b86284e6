//! Polygon obstacles.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{OBSTACLE, Rgb};
use crate::legend::{LegendEntry, LegendMark};
use crate::marks::hatched_polygon;
use crate::view::Extent;
use keyway::geometry::Point;

/// Hatched polygons.
#[derive(Clone, Debug)]
pub struct Polygons<'a> {
    /// Vertices in the world \[m\].
    all: &'a [&'a [Point]],
    label: String,
    color: Rgb,
}

impl<'a> Polygons<'a> {
    /// Creates hatched polygons in a colour; those with a vertex that is not finite are left out.
    pub fn new(polygons: &'a [&'a [Point]], label: impl Into<String>, color: Rgb) -> Self {
        Self { all: polygons, label: label.into(), color }
    }

    /// Creates the static obstacles that are in the world but not on the map.
    pub fn unknown_obstacles(polygons: &'a [&'a [Point]]) -> Self {
        Self::new(polygons, "unknown obstacle", OBSTACLE)
    }

    fn drawable(&self) -> impl Iterator<Item = &'a [Point]> {
        self.all.iter().copied().filter(|vertices| vertices.iter().all(|point| point.is_finite()))
    }
}

impl Layer for Polygons<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn extend(&self, extent: &mut Extent) {
        self.drawable().flatten().for_each(|&vertex| extent.include(vertex));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        for vertices in self.drawable() {
            let vertices: Vec<_> = vertices.iter().map(|&at| view.px_from_world(at)).collect();
            hatched_polygon(canvas.writer(), &vertices, self.color);
        }
        if self.drawable().next().is_some() {
            canvas
                .explain(LegendEntry::new(self.label.clone(), LegendMark::HatchedDisc(self.color)));
        }
    }
}
