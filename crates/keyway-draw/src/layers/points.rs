//! Start, goal and points along the way.

use super::{Depth, Layer};
use crate::canvas::{Canvas, LineStyle};
use crate::color::{INK, SMOOTHED};
use crate::legend::{Entry, Sample};
use crate::marks::{KEY_RING_PX, LETTER_MARK_PX, letter_mark};
use crate::view::Extent;
use keyway::geometry::Point;

/// Small rings.
#[derive(Clone, Debug)]
pub struct Points<'a> {
    all: &'a [Point],
    label: String,
    style: LineStyle,
}

impl<'a> Points<'a> {
    /// Rings in a style of their own; its dashes are not used.
    pub fn new(points: &'a [Point], label: impl Into<String>, style: LineStyle) -> Self {
        Self { all: points, label: label.into(), style }
    }

    /// The key points of a path.
    pub fn key_points(points: &'a [Point]) -> Self {
        let style = LineStyle { color: SMOOTHED, width_px: 1.4, dashes: "" };
        Self::new(points, "key point", style)
    }
}

impl Layer for Points<'_> {
    fn depth(&self) -> Depth {
        Depth::Points
    }

    fn extend(&self, extent: &mut Extent) {
        self.all.iter().for_each(|&point| extent.include(point));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        let mut finite = self.all.iter().filter(|point| point.is_finite()).peekable();
        if finite.peek().is_some() {
            canvas.explain(Entry::new(self.label.clone(), Sample::Ring(self.style)));
        }
        for &point in finite {
            let (x, y) = view.px_from_world(point);
            let ring = canvas.writer().tag("circle").round(x, y, KEY_RING_PX).attr("fill", "#fff");
            ring.stroke(self.style.color, self.style.width_px).leaf();
        }
    }
}

/// The start: S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start(
    /// Where \[m\].
    pub Point,
);

impl Layer for Start {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include(self.0);
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        draw_letter(canvas, self.0, 'S', false, "start");
    }
}

/// The goal: G, with the circle in which it counts as reached when that is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Where \[m\].
    pub point: Point,
    /// How near is near enough \[m\].
    pub tolerance_m: Option<f64>,
}

impl Goal {
    const TOLERANCE: LineStyle = LineStyle { color: INK, width_px: 0.9, dashes: "2.5 2" };

    /// The tolerance; 0 without one, or when it is not a length.
    fn radius_m(&self) -> f64 {
        self.tolerance_m.filter(|r| r.is_finite() && *r > 0.0).unwrap_or(0.0)
    }
}

impl Layer for Goal {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include_disc(self.point, self.radius_m());
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        draw_letter(canvas, self.point, 'G', true, "goal");
        let radius = self.radius_m() * canvas.view().px_per_m();
        // A circle that the letter hides is not drawn.
        if radius > LETTER_MARK_PX + 2.0 && self.point.is_finite() {
            let (x, y) = canvas.view().px_from_world(self.point);
            let style = Self::TOLERANCE;
            let circle = canvas.writer().tag("circle").round(x, y, radius).attr("fill", "none");
            let circle = circle.stroke(style.color, style.width_px);
            circle.attr("stroke-dasharray", style.dashes).leaf();
            canvas.explain(Entry::new("goal tolerance", Sample::Circle(style)));
        }
    }
}

fn draw_letter(canvas: &mut Canvas<'_>, at: Point, letter: char, dark: bool, label: &str) {
    if at.is_finite() {
        let px = canvas.view().px_from_world(at);
        letter_mark(canvas.writer(), px, letter, dark);
        canvas.explain(Entry::new(label, Sample::Letter { letter, dark }));
    }
}
