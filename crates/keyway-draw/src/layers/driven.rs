//! Driven trajectory of a robot, coloured by speed, and its outlines along it.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{INK, QUIET, viridis};
use crate::legend::{ColorBar, LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::ticks::Ticks;
use crate::view::Extent;
use crate::writer::{PathData, SvgWriter};
use keyway::geometry::{Point, Pose};
use keyway::robot::Footprint;
use keyway_sim::sim::TrajectoryPoint;

fn is_drawable(point: &TrajectoryPoint) -> bool {
    point.pose.point().is_finite() && point.velocity.v.is_finite()
}

/// Wide enough that a path is visible over it.
pub(crate) const DRIVEN_WIDTH_PX: f64 = 4.0;
/// Distinct colours along a trajectory.
const COLORS: u32 = 32;
/// Points closer than this \[px\] count as one: a smaller distance is not visible.
const MIN_STEP_PX: f64 = 0.25;

/// Radius below which a robot's outline \[px\] would only blot its trajectory.
const MIN_ROBOT_PX: f64 = 3.0;

/// Draws a dark rim below a coloured line: without it, the light end of the colours vanishes on
/// white.
pub(crate) fn casing(out: &mut SvgWriter, path: &PathData) {
    let line = out.tag("path").attr("fill", "none").stroke(INK, DRIVEN_WIDTH_PX + 1.1);
    let line = line.attr("stroke-linecap", "round").attr("stroke-linejoin", "round");
    line.attr("d", path.as_str()).leaf();
}

/// A trajectory coloured by forward speed, with a colour bar.
#[derive(Clone, Debug)]
pub struct DrivenPath<'a> {
    points: &'a [TrajectoryPoint],
    v_max_mps: Option<f64>,
}

impl<'a> DrivenPath<'a> {
    /// Creates the layer with colours from standstill (or the fastest reverse speed) to the
    /// highest speed driven.
    pub const fn new(points: &'a [TrajectoryPoint]) -> Self {
        Self { points, v_max_mps: None }
    }

    /// Sets the speed of the lightest colour, so that several pictures can be compared.
    #[must_use]
    pub const fn v_max_mps(self, v_max_mps: f64) -> Self {
        Self { v_max_mps: Some(v_max_mps), ..self }
    }

    fn speed_range(&self) -> (f64, f64) {
        let speeds = || self.points.iter().filter(|p| is_drawable(p)).map(|p| p.velocity.v);
        let low = speeds().fold(0.0, f64::min);
        let given = self.v_max_mps.filter(|v| v.is_finite() && *v > low);
        let high = given.unwrap_or_else(|| speeds().fold(0.0, f64::max));
        if high > low {
            let ticks = Ticks::new(low, high, 5);
            let low = if low < 0.0 { ticks.round_down(low) } else { 0.0 };
            (low, given.unwrap_or_else(|| ticks.round_up(high)))
        } else {
            (low, low + 1.0)
        }
    }

    /// Returns the pixels and speeds of the distinguishable points.
    fn steps(&self, canvas: &Canvas<'_>) -> Vec<((f64, f64), f64)> {
        let mut steps: Vec<((f64, f64), f64)> = Vec::new();
        let drawable: Vec<&TrajectoryPoint> =
            self.points.iter().filter(|p| is_drawable(p)).collect();
        for (i, point) in drawable.iter().enumerate() {
            let px = canvas.view().px_from_world(point.pose.point());
            let moved = steps
                .last()
                .is_none_or(|((x, y), _)| (px.0 - x).abs().max((px.1 - y).abs()) >= MIN_STEP_PX);
            if moved || i + 1 == drawable.len() {
                steps.push((px, point.velocity.v));
            }
        }
        steps
    }
}

impl Layer for DrivenPath<'_> {
    fn depth(&self) -> Depth {
        Depth::Driven
    }

    fn extend(&self, extent: &mut Extent) {
        self.points.iter().for_each(|point| extent.include(point.pose.point()));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let mut steps = self.steps(canvas);
        let Some(&first) = steps.first() else { return };
        if steps.len() == 1 {
            // A line of length 0 with round ends is a dot.
            steps.push(first);
        }
        let (low, high) = self.speed_range();
        casing(canvas.writer(), &PathData::line(steps.iter().map(|step| step.0)));
        let color_of = |pair: &[((f64, f64), f64)]| {
            let fraction = (0.5 * (pair[0].1 + pair[1].1) - low) / (high - low);
            (fraction.clamp(0.0, 1.0) * f64::from(COLORS - 1)).round()
        };
        let pairs: Vec<&[_]> = steps.windows(2).collect();
        for run in pairs.chunk_by(|a, b| color_of(a) == color_of(b)) {
            let color = viridis(color_of(run[0]) / f64::from(COLORS - 1));
            let points = std::iter::once(run[0][0].0).chain(run.iter().map(|pair| pair[1].0));
            canvas.path(&PathData::line(points), LineStyle::solid(color, DRIVEN_WIDTH_PX));
        }
        canvas.explain(LegendEntry::new("driven", LegendMark::ColoredLine));
        canvas.explain_colors(ColorBar { label: "speed [m/s]".to_owned(), low, high });
    }
}

/// Outlines of a robot along its trajectory, with a stroke for the heading. Nothing is drawn if
/// the robot is only a dot at the picture's scale.
#[derive(Clone, Debug)]
pub struct Footprints<'a> {
    points: &'a [TrajectoryPoint],
    footprint: &'a Footprint,
    every_m: Option<f64>,
    label: &'static str,
    style: LineStyle,
}

impl<'a> Footprints<'a> {
    const STYLE: LineStyle = LineStyle::solid(QUIET, 0.9);

    /// Creates the outlines of a robot, at distances at which they are distinguishable.
    pub const fn new(points: &'a [TrajectoryPoint], footprint: &'a Footprint) -> Self {
        Self { points, footprint, every_m: None, label: "robot", style: Self::STYLE }
    }

    /// Sets another style and its text in the legend; an empty text has no entry.
    #[must_use]
    pub const fn looking(self, label: &'static str, style: LineStyle) -> Self {
        Self { label, style, ..self }
    }

    /// Sets the driven distance between two outlines \[m\].
    #[must_use]
    pub const fn every_m(self, every_m: f64) -> Self {
        Self { every_m: Some(every_m), ..self }
    }

    /// Returns the front of the footprint, straight ahead of the centre of rotation.
    fn front(&self) -> Point {
        let x = match self.footprint {
            Footprint::Circle(disc) => disc.radius_m(),
            Footprint::Polygon(polygon) => {
                polygon.vertices().iter().map(|vertex| vertex.x).fold(0.0, f64::max)
            }
        };
        Point::new(x, 0.0)
    }

    /// Returns poses at equal distances, beginning with the first.
    fn poses(&self) -> Vec<Pose> {
        let poses = || self.points.iter().filter(|p| is_drawable(p)).map(|p| p.pose);
        let step = |from: Option<Point>, to: Point| from.map_or(0.0, |from| from.distance(to));
        let mut last = None;
        let length: f64 = poses().map(|p| step(last.replace(p.point()), p.point())).sum();
        // About twenty outlines on a long trajectory, never overlapping on a short one.
        let apart_m = (length / 20.0).max(2.5 * self.footprint.circumscribed_radius_m());
        let every = self.every_m.filter(|d| *d > 0.0).unwrap_or(apart_m);
        let (mut last, mut since) = (None, f64::INFINITY);
        let mut kept = Vec::new();
        for pose in poses() {
            since += step(last.replace(pose.point()), pose.point());
            if since >= every {
                kept.push(pose);
                since = 0.0;
            }
        }
        kept
    }
}

impl Layer for Footprints<'_> {
    fn depth(&self) -> Depth {
        Depth::Robot
    }

    fn extend(&self, extent: &mut Extent) {
        let radius = self.footprint.circumscribed_radius_m();
        self.points.iter().for_each(|p| extent.include_disc(p.pose.point(), radius));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let view = *canvas.view();
        if self.footprint.circumscribed_radius_m() * view.px_per_m() < MIN_ROBOT_PX {
            return;
        }
        let poses = self.poses();
        let style = self.style;
        for pose in &poses {
            let (x, y) = view.px_from_world(pose.point());
            match self.footprint {
                Footprint::Circle(disc) => {
                    let circle = canvas.writer().tag("circle").attr("fill", "none");
                    let radius_px = disc.radius_m() * view.px_per_m();
                    circle.round(x, y, radius_px).line_style(style).leaf();
                }
                Footprint::Polygon(polygon) => {
                    let place = |&vertex: &Point| view.px_from_world(pose.world_from_body(vertex));
                    let corners = polygon.vertices().iter().chain(polygon.vertices().first());
                    canvas.path(&PathData::line(corners.map(place)), style);
                }
            }
            let rim = view.px_from_world(pose.world_from_body(self.front()));
            canvas.path(&PathData::line([(x, y), rim]), style);
        }
        if !poses.is_empty() && !self.label.is_empty() {
            let mark = match self.footprint {
                Footprint::Circle(_) => LegendMark::Circle(style),
                Footprint::Polygon(_) => LegendMark::Box(style),
            };
            canvas.explain(LegendEntry::new(self.label, mark));
        }
    }
}
