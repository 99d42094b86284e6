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
    /// Creates a path in a custom style.
    pub fn new(path: &'a Polyline, label: impl Into<String>, style: LineStyle) -> Self {
        Self { path, label: label.into(), style, rim_px: 0.0, depth: Depth::Paths }
    }

    /// Creates a path as returned by the search: thin, dashed, grey-blue.
    pub fn planned(path: &'a Polyline) -> Self {
        let style = LineStyle { color: PLANNED, width_px: 1.3, dashes: "5 2.5" };
        Self::new(path, "planned path", style)
    }

    /// Creates the path that is followed: solid, blue.
    pub fn smoothed(path: &'a Polyline) -> Self {
        Self::new(path, "smoothed path", LineStyle::solid(SMOOTHED, 1.6))
    }

    /// Adds a white rim, for visibility over colours.
    #[must_use]
    pub fn rimmed(self) -> Self {
        Self { rim_px: 0.7, ..self }
    }

    /// Draws the path in front of all other paths.
    #[must_use]
    pub fn in_front(self) -> Self {
        Self { depth: Depth::Points, ..self }
    }

    /// Draws the path over the driven trajectory, which is wider: both are visible where they
    /// overlap.
    #[must_use]
    pub fn over_driven(self) -> Self {
        Self { style: LineStyle::solid(OVER_DRIVEN, 1.3), depth: Depth::Driven, ..self }
    }

    /// Sets the text in the legend.
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
