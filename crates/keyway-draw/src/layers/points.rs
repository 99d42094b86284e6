//! Start, goal and points along the route.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{FREE, INK, Rgb, SMOOTHED};
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::marks::{KEY_RING_PX, LETTER_MARK_PX, letter_mark};
use crate::view::Extent;
use crate::writer::PathData;
use keyway::geometry::Point;

/// Small rings.
#[derive(Clone, Debug)]
pub struct Points<'a> {
    all: &'a [Point],
    label: String,
    style: LineStyle,
}

impl<'a> Points<'a> {
    /// Creates rings in a custom style; its dashes are not used.
    pub fn new(points: &'a [Point], label: impl Into<String>, style: LineStyle) -> Self {
        Self { all: points, label: label.into(), style }
    }

    /// Creates the key points of a path.
    pub fn key_points(points: &'a [Point]) -> Self {
        Self::new(points, "key point", LineStyle::solid(SMOOTHED, 1.4))
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
            canvas.explain(LegendEntry::new(self.label.clone(), LegendMark::Ring(self.style)));
        }
        for &point in finite {
            let (x, y) = view.px_from_world(point);
            let ring = canvas.writer().tag("circle").round(x, y, KEY_RING_PX).attr("fill", "#fff");
            ring.stroke(self.style.color, self.style.width_px).leaf();
        }
    }
}

/// Small dots at the hits of a range sensor.
#[derive(Clone, Debug)]
pub struct Hits<'a>(
    /// Positions of the hits \[m\].
    pub &'a [Point],
);

impl Hits<'_> {
    const COLOR: Rgb = Rgb(0xd7, 0x19, 0x1c);
    const RADIUS_PX: f64 = 1.2;
}

impl Layer for Hits<'_> {
    fn depth(&self) -> Depth {
        Depth::Points
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        let mut dots = PathData::default();
        for &point in self.0.iter().filter(|point| point.is_finite()) {
            // A line of length 0 has round ends.
            dots.append([view.px_from_world(point); 2]);
        }
        if canvas.path(&dots, LineStyle::solid(Self::COLOR, 2.0 * Self::RADIUS_PX)) {
            canvas.explain(LegendEntry::new(
                "scan",
                LegendMark::Dot(Self::COLOR, Self::RADIUS_PX + 0.6),
            ));
        }
    }
}

/// The start: S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartMark(
    /// Position \[m\].
    pub Point,
);

impl Layer for StartMark {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include(self.0);
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        draw_letter(canvas, self.0, START, "start");
    }
}

/// The goal: G, with the tolerance circle if a tolerance is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalMark {
    /// Position \[m\].
    pub point: Point,
    /// Distance within which the goal counts as reached \[m\].
    pub tolerance_m: Option<f64>,
}

impl GoalMark {
    const TOLERANCE: LineStyle = LineStyle { color: INK, width_px: 0.9, dashes: "2.5 2" };

    /// Returns the tolerance; 0 without one, or if it is not a valid length.
    fn radius_m(&self) -> f64 {
        self.tolerance_m.filter(|r| r.is_finite() && *r > 0.0).unwrap_or(0.0)
    }
}

impl Layer for GoalMark {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include(self.point);
        extent.include_disc(self.point, self.radius_m());
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        draw_letter(canvas, self.point, GOAL, "goal");
        let radius = self.radius_m() * canvas.view().px_per_m();
        // A circle hidden by the letter is not drawn.
        if radius > LETTER_MARK_PX + 2.0 && self.point.is_finite() {
            let (x, y) = canvas.view().px_from_world(self.point);
            let circle = canvas.writer().tag("circle").round(x, y, radius).attr("fill", "none");
            circle.line_style(Self::TOLERANCE).leaf();
            canvas.explain(LegendEntry::new("goal tolerance", LegendMark::Circle(Self::TOLERANCE)));
        }
    }
}

/// The position at which a run ended without reaching its goal: X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndMark<'a> {
    /// Position \[m\].
    pub point: Point,
    /// Reason of the end, for the legend.
    pub label: &'a str,
}

impl Layer for EndMark<'_> {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include(self.point);
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        draw_letter(canvas, self.point, END, self.label);
    }
}

/// Goals that were not chosen: G, light.
#[derive(Clone, Debug)]
pub struct OtherGoals<'a> {
    all: &'a [Point],
    label: String,
}

impl<'a> OtherGoals<'a> {
    /// Creates the goals other than the one that the path leads to.
    pub fn new(goals: &'a [Point]) -> Self {
        Self { all: goals, label: "other goal".to_owned() }
    }

    /// Sets the text in the legend.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }
}

impl Layer for OtherGoals<'_> {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        self.all.iter().for_each(|&point| extent.include(point));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let mut label = Some(self.label.as_str());
        for &point in self.all {
            draw_letter(canvas, point, OTHER_GOAL, label.take().unwrap_or_default());
        }
    }
}

/// Start and goal of several robots: their numbers, from 0, on light discs for starts and dark
/// ones for goals.
#[derive(Clone, Debug)]
pub struct NumberedEnds<'a>(
    /// Start and goal of each robot \[m\].
    pub &'a [(Point, Point)],
);

impl Layer for NumberedEnds<'_> {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn extend(&self, extent: &mut Extent) {
        for &(start, goal) in self.0 {
            extent.include(start);
            extent.include(goal);
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        for (label, dark) in [("start of a robot, and its number", false), ("its goal", true)] {
            canvas.explain(LegendEntry::new(label, LegendMark::Letter { letter: '0', dark }));
        }
        let mut placed: Vec<(f64, f64)> = Vec::new();
        for (number, &(start, goal)) in self.0.iter().enumerate() {
            let number = number.to_string();
            for (at, dark) in [(start, false), (goal, true)] {
                if !at.is_finite() {
                    continue;
                }
                let (mut x, y) = canvas.view().px_from_world(at);
                // The start of one robot may be the goal of another: both are visible, side by
                // side.
                let is_taken = |x: f64| {
                    placed.iter().any(|one| (one.0 - x).hypot(one.1 - y) < 2.0 * LETTER_MARK_PX)
                };
                while is_taken(x) {
                    x += 2.0 * LETTER_MARK_PX + 1.0;
                }
                placed.push((x, y));
                letter_mark(canvas.writer(), (x, y), &number, dark);
            }
        }
    }
}

/// A letter or a number; the flag is true if its disc is dark.
type Mark<'a> = (&'a str, bool);
const START: Mark<'_> = ("S", false);
const GOAL: Mark<'_> = ("G", true);
const END: Mark<'_> = ("X", true);
const OTHER_GOAL: Mark<'_> = ("G", false);

/// Draws a marker, and explains it unless the label is empty. If the marker would hide a disc, it
/// is drawn beside its position, at the end of a line from there.
fn draw_letter(canvas: &mut Canvas<'_>, at: Point, (text, dark): Mark<'_>, label: &str) {
    if !at.is_finite() {
        return;
    }
    let (x, y) = canvas.view().px_from_world(at);
    // A disc is visible if this much of it protrudes.
    let hidden_px = LETTER_MARK_PX + 3.0;
    let reach = |((cx, cy), radius): &((f64, f64), f64)| (cx - x).hypot(cy - y) + radius;
    let hidden = canvas.discs.iter().map(reach).filter(|reach_px| *reach_px < hidden_px);
    let px = hidden.reduce(f64::max).map_or((x, y), |reach_px| {
        // Towards the middle of the plot, where there is space.
        let aside_px = (reach_px + LETTER_MARK_PX + 6.0) * std::f64::consts::FRAC_1_SQRT_2;
        let view = canvas.view();
        let towards = |at: f64, side: f64| aside_px.copysign(0.5 * side - at);
        let px = (x + towards(x, view.width_px()), y + towards(y, view.height_px()));
        let leader = PathData::line([(x, y), px]);
        for (color, width_px) in [(FREE, 3.0), (INK, 1.2)] {
            canvas.path(&leader, LineStyle::solid(color, width_px));
        }
        px
    });
    letter_mark(canvas.writer(), px, text, dark);
    if let Some(letter) = text.chars().next().filter(|_| !label.is_empty()) {
        canvas.explain(LegendEntry::new(label, LegendMark::Letter { letter, dark }));
    }
}
