//! Paths as lines.

use super::{Depth, Layer};
use crate::canvas::{Canvas, LineStyle};
use crate::color::{PLANNED, SMOOTHED};
use crate::legend::{Entry, Sample};
use crate::view::Extent;
use keyway::geometry::Polyline;

/// A path in one style.
#[derive(Clone, Debug)]
pub struct PathLine<'a> {
    path: &'a Polyline,
    label: String,
    style: LineStyle,
}

impl<'a> PathLine<'a> {
    /// A path in a style of its own.
    pub fn new(path: &'a Polyline, label: impl Into<String>, style: LineStyle) -> Self {
        Self { path, label: label.into(), style }
    }

    /// A path as the search returned it: thin, dashed, grey-blue.
    pub fn planned(path: &'a Polyline) -> Self {
        let style = LineStyle { color: PLANNED, width_px: 1.3, dashes: "5 2.5" };
        Self::new(path, "planned path", style)
    }

    /// A path to be followed: solid, blue.
    pub fn smoothed(path: &'a Polyline) -> Self {
        let style = LineStyle { color: SMOOTHED, width_px: 1.6, dashes: "" };
        Self::new(path, "smoothed path", style)
    }

    /// What the legend says.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }
}

impl Layer for PathLine<'_> {
    fn depth(&self) -> Depth {
        Depth::Paths
    }

    fn extend(&self, extent: &mut Extent) {
        self.path.points().iter().for_each(|&point| extent.include(point));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if canvas.line(self.path.points(), self.style) {
            canvas.explain(Entry::new(self.label.clone(), Sample::Line(self.style)));
        }
    }
}
