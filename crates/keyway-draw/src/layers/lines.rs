//! Paths as lines.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{FREE, OVER_DRIVEN, PLANNED, SMOOTHED};
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::view::Extent;
use keyway::geometry::Polyline;

/// A path in one style.
#[derive(Clone, Debug)]
pub struct PathLine<'a> {
    path: &'a Polyline,
    label: String,
    style: LineStyle,
    rim_px: f64,
    depth: Depth,
}

impl<'a> PathLine<'a> {
    /// A path in a style of its own.
    pub fn new(path: &'a Polyline, label: impl Into<String>, style: LineStyle) -> Self {
        Self { path, label: label.into(), style, rim_px: 0.0, depth: Depth::Paths }
    }

    /// A path as the search returned it: thin, dashed, grey-blue.
    pub fn planned(path: &'a Polyline) -> Self {
        let style = LineStyle { color: PLANNED, width_px: 1.3, dashes: "5 2.5" };
        Self::new(path, "planned path", style)
    }

    /// A path to be followed: solid, blue.
    pub fn smoothed(path: &'a Polyline) -> Self {
        Self::new(path, "smoothed path", LineStyle::solid(SMOOTHED, 1.6))
    }

    /// With a white rim, to be seen on coloured ground.
    #[must_use]
    pub fn rimmed(self) -> Self {
        Self { rim_px: 0.7, ..self }
    }

    /// In front of all other paths.
    #[must_use]
    pub fn in_front(self) -> Self {
        Self { depth: Depth::Points, ..self }
    }

    /// Over what was driven, which is wider: both are seen where they run together.
    #[must_use]
    pub fn over_driven(self) -> Self {
        Self { style: LineStyle::solid(OVER_DRIVEN, 1.3), depth: Depth::Driven, ..self }
    }

    /// What the legend says.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }
}

impl Layer for PathLine<'_> {
    fn depth(&self) -> Depth {
        self.depth
    }

    fn extend(&self, extent: &mut Extent) {
        self.path.points().iter().for_each(|&point| extent.include(point));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if self.rim_px > 0.0 {
            let width_px = self.style.width_px + 2.0 * self.rim_px;
            canvas.line(self.path.points(), LineStyle::solid(FREE, width_px));
        }
        if canvas.line(self.path.points(), self.style) {
            canvas.explain(LegendEntry::new(self.label.clone(), LegendMark::Line(self.style)));
        }
    }
}
